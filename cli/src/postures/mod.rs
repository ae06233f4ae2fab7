//! The commands `sweep`, `merge`, `map` and `path`: try tool postures at every triangle, join the shards of a sweep, print or draw the
//! result, and plan a path over it. `picture` draws both on the part.

pub(crate) mod map;
pub(crate) mod path;
pub(crate) mod picture;
pub(crate) mod shard;
pub(crate) mod sweep;
mod touched;

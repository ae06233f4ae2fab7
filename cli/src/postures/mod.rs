//! The commands `sweep`, `map` and `path`: try tool postures at every triangle, print or draw the result, and plan a
//! path over it. `picture` draws both on the part; `post` writes G-code, and `prove` checks what is written.

pub(crate) mod map;
pub(crate) mod path;
pub(crate) mod picture;
mod post;
mod prove;
pub(crate) mod sweep;
mod touched;

//! The commands `sweep`, `map` and `path`: try tool postures at every triangle, print or draw the result, and plan a
//! path over it. `picture` draws both on the part; `post` writes G-code, and `prove` checks what is written.

pub(crate) mod map;
pub(crate) mod path;
pub(crate) mod picture;
mod post;
mod prove;
pub(crate) mod sweep;
mod touched;

use touchoff::Unit;

/// Returns the default depth tolerance of postures, 0.01 mm, in `unit`. Recordings of the haptic loop use it too.
pub(crate) fn default_tolerance(unit: Unit) -> f64 {
    0.01 * Unit::Millimetre.factor_to(unit)
}

//! The haptic loop with a simulated hand: what it shakes at, how long it takes.

pub mod latency;
pub mod page;
pub mod shake;
mod smooth;

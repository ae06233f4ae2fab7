//! The haptic loop with a simulated hand: force roughness, and the time per cycle.

pub mod latency;
pub mod page;
pub mod roughness;
mod smooth;

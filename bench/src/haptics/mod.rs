//! The haptic loop with a simulated hand: the stiffest walls, force roughness, and the time per cycle.

pub mod latency;
pub mod page;
pub mod roughness;
mod smooth;
pub mod wall;

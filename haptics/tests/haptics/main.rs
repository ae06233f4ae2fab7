//! The haptic loop: against theory, and against faults of devices, clocks and hands.

mod energy;
mod faults;
mod settings;
mod sheet;
mod solid;
#[cfg(unix)]
mod spacenav;
mod stiffness;
mod time;
mod wall;

//! The haptic loop: against theory, and against what devices, clocks and hands do wrong.

mod energy;
mod faults;
mod settings;
mod sheet;
mod solid;
#[cfg(unix)]
mod spacenav;
mod time;
mod wall;

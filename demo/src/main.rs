//! The first look at Touchoff: a program is checked, then contacts are timed beside the figures of Ho (1999).
//!
//! It depends on as little as these need, so that a fresh clone shows them soon; the program `touchoff` is the package
//! `touchoff-cli`.

mod job;
mod table;

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    job::check()?;
    println!();
    table::measure()
}

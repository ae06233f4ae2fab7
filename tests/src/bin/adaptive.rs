//! Prints `docs/measured/adaptive.md`.

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    print!("{}", touchoff_tests::measure::adaptive::page()?);
    Ok(())
}

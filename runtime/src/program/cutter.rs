//! The cutter that a program says it is for, beside the tool that is at hand.

use super::{Cutter, Program, ProgramError};
use crate::tool::Card;
use crate::unit::Unit;

/// Lengths of cutters are written with few digits: they may differ by this part of the diameter.
const ROUNDED: f64 = 1e-3;

impl Program {
    /// Compares the arguments of APT's `CUTTER`, and of NX's `TLDATA/MILL`, with a tool; `part` is the unit of a program that states
    /// none. Returns the line of a `CUTTER` that cannot be compared: two numbers do not describe the tool
    /// (see [`Cutter::of`]).
    ///
    /// `CUTTER/d,r,e,f,a,b,h` is the diameter, the radius of the corner, the place of its centre from the
    /// axis and from the tip, the angles of end and side in degrees, and the height. What is given of the
    /// first six is compared.
    ///
    /// # Errors
    /// If one is not the tool's.
    pub fn check_cutter(&self, card: &Card, part: Unit) -> Result<Option<usize>, ProgramError> {
        let unit = self.unit.unwrap_or(part);
        let Some((first, _)) = self.cutters.first() else { return Ok(None) };
        let Some(Cutter { diameter, corner }) = Cutter::of(card, unit) else {
            return Ok(Some(*first));
        };
        let expected = [diameter, corner, 0.5 * diameter - corner, corner, 0.0, 0.0];
        let alike =
            |(stated, expected): (&f64, &f64)| (stated - expected).abs() <= ROUNDED * diameter;
        let other =
            self.cutters.iter().find(|(_, stated)| !stated.iter().zip(&expected).all(alike));
        let Some((line, stated)) = other else { return Ok(None) };
        let list: Vec<String> = stated.iter().map(f64::to_string).collect();
        Err(ProgramError::Cutter {
            file: self.file.clone(),
            line: *line,
            stated: list.join(","),
            tool: card.name.to_string(),
            expected: format!("{diameter},{corner}"),
            unit,
        })
    }
}

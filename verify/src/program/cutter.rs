//! Comparison of the cutter that a program states with the tool at hand.

use super::{ClData, Cutter, ProgramError};
use touchoff::Unit;
use touchoff::tool::ToolInfo;

/// Tolerance of lengths as a fraction of the diameter: cutters are written with few digits.
const ROUNDED: f64 = 1e-3;

impl ClData {
    /// Compares the arguments of APT's `CUTTER`, and of NX's `TLDATA/MILL`, with a tool. `part` is the unit of
    /// a program that states none. Returns the line of a `CUTTER` that cannot be compared because two numbers
    /// do not describe the tool (see [`Cutter::of`]).
    ///
    /// `CUTTER/d,r,e,f,a,b,h` is the diameter, the radius of the corner, the distances of its centre from the
    /// axis and from the tip, the angles of end and side in degrees, and the height. Those of the first six
    /// that are given are compared.
    ///
    /// # Errors
    /// If a stated cutter is not the tool's.
    pub fn check_cutter(&self, info: &ToolInfo, part: Unit) -> Result<Option<usize>, ProgramError> {
        let unit = self.unit.unwrap_or(part);
        let Some((first, _)) = self.cutters.first() else { return Ok(None) };
        let Some(Cutter { diameter, corner }) = Cutter::of(info, unit) else {
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
            tool: info.name.to_string(),
            expected: format!("{diameter},{corner}"),
            unit,
        })
    }
}

//! A finishing pass checked against the part: `cargo run --release -p touchoff-verify --example check_program`.

use nalgebra::Point3;
use std::io::Write;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::shapes;
use touchoff::{Interval, Unit};
use touchoff_verify::{ClData, FindingKind, Verifier};

touchoff::tool! {
    tool EndMill "12 mm across, 20 mm of it cut, in a holder 50 mm wide" {
        units mm;
        profile {
            start (0, 0);
            line to (6, 0) as face cutting;
            line to (6, 20) as flute cutting;
            line to (6, 45) as shank;
            line to (25, 45), (25, 90), (0, 90) as holder;
        }
        niceness cutting: 1;
    }
}

/// A pass along a wall 30 mm high with its face at x = 0. One point is 0.05 mm in the wall. The retract is not
/// high enough to cross it: both ends of that motion are clear, and the motion between them is not.
const PROGRAM: &str = "\
PARTNO/WALL
UNITS/MM
MULTAX/ON
RAPID
GOTO/-8,-40,12,0,0,1
GOTO/-6,-40,12,0,0,1
GOTO/-6,0,12,0,0,1
GOTO/-5.95,40,12,0,0,1
GOTO/-6,80,12,0,0,1
RAPID
GOTO/-6,80,25,0,0,1
RAPID
GOTO/40,0,25,0,0,1
FINI
";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (low, high) = (Point3::new(0.0, -60.0, 0.0), Point3::new(20.0, 60.0, 30.0));
    let wall = TriangleBvh::new(&shapes::cuboid(low, high, Unit::Millimetre)?);
    let program = ClData::parse(PROGRAM, "wall.apt")?;
    // Allow 0.01 mm everywhere, and keep the holder 1 mm away.
    let verifier =
        Verifier::new(&wall, &EndMill)?.with_tolerance(0.01)?.with_allowance("holder", -1.0)?;
    let report = verifier.check(&program)?;
    let name = |surface| &*verifier.info().surface(surface).name;
    let mut out = std::io::stdout().lock();
    for found in &report.findings {
        write!(out, "wall.apt:{}: at fraction {:.2} of the motion, ", found.line, found.time)?;
        match found.kind {
            FindingKind::Deep { surface, depth: Interval { low, high }, witness, .. } => writeln!(
                out,
                "{} is {low:.4} to {high:.4} mm deep in triangle {}",
                name(surface),
                witness.triangle
            )?,
            FindingKind::Near { surface, distance: Interval { low, high }, .. } => {
                writeln!(out, "{} is {low:.4} to {high:.4} mm away", name(surface))?;
            }
            other => writeln!(out, "{other:?}")?,
        }
    }
    writeln!(out, "{} findings in {} motions", report.findings.len(), report.motions)?;
    Ok(())
}

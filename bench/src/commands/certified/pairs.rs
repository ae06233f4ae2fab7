//! The section of `certified.md` on brute force.

use std::error::Error;
use std::path::Path;
use touchoff::certify::TriangleBvh;
use touchoff::{Mesh, Unit};
use touchoff_bench::certified::{Pair, Row, poses, table};
use touchoff_bench::page::Section;
use touchoff_bench::parallel;
use touchoff_tests::oracle::Nearest;

const TOOLS: [&str; 6] = ["Fig73Exact", "BullNose", "Lollipop", "TSlot", "BallEr16", "TaperedBall"];

/// Files of real parts and their units; missing files are skipped.
const FILES: [(&str, Unit); 4] = [
    ("impeller.stl", Unit::Millimetre),
    ("featuretype_inch.stl", Unit::Inch),
    ("octagonal_pocket_metre.stl", Unit::Metre),
    ("kiri_pocket_test.stl", Unit::Millimetre),
];

/// Returns the section about `count` poses, with the violations. `folder` has the real parts; missing ones are skipped.
pub(super) fn section(count: usize, seed: u64, folder: &Path) -> Result<Section, Box<dyn Error>> {
    let mut parts = poses::parts()?;
    for (name, unit) in FILES {
        let path = folder.join(name);
        if path.exists() {
            parts.push((name, Mesh::read_stl(path, unit)?));
        } else {
            eprintln!("{name} is skipped: there is no {}", path.display());
        }
    }
    let count = count / (parts.len() * TOOLS.len()).max(1);
    let rows = rows(&parts, count, seed);
    let about = format!(
        "For each tool and part {count} poses: most put the tool's surface between 1e-9 and 6 mm into a triangle, a sixth lie along the
coordinate axes and flush with the part's box, a tenth are anywhere about the part. Tolerances are 0, 1e-9, 1e-6 and 1e-3 in turn.
All lengths are in the part's unit. *Over* is by how much a sample of brute force, or one beside the witness, is above the upper bound,
*under* by how much the witness is shallower than the lower one; 0 where it never is. *Brute behind* is by how much brute force without
the witness, which does not zoom, falls short of the lower bound, *reached* at how many poses by no more than 1e-6. *Wider* counts intervals wider than the tolerance and rounding.

"
    );
    Ok(Section {
        title: "Beside brute force",
        body: about + &table(&rows)?,
        missed_limits: rows.into_iter().flat_map(|row| row.violations).collect(),
    })
}

/// Returns one row per part and tool.
fn rows(parts: &[(&str, Mesh)], count: usize, seed: u64) -> Vec<Row> {
    let bvh: Vec<TriangleBvh> = parts.iter().map(|(_, mesh)| TriangleBvh::new(mesh)).collect();
    parallel::rows(parts.len() * TOOLS.len(), |k| {
        let ((part, mesh), name) = (&parts[k / TOOLS.len()], TOOLS[k % TOOLS.len()]);
        let tool = tools_library::find(name).expect("a tool of the library");
        let oracle = Nearest::of(name);
        let pair = Pair { part, mesh, bvh: &bvh[k / TOOLS.len()], tool, oracle: &oracle };
        let row = pair.measure(count, seed + k as u64);
        eprintln!("{} in {}: {} violations", row.tool, part, row.violations.len());
        row
    })
}

//! The section of `certified.md` on zooming samples, and on tools inside the material.

use std::error::Error;
use touchoff::certify::TriangleBvh;
use touchoff_bench::certified::depth_oracle::{DepthOracle, FIELDS, PROFILES};
use touchoff_bench::certified::{enclosed, poses, zoomed};
use touchoff_bench::page::Section;
use touchoff_bench::parallel;

/// Returns the section about at least `count` poses, with this number of samples at each pose where a triangle is near.
pub(super) fn section(count: usize, samples: u64, seed: u64) -> Result<Section, Box<dyn Error>> {
    let parts = poses::parts()?;
    let names: Vec<&str> = PROFILES.iter().chain(&FIELDS).copied().collect();
    let poses_each = count.div_ceil(parts.len() * names.len());
    let bvh: Vec<TriangleBvh> = parts.iter().map(|(_, mesh)| TriangleBvh::new(mesh)).collect();
    let rows = parallel::rows(parts.len() * names.len(), |k| {
        let ((part, mesh), name) = (&parts[k / names.len()], names[k % names.len()]);
        let tool = tools_library::find(name).expect("a tool of the library");
        let oracle = DepthOracle::of(name);
        let bvh = &bvh[k / names.len()];
        let row = zoomed::Zoomed { part, mesh, bvh, tool, depth_oracle: &oracle }.measure(
            poses_each,
            samples,
            seed + k as u64,
        );
        eprintln!("{name} in {part}: {} violations", row.violations.len());
        row
    });
    // The extents of a solid are not distances from an axis.
    let round: Vec<&str> =
        names.into_iter().filter(|name| !["Block", "LBracket"].contains(name)).collect();
    let blocks = parallel::rows(round.len(), |k| {
        let oracle = DepthOracle::of(round[k]);
        let tool = tools_library::find(round[k]).expect("a tool of the library");
        let count = if matches!(oracle, DepthOracle::Profile(..)) { 1000 } else { 20 };
        enclosed::measure(tool, &oracle, count, seed)
    });

    let about = format!(
        "For each tool and part {poses_each} poses with {samples} samples each where a triangle is near. Half of them are middles of triangles and of their halves, the piece that may
have the deepest place first; the others zoom in on the deepest of these. Lengths are parts of the tool's size. *Over* is by how much a sample is above the upper
bound, *behind* by how much the samples fall short of the lower one, which they do not know, *reached* at how many poses by no more than 1e-9 or, of the tools by
their field or with overhangs, 1e-6. Tolerances are 1e-9 of the size, and of these 1e-6 mm; *wider* counts intervals wider than that and rounding.

"
    );
    let enclosed_violations = blocks.iter().flat_map(|row| row.violations.clone());
    let missed_limits =
        rows.iter().flat_map(|row| row.violations.clone()).chain(enclosed_violations).collect();
    Ok(Section {
        title: "Beside samples that zoom in",
        body: about + &zoomed::table(&rows, &blocks)?,
        missed_limits,
    })
}

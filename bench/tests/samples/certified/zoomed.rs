//! Certified depths compared with zooming samples, and tools inside blocks: a sample of `docs/measured/certified.md`.

use super::tool;
use touchoff::certify::TriangleBvh;
use touchoff_bench::certified::depth_oracle::{DepthOracle, PROFILES};
use touchoff_bench::certified::zoomed::Zoomed;
use touchoff_bench::certified::{enclosed, poses};

const SAMPLES: u64 = 40_000;

#[test]
fn samples_that_zoom_in_are_within_the_interval() {
    let (mut queried, mut reached) = (0, 0);
    let parts = poses::parts().expect("parts");
    // The thousands of slivers in the tube need more samples than a test can afford.
    for (part, mesh) in parts.iter().filter(|(part, _)| *part != "tube") {
        let bvh = TriangleBvh::new(mesh);
        for name in PROFILES.iter().chain(&["Fig73", "UnitSphere", "Block"]) {
            let subject = DepthOracle::of(name);
            let zoomed = Zoomed { part, mesh, bvh: &bvh, tool: tool(name), depth_oracle: &subject };
            let row = zoomed.measure(4, SAMPLES, 3);
            assert!(row.violations.is_empty() && row.too_wide == 0, "{row:?}");
            queried += row.poses;
            reached += row.reached;
        }
    }
    assert!(10 * reached > 9 * queried, "{reached} of {queried}");
}

#[test]
fn a_tool_in_a_block_is_inside_unless_a_face_cuts_it() {
    for name in PROFILES {
        let row = enclosed::measure(tool(name), &DepthOracle::of(name), 40, 5);
        assert!(row.violations.is_empty(), "{row:?}");
        assert!(row.inside[1] > 10 && row.cut[1] > 10, "{row:?}");
    }
}

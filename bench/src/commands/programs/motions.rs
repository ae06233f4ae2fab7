//! Certified motions compared with samples.

use clap::Args;
use clap::builder::PossibleValuesParser;
use std::error::Error;
use touchoff::Mesh;
use touchoff::certify::TriangleBvh;
use touchoff_bench::certified::sweeps::{Row, table};
use touchoff_bench::certified::{Pair, poses};
use touchoff_bench::page::Section;
use touchoff_bench::parallel;
use touchoff_tests::oracle::Nearest;

/// Library tools; the last is in inches.
const TOOLS: [&str; 10] = [
    "Fig73Exact",
    "BullNose",
    "TSlot",
    "BallEr16",
    "TaperedBall",
    "Lollipop",
    "Barrel",
    "CornerRounding",
    "Dovetail",
    "HalfInchBallCat40",
];

#[derive(Args)]
pub(super) struct Motions {
    /// Number of motions to prove clear, over all parts and tools together.
    #[arg(long, value_name = "N", default_value_t = 10_000)]
    motions: usize,
    /// Seed for the motions.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Measures only this tool, with its share of the motions [default: all tools].
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(TOOLS))]
    tool: Option<String>,
}

impl Motions {
    pub(super) fn section(&self) -> Result<Section, Box<dyn Error>> {
        let parts = poses::parts()?;
        let count = self.motions / (parts.len() * TOOLS.len());
        let rows = self.rows(&parts, count);
        let introduction = format!(
            "For each tool and part motions are drawn until {count} are proved: slides, swings about the tip and about a place of the part by up to 150°,
plunges, straight ways, none at all, rapid moves and any between two poses. Most are moved to where they pass the part by 1e-7 to 0.5 mm,
some as much too near. Tolerances are 0, 1e-6 and 1e-3 in turn. Those that are proved are sampled at 66 times and 30 more beside the
closest, and from the best six a search climbs in time and place. All lengths are in the part's unit. *Near* is closer than 0.001; *over* is by how
much a sample is deeper than the tolerance and rounding, less than 0 where none is.

"
        );
        Ok(Section {
            title: "Proved motions beside samples",
            body: introduction + &table(&rows)?,
            missed_limits: rows.into_iter().flat_map(|row| row.violations).collect(),
        })
    }

    /// Returns one row per part and tool.
    fn rows(&self, parts: &[(&str, Mesh)], count: usize) -> Vec<Row> {
        let bvh: Vec<TriangleBvh> = parts.iter().map(|(_, mesh)| TriangleBvh::new(mesh)).collect();
        let is_chosen = |name: &str| self.tool.as_deref().is_none_or(|chosen| chosen == name);
        let indices = (0..parts.len() * TOOLS.len()).filter(|k| is_chosen(TOOLS[k % TOOLS.len()]));
        let indices: Vec<usize> = indices.collect();
        parallel::rows(indices.len(), |index| {
            let k = indices[index];
            let ((part, mesh), name) = (&parts[k / TOOLS.len()], TOOLS[k % TOOLS.len()]);
            let tool = tools_library::find(name).expect("a tool of the library");
            let oracle = Nearest::of(name);
            let bvh = &bvh[k / TOOLS.len()];
            let row =
                Pair { part, mesh, bvh, tool, oracle: &oracle }.sweeps(count, self.seed + k as u64);
            eprintln!(
                "{name} in {part}: {} of {} proved, {} undecided, {} violations",
                row.proved,
                row.motions,
                row.undecided.len(),
                row.violations.len()
            );
            row.violations.iter().for_each(|violation| eprintln!("{violation}"));
            row
        })
    }
}

//! The page `zoomed.md`: certified penetrations beside samples that zoom in, and tools inside the material.

use clap::Args;
use std::error::Error;
use touchoff::certify::Facets;
use touchoff_bench::certified::subject::{FIELDS, PROFILES, Subject};
use touchoff_bench::certified::{buried, poses, zoomed};
use touchoff_bench::page::Page;
use touchoff_bench::parallel;

/// Compares certified penetrations with the largest of samples that zoom in, and asks about tools inside the material.
#[derive(Args)]
pub(crate) struct Zoomed {
    /// Poses of all parts and tools together, at least.
    #[arg(long, value_name = "N", default_value_t = 1040)]
    poses: usize,
    /// Samples of each pose at which a triangle is near.
    #[arg(long, value_name = "M", default_value_t = 10_000_000)]
    samples: u64,
    /// Seed of the poses and samples.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
}

impl Zoomed {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        let parts = poses::parts()?;
        let names: Vec<&str> = PROFILES.iter().chain(&FIELDS).copied().collect();
        let each = self.poses.div_ceil(parts.len() * names.len());
        let facets: Vec<Facets> = parts.iter().map(|(_, mesh)| Facets::new(mesh)).collect();
        let rows = parallel::rows(parts.len() * names.len(), |k| {
            let ((part, mesh), name) = (&parts[k / names.len()], names[k % names.len()]);
            let tool = tools_library::find(name).expect("a tool of the library");
            let subject = Subject::of(name);
            let facets = &facets[k / names.len()];
            let row = zoomed::Zoomed { part, mesh, facets, tool, subject: &subject }.measure(
                each,
                self.samples,
                self.seed + k as u64,
            );
            eprintln!("{name} in {part}: {} violations", row.violations.len());
            row
        });
        // A solid's extents are no distances from an axis.
        let round: Vec<&str> =
            names.into_iter().filter(|name| !["Block", "LBracket"].contains(name)).collect();
        let blocks = parallel::rows(round.len(), |k| {
            let subject = Subject::of(round[k]);
            let tool = tools_library::find(round[k]).expect("a tool of the library");
            let count = if matches!(subject, Subject::Profile(..)) { 1000 } else { 20 };
            buried::measure(tool, &subject, count, self.seed)
        });

        let about = format!(
            "For each tool and part {each} poses with {} samples each where a triangle is near. Half of them are middles of triangles and of their halves, the piece that may
have the deepest place first; the others zoom in on the deepest of these. Lengths are parts of the tool's size. *Over* is by how much a sample is above the upper
bound, *behind* by how much the samples fall short of the lower one, which they do not know, *reached* at how many poses by no more than 1e-9 or, of the tools by
their field or with overhangs, 1e-6. Tolerances are 1e-9 of the size, and of these 1e-6 mm; *wider* counts intervals wider than that and rounding.

",
            self.samples
        );
        let buried = blocks.iter().flat_map(|row| row.violations.clone());
        let missed = rows.iter().flat_map(|row| row.violations.clone()).chain(buried).collect();
        Ok(Some(Page {
            name: "zoomed",
            title: "Zoomed maxima".to_owned(),
            covers: &["runtime/src/certify"],
            body: about + &zoomed::table(&rows, &blocks)?,
            figures: Vec::new(),
            missed,
        }))
    }
}

//! The page `certified.md`: certified depths compared with brute force, zooming samples and a 256-bit reference.

mod pairs;
mod rounding;
mod zoomed;

use clap::Args;
use std::error::Error;
use std::path::PathBuf;
use touchoff_bench::page::Page;

/// Compares certified depths with brute force, with zooming samples, and with 256 bits where rounding errors are
/// largest.
#[derive(Args)]
pub(crate) struct Certified {
    /// Number of poses compared with brute force, over all parts and tools together.
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    poses: usize,
    /// Folder of further parts; missing ones are skipped [default: `../shared/data/parts`, beside the repository].
    #[arg(long, value_name = "FOLDER")]
    parts: Option<PathBuf>,
    /// Number of poses compared with zooming samples, over all parts and tools together.
    #[arg(long, value_name = "N", default_value_t = 1_040)]
    zoomed: usize,
    /// Number of samples per pose of these at which a triangle is near.
    #[arg(long, value_name = "M", default_value_t = 1_000_000)]
    samples: u64,
    /// Number of cases compared with 256 bits.
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    cases: u64,
    /// Seed for poses, samples and cases.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Prints only the case with this number, and makes no page.
    #[arg(long, value_name = "CASE")]
    case: Option<u64>,
}

impl Certified {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        if let Some(number) = self.case {
            rounding::show(number, self.seed)?;
            return Ok(None);
        }
        let sections = [
            pairs::section(self.poses, self.seed, &super::parts(self.parts.as_deref()))?,
            zoomed::section(self.zoomed, self.samples, self.seed)?,
            rounding::section(self.cases, self.seed)?,
        ];
        Ok(Some(Page {
            name: "certified",
            title: "Certified depths, judged",
            covers: &["runtime/src/certify"],
            sections: sections.into(),
            figures: Vec::new(),
        }))
    }
}

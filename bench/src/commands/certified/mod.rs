//! The page `certified.md`: certified depths beside brute force, beside samples that zoom in, and beside 256 bits.

mod pairs;
mod rounding;
mod zoomed;

use clap::Args;
use std::error::Error;
use std::path::PathBuf;
use touchoff_bench::page::Page;

/// Compares certified depths with brute force, with samples that zoom in, and with 256 bits where rounding does the most.
#[derive(Args)]
pub(crate) struct Certified {
    /// Poses beside brute force, of all parts and tools together.
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    poses: usize,
    /// Folder of more parts, of which those are taken that are there [default: `../shared/data/parts`, beside the repository].
    #[arg(long, value_name = "FOLDER")]
    parts: Option<PathBuf>,
    /// Poses beside samples that zoom in, of all parts and tools together.
    #[arg(long, value_name = "N", default_value_t = 1_040)]
    zoomed: usize,
    /// Samples of each of these poses at which a triangle is near.
    #[arg(long, value_name = "M", default_value_t = 1_000_000)]
    samples: u64,
    /// Cases beside 256 bits.
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    cases: u64,
    /// Seed of poses, samples and cases.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Prints this case alone, by its number, and makes no page.
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

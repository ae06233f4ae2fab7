//! The page `programs.md`: proved motions compared with samples, and time and memory of the check of long programs.

mod motions;
mod time;

use clap::Args;
use motions::Motions;
use std::error::Error;
use time::LongPrograms;
use touchoff_bench::page::Page;

/// Compares proved motions with samples of them, and times the check of long programs.
#[derive(Args)]
pub(crate) struct Programs {
    #[command(flatten)]
    long: LongPrograms,
    #[command(flatten)]
    motions: Motions,
}

impl Programs {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        // Long programs come first, since their peak memory is that of the process.
        let sections = vec![self.long.section()?, self.motions.section()?];
        Ok(Some(Page {
            name: "programs",
            title: "Programs: the time of a check, and proved motions beside samples",
            covers: &[
                "runtime/src/bvh",
                "runtime/src/certify",
                "verify/src/gcode",
                "verify/src/machine",
                "runtime/src/motion.rs",
                "runtime/src/pose.rs",
                "runtime/src/tool",
                "verify/src/check",
            ],
            sections,
            figures: Vec::new(),
        }))
    }
}

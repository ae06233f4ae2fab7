//! The page `stress.md`: every tool at difficult points, poses and scenes.

use clap::Args;
use clap::builder::RangedU64ValueParser;
use std::error::Error;
use touchoff_bench::page::{Page, Section};
use touchoff_bench::stress::ledger::ITEMS;
use touchoff_bench::stress::{StressSettings, measure, page};

/// Compares every tool with a 256-bit reference at difficult points, poses and scenes.
#[derive(Args)]
pub(crate) struct Stress {
    /// Measures a small sample instead of the full set.
    #[arg(long)]
    quick: bool,
    /// Seed for points, poses and scenes.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Measures only the item with this number [default: all items].
    #[arg(long, value_name = "N", value_parser = RangedU64ValueParser::<usize>::new().range(1..=ITEMS.len() as u64))]
    item: Option<usize>,
    /// Measures only the library tool with this name [default: all tools].
    #[arg(long, value_name = "NAME", value_parser = super::tool)]
    tool: Option<String>,
}

impl Stress {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        let amount = if self.quick {
            StressSettings::sample(self.seed)
        } else {
            StressSettings::full(self.seed)
        };
        let rows = measure(
            amount,
            |item| self.item.is_none_or(|chosen| item.0 == chosen),
            |name| self.tool.as_deref().is_none_or(|chosen| name == chosen),
        );
        let introduction = "\
Every tool of the library at points, poses and scenes that are hard, against 256 bits. *The contract* is that of `accuracy.md`: with S the next
power of two above the tool's largest coordinate, ε = 2^-52 and ulp(S) = ε S, a depth is within 1 ulp(S), the side and the owner are right
beyond 2 ulp(S), ||u| - 1| ≤ 4 ε, u is within 8 ε max(1, S/ρ), ρ the distance to the nearest place where it does not exist; nothing is
NaN, infinite or below 0, and both forms of the code have the same bits. Of `Fig73` the depth is its own magnitude. Places are given to
the last bit, in the tool's frame or as *point of tip, axes* (the rotation's columns). The same seed gives the same page.

";
        Ok(Some(Page {
            name: "stress",
            title: "Under stress",
            covers: &[
                "runtime/src/bvh",
                "runtime/src/certify",
                "runtime/src/cloud",
                "runtime/src/mesh",
                "runtime/src/motion.rs",
                "runtime/src/part.rs",
                "runtime/src/point_bvh",
                "runtime/src/pose.rs",
                "runtime/src/probe",
                "runtime/src/tool",
                "tool-dsl/src",
                ":!tool-dsl/src/diagnostic",
                ":!tool-dsl/src/draw",
                ":!tool-dsl/src/format",
                ":!tool-dsl/src/source.rs",
                "tools-library/tools",
            ],
            sections: vec![Section {
                title: "",
                body: introduction.to_owned() + &page::page(&rows)?,
                missed_limits: rows
                    .iter()
                    .filter(|row| row.exceeds_limit())
                    .map(|row| row.describe())
                    .collect(),
            }],
            figures: Vec::new(),
        }))
    }
}

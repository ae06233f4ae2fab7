//! The page `search.md`: climbs toward the worst points and poses.

use clap::Args;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;
use touchoff_bench::page::Page;
use touchoff_bench::parallel;
use touchoff_bench::search::Effort;
use touchoff_bench::search::found::{Line, lines};
use touchoff_bench::search::page::{missed, page};
use touchoff_bench::search::tool::{Hunted, hunt, names};

/// Climbs toward the worst points of each tool and the worst poses of each question.
#[derive(Args)]
pub(crate) struct Search {
    /// Seed of the climbs.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Steps of each climb.
    #[arg(long, value_name = "N", default_value_t = 1000)]
    steps: usize,
    /// Searches this tool alone [default: all of the library].
    #[arg(long, value_name = "NAME", value_parser = super::tool)]
    tool: Option<String>,
    /// Keeps the worst points in this file, beside those that it has of other tools and questions and where it has no worse.
    #[arg(long, value_name = "FILE")]
    found: Option<PathBuf>,
}

impl Search {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        let tools = self.tool.clone().map_or_else(names, |tool| vec![tool]);
        let steps = self.steps;
        let hunted = all(&tools, Effort::of(steps), self.seed);
        let about = format!(
            "Random points seldom meet the worst ones. Here they are climbed for: from the hardest of the points of
[accuracy.md](accuracy.md) and from pairs of neighbours on every border, by steps that shrink to single bits, {steps} a climb. What is
found is judged against 256 bits as there. *Jumps* are those between two points that are neighbours, one double apart in one
coordinate; *of its bound* is a share of what is promised; *64 ε sizes* is what certified answers are widened by, and below 0 what was left of it.

"
        );
        if let Some(file) = &self.found {
            keep(file, hunted.iter().flat_map(lines).collect())?;
        }
        Ok(Some(Page {
            name: "search",
            title: "Looking for the worst".to_owned(),
            covers: &["runtime/src", "tool-dsl/src", "tools-library/tools"],
            body: about + &page(&hunted)?,
            figures: Vec::new(),
            missed: missed(&hunted),
        }))
    }
}

/// Writes the worst line of each tool and question: of those that a file has and of new ones.
fn keep(file: &Path, found: Vec<Line>) -> std::io::Result<()> {
    let old = std::fs::read_to_string(file).unwrap_or_default();
    let mut kept: Vec<Line> = old.lines().filter_map(Line::read).collect();
    for line in found {
        let same = |known: &&mut Line| known.tool == line.tool && known.question == line.question;
        match kept.iter_mut().find(same) {
            Some(known) if known.error >= line.error => (),
            Some(known) => *known = line,
            None => kept.push(line),
        }
    }
    kept.sort_by(|a, b| a.tool.cmp(&b.tool).then((a.question as u8).cmp(&(b.question as u8))));
    let lines: Vec<String> = kept.iter().map(Line::text).collect();
    std::fs::write(file, lines.join("\n") + "\n")
}

/// Returns what is found of each tool.
fn all(tools: &[String], effort: Effort, seed: u64) -> Vec<Hunted> {
    parallel::rows(tools.len(), |k| {
        let (tool, start) = (&tools[k], Instant::now());
        let found = hunt(tool, effort, seed);
        eprintln!("{tool}: {:.1} s", start.elapsed().as_secs_f64());
        missed(std::slice::from_ref(&found)).iter().for_each(|line| eprintln!("{line}"));
        found
    })
}

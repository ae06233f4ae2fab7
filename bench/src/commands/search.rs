//! The page `docs/measured/search.md`: `search [--seed N] [--tool NAME] [--steps N] [--found FILE]`. What was found at points goes to the
//! file, beside what it has of other tools and questions and where it has no worse.

use rayon::prelude::*;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;
use touchoff_bench::search::Effort;
use touchoff_bench::search::found::{Line, lines};
use touchoff_bench::search::page::{missed, page};
use touchoff_bench::search::tool::{Hunted, hunt, names};

/// Steps of each climb.
const STEPS: usize = 1000;

fn main() -> Result<(), Box<dyn Error>> {
    let (mut seed, mut steps, mut found) = (1, STEPS, None::<PathBuf>);
    let mut tools = names();
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("what is `{word}`?"));
        match word.as_str() {
            "--seed" => seed = value()?.parse()?,
            "--steps" => steps = value()?.parse()?,
            "--found" => found = Some(value()?.into()),
            "--tool" => {
                let name = value()?;
                tools.retain(|tool| *tool == name);
            }
            _ => return Err(format!("`{word}` is not known").into()),
        }
    }
    let start = Instant::now();
    let hunted = all(&tools, Effort::of(steps), seed);
    println!(
        "# Looking for the worst

```sh
cargo run --release -p touchoff-bench --bin search -- --seed {seed} --steps {steps} > docs/measured/search.md
```

Random points seldom meet the worst ones. Here they are climbed for: from the hardest of the points of
[accuracy.md](accuracy.md) and from pairs of neighbours on every border, by steps that shrink to single bits, {steps} a climb. What is
found is judged against 256 bits as there. *Jumps* are those between two points that are neighbours, one double apart in one
coordinate; *of its bound* is a share of what is promised; *64 ε sizes* is what certified answers are widened by, and below 0 what was left of it.

{}",
        page(&hunted)?
    );
    eprintln!("{} tools in {:.0} s", hunted.len(), start.elapsed().as_secs_f64());
    if let Some(file) = found {
        keep(&file, hunted.iter().flat_map(lines).collect())?;
    }
    match missed(&hunted).len() {
        0 => Ok(()),
        count => Err(format!("{count} bars were missed").into()),
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

/// What is found of each tool, on all cores.
fn all(tools: &[String], effort: Effort, seed: u64) -> Vec<Hunted> {
    let hunted = tools.par_iter().with_max_len(1).map(|tool| {
        let start = Instant::now();
        let found = hunt(tool, effort, seed);
        eprintln!("{tool}: {:.1} s", start.elapsed().as_secs_f64());
        missed(std::slice::from_ref(&found)).iter().for_each(|line| eprintln!("{line}"));
        found
    });
    hunted.collect()
}

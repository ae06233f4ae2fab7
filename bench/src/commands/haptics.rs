//! The page `docs/measured/haptics.md` and its plots: `haptics [--quick] [--latency SECONDS] [--to FOLDER]`.

use std::error::Error;
use std::path::{Path, PathBuf};
use touchoff::haptic::{Energy, Rendering};
use touchoff::scenes::tube;
use touchoff::{Law, Part};
use touchoff_bench::haptics::latency;
use touchoff_bench::haptics::page::{Measured, page, plots};
use touchoff_bench::haptics::shake::{Case, Shaking, Way, shaking, tools};
use touchoff_bench::page::made;
use touchoff_tests::haptics::{energy, sheet, wall};

fn main() -> Result<(), Box<dyn Error>> {
    let (mut quick, mut seconds) = (false, 10.0);
    let mut to = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/measured");
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("what is `{word}`?"));
        match word.as_str() {
            "--quick" => quick = true,
            "--latency" => seconds = value()?.parse()?,
            "--to" => to = PathBuf::from(value()?),
            _ => return Err(format!("`{word}` is not known").into()),
        }
    }
    let rates: &[f64] = match quick {
        true => &[1000.0],
        false => &[250.0, 500.0, 1000.0, 2000.0, 5000.0, 10_000.0, 40_000.0],
    };
    let measured = Measured {
        walls: rates.iter().map(|rate| wall::row(*rate)).collect(),
        shaking: shaken(quick)?,
        sheet: pressed(),
        tapping: tapped(),
        latency: {
            // Five times as fast for a tenth of the time.
            let rates: &[f64] = if quick { &[1.0] } else { &[1.0, 5.0] };
            let run = |times: &f64| {
                let seconds = if *times > 1.0 { seconds / 10.0 } else { seconds };
                (1000.0 * times, seconds, latency::both(1000.0 * times, seconds))
            };
            rates.iter().map(run).collect()
        },
    };
    std::fs::create_dir_all(&to)?;
    let quickly = if quick { " --quick" } else { "" };
    let command = format!(
        "cargo run --release -p touchoff-bench --bin haptics --{quickly} --latency {seconds}"
    );
    let head = made(&command, &["runtime/src"]);
    let text = format!(
        "# The haptic loop

{head}

{}",
        page(&measured)?
    );
    std::fs::write(to.join("haptics.md"), text)?;
    for (name, plot) in plots(&measured) {
        std::fs::write(to.join(name), plot)?;
    }
    Ok(())
}

type Shaken = (usize, Case<'static>, Shaking);

fn shaken(quick: bool) -> Result<Vec<Shaken>, Box<dyn Error>> {
    let mut rows = Vec::new();
    let [own, exact, smooth] = tools();
    let points: &[usize] = if quick { &[20_000] } else { &[1_000, 20_000, 400_000] };
    for count in points {
        let part = Part::from_mesh(&tube(), *count, 1)?;
        let mut add = |way, tool, law, how, stiffness| {
            let case = Case { way, tool, law, how, stiffness };
            rows.push((*count, case, shaking(&part, &case)));
        };
        for law in [Law::Thesis, Law::Gradient] {
            for how in ["direct", "coupled"] {
                add(Way::Wall, exact, law, how, 3.0);
                for tool in [own, exact, smooth] {
                    add(Way::Edge, tool, law, how, 3.0);
                }
            }
            for how in ["direct", "scaled", "coupled"] {
                add(Way::Wall, exact, law, how, 300.0);
            }
        }
    }
    Ok(rows)
}

fn tapped() -> Vec<(&'static str, Vec<Energy>)> {
    let part = energy::plane();
    let direct = Some(Rendering::Direct { scaled: false, damping: 0.0 });
    vec![
        ("direct", energy::tapping(&part, direct, false)),
        ("direct, controlled", energy::tapping(&part, direct, true)),
        ("coupled, controlled", energy::tapping(&part, None, true)),
    ]
}

fn pressed() -> Vec<(&'static str, Vec<[f64; 3]>)> {
    let part = sheet::sheet();
    let direct = Some(Rendering::Direct { scaled: true, damping: 0.0 });
    vec![
        ("thesis, direct", sheet::pressed(&part, Law::Thesis, direct)),
        ("facing, direct", sheet::pressed(&part, Law::Facing, direct)),
        ("gradient, direct", sheet::pressed(&part, Law::Gradient, direct)),
        ("gradient, coupled", sheet::pressed(&part, Law::Gradient, None)),
    ]
}

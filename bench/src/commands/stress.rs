//! The page `docs/measured/stress.md`: `stress [--seed S] [--tool NAME] [--item N] [--quick]`.

use std::error::Error;
use std::time::Instant;
use touchoff_bench::stress::{Amount, measure, page};

fn main() -> Result<(), Box<dyn Error>> {
    let (mut quick, mut seed, mut item, mut tool) = (false, 1, None, None);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("what is `{word}`?"));
        match word.as_str() {
            "--quick" => quick = true,
            "--seed" => seed = value()?.parse()?,
            "--item" => item = Some(value()?.parse::<usize>()?),
            "--tool" => tool = Some(value()?),
            _ => return Err(format!("`{word}` is not known").into()),
        }
    }
    let start = Instant::now();
    let amount = if quick { Amount::sample(seed) } else { Amount::full(seed) };
    let rows = measure(
        amount,
        |one| item.is_none_or(|wanted| one.0 == wanted),
        |name| tool.as_deref().is_none_or(|wanted| name == wanted),
    );
    let quickly = if quick { " --quick" } else { "" };
    println!(
        "# Under stress

```sh
cargo run --release -p touchoff-bench --bin stress -- --seed {seed}{quickly} > docs/measured/stress.md
```

Every tool of the library at points, poses and scenes that are hard, against 256 bits. *The contract* is that of `accuracy.md`: with S the next
power of two above the tool's largest coordinate, ε = 2^-52 and ulp(S) = ε S, a depth is within 1 ulp(S), the side and the owner are right
beyond 2 ulp(S), ||u| - 1| ≤ 4 ε, u is within 8 ε max(1, S/ρ), ρ the distance to the nearest place where it does not exist; nothing is
NaN, infinite or below 0, and both forms of the code have the same bits. Of `Fig73` the depth is its own magnitude. Places are given to
the last bit, in the tool's frame or as *point of tip, axes* (the rotation's columns). The same seed gives the same page.
"
    );
    print!("{}", page::page(&rows)?);
    for row in rows.iter().filter(|row| row.missed()) {
        eprintln!("missed: {}", row.shown());
    }
    eprintln!("{:.0} s", start.elapsed().as_secs_f64());
    Ok(())
}

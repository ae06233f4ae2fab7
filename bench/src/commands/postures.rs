//! The tables of `docs/measured/postures.md`: `postures [--part FILE --unit UNIT] [--tools A,B,…] [--directions N]
//! [--tolerance T] [--niceness N] [--draws N] [--seed S]`. Without a part it is one that is made here.

use std::error::Error;
use touchoff::mesh::Shape;
use touchoff::{Mesh, Unit};
use touchoff_bench::postures::page::page;
use touchoff_bench::postures::parts::relief;
use touchoff_bench::postures::{Wanted, measure};

/// Into how many squares a side the part is cut that is made here.
const SQUARES: u32 = 64;

fn main() -> Result<(), Box<dyn Error>> {
    let (mut part, mut unit) = (None, None);
    let mut tools = "D2Ball,BallEr16,TaperedBall".to_owned();
    let (mut hemisphere, mut draws, mut seed) = (200, 100_000, 1);
    let (mut tolerance, mut niceness) = (0.01, 0.5);
    let words: Vec<String> = std::env::args().skip(1).collect();
    for pair in words.chunks(2) {
        let [word, value] = pair else { return Err(format!("what is `{}`?", pair[0]).into()) };
        match word.as_str() {
            "--part" => part = Some(value.clone()),
            "--unit" => unit = Some(value.parse::<Unit>()?),
            "--tools" => tools.clone_from(value),
            "--directions" => hemisphere = value.parse()?,
            "--tolerance" => tolerance = value.parse()?,
            "--niceness" => niceness = value.parse()?,
            "--draws" => draws = value.parse()?,
            "--seed" => seed = value.parse()?,
            _ => return Err(format!("`{word}` is not known").into()),
        }
    }
    let (name, mesh) = match (&part, unit) {
        (Some(file), Some(unit)) => {
            let name = file.rsplit('/').next().unwrap_or(file);
            (name.to_owned(), read(file, unit)?)
        }
        (Some(_), None) => return Err("give the part's unit: `--unit mm`".into()),
        (None, _) => ("A relief that is made here".to_owned(), relief(SQUARES)?),
    };
    let tools = tools.split(',').collect();
    let wanted = Wanted { mesh: &mesh, tools, hemisphere, tolerance, niceness, draws, seed };
    let found = measure(&wanted)?;
    println!(
        "# Postures beside brute force

```sh
cargo run --release -p touchoff-bench --bin postures -- {} > docs/measured/postures.md
```

Postures of a sweep are drawn, rebuilt from the tools' restatements, and judged by cutting up all of the part's triangles.
",
        words.join(" ")
    );
    print!("{}", page(&name, &wanted, &found)?);
    let wrong = found.accessible.wrong.len() + found.refused.wrong.len();
    if wrong > 0 {
        return Err(format!("{wrong} postures are not as the sweep has them").into());
    }
    Ok(())
}

fn read(file: &str, unit: Unit) -> Result<Mesh, Box<dyn Error>> {
    match Shape::read(file, unit)? {
        Shape::Mesh(mesh) => Ok(mesh),
        Shape::Points(_) => Err(format!("{file} has no triangles").into()),
    }
}

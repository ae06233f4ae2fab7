//! The page `docs/measured/convergence.md` and its plots: `convergence [--quick] [--seed S] [--parts FOLDER]
//! [--to FOLDER]`. The folder's parts are measured where it is there.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;
use touchoff_bench::convergence::bounds::{self, Place};
use touchoff_bench::convergence::contact::Contact;
use touchoff_bench::convergence::errors::{self, Often};
use touchoff_bench::convergence::page::{Measured, page};
use touchoff_bench::convergence::{Pattern, cover, missed, plots};

/// Points in contact, about.
const CONTACTS: [f64; 9] = [20.0, 38.0, 76.0, 152.0, 305.0, 611.0, 1220.0, 2450.0, 5000.0];
/// How many have more clouds than the rest.
const CHEAP: f64 = 1000.0;
/// Placements of a tool on each cloud.
const PLACEMENTS: usize = 16;
/// Points of clouds whose covering radius is measured.
const POINTS: [usize; 4] = [1_000, 10_000, 100_000, 1_000_000];

fn main() -> Result<(), Box<dyn Error>> {
    let (mut quick, mut seed) = (false, 1);
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut parts = root.join("../shared/data/parts");
    let mut to = root.join("docs/measured");
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("what is `{word}`?"));
        match word.as_str() {
            "--quick" => quick = true,
            "--seed" => seed = value()?.parse()?,
            "--parts" => parts = PathBuf::from(value()?),
            "--to" => to = PathBuf::from(value()?),
            _ => return Err(format!("`{word}` is not known").into()),
        }
    }
    let start = Instant::now();
    let measured = measure(quick, seed, &parts)?;
    let quickly = if quick { " --quick" } else { "" };
    let text = format!(
        "# How what is felt nears the surface

```sh
cargo run --release -p touchoff-bench --bin convergence --{quickly} --seed {seed}
```

Clouds are `Cloud::random`, each point by itself, and `Cloud::blue`, spread evenly. The prototype is one that was made before
this project; its figures are what was expected.

{}",
        page(&measured)?
    );
    std::fs::create_dir_all(&to)?;
    std::fs::write(to.join("convergence.md"), text)?;
    if let Some(table) = measured.tables.iter().find(|table| table.contact == plots::DRAWN) {
        std::fs::write(to.join("convergence.svg"), plots::errors(table).svg())?;
    }
    let missed = plots::missed(&measured.missed);
    std::fs::write(to.join("convergence-missed.svg"), missed.svg())?;
    eprintln!("{} s", start.elapsed().as_secs());
    let broken = |row: &&bounds::Row| {
        let flat = row.place == Place::Plane && row.beyond_flat > 0;
        flat || row.beyond > 0 || row.too_deep > 0
    };
    match measured.bounds.iter().filter(broken).count() {
        0 => Ok(()),
        count => Err(format!("{count} promises were not kept").into()),
    }
}

fn measure(quick: bool, seed: u64, folder: &Path) -> Result<Measured, Box<dyn Error>> {
    let sizes = sizes(quick);
    let tables = Contact::ALL.map(|contact| {
        eprintln!("{}", contact.name());
        errors::table(contact, &sizes, seed)
    });
    eprintln!("missed contacts");
    let [clouds, placements] = if quick { [4, 2_500] } else { [20, 10_000] };
    let missed = missed::rows(clouds, placements, seed);
    let [clouds, placements] = if quick { [4, 2_500] } else { [10, 20_000] };
    let pairs = Place::ALL.into_iter().flat_map(|place| Pattern::ALL.map(|p| (place, p)));
    let bounds = pairs.map(|(place, p)| bounds::row(place, p, clouds, placements, seed)).collect();
    let mut cover = Vec::new();
    for part in cover::parts(folder)? {
        for points in &POINTS[..if quick { 2 } else { POINTS.len() }] {
            let row = cover::row(&part, *points, seed);
            eprintln!("{}: {points} points in {:?}, {:?}", row.part, row.all, row.one);
            cover.push(row);
        }
    }
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    Ok(Measured { tables: tables.to_vec(), missed, bounds, cover, cores })
}

fn sizes(quick: bool) -> Vec<Often> {
    let often = |contacts: f64| {
        let clouds = match (quick, contacts > CHEAP) {
            (true, _) => 4,
            (false, true) => 10,
            (false, false) => 25,
        };
        Often { contacts, clouds, placements: PLACEMENTS }
    };
    let shown = |contacts: &f64| !quick || *contacts < CHEAP;
    CONTACTS.into_iter().filter(shown).map(often).collect()
}

//! The page `convergence.md` and its plots: errors by the number of points.

use clap::Args;
use std::error::Error;
use std::path::{Path, PathBuf};
use touchoff_bench::convergence::bounds::{self, Place};
use touchoff_bench::convergence::contact::Contact;
use touchoff_bench::convergence::errors::{self, Often};
use touchoff_bench::convergence::page::{Measured, page};
use touchoff_bench::convergence::{Pattern, cover, missed, plots};
use touchoff_bench::page::Page;

/// Points in contact, about.
const CONTACTS: [f64; 9] = [20.0, 38.0, 76.0, 152.0, 305.0, 611.0, 1220.0, 2450.0, 5000.0];
/// Points in contact up to which there are more clouds.
const CHEAP: f64 = 1000.0;
/// Placements of a tool on each cloud.
const PLACEMENTS: usize = 16;
/// Points of clouds whose covering radius is measured.
const POINTS: [usize; 4] = [1_000, 10_000, 100_000, 1_000_000];

/// Measures errors by the number of points, contacts that are missed, and covering radii.
#[derive(Args)]
pub(crate) struct Convergence {
    /// Measures a sample.
    #[arg(long)]
    quick: bool,
    /// Seed of the clouds and placements.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Folder of more parts, of which those are taken that are there [default: `../shared/data/parts`, beside the repository].
    #[arg(long, value_name = "FOLDER")]
    parts: Option<PathBuf>,
}

impl Convergence {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        let measured = measure(self.quick, self.seed, &super::parts(self.parts.as_deref()))?;
        let about = "\
Clouds are `Cloud::random`, each point by itself, and `Cloud::blue`, spread evenly. The prototype is one that was made before
this project; its figures are what was expected.

";
        let drawn = measured.tables.iter().find(|table| table.contact == plots::DRAWN);
        let errors = drawn.map(|table| ("convergence.svg", plots::errors(table).svg()));
        let shares = ("convergence-missed.svg", plots::missed(&measured.missed).svg());
        let figures = errors.into_iter().chain([shares]);
        Ok(Some(Page {
            name: "convergence",
            title: "How what is felt nears the surface".to_owned(),
            covers: &["runtime/src", "tool-dsl/src", "tools-library/tools"],
            body: about.to_owned() + &page(&measured)?,
            figures: figures.map(|(name, plot)| (name.to_owned(), plot)).collect(),
            missed: measured.bounds.iter().filter_map(broken).collect(),
        }))
    }
}

/// Returns the promises of the covering radius that a row does not keep, in words.
fn broken(row: &bounds::Row) -> Option<String> {
    let bounds::Row { place, pattern, beyond_flat, beyond, too_deep, .. } = row;
    let flat = if *place == Place::Plane { *beyond_flat } else { 0 };
    (flat + beyond + too_deep > 0).then(|| {
        format!(
            "{}, {}: {flat} balls beyond the flat bound and {beyond} beyond ε not felt, {too_deep} depths above what was found and ε",
            place.name(),
            pattern.name()
        )
    })
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

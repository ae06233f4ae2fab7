//! The page `postures.md`: postures of a sweep compared with brute force.

use clap::Args;
use std::error::Error;
use std::path::{Path, PathBuf};
use touchoff::mesh::Geometry;
use touchoff::{Mesh, Unit};
use touchoff_bench::page::{Page, Section};
use touchoff_bench::postures::page::page;
use touchoff_bench::postures::parts::relief;
use touchoff_bench::postures::{ComparisonSettings, Discrepancy, measure};

/// Number of squares per side of the generated part.
const SQUARES: u32 = 64;

/// Validates postures of a sweep by brute force.
#[derive(Args)]
pub(crate) struct Postures {
    /// Mesh of the part in STL, PLY or OBJ [default: a generated relief].
    #[arg(long, value_name = "FILE", requires = "unit")]
    part: Option<PathBuf>,
    /// Unit of the part: `mm`, `inch` or `m`.
    #[arg(long, requires = "part")]
    unit: Option<Unit>,
    /// Library tools by name, separated by commas.
    #[arg(
        long,
        value_name = "A,B,…",
        value_delimiter = ',',
        default_value = "D2Ball,BallEr16,TaperedBall",
        value_parser = super::tool
    )]
    tools: Vec<String>,
    /// Number of directions on a hemisphere.
    #[arg(long, value_name = "N", default_value_t = 200)]
    directions: usize,
    /// Allowed depth of cutting surfaces, in the part's unit.
    #[arg(long, value_name = "T", default_value_t = 0.01, value_parser = super::not_negative)]
    tolerance: f64,
    /// Niceness that contacts must exceed.
    #[arg(long, value_name = "N", default_value_t = 0.5, value_parser = super::not_negative)]
    niceness: f64,
    /// Number of postures of each kind that are validated.
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    draws: usize,
    /// Seed for the random choice of postures.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
}

impl Postures {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        let (name, mesh) = match (&self.part, self.unit) {
            (Some(file), Some(unit)) => {
                let name = file.file_name().unwrap_or(file.as_os_str());
                (name.to_string_lossy().into_owned(), read(file, unit)?)
            }
            _ => ("A relief that is made here".to_owned(), relief(SQUARES)?),
        };
        let settings = ComparisonSettings {
            mesh: &mesh,
            tools: self.tools.iter().map(String::as_str).collect(),
            hemisphere: self.directions,
            tolerance: self.tolerance,
            niceness: self.niceness,
            draws: self.draws,
            seed: self.seed,
        };
        let results = measure(&settings)?;
        let introduction = "Postures of a sweep are drawn, rebuilt from the tools' restatements, and judged by cutting up all of the part's triangles.\n\n";
        let contradicted =
            results.accessible.contradicted.iter().chain(&results.inaccessible.contradicted);
        Ok(Some(Page {
            name: "postures",
            title: "Postures beside brute force",
            covers: &[
                "postures/src",
                // Declarations only, and the paths, which this page is not about.
                ":!postures/src/lib.rs",
                ":!postures/src/path",
                "runtime/src/certify",
                "tools-library/tools",
            ],
            sections: vec![Section {
                title: "",
                body: introduction.to_owned() + &page(&name, &settings, &results)?,
                missed_limits: contradicted
                    .map(|Discrepancy { posture, result }| format!("{posture}: {result}"))
                    .collect(),
            }],
            figures: Vec::new(),
        }))
    }
}

fn read(file: &Path, unit: Unit) -> Result<Mesh, Box<dyn Error>> {
    match Geometry::read(file, unit)? {
        Geometry::Mesh(mesh) => Ok(mesh),
        Geometry::Points(_) => Err(format!("{} has no triangles", file.display()).into()),
    }
}

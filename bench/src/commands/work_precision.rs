//! The page `work-precision.md`, its plots and its rows: run time against error.

use clap::Args;
use clap::builder::PossibleValuesParser;
use std::error::Error;
use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use touchoff::mesh::Shape;
use touchoff::tool::Interpreted;
use touchoff::{Program, Tool, Unit};
use touchoff_bench::page::Page;
use touchoff_bench::work_precision::{self, Own, Plan, Row};

/// The word for all scenes.
const ALL: &str = "all";

/// Races settings, levels, proofs and, with the feature `peers`, other methods; a row is printed as it comes.
#[derive(Args)]
pub(crate) struct WorkPrecision {
    /// Measures a sample, in less than a minute.
    #[arg(long)]
    quick: bool,
    /// Seed of the clouds and placements.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Scenes by name [default: all, or with `--part` none but that].
    #[arg(long, value_name = "NAME", num_args = 1.., value_delimiter = ',', value_parser = PossibleValuesParser::new(words()))]
    scene: Vec<String>,
    /// A part of your own: a mesh in STL, PLY or OBJ.
    #[arg(long, value_name = "FILE", requires_all = ["unit", "tool", "path"])]
    part: Option<PathBuf>,
    /// The part's unit: `mm`, `inch` or `m`.
    #[arg(long, requires = "part")]
    unit: Option<Unit>,
    /// A tool of the library by name, or any `.tool` file.
    #[arg(long, value_name = "NAME|FILE.tool", requires = "part")]
    tool: Option<OsString>,
    /// The tool's path along the part: a table, or APT-CL.
    #[arg(long, value_name = "FILE", requires = "part")]
    path: Option<PathBuf>,
}

impl WorkPrecision {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        let plan = if self.quick { Plan::quick(self.seed) } else { Plan::full(self.seed) };
        let loaded = self.loaded()?;
        let own = match (&self.part, self.unit, &self.path) {
            (Some(part), Some(unit), Some(path)) => {
                let tool = self.tool(loaded.as_ref())?;
                Some(own((part, unit), tool, path)?)
            }
            _ => None,
        };
        // A reader who has enough of the rows ends them, not the measurement.
        let mut print = |row: Row| drop(writeln!(std::io::stdout(), "{}", row.json()));
        let measured = work_precision::measure(&self.scenes(), own, &plan, &mut print)?;
        Ok(Some(work_precision::page(&measured, &plan)?))
    }

    /// Returns the scenes that are meant.
    fn scenes(&self) -> Vec<&str> {
        let all = self.scene.iter().any(|word| word == ALL);
        if all || (self.scene.is_empty() && self.part.is_none()) {
            return work_precision::scenes();
        }
        self.scene.iter().map(String::as_str).collect()
    }

    /// Loads the tool if a file is named.
    fn loaded(&self) -> Result<Option<Interpreted>, Box<dyn Error>> {
        let named = self.tool.as_ref().map(Path::new);
        let file = named.filter(|name| name.extension().is_some_and(|ending| ending == "tool"));
        let loaded = file.map(Interpreted::load).transpose()?;
        if let Some(tool) = loaded.as_ref().filter(|tool| !tool.warnings().is_empty()) {
            eprintln!("{}", tool.warnings());
        }
        Ok(loaded)
    }

    /// Returns the tool of a file, or the library's of that name.
    fn tool<'t>(&self, loaded: Option<&'t Interpreted>) -> Result<&'t dyn Tool, Box<dyn Error>> {
        if let Some(tool) = loaded {
            return Ok(tool);
        }
        let name = self.tool.as_deref().unwrap_or_default().to_string_lossy();
        let tool = tools_library::find(&name);
        Ok(tool.ok_or_else(|| format!("the library has no tool `{name}`"))?)
    }
}

fn words() -> Vec<&'static str> {
    let mut words = work_precision::scenes();
    words.push(ALL);
    words
}

/// Reads a part and a tool's path along it.
fn own<'t>(
    (part, unit): (&Path, Unit),
    tool: &'t dyn Tool,
    path: &Path,
) -> Result<Own<'t>, Box<dyn Error>> {
    let program = Program::read(path)?;
    program.check_unit(unit)?;
    program.check_poses(tool.card())?;
    if let Some(line) = program.check_cutter(tool.card(), unit)? {
        let (path, name) = (path.display(), &tool.card().name);
        eprintln!("{path}:{line}: CUTTER is not compared: it cannot describe `{name}`");
    }
    let file = part.display();
    let Shape::Mesh(mesh) = Shape::read(part, unit)? else {
        return Err(format!("{file} has no triangles").into());
    };
    for finding in mesh.survey().findings() {
        eprintln!("{file}: {finding}");
    }
    let name = part.file_stem().map_or("part".into(), |stem| stem.to_string_lossy().into_owned());
    let poses = program.stops.iter().map(|stop| stop.pose).collect();
    Ok(Own { mesh, name, tool, poses })
}

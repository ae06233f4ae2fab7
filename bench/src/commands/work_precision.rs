//! The page `work-precision.md`, its plots and its rows: run time against error.

use clap::Args;
use clap::builder::PossibleValuesParser;
use std::error::Error;
use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use touchoff::mesh::Geometry;
use touchoff::tool::Interpreted;
use touchoff::{Tool, Unit};
use touchoff_bench::page::Page;
use touchoff_bench::work_precision::{self, Plan, Row, UserScene};
use touchoff_verify::ClData;

/// The scene name that stands for all scenes.
const ALL: &str = "all";

/// Times point clouds, levels of detail, proofs and, with the feature `peers`, other methods; prints each row when
/// measured.
#[derive(Args)]
pub(crate) struct WorkPrecision {
    /// Measures a small sample, in less than a minute.
    #[arg(long)]
    quick: bool,
    /// Seed for clouds and placements.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Scenes by name [default: all; with `--part` only that part].
    #[arg(long, value_name = "NAME", num_args = 1.., value_delimiter = ',', value_parser = PossibleValuesParser::new(scene_names()))]
    scene: Vec<String>,
    /// Mesh of your own part in STL, PLY or OBJ.
    #[arg(long, value_name = "FILE", requires_all = ["unit", "tool", "program"])]
    part: Option<PathBuf>,
    /// Unit of the part: `mm`, `inch` or `m`.
    #[arg(long, requires = "part")]
    unit: Option<Unit>,
    /// Library tool by name, or a `.tool` file.
    #[arg(long, value_name = "NAME|FILE.tool", requires = "part")]
    tool: Option<OsString>,
    /// Program, the tool's path along the part: a table, or APT-CL.
    #[arg(long, value_name = "FILE", requires = "part")]
    program: Option<PathBuf>,
}

impl WorkPrecision {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        let plan = if self.quick { Plan::quick(self.seed) } else { Plan::full(self.seed) };
        let loaded = self.load_tool()?;
        let own = match (&self.part, self.unit, &self.program) {
            (Some(part), Some(unit), Some(program)) => {
                let tool = self.tool(loaded.as_ref())?;
                Some(read_own((part, unit), tool, program)?)
            }
            _ => None,
        };
        // A closed pipe on standard output ends the printing of rows, not the measurement.
        let mut print = |row: Row| drop(writeln!(std::io::stdout(), "{}", row.json()));
        let measured = work_precision::measure(&self.scenes(), own, &plan, &mut print)?;
        Ok(Some(work_precision::page(&measured, &plan)?))
    }

    /// Returns the names of the chosen scenes.
    fn scenes(&self) -> Vec<&str> {
        let measures_all = self.scene.iter().any(|name| name == ALL);
        if measures_all || (self.scene.is_empty() && self.part.is_none()) {
            return work_precision::scenes();
        }
        self.scene.iter().map(String::as_str).collect()
    }

    /// Loads the tool if the option names a `.tool` file.
    fn load_tool(&self) -> Result<Option<Interpreted>, Box<dyn Error>> {
        let path = self.tool.as_ref().map(Path::new);
        let file =
            path.filter(|path| path.extension().is_some_and(|extension| extension == "tool"));
        let loaded = file.map(Interpreted::load).transpose()?;
        if let Some(tool) = loaded.as_ref().filter(|tool| !tool.warnings().is_empty()) {
            eprintln!("{}", tool.warnings());
        }
        Ok(loaded)
    }

    /// Returns the loaded tool, or the library tool with the given name.
    fn tool<'t>(&self, loaded: Option<&'t Interpreted>) -> Result<&'t dyn Tool, Box<dyn Error>> {
        if let Some(tool) = loaded {
            return Ok(tool);
        }
        let name = self.tool.as_deref().unwrap_or_default().to_string_lossy();
        let tool = touchoff_tools::find(&name);
        Ok(tool.ok_or_else(|| format!("the library has no tool `{name}`"))?)
    }
}

fn scene_names() -> Vec<&'static str> {
    let mut names = work_precision::scenes();
    names.push(ALL);
    names
}

/// Reads a part and a tool path along it.
fn read_own<'t>(
    (part, unit): (&Path, Unit),
    tool: &'t dyn Tool,
    path: &Path,
) -> Result<UserScene<'t>, Box<dyn Error>> {
    let program = ClData::read(path)?;
    program.check_unit(unit)?;
    program.check_poses(tool.info())?;
    if let Some(line) = program.check_cutter(tool.info(), unit)? {
        let (path, name) = (path.display(), &tool.info().name);
        eprintln!("{path}:{line}: CUTTER is not compared: it cannot describe `{name}`");
    }
    let part_file = part.display();
    let Geometry::Mesh(mesh) = Geometry::read(part, unit)? else {
        return Err(format!("{part_file} has no triangles").into());
    };
    for finding in mesh.diagnostics().findings() {
        eprintln!("{part_file}: {finding}");
    }
    let name = part.file_stem().map_or("part".into(), |stem| stem.to_string_lossy().into_owned());
    let poses = program.locations.iter().map(|location| location.pose).collect();
    Ok(UserScene { mesh, name, tool, poses })
}

//! The task of `verify`, from options or from a job file.

use crate::arguments::{CheckArguments, ParamArguments, ToolArguments};
use crate::failure::Failure;
use crate::output::extension;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use touchoff::Unit;

/// The check of a program: lengths are in the part's unit.
pub(crate) struct Job {
    pub(crate) part: PathBuf,
    pub(crate) unit: Unit,
    pub(crate) program: PathBuf,
    /// Name of a machine that ships, or the file of another.
    pub(crate) machine: Option<OsString>,
    /// Name of a control that is known, or the file of another.
    pub(crate) control: Option<OsString>,
    /// Origins of G54 to G59.3 in machine coordinates, in mm and degrees.
    pub(crate) work_offsets: [Option<[f64; 6]>; 9],
    /// `true` if optional blocks are left out; `None` for both ways.
    pub(crate) block_delete: Option<bool>,
    pub(crate) tools: Tools,
    pub(crate) tolerance: f64,
    pub(crate) resolution: Option<f64>,
    pub(crate) allow: Vec<(String, f64)>,
    pub(crate) fixtures: Vec<Fixture>,
    pub(crate) stock: Option<Stock>,
    pub(crate) surface_only: bool,
    pub(crate) anyway: bool,
}

/// The tools of a program.
pub(crate) enum Tools {
    /// One tool, whatever number the program gives it.
    One(OsString, ToolArguments),
    /// Tools by their numbers, from a library and from files.
    Numbered { library: Option<PathBuf>, entries: BTreeMap<u32, ToolEntry> },
}

/// A tool of a job file.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ToolEntry {
    /// A `.tool` file or a built-in tool, instead of the library's tool with this number.
    pub(super) tool: Option<String>,
    /// Values for the params of the file.
    #[serde(default)]
    pub(super) set: BTreeMap<String, ParamValue>,
    /// Distance from the tip to the gauge point of the spindle, in mm.
    pub(super) length: Option<f64>,
    /// The hand of its cutting edges, `right` if absent: that of the spindle's turn.
    #[serde(default)]
    pub(super) hand: Hand,
    /// Allowances of its surfaces, beside those of the job.
    #[serde(default)]
    pub(super) allow: BTreeMap<String, f64>,
}

/// The hand of cutting edges.
#[derive(Clone, Copy, Default, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Hand {
    /// It cuts while the spindle turns clockwise (M3).
    #[default]
    Right,
    /// It cuts while the spindle turns counter-clockwise (M4).
    Left,
}

/// The value of a param: a number in the tool's unit, or an expression of the language.
#[derive(Deserialize)]
#[serde(untagged)]
pub(crate) enum ParamValue {
    Number(f64),
    Text(String),
}

/// A mesh that no surface of a tool may touch.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Fixture {
    pub(super) name: String,
    pub(super) mesh: PathBuf,
    /// The axis of the table with which it moves: a letter, or `base` for none; the workpiece's if absent.
    pub(super) moves_with: Option<String>,
    /// Distance that every surface has to keep.
    #[serde(default)]
    pub(super) margin: f64,
}

/// The stock: a mesh, or a box by its lowest and highest corner.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Stock {
    pub(super) mesh: Option<PathBuf>,
    #[serde(rename = "box")]
    pub(super) corners: Option<[[f64; 3]; 2]>,
    /// Distance between neighbouring points of its lattice.
    pub(super) spacing: f64,
    /// Depth that non-cutting surfaces may have in it.
    pub(super) tolerance: Option<f64>,
    /// Output file for what remains, an STL mesh.
    pub(super) output: Option<PathBuf>,
    /// Output file for its deviations from the part: CSV, or PLY.
    pub(super) map: Option<PathBuf>,
}

/// The work offsets that a job can state.
const WORK_OFFSETS: [&str; 9] =
    ["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"];

/// A job file. Paths are relative to its folder.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JobFile {
    part: PathBuf,
    unit: String,
    program: PathBuf,
    machine: Option<String>,
    control: Option<String>,
    #[serde(default)]
    work_offsets: BTreeMap<String, Vec<f64>>,
    block_delete: Option<bool>,
    /// Library of the tools, which the program selects by number.
    tools: Option<PathBuf>,
    #[serde(default)]
    tool: BTreeMap<String, ToolEntry>,
    #[serde(default)]
    tolerance: f64,
    resolution: Option<f64>,
    #[serde(default)]
    allow: BTreeMap<String, f64>,
    #[serde(default)]
    fixture: Vec<Fixture>,
    stock: Option<Stock>,
    #[serde(default)]
    surface_only: bool,
    #[serde(default)]
    anyway: bool,
}

impl Job {
    /// Returns the job of a job file, or of a part and the options.
    ///
    /// # Errors
    /// If the job file cannot be read.
    pub(crate) fn new(
        [file, part]: [Option<PathBuf>; 2],
        arguments: CheckArguments,
    ) -> Result<Job, Failure> {
        if let Some(file) = file {
            if extension(&file)
                .is_some_and(|ending| matches!(&*ending, "stl" | "ply" | "obj" | "touchoff"))
            {
                return Err(Failure::MeshForJob { file: file.display().to_string() });
            }
            let mut job = Job::read(&file)?;
            job.control = arguments.control.or(job.control);
            job.resolution = arguments.resolution.or(job.resolution);
            job.surface_only |= arguments.surface_only;
            job.anyway |= arguments.anyway;
            return Ok(job);
        }
        let missing =
            Failure::Usage("name a job file, or `--part`, `--unit`, `--tool` and `--program`");
        let (Some(part), Some(unit), Some(program)) = (part, arguments.unit, arguments.program)
        else {
            return Err(missing);
        };
        let tools = match (arguments.tool, arguments.params) {
            (Some(tool), params) => Tools::One(tool, params),
            (None, ToolArguments { library: Some(library), params }) if params.is_empty() => {
                Tools::Numbered { library: Some(library), entries: BTreeMap::new() }
            }
            (None, ToolArguments { library: Some(_), .. }) => {
                return Err(Failure::UnusedParams(
                    "name the tool whose params they are by `--tool`",
                ));
            }
            (None, ToolArguments { library: None, .. }) => return Err(missing),
        };
        Ok(Job {
            part,
            unit,
            program,
            machine: arguments.machine,
            control: arguments.control,
            work_offsets: [None; 9],
            block_delete: None,
            tools,
            tolerance: arguments.tolerance,
            resolution: arguments.resolution,
            allow: arguments.allow,
            fixtures: Vec::new(),
            stock: None,
            surface_only: arguments.surface_only,
            anyway: arguments.anyway,
        })
    }

    /// Returns the files that it reads, each with its role. Those that a tool's file mounts are not among them.
    pub(crate) fn files(&self) -> Vec<(String, &Path)> {
        let mut files =
            vec![("part".to_owned(), &*self.part), ("program".to_owned(), &*self.program)];
        let has_ending = |file: &&Path, ending| file.extension().is_some_and(|end| end == ending);
        for (role, name) in [("machine", &self.machine), ("control", &self.control)] {
            let file = name.as_deref().map(Path::new).filter(|file| has_ending(file, "toml"));
            files.extend(file.map(|file| (role.to_owned(), file)));
        }
        match &self.tools {
            Tools::One(name, arguments) => {
                let library = arguments.library.as_deref();
                files.extend(library.map(|file| ("tool library".to_owned(), file)));
                let file = Some(Path::new(name)).filter(|file| has_ending(file, "tool"));
                files.extend(file.map(|file| ("tool".to_owned(), file)));
            }
            Tools::Numbered { library, entries } => {
                files.extend(library.as_deref().map(|file| ("tool library".to_owned(), file)));
                for (number, entry) in entries {
                    let file = entry.tool.as_deref().map(Path::new);
                    let file = file.filter(|file| has_ending(file, "tool"));
                    files.extend(file.map(|file| (format!("tool T{number}"), file)));
                }
            }
        }
        let fixtures = self.fixtures.iter();
        files.extend(fixtures.map(|fixture| (fixture.name.clone(), &*fixture.mesh)));
        let stock = self.stock.as_ref().and_then(|stock| stock.mesh.as_deref());
        files.extend(stock.map(|file| ("stock".to_owned(), file)));
        files
    }

    fn read(file: &Path) -> Result<Job, Failure> {
        let fault = |message: String| Failure::Job { file: file.display().to_string(), message };
        let text = std::fs::read_to_string(file)
            .map_err(|error| fault(format!("cannot be read ({error}): check the path")))?;
        let job: JobFile = toml::from_str(&text).map_err(|error| {
            let line = error.span().map(|span| 1 + text[..span.start].matches('\n').count());
            let line = line.map_or(String::new(), |line| format!("line {line}: "));
            fault(format!("{line}{}", error.message()))
        })?;
        let unit = job.unit.parse::<Unit>().map_err(|error| fault(error.to_string()))?;
        let lengths = [Some(job.tolerance), job.resolution];
        if lengths.into_iter().flatten().any(|length| !(0.0..f64::INFINITY).contains(&length)) {
            return Err(fault("`tolerance` and `resolution` are lengths of 0 or more".to_owned()));
        }
        let folder = file.parent().unwrap_or(Path::new(""));
        let beside = |path: PathBuf| folder.join(path);
        let mut entries = BTreeMap::new();
        for (number, mut entry) in job.tool {
            let number = number
                .trim_start_matches(['T', 't'])
                .parse::<u32>()
                .map_err(|_| fault(format!("`{number}` is no tool number: write `[tool.3]`")))?;
            if let Some(tool) = entry.tool.as_mut().filter(|tool| tool.ends_with(".tool")) {
                *tool = folder.join(&*tool).display().to_string();
            }
            if entries.insert(number, entry).is_some() {
                return Err(fault(format!("tool {number} is given twice: keep one of both")));
            }
        }
        let named = |name: String| -> OsString {
            if name.ends_with(".toml") { folder.join(name).into() } else { name.into() }
        };
        Ok(Job {
            part: beside(job.part),
            unit,
            program: beside(job.program),
            machine: job.machine.map(named),
            control: job.control.map(named),
            work_offsets: work_offsets(&job.work_offsets)?,
            block_delete: job.block_delete,
            tools: Tools::Numbered { library: job.tools.map(beside), entries },
            tolerance: job.tolerance,
            resolution: job.resolution,
            allow: job.allow.into_iter().collect(),
            fixtures: job
                .fixture
                .into_iter()
                .map(|fixture| Fixture { mesh: folder.join(&fixture.mesh), ..fixture })
                .collect(),
            stock: job.stock.map(|stock| Stock {
                mesh: stock.mesh.map(beside),
                output: stock.output.map(beside),
                map: stock.map.map(beside),
                ..stock
            }),
            surface_only: job.surface_only,
            anyway: job.anyway,
        })
    }
}

/// Returns the origins of G54 to G59.3 by their names.
///
/// # Errors
/// If a name is not one of these, or has fewer than three numbers or more than six.
fn work_offsets(named: &BTreeMap<String, Vec<f64>>) -> Result<[Option<[f64; 6]>; 9], Failure> {
    let mut offsets = [None; 9];
    for (name, values) in named {
        let position = WORK_OFFSETS.iter().position(|known| known.eq_ignore_ascii_case(name));
        let (Some(position), 3..=6) = (position, values.len()) else {
            return Err(Failure::WorkOffset { name: name.clone() });
        };
        let mut origin = [0.0; 6];
        origin[..values.len()].copy_from_slice(values);
        offsets[position] = Some(origin);
    }
    Ok(offsets)
}

impl ToolEntry {
    /// Returns the values of the params as the command line writes them.
    pub(super) fn params(&self) -> ParamArguments {
        let value = |value: &ParamValue| match value {
            ParamValue::Number(number) => number.to_string(),
            ParamValue::Text(text) => text.clone(),
        };
        ParamArguments::new(
            self.set.iter().map(|(name, given)| format!("{name}={}", value(given))).collect(),
        )
    }
}

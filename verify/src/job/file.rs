//! Job files: TOML, with paths relative to the folder of the file.

use super::program::{Program, read_control, read_subprograms};
use super::{Hand, JobError, JobFileFault, PART, STOCK, checked_margin};
use crate::gcode::{
    Choice, ControlRules, ControlSetup, LARGEST_NUMBER, Rule, SubprogramFile, WorkOffset, rules_of,
    variable_name,
};
use crate::machine::is_name;
use crate::program::ProgramFile;
use crate::{ToolSelection, ToolUse};
use serde::{Deserialize, Deserializer};
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use touchoff::{FileKind, Unit, is_within, read_text_file};

/// A job as a file states it, or the options of a command: names and paths of what a [`Job`](super::Job) is made of. Lengths are in the
/// part's unit.
#[derive(Clone, Debug)]
pub struct JobFile {
    /// The folder within which all inputs lie; `None` if they may lie anywhere.
    pub root: Option<PathBuf>,
    /// The finished part, a mesh.
    pub part: PathBuf,
    /// Its unit.
    pub unit: Unit,
    /// The program.
    pub program: PathBuf,
    /// Name of a machine that ships, or the file of another.
    pub machine: Option<OsString>,
    /// Name of a control that is known, or the file of another.
    pub control: Option<OsString>,
    /// Origins of G54 to G59.3 in machine coordinates, in mm and degrees.
    pub work_offsets: [Option<[f64; 6]>; 9],
    /// Origins of further work offsets ([`ControlSetup::additional_offsets`]).
    pub additional_offsets: BTreeMap<u16, [f64; 6]>,
    /// Radius offsets of cutter compensation in mm, by D or tool number.
    pub radius_offsets: BTreeMap<u32, f64>,
    /// The work offsets of presets ([`ControlSetup::presets`]).
    pub presets: BTreeMap<u32, u8>,
    /// `true` if optional blocks are left out; `None` for both ways.
    pub block_delete: Option<bool>,
    /// Words that the control passes over, each with a reason ([`ControlRules::ignoring`]).
    pub ignore: BTreeMap<String, String>,
    /// Values that variables of the program can have before it ([`ControlSetup::variables`]).
    pub variables: BTreeMap<String, Vec<f64>>,
    /// Files of subprograms that the program calls.
    pub subprograms: Vec<PathBuf>,
    /// The tools.
    pub tools: JobTools,
    /// Depth in the part that any surface may have.
    pub tolerance: f64,
    /// Excess of depth up to which a finding may or may not be reported.
    pub resolution: Option<f64>,
    /// Depths that surfaces may have instead, by their names.
    pub allow: Vec<(String, f64)>,
    /// Other parts on the same table.
    pub other_parts: Vec<PartEntry>,
    /// The fixtures.
    pub fixtures: Vec<FixtureEntry>,
    /// The stock.
    pub stock: Option<StockEntry>,
    /// Checks the surface alone of a body whose mesh has no inside.
    pub surface_only: bool,
    /// Accepts what is left open.
    pub anyway: bool,
}

/// The tools of a program, by their names.
#[derive(Clone, Debug)]
pub enum JobTools {
    /// One tool, whatever number the program gives it.
    One(NamedTool),
    /// Tools by their numbers, from a library and from files.
    Numbered {
        /// A library that the program selects from by number.
        library: Option<PathBuf>,
        /// Tools that are stated one by one.
        entries: BTreeMap<u32, ToolEntry>,
    },
}

/// A tool by its name, for a loader of tools, and its use in a job.
#[derive(Clone, Debug)]
pub struct NamedTool {
    /// The motions that it makes.
    pub motions: ToolSelection,
    /// A built-in tool, a `.tool` file, or a tool of the library.
    pub name: OsString,
    /// The library.
    pub library: Option<PathBuf>,
    /// Values of the params of the file: `name=value`.
    pub params: Vec<String>,
    /// The folder within which its files lie: those that it mounts, if not in its own folder, and those that the library lists.
    pub root: Option<PathBuf>,
    /// The hand of its cutting edges; `None` if it is not stated.
    pub hand: Option<Hand>,
    /// The notes of its library for which programs may hit where the tool as it is drawn does not.
    pub doubts: Vec<String>,
    /// Depths that its surfaces may have in the part, beside those of the job.
    pub allow: Vec<(String, f64)>,
}

/// A tool of a job file.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToolEntry {
    /// A `.tool` file or a built-in tool, instead of the library's tool with this number.
    pub tool: Option<PathBuf>,
    /// The name by which programs of Sinumerik select it: `T="NAME"`.
    pub name: Option<String>,
    /// Values of the params of the file: `name=value`.
    #[serde(default, rename = "set", deserialize_with = "assignments")]
    pub params: Vec<String>,
    /// Distance from the tip to the gauge point of the spindle, in mm.
    pub length: Option<f64>,
    /// Radius offset of cutter compensation under its number, in mm.
    pub radius_offset: Option<f64>,
    /// The hand of its cutting edges. If absent, that of its library, or `right`.
    pub hand: Option<Hand>,
    /// Allowances of its surfaces, beside those of the job.
    #[serde(default)]
    pub allow: BTreeMap<String, f64>,
}

/// Reads the table of params as `name=value`, in the order of the names. A value is a number in the tool's unit, or an
/// expression of the language.
fn assignments<'de, D: Deserializer<'de>>(table: D) -> Result<Vec<String>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged, expecting = "expected a number, or an expression as a text")]
    enum ParamValue {
        Number(f64),
        Expression(String),
    }
    let params = BTreeMap::<String, ParamValue>::deserialize(table)?;
    let params = params.into_iter().map(|(name, value)| match value {
        ParamValue::Number(number) => format!("{name}={number}"),
        ParamValue::Expression(text) => format!("{name}={text}"),
    });
    Ok(params.collect())
}

/// The value of a variable, or all values that it can have.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a number, or a list of numbers")]
enum VariableValues {
    One(f64),
    Several(Vec<f64>),
}

impl VariableValues {
    fn into_values(self) -> Vec<f64> {
        match self {
            VariableValues::One(value) => vec![value],
            VariableValues::Several(values) => values,
        }
    }
}

/// Another part on the same table, which stands at another work offset as the part stands at G54.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartEntry {
    /// Name of its work offset, G55 to G59.3.
    pub work_offset: String,
    /// Its mesh, in the unit of the part; that of the part if absent.
    pub mesh: Option<PathBuf>,
    /// Its name in findings; `the part at` its work offset if absent.
    pub name: Option<String>,
}

/// A mesh that no surface of a tool may touch.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FixtureEntry {
    /// Its name in findings.
    pub name: String,
    /// Its mesh, in the unit of the part.
    pub mesh: PathBuf,
    /// The axis of the table with which it moves: a letter, or `base` for none; the workpiece's if absent.
    pub moves_with: Option<String>,
    /// Distance that every surface has to keep.
    #[serde(default)]
    pub margin: f64,
}

/// The stock: a mesh, a box by its lowest and highest corner, the blank of the program, or what an earlier set-up leaves.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StockEntry {
    /// A mesh, in the unit of the part.
    pub mesh: Option<PathBuf>,
    /// The lowest and the highest corner of a box.
    #[serde(rename = "box")]
    pub corners: Option<[[f64; 3]; 2]>,
    /// The box that the program states by BLK FORM (Heidenhain Klartext), or by G30 and G31 (DIN/ISO).
    #[serde(default)]
    pub blank: bool,
    /// The job file of an earlier set-up.
    pub from: Option<PathBuf>,
    /// The origin of the earlier set-up's part frame in the frame of the part; its own if absent.
    pub origin: Option<[f64; 3]>,
    /// The direction of its axis x, that of a coordinate axis; `[1, 0, 0]` if absent.
    pub x: Option<[f64; 3]>,
    /// The direction of its axis z; `[0, 0, 1]` if absent.
    pub z: Option<[f64; 3]>,
    /// Distance between neighbouring points of its lattice; that of an earlier set-up is its own.
    pub spacing: Option<f64>,
    /// Depth that non-cutting surfaces may have in it.
    pub tolerance: Option<f64>,
    /// Output file for what remains, an STL mesh.
    pub output: Option<PathBuf>,
    /// Output file for its deviations from the part: CSV, or PLY.
    pub map: Option<PathBuf>,
}

/// The work offsets that a job can state.
const WORK_OFFSETS: [&str; 9] =
    ["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"];

/// A job file as it is written. Paths are relative to its folder.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JobText {
    part: PathBuf,
    unit: String,
    program: PathBuf,
    machine: Option<String>,
    control: Option<String>,
    #[serde(default)]
    work_offsets: BTreeMap<String, Vec<f64>>,
    #[serde(default)]
    radius_offsets: BTreeMap<String, f64>,
    #[serde(default)]
    presets: BTreeMap<String, String>,
    block_delete: Option<bool>,
    #[serde(default)]
    ignore: BTreeMap<String, String>,
    #[serde(default)]
    variables: BTreeMap<String, VariableValues>,
    #[serde(default)]
    subprograms: Vec<PathBuf>,
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
    other_part: Vec<PartEntry>,
    #[serde(default)]
    fixture: Vec<FixtureEntry>,
    stock: Option<StockEntry>,
    #[serde(default)]
    surface_only: bool,
    #[serde(default)]
    anyway: bool,
}

impl JobFile {
    /// Returns the files that it reads, each with its role. Those that a tool's file mounts are not among them.
    pub fn files(&self) -> Vec<(String, &Path)> {
        let mut files =
            vec![("part".to_owned(), &*self.part), ("program".to_owned(), &*self.program)];
        files.extend(self.subprograms.iter().map(|file| ("subprograms".to_owned(), &**file)));
        for (role, name) in [("machine", &self.machine), ("control", &self.control)] {
            let file = name.as_deref().map(Path::new).filter(|file| has_ending(file, "toml"));
            files.extend(file.map(|file| (role.to_owned(), file)));
        }
        match &self.tools {
            JobTools::One(tool) => {
                let library = tool.library.as_deref();
                files.extend(library.map(|file| ("tool library".to_owned(), file)));
                let file = Some(Path::new(&tool.name)).filter(|file| has_ending(file, "tool"));
                files.extend(file.map(|file| ("tool".to_owned(), file)));
            }
            JobTools::Numbered { library, entries } => {
                files.extend(library.as_deref().map(|file| ("tool library".to_owned(), file)));
                for (number, entry) in entries {
                    let file = entry.tool.as_deref();
                    let file = file.filter(|file| has_ending(file, "tool"));
                    files.extend(file.map(|file| (format!("tool T{number}"), file)));
                }
            }
        }
        let others =
            self.other_parts.iter().filter_map(|part| Some((part.name(), &**part.mesh.as_ref()?)));
        files.extend(others);
        let fixtures = self.fixtures.iter();
        files.extend(fixtures.map(|fixture| (fixture.name.clone(), &*fixture.mesh)));
        let stock = self.stock.as_ref().and_then(|stock| stock.mesh.as_deref());
        files.extend(stock.map(|file| ("stock".to_owned(), file)));
        let earlier = self.stock.as_ref().and_then(|stock| stock.from.as_deref());
        files.extend(earlier.map(|file| ("job of the earlier set-up".to_owned(), file)));
        files
    }

    /// Reads a job file, which may be a stranger's: it names inputs within `root` only, its own folder by default, and outputs
    /// within its own folder. Links are followed.
    ///
    /// # Errors
    /// If it cannot be read or names a file elsewhere, or as for [`JobFile::parse`].
    pub fn read(file: &Path, root: Option<&Path>) -> Result<JobFile, JobError> {
        let folder = file.parent().unwrap_or(Path::new(""));
        let root = root.unwrap_or(folder);
        // A message about its text would show what is elsewhere.
        check_within(root, "job", file)?;
        let text = read_text_file(file, FileKind::Settings)
            .map_err(|source| JobError::Unreadable { file: file.display().to_string(), source })?;
        let mut job = JobFile::parse(&text, file)?;
        job.root = Some(root.to_owned());
        for (role, input) in job.files() {
            job.check_within(&role, input)?;
        }
        for (key, output) in job.outputs() {
            // A link has another name than the file that it leads to, which can be of any kind.
            let is_other = output.is_symlink() || output.exists() && !output.is_file();
            if is_other || !is_within(output, folder) {
                let (key, output) = (format!("stock.{key}"), output.display().to_string());
                let fault = JobFileFault::OutputOutside { key, output };
                return Err(JobError::File { file: file.display().to_string(), line: None, fault });
            }
        }
        Ok(job)
    }

    /// Checks that an input is one that the job may read.
    ///
    /// # Errors
    /// [`JobError::Outside`] if it lies outside the root.
    pub(super) fn check_within(&self, role: &str, input: &Path) -> Result<(), JobError> {
        self.root.as_ref().map_or(Ok(()), |root| check_within(root, role, input))
    }

    /// Returns the files that it has written, each with its key in `[stock]`.
    pub fn outputs(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let stock = self.stock.iter();
        stock
            .flat_map(|stock| [("output", &stock.output), ("map", &stock.map)])
            .filter_map(|(key, file)| Some((key, file.as_deref()?)))
    }

    /// Reads the text of a job file. Paths in it are relative to the folder of `file`.
    ///
    /// # Errors
    /// If it is no job: the message names the line.
    pub fn parse(text: &str, file: &Path) -> Result<JobFile, JobError> {
        let name = file.display().to_string();
        let job: JobText = toml::from_str(text).map_err(|error| {
            let line = error.span().map(|span| 1 + text[..span.start].matches('\n').count());
            let fault = JobFileFault::Syntax { message: error.message().to_owned() };
            JobError::File { file: name.clone(), line, fault }
        })?;
        let refused =
            |fault: JobFileFault| JobError::File { file: name.clone(), line: None, fault };
        let unit = job.unit.parse::<Unit>().map_err(|error| refused(error.into()))?;
        let lengths = [Some(job.tolerance), job.resolution];
        if lengths.into_iter().flatten().any(|length| !(0.0..f64::INFINITY).contains(&length)) {
            return Err(refused(JobFileFault::Length));
        }
        let others = job.other_part.iter().filter_map(|part| part.name.as_ref());
        let mut names = job.fixture.iter().map(|fixture| &fixture.name).chain(others);
        if !names.all(|name| is_name(name)) {
            return Err(refused(JobFileFault::Name));
        }
        let others = job.other_part.iter().map(PartEntry::name);
        let fixtures = job.fixture.iter().map(|fixture| fixture.name.clone());
        let mut bodies = BTreeSet::from([PART.to_owned(), STOCK.to_owned()]);
        for name in others.chain(fixtures) {
            if !bodies.insert(name.clone()) {
                return Err(refused(JobFileFault::SecondBody { name }));
            }
        }
        for fixture in &job.fixture {
            checked_margin(fixture.margin).map_err(|_| refused(JobFileFault::Margin))?;
        }
        let Origins { standard: work_offsets, additional: additional_offsets } =
            work_offsets(&job.work_offsets)?;
        let mut variables = BTreeMap::new();
        for (name, values) in job.variables {
            let values = values.into_values();
            let is_number =
                !values.is_empty() && values.iter().all(|value| value.abs() <= LARGEST_NUMBER);
            let Some(variable) = variable_name(&name).filter(|_| is_number) else {
                return Err(refused(JobFileFault::Variable { name }));
            };
            // `#<_D>` and `#<_d>` are one.
            if variables.insert(variable.clone(), values).is_some() {
                return Err(refused(JobFileFault::SecondVariable { name: variable }));
            }
        }
        let folder = file.parent().unwrap_or(Path::new(""));
        let beside = |path: PathBuf| folder.join(path);
        let (mut entries, mut tool_names) = (BTreeMap::new(), BTreeSet::new());
        for (number, mut entry) in job.tool {
            let number = whole_number(number.strip_prefix(['T', 't']).unwrap_or(&number))
                .ok_or_else(|| refused(JobFileFault::ToolNumber { number: number.clone() }))?;
            if let Some(tool) = entry.tool.as_mut().filter(|tool| has_ending(tool, "tool")) {
                *tool = folder.join(&*tool);
            }
            // Programs select them in either case.
            if let Some(name) = &entry.name
                && !tool_names.insert(name.to_ascii_lowercase())
            {
                return Err(refused(JobFileFault::SecondToolName { name: name.clone() }));
            }
            if entries.insert(number, entry).is_some() {
                return Err(refused(JobFileFault::SecondTool { number }));
            }
        }
        let radius_offsets = radius_offsets(&job.radius_offsets, &entries).map_err(refused)?;
        let presets = presets(&job.presets).map_err(refused)?;
        let named = |name: String| -> OsString {
            let is_file = has_ending(Path::new(&name), "toml");
            if is_file { folder.join(name).into() } else { name.into() }
        };
        if let Some(stock) = &job.stock {
            let kinds =
                [("output", &stock.output, &["stl"][..]), ("map", &stock.map, &["csv", "ply"])];
            for (key, file, endings) in kinds {
                let is_kind =
                    |file: &PathBuf| endings.iter().any(|ending| has_ending(file, ending));
                if let Some(file) = file.as_ref().filter(|file| !is_kind(file)) {
                    let endings = endings.join("` or `.");
                    let (key, file) = (format!("stock.{key}"), file.display().to_string());
                    return Err(refused(JobFileFault::OutputEnding { key, file, endings }));
                }
            }
        }
        Ok(JobFile {
            root: None,
            part: beside(job.part),
            unit,
            program: beside(job.program),
            machine: job.machine.map(named),
            control: job.control.map(named),
            work_offsets,
            additional_offsets,
            radius_offsets,
            presets,
            block_delete: job.block_delete,
            ignore: job.ignore,
            variables,
            subprograms: job.subprograms.into_iter().map(beside).collect(),
            tools: JobTools::Numbered { library: job.tools.map(beside), entries },
            tolerance: job.tolerance,
            resolution: job.resolution,
            allow: job.allow.into_iter().collect(),
            other_parts: job
                .other_part
                .into_iter()
                .map(|part| PartEntry { mesh: part.mesh.map(beside), ..part })
                .collect(),
            fixtures: job
                .fixture
                .into_iter()
                .map(|fixture| FixtureEntry { mesh: folder.join(&fixture.mesh), ..fixture })
                .collect(),
            stock: job.stock.map(|stock| StockEntry {
                mesh: stock.mesh.map(beside),
                from: stock.from.map(beside),
                output: stock.output.map(beside),
                map: stock.map.map(beside),
                ..stock
            }),
            surface_only: job.surface_only,
            anyway: job.anyway,
        })
    }

    /// Returns the set-up of the control that the job states, with the rules of its control and the files of its subprograms.
    ///
    /// # Errors
    /// If a word cannot be ignored.
    pub fn setup(
        &self,
        mut rules: ControlRules,
        subprograms: Vec<SubprogramFile>,
    ) -> Result<ControlSetup, JobError> {
        if let Some(left_out) = self.block_delete {
            let choice = if left_out { Choice::LeftOut } else { Choice::Executed };
            rules = rules.with(Rule::OptionalBlocks, choice);
        }
        for (word, reason) in &self.ignore {
            rules = rules.ignoring(word, reason)?;
        }
        Ok(ControlSetup {
            work_offsets: self.work_offsets,
            additional_offsets: self.additional_offsets.clone(),
            lengths: self.tools.lengths(),
            t0_is_empty: self.tools.lacks_zero(),
            variables: self.variables.clone(),
            subprograms,
            radius_offsets: self.radius_offsets.clone(),
            presets: self.presets.clone(),
            tool_names: self.tools.names(),
            rules,
            ..ControlSetup::default()
        })
    }

    /// Reads the program, and interprets G-code as the control that is stated reads it.
    ///
    /// # Errors
    /// If the program, the machine or the control is refused, if no control is stated and several read the language of the program, or if
    /// a single program of positions has one position.
    pub fn program(&self) -> Result<Program, JobError> {
        let content = ProgramFile::read(&self.program)?;
        let rules = match (&self.control, &content) {
            (Some(_), ProgramFile::Locations(_)) => return Err(JobError::MachineForPositions),
            (Some(control), ProgramFile::Gcode(_)) => read_control(Path::new(control))?,
            (None, ProgramFile::Gcode(text)) if rules_of(text).is_none() => {
                return Err(JobError::NoControl { file: self.program.display().to_string() });
            }
            (None, _) => ControlRules::default(),
        };
        let setup = self.setup(rules, read_subprograms(&self.subprograms)?)?;
        let machine = self.machine.as_deref().map(Path::new);
        let program = Program::of_content(content, &self.program, machine, &setup)?;
        if let Program::Locations(programs) = &program
            && let [program] = &programs[..]
        {
            program.check_motions()?;
        }
        Ok(program)
    }

    /// Returns the tools that the program uses, in the order of their first motions.
    ///
    /// # Errors
    /// If no tool is given for a number, or one for several, or if the length of one is below 0.
    pub fn used_tools(&self, program: &Program) -> Result<Vec<NamedTool>, JobError> {
        let uses = program.tools();
        let (library, entries) = match &self.tools {
            JobTools::One(tool) => {
                let mut numbers = uses.iter().filter_map(|tool| tool.number);
                if let (Some(first), Some(second)) = (numbers.next(), numbers.next()) {
                    return Err(JobError::SeveralTools { first, second });
                }
                return Ok(vec![tool.clone()]);
            }
            JobTools::Numbered { library, entries } => (library, entries),
        };
        let mut tools = Vec::new();
        let mut missing: Vec<(u32, usize)> = Vec::new();
        for ToolUse { number, line, .. } in uses {
            // A program without numbers needs no choice if there is one tool.
            let known = match (number, entries.iter().next()) {
                (Some(number), _) => number,
                (None, Some((only, _))) if entries.len() == 1 => *only,
                (None, _) => return Err(JobError::UnnamedTool { line }),
            };
            let entry = entries.get(&known).cloned().unwrap_or_default();
            if let Some(length) = entry.length.filter(|length| *length < 0.0) {
                return Err(JobError::ToolLength { number: known, length });
            }
            let (name, library) = match (entry.tool, library) {
                (Some(name), _) => (OsString::from(name), None),
                (None, Some(library)) => (format!("T{known}").into(), Some(library.clone())),
                (None, None) => {
                    missing.push((known, line));
                    continue;
                }
            };
            tools.push(NamedTool {
                motions: ToolSelection::Number(number),
                name,
                library,
                params: entry.params,
                root: self.root.clone(),
                hand: entry.hand,
                doubts: Vec::new(),
                allow: entry.allow.into_iter().collect(),
            });
        }
        if let [(first, line), others @ ..] = &missing[..] {
            let others = others.iter().map(|(number, _)| *number).collect();
            return Err(JobError::NoTool { number: *first, line: *line, others });
        }
        Ok(tools)
    }
}

impl JobTools {
    /// Returns the lengths that are stated, by number, in mm.
    fn lengths(&self) -> BTreeMap<u32, f64> {
        match self {
            JobTools::One(_) => BTreeMap::new(),
            JobTools::Numbered { entries, .. } => entries
                .iter()
                .filter_map(|(number, entry)| Some((*number, entry.length?)))
                .collect(),
        }
    }

    /// Returns whether the tools have numbers, and none has 0.
    fn lacks_zero(&self) -> bool {
        matches!(self, JobTools::Numbered { entries, .. } if !entries.contains_key(&0))
    }

    /// Returns the numbers of the tools that have names, by these.
    fn names(&self) -> BTreeMap<String, u32> {
        match self {
            JobTools::One(_) => BTreeMap::new(),
            JobTools::Numbered { entries, .. } => entries
                .iter()
                .filter_map(|(number, entry)| Some((entry.name.clone()?, *number)))
                .collect(),
        }
    }
}

impl PartEntry {
    /// Returns its name in findings.
    pub fn name(&self) -> String {
        match &self.name {
            Some(name) => name.clone(),
            None => format!("{PART} at {}", self.work_offset),
        }
    }

    /// Returns the index of its work offset, from 1 on: that of G54 is the part's own.
    ///
    /// # Errors
    /// [`JobError::OtherPartOffset`] if it has none of these names.
    pub(super) fn offset_index(&self) -> Result<usize, JobError> {
        let known = |name: &&str| name.eq_ignore_ascii_case(&self.work_offset);
        match WORK_OFFSETS.iter().position(known) {
            Some(index) if index > 0 => Ok(index),
            _ => Err(JobError::OtherPartOffset { name: self.name() }),
        }
    }
}

fn check_within(root: &Path, role: &str, input: &Path) -> Result<(), JobError> {
    if is_within(input, root) {
        return Ok(());
    }
    let root = match root.display().to_string() {
        here if here.is_empty() => ".".to_owned(),
        root => root,
    };
    Err(JobError::Outside { role: role.to_owned(), file: input.display().to_string(), root })
}

pub(super) fn has_ending(file: &Path, ending: &str) -> bool {
    file.extension().is_some_and(|end| end.eq_ignore_ascii_case(ending))
}

/// Returns the radius offsets that are stated, by D or tool number: those by their names, `D21`, and those of the tools.
///
/// # Errors
/// If a name is no such word, if one number has two values, or if a value is not finite.
fn radius_offsets(
    named: &BTreeMap<String, f64>,
    tools: &BTreeMap<u32, ToolEntry>,
) -> Result<BTreeMap<u32, f64>, JobFileFault> {
    let of_tools = tools.iter().filter_map(|(number, entry)| Some((*number, entry.radius_offset?)));
    let mut offsets: BTreeMap<u32, f64> = of_tools.collect();
    for (name, radius) in named {
        let digits = name.strip_prefix(['D', 'd']).unwrap_or_default();
        let Some(number) = whole_number(digits).filter(|number| *number > 0) else {
            return Err(JobFileFault::RadiusOffset { name: name.clone() });
        };
        if offsets.insert(number, *radius).is_some() {
            return Err(JobFileFault::SecondRadiusOffset { number });
        }
    }
    match offsets.iter().find(|(_, radius)| !radius.is_finite()) {
        Some((number, _)) => Err(JobFileFault::RadiusLength { number: *number }),
        None => Ok(offsets),
    }
}

/// Returns the numbers of work offsets, from 1 for G54, by those of presets.
///
/// # Errors
/// If a preset is no whole number, stands for no work offset, or is given twice (`1` and `01`).
fn presets(named: &BTreeMap<String, String>) -> Result<BTreeMap<u32, u8>, JobFileFault> {
    let mut offsets = BTreeMap::new();
    for (preset, offset) in named {
        let known = (1..).zip(WORK_OFFSETS).find(|(_, known)| known.eq_ignore_ascii_case(offset));
        let of_both = whole_number(preset).zip(known);
        let is_new =
            of_both.is_some_and(|(number, (index, _))| offsets.insert(number, index).is_none());
        if !is_new {
            return Err(JobFileFault::Preset { preset: preset.clone() });
        }
    }
    Ok(offsets)
}

/// Returns the number that digits write, without a sign.
fn whole_number(digits: &str) -> Option<u32> {
    digits.bytes().all(|byte| byte.is_ascii_digit()).then(|| digits.parse().ok()).flatten()
}

/// The origins of work offsets.
#[derive(Default)]
struct Origins {
    /// Those of G54 to G59.3.
    standard: [Option<[f64; 6]>; 9],
    additional: BTreeMap<u16, [f64; 6]>,
}

/// Returns the origins of work offsets by their names.
///
/// # Errors
/// If a name is not that of a work offset, or has fewer than three numbers or more than six, or if two names are of one offset.
fn work_offsets(named: &BTreeMap<String, Vec<f64>>) -> Result<Origins, JobError> {
    let mut origins = Origins::default();
    for (name, values) in named {
        let refused = || JobError::WorkOffset { name: name.clone() };
        let mut origin = [0.0; 6];
        origin
            .get_mut(..values.len())
            .filter(|own| own.len() >= 3)
            .ok_or_else(refused)?
            .copy_from_slice(values);
        let position = WORK_OFFSETS.iter().position(|known| known.eq_ignore_ascii_case(name));
        let before = match (position, additional_offset(name)) {
            (Some(position), _) => origins.standard[position].replace(origin),
            (None, Some(number)) => origins.additional.insert(number, origin),
            (None, None) => return Err(refused()),
        };
        if before.is_some() {
            return Err(refused());
        }
    }
    Ok(origins)
}

/// Returns the number of a further work offset by its name: `G54.1 P1` to `P300` and `G154 P1` to `P300`, `G110` to `G129` of Haas, and
/// `G507` to `G599` of Sinumerik.
fn additional_offset(name: &str) -> Option<u16> {
    let name = name.to_ascii_uppercase();
    let found = match name.split_once('P') {
        Some((code, index)) => {
            whole_number(index.trim()).filter(|_| matches!(code.trim(), "G54.1" | "G154"))
        }
        None => match whole_number(name.strip_prefix('G')?)? {
            code @ 110..=129 => Some(code - WorkOffset::FIRST_OF_HAAS + 1),
            code @ 507..=599 => Some(code - WorkOffset::FIRST_OF_SINUMERIK + 1),
            _ => None,
        },
    };
    found.filter(|number| (1..=300).contains(number)).map(|number| number as u16)
}

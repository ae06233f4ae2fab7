//! A block, a tool, a program and a job, all in memory, and what their check gives.

use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::Path;
use std::sync::Arc;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::shapes;
use touchoff::tool::Interpreted;
use touchoff::{Pose, Tool, Unit};
use touchoff_verify::gcode::{Choice, ControlRules, Rule, SubprogramFile, SubprogramLine};
use touchoff_verify::job::{Body, NoVerdict, RevolvedBody};
use touchoff_verify::machine::{Link, Machine};
use touchoff_verify::{
    Job, JobError, JobFile, JobReport, JobTool, MachineProgramError, Program, Verdict,
};

pub(crate) const CLEAN: Verdict = Verdict::Clean;
pub(crate) const FINDINGS: Verdict = Verdict::Findings;
/// No verdict: a gap, or a job that is refused.
pub(crate) const NONE: Verdict = Verdict::None;

/// A control by its name; `None` for all readings.
pub(crate) type Control = Option<&'static str>;

pub(crate) const ANY: Control = None;
pub(crate) const LINUXCNC: Control = Some("linuxcnc");
pub(crate) const FANUC: Control = Some("fanuc");
pub(crate) const HAAS: Control = Some("haas");
pub(crate) const SIEMENS: Control = Some("siemens");
pub(crate) const HEIDENHAIN: Control = Some("heidenhain");

/// Returns the rules of a known control. LinuxCNC is configured as machines of the library turn, and compensates lengths.
pub(crate) fn rules(name: &str) -> ControlRules {
    let rules = ControlRules::named(name).expect("a control");
    let rules = rules.with(Rule::RotaryDirection, Choice::Iso841);
    rules.with(Rule::HeadLength, Choice::Compensated)
}

/// Returns the rules of a Sinumerik that reads native programs, with what TRAORI does to the work offset.
pub(crate) fn native(offset: Choice) -> ControlRules {
    let rules = rules("siemens").with(Rule::ToolLength, Choice::Always);
    let rules = rules.with(Rule::Rotary, Choice::WithinTurn);
    let rules = rules.with(Rule::ToolOrientation, Choice::ByAxes);
    rules.with(Rule::TransformationOffset, offset)
}

/// Returns the rules of a control that reads the words of Fanuc and moves as LinuxCNC does.
pub(crate) fn straight() -> ControlRules {
    rules("linuxcnc").with(Rule::Dialect, Choice::Iso)
}

/// A program that states its unit and its offset, and turns the spindle.
pub(crate) fn program(blocks: &str) -> String {
    format!("G21 G90 G54 G94 S9000 M3 F100.\n{blocks}\nM30\n")
}

pub(crate) fn cuboid(low: [f64; 3], high: [f64; 3]) -> TriangleBvh {
    let mesh = shapes::cuboid(Point3::from(low), Point3::from(high), Unit::Millimetre);
    TriangleBvh::new(&mesh.expect("a cuboid"))
}

/// A block of 6 × 6 × 2 below z = 0, a tool of 2 mm that ends in a ball, and what is added by a test.
pub(crate) struct Scene {
    /// The name of the program, whose ending tells its language.
    pub(crate) file: &'static str,
    pub(crate) text: String,
    /// The job's file. `TOP` and `LENGTH` are the places of further keys of the job and of the tool.
    pub(crate) job: String,
    /// Files that the job names: machines, tools and subprograms.
    pub(crate) files: BTreeMap<&'static str, String>,
    obstacle: Option<TriangleBvh>,
    /// The link of the machine with which the obstacle moves; otherwise it is a fixture.
    link: Option<Link>,
    /// The place in machine coordinates of a disc that moves with a link, and must not touch the obstacle.
    disc: Option<([f64; 3], Link)>,
}

/// A disc with a radius of 150 mm.
const DISC: &str = "tool Disc { units mm; profile { start (0, 0); line to (150, 0), (150, 10), (0, 10) as rim; } }";

/// A finding, a gap, a reason against a verdict, or an error.
#[derive(Debug)]
pub(crate) struct Row {
    pub(crate) code: &'static str,
    /// The line of the program; 0 if it concerns none.
    pub(crate) line: usize,
    /// The file of subprograms and its line.
    pub(crate) within: Option<(String, usize)>,
    pub(crate) text: String,
}

impl Row {
    fn new(code: &'static str, line: usize, text: &dyn Display) -> Row {
        Row { code, line, within: None, text: text.to_string() }
    }

    /// Returns whether it is what a pattern names: `CODE`, `CODE LINE`, or either with data of the text, such as the name of a body, a
    /// word of the program or a key. The code may be the start of one.
    pub(crate) fn is(&self, pattern: &str) -> bool {
        let (code, rest) = pattern.split_once(' ').unwrap_or((pattern, ""));
        let (line, word) = rest.split_once(' ').unwrap_or((rest, ""));
        let (line, word) = match line.parse::<usize>() {
            Ok(line) => (Some(line), word),
            Err(_) => (None, rest),
        };
        self.code.starts_with(code)
            && line.is_none_or(|line| line == self.line)
            && self.text.contains(word)
    }
}

/// The result of a check, or the error of a job that cannot be checked.
#[derive(Debug)]
pub(crate) struct Checked {
    pub(crate) verdict: Verdict,
    pub(crate) rows: Vec<Row>,
}

impl Checked {
    pub(crate) fn of(report: &JobReport<'_>) -> Checked {
        let mut rows = Vec::new();
        let within = |place: Option<SubprogramLine>| {
            place.map(|place| (report.job.program.file_name(place.file).to_owned(), place.line))
        };
        for finding in report.findings() {
            let row = Row::new(finding.rule.code(), finding.line, &finding.text);
            rows.push(Row { within: within(finding.within), ..row });
        }
        for gap in &report.gaps {
            let row = Row::new(gap.code(), gap.line, &gap.reason);
            rows.push(Row { within: within(gap.within), ..row });
        }
        for refusal in report.refusals() {
            if !matches!(refusal, NoVerdict::Open(_) | NoVerdict::Unread { .. }) {
                rows.push(Row::new(refusal.code(), refusal.line(), &refusal));
            }
        }
        Checked { verdict: report.verdict(), rows }
    }

    pub(crate) fn refused(error: &JobError) -> Checked {
        let rows = vec![Row::new(error.code(), line_of(error), &error)];
        Checked { verdict: Verdict::None, rows }
    }

    pub(crate) fn has(&self, pattern: &str) -> bool {
        self.rows.iter().any(|row| row.is(pattern))
    }

    /// Asserts the verdict, and what is found, left open or refused. `text` is shown if it is not so.
    #[track_caller]
    pub(crate) fn assert(&self, verdict: Verdict, patterns: &[&str], text: &str) {
        assert_eq!(self.verdict, verdict, "{:#?}\n{text}", self.rows);
        for pattern in patterns {
            assert!(self.has(pattern), "{pattern}: {:#?}\n{text}", self.rows);
        }
    }
}

impl Scene {
    pub(crate) fn new(blocks: &str) -> Scene {
        Scene::of(&program(blocks))
    }

    pub(crate) fn of(text: &str) -> Scene {
        let job = "part = \"block.stl\"\nunit = \"mm\"\nprogram = \"a.nc\"\nTOP\n[tool.1]\ntool = \"D2Ball\"\nLENGTH\n";
        Scene {
            file: "a.nc",
            text: text.to_owned(),
            job: job.to_owned(),
            files: BTreeMap::new(),
            obstacle: None,
            link: None,
            disc: None,
        }
    }

    /// States a key of the job.
    pub(crate) fn with(mut self, line: &str) -> Scene {
        self.job = self.job.replace("TOP", &format!("{line}\nTOP"));
        self
    }

    /// Adds a file that the job names.
    pub(crate) fn with_file(mut self, name: &'static str, text: impl Into<String>) -> Scene {
        self.files.insert(name, text.into());
        self
    }

    /// Moves on an own machine, that of the library with a change of its file.
    pub(crate) fn on(self, machine: &str, from: &str, to: &str) -> Scene {
        let text = Machine::file(machine).expect("a machine");
        assert!(text.contains(from), "{text}");
        self.with_file("mine.toml", text.replace(from, to)).with("machine = \"mine.toml\"")
    }

    /// Moves on three axes with rates in rapid traverse, in mm per minute.
    pub(crate) fn with_rates(self, rates: [u32; 3]) -> Scene {
        let mut text = Machine::file("3-axis").expect("a machine").to_owned();
        for (letter, rate) in ["X", "Y", "Z"].into_iter().zip(rates) {
            let line = format!("letter = \"{letter}\"\n");
            assert!(text.contains(&line), "{text}");
            text = text.replace(&line, &format!("{line}rapid = {rate}\n"));
        }
        self.with_file("mine.toml", text).with("machine = \"mine.toml\"")
    }

    /// States the length of the tool, and where the part is on the machine.
    pub(crate) fn placed(mut self) -> Scene {
        self.job = self.job.replace("LENGTH", "length = 50");
        self.job += "[work_offsets]\nG54 = [0, 0, -400]\n";
        self
    }

    /// Adds an obstacle.
    pub(crate) fn obstacle(mut self, low: [f64; 3], high: [f64; 3]) -> Scene {
        self.obstacle = Some(cuboid(low, high));
        self
    }

    /// Adds a mesh of the machine, in machine coordinates.
    pub(crate) fn body(mut self, low: [f64; 3], high: [f64; 3], link: Link) -> Scene {
        self.link = Some(link);
        self.obstacle(low, high)
    }

    /// Adds a disc of the machine, in machine coordinates, that must not touch the obstacle.
    pub(crate) fn disc(mut self, place: [f64; 3], link: Link) -> Scene {
        self.disc = Some((place, link));
        self
    }

    /// Asserts the verdict, and what is found, left open or refused.
    #[track_caller]
    pub(crate) fn gives(&self, control: Control, verdict: Verdict, patterns: &[&str]) {
        self.gives_by(control.map(rules).unwrap_or_default(), verdict, patterns);
    }

    /// As [`Scene::gives`], on a Sinumerik that reads native programs.
    #[track_caller]
    pub(crate) fn gives_natively(&self, verdict: Verdict, patterns: &[&str]) {
        self.gives_by(native(Choice::DeselectsOffset), verdict, patterns);
    }

    /// As [`Scene::gives`], by the rules of a control.
    #[track_caller]
    pub(crate) fn gives_by(&self, rules: ControlRules, verdict: Verdict, patterns: &[&str]) {
        self.check_by(rules).assert(verdict, patterns, &self.text);
    }

    pub(crate) fn check(&self, control: Control) -> Checked {
        self.check_by(control.map(rules).unwrap_or_default())
    }

    pub(crate) fn check_by(&self, rules: ControlRules) -> Checked {
        self.with_report(rules, Checked::of).unwrap_or_else(|error| Checked::refused(&error))
    }

    /// Checks the job, and hands on its report.
    pub(crate) fn with_report<T>(
        &self,
        rules: ControlRules,
        found: impl FnOnce(&JobReport<'_>) -> T,
    ) -> Result<T, JobError> {
        self.with_job(rules, |job| Ok(found(&job.check(&|_| ())?)))
    }

    /// Builds the job, and hands it on.
    pub(crate) fn with_job<T>(
        &self,
        rules: ControlRules,
        check: impl FnOnce(&Job<'_>) -> Result<T, JobError>,
    ) -> Result<T, JobError> {
        let text = self.job.replace("TOP\n", "").replace("LENGTH\n", "");
        let file = JobFile::parse(&text, Path::new("a.toml"))?;
        let subprograms = file.subprograms.iter().map(|path| {
            let name = path.display().to_string();
            SubprogramFile { text: Arc::from(&*self.files[&*name]), name }
        });
        let setup = file.setup(rules, subprograms.collect())?;
        let machine = match file.machine.as_deref().and_then(|name| name.to_str()) {
            None => Machine::named("3-axis")?,
            Some(name) => match self.files.get(name) {
                Some(text) => Machine::parse(text, name)?,
                None => Machine::named(name)?,
            },
        };
        let program = Program::parse(&self.text, self.file, machine, &setup)?;
        let named = file.used_tools(&program)?;
        let tools: Vec<Interpreted> = named
            .iter()
            .map(|tool| {
                let name = tool.name.to_str().expect("a name");
                let text = match self.files.get(name) {
                    Some(text) => text,
                    None => include_str!("../../../tools-library/tools/d2_ball.tool"),
                };
                Interpreted::from_text(name, text).expect("a tool")
            })
            .collect();
        let disc = Interpreted::from_text("disc.tool", DISC).expect("a tool");
        let part = cuboid([-3.0, -3.0, -2.0], [3.0, 3.0, 0.0]);
        let mut job = Job::new(&program, &part);
        for (named, tool) in named.iter().zip(&tools) {
            program.check_tool(named.motions, tool.info(), file.unit)?;
            let mut tool = JobTool::of_all(tool);
            (tool.motions, tool.hand) = (named.motions, named.hand);
            tool.allow.clone_from(&named.allow);
            job.tools.push(tool);
        }
        if let Some(obstacle) = &self.obstacle {
            job.bodies.push(match self.link {
                None => Body::fixture("the clamp", obstacle),
                Some(link) => Body::machine("the clamp", obstacle, link),
            });
        }
        if let Some((place, link)) = self.disc {
            let mount = Pose::from_axis(Point3::from(place), Vector3::z()).expect("a pose");
            let mut body = RevolvedBody::new("the disc", &disc, link, mount);
            body.against.push(job.bodies.len() - 1);
            job.revolved.push(body);
        }
        if let Some(stock) = &file.stock {
            job.stock = Some(stock.stock(None, &program, file.unit)?);
        }
        job.tolerance = file.tolerance;
        job.resolution = file.resolution;
        job.allow.clone_from(&file.allow);
        (job.surface_only, job.anyway) = (file.surface_only, file.anyway);
        check(&job)
    }
}

/// Returns the line of the program at which a job is refused; 0 if it is no line.
pub(crate) fn line_of(error: &JobError) -> usize {
    let mut error = match error {
        JobError::MachineProgram(error) => error,
        JobError::File { line, .. } => return line.unwrap_or(0),
        JobError::NoTool { line, .. }
        | JobError::UnnamedTool { line }
        | JobError::MovedPart { line, .. } => return *line,
        _ => return 0,
    };
    loop {
        match error {
            MachineProgramError::Under { error: inner, .. } => error = inner,
            MachineProgramError::Block { line, .. } => return *line,
            _ => return 0,
        }
    }
}

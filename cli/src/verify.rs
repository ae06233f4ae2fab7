//! `touchoff verify`: reads the files of a job, and prints one line per finding, as compilers do, and a summary.

use crate::arguments::{CheckArguments, ParamArguments, ToolArguments, Verify};
use crate::failure::Failure;
use crate::loaded_tool::{LoadedTool, compile_named};
use crate::output::{Output, extension, refuse_inputs_within, write_file};
use crate::part;
use crate::program::{print_approach, print_ignored, warn_of_cutter};
use crate::progress::Progress;
use anstyle::{AnsiColor, Style};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use touchoff::Escaped;
use touchoff::certify::TriangleBvh;
use touchoff_dsl::Compiled;
use touchoff_import::Libraries;
use touchoff_verify::job::{
    CutStock, Hand, JobInputs, JobStock, JobTools, NO_INSIDE, NamedTool, Severity, StockEntry,
    StockShape,
};
use touchoff_verify::machine::Machine;
use touchoff_verify::{GapWeight, Job, JobFile, JobReport, Program, ToolSelection, Verdict};

/// The exit status if there is no verdict, even with findings; the same as for wrong options.
pub(crate) const NOT_CHECKED: u8 = 2;

/// The number of findings that are printed as lines: nobody reads a million.
const MAX_LINES: usize = 1_000;

/// A job and the files that it names, read.
pub(crate) type Inputs = JobInputs<LoadedTool>;

/// Reads program, tools, part, fixtures and stock of a job, and prints what is noteworthy about them, and all meshes if `verbose` is set.
/// `outputs` are the files that the command writes, beside those of the job; `other_inputs` are the job's own file and what else the
/// command reads.
///
/// # Errors
/// If one of them cannot be read, or they do not fit, or if an output is an input.
pub(crate) fn read(
    file: JobFile,
    outputs: &[&Path],
    other_inputs: &[&Path],
    verbose: bool,
) -> Result<Inputs, Failure> {
    let refuse = |file: &JobFile, inputs: Vec<(String, &Path)>| {
        let outputs = outputs.iter().copied().chain(file.outputs().map(|(_, file)| file));
        let inputs = inputs.into_iter().map(|(_, file)| file);
        let root = file.root.as_deref().unwrap_or(Path::new("/"));
        refuse_inputs_within(root, outputs, other_inputs.iter().copied().chain(inputs))
    };
    refuse(&file, file.files())?;
    let mut libraries = Libraries::default();
    let inputs = JobInputs::read::<Failure>(file, |named| {
        let loaded = LoadedTool::load_from(&named.name, &arguments(named), &mut libraries)?;
        let library = named.library.as_deref();
        let root = named.root.as_deref();
        if let Some(entry) = libraries.entry::<Failure>(library, &named.name, root)? {
            named.hand = named.hand.or(entry.left_handed.map(Hand::of));
            named.doubts = entry.doubts();
        }
        Ok(loaded)
    })?;
    // Those that a machine and earlier set-ups name are known by now.
    refuse(&inputs.file, inputs.further_files())?;
    for (named, loaded) in &inputs.tools {
        let info = loaded.tool().info();
        if let Some(line) = inputs.program.check_tool(named.motions, info, inputs.file.unit)? {
            warn_of_cutter(&inputs.program.name(), line, info);
        }
    }
    for body in &inputs.bodies {
        if let Some(file) = &body.file {
            part::print_findings(file, &body.mesh, verbose);
        }
    }
    let entry = inputs.file.stock.as_ref().and_then(|entry| entry.mesh.as_ref());
    if let (Some(file), Some(JobStock { shape: StockShape::Mesh(mesh), .. })) =
        (entry, &inputs.stock)
    {
        part::print_findings(file, mesh, verbose);
    }
    Ok(inputs)
}

/// Compiles a tool of a job again, for its drawing and its proof. Libraries of several tools are read once.
///
/// # Errors
/// If its file cannot be read any more.
pub(crate) fn compile(named: &NamedTool, libraries: &mut Libraries) -> Result<Compiled, Failure> {
    compile_named(&named.name, &arguments(named), libraries)
}

/// Returns the arguments with which a named tool is loaded.
fn arguments(named: &NamedTool) -> ToolArguments {
    let params = ParamArguments::new(named.params.clone(), named.root.clone());
    ToolArguments { library: named.library.clone(), params }
}

/// Returns the job of a job file, or of a part and the options.
///
/// # Errors
/// If the job file cannot be read.
pub(crate) fn job_file(
    file: Option<PathBuf>,
    part: Option<PathBuf>,
    options: CheckArguments,
) -> Result<JobFile, Failure> {
    if let Some(file) = file {
        if extension(&file)
            .is_some_and(|ending| matches!(&*ending, "stl" | "ply" | "obj" | "touchoff"))
        {
            return Err(Failure::MeshForJob { file: file.display().to_string() });
        }
        let ToolArguments { library, params } = options.params;
        let (set, root) = params.into_parts();
        if !set.is_empty() || library.is_some() {
            return Err(Failure::Usage(
                "a job file states its tools with their params: leave out `--tools` and `--set`",
            ));
        }
        let mut job = JobFile::read(&file, root.as_deref())?;
        // Options go before the file; leniency holds if either states it.
        job.control = options.control.or(job.control);
        job.resolution = options.resolution.or(job.resolution);
        job.surface_only |= options.surface_only;
        job.anyway |= options.anyway;
        if let Some(stock) = job.stock.as_mut().filter(|_| options.read_only) {
            (stock.output, stock.map) = (None, None);
        }
        return Ok(job);
    }
    let missing =
        Failure::Usage("name a job file, or `--part`, `--unit`, `--tool` and `--program`");
    let (Some(part), Some(unit), Some(program)) = (part, options.unit, options.program) else {
        return Err(missing);
    };
    let ToolArguments { library, params } = options.params;
    let tools = match (options.tool, library) {
        (Some(name), library) => {
            let (params, root) = params.into_parts();
            let (motions, hand, allow) = (ToolSelection::All, None, Vec::new());
            let doubts = Vec::new();
            JobTools::One(NamedTool { motions, name, library, params, root, hand, doubts, allow })
        }
        (None, Some(library)) if params.is_empty() => {
            JobTools::Numbered { library: Some(library), entries: BTreeMap::new() }
        }
        (None, Some(_)) => {
            return Err(Failure::UnusedParams("name the tool whose params they are by `--tool`"));
        }
        (None, None) => return Err(missing),
    };
    Ok(JobFile {
        root: None,
        part,
        unit,
        program,
        machine: options.machine,
        control: options.control,
        work_offsets: [None; 9],
        additional_offsets: BTreeMap::new(),
        radius_offsets: BTreeMap::new(),
        presets: BTreeMap::new(),
        block_delete: None,
        ignore: BTreeMap::new(),
        variables: BTreeMap::new(),
        subprograms: Vec::new(),
        tools,
        tolerance: options.tolerance,
        resolution: options.resolution,
        allow: options.allow,
        other_parts: Vec::new(),
        fixtures: Vec::new(),
        stock: None,
        surface_only: options.surface_only,
        anyway: options.anyway,
    })
}

/// Checks a job. `json` suppresses the progress display.
///
/// # Errors
/// As for [`Job::check`].
pub(crate) fn check<'a>(job: &'a Job<'_>, json: bool) -> Result<JobReport<'a>, Failure> {
    let progress = Progress::steps(job.motion_checks(), "motions", json);
    Ok(job.check(&|count| progress.advance(count))?)
}

/// Checks a program, and returns the exit status.
pub(crate) fn verify(arguments: Verify, json: bool) -> Result<ExitCode, Failure> {
    let Verify { job: job_path, part, check: options, sarif } = arguments;
    let verbose = options.verbose;
    let file = job_file(job_path.clone(), part, options)?;
    let inputs = read(file, sarif.as_deref().as_slice(), job_path.as_deref().as_slice(), verbose)?;
    let job = inputs.job();
    let report = check(&job, json)?;
    message!("{}", report.headline());
    let mut out = Output::rows();
    for (count, finding) in report.findings().iter().enumerate() {
        if json {
            out.json(&report.row(finding))?;
        } else if count < MAX_LINES {
            let place = format!("{}:{}:", Escaped(inputs.program.name()), finding.line);
            out.styled(style(finding.severity), &place)?;
            writeln!(out, " {} [{}]", Escaped(&finding.text), finding.rule.code())?;
        }
    }
    if json {
        for row in report.gap_rows() {
            out.json(&row)?;
        }
    }
    out.flush()?;
    let left_out = report.findings().len().saturating_sub(MAX_LINES);
    if !json && left_out > 0 {
        message!("{left_out} more findings are left out: `--json` and `--sarif` list all");
    }
    print(&inputs, &report, verbose)?;
    if let Some(file) = sarif {
        let name = job_path.as_deref().unwrap_or(&inputs.file.program);
        write_file(&file, serde_json::to_vec_pretty(&report.sarif(&name.to_string_lossy()))?)?;
    }
    Ok(exit(report.verdict()))
}

/// Returns the exit status of a verdict.
pub(crate) fn exit(verdict: Verdict) -> ExitCode {
    ExitCode::from(match verdict {
        Verdict::Clean => 0,
        Verdict::Findings => 1,
        Verdict::None => NOT_CHECKED,
    })
}

/// Returns the style of a finding's file and line on a terminal.
fn style(severity: Severity) -> Style {
    let color = match severity {
        Severity::Violation => AnsiColor::Red,
        Severity::Undecided => AnsiColor::Yellow,
        Severity::Remark => AnsiColor::Cyan,
    };
    color.on_default().bold()
}

/// Prints the reasons for which there is no verdict, what was not checked, and, if `verbose` is set, what was read and how near the tools
/// came; then writes what the job asks for of the stock.
///
/// # Errors
/// If a file cannot be written.
pub(crate) fn print(inputs: &Inputs, report: &JobReport<'_>, verbose: bool) -> Result<(), Failure> {
    for reason in report.refusals() {
        message!("not verified: {reason} [{}]", reason.code());
    }
    // Gaps that are open and not accepted are among the refusals.
    for gap in report.gaps.iter().filter(|gap| match gap.weight {
        GapWeight::Stops => false,
        GapWeight::Open => inputs.file.anyway,
        GapWeight::Said => true,
    }) {
        message!("not checked: {gap} [{}]", gap.code());
    }
    if report.is_surface_only() {
        message!("{NO_INSIDE}; only its surface was checked");
    }
    if let Program::Locations(programs) = &inputs.program {
        print_ignored(programs);
    }
    if verbose {
        print_summary(inputs, report);
    }
    if let (Some(cut), Some(entry)) = (report.cut(), &inputs.file.stock) {
        print_stock(cut, entry, &inputs.bodies[0].bvh, report.verdict())?;
    }
    Ok(())
}

/// Prints where part and program are and how near they come, the machine, and the findings of each tool at each body.
fn print_summary(inputs: &Inputs, report: &JobReport<'_>) {
    // Once per tool: at every body and in every reading it goes the same way.
    for pair in report.tools_at_part() {
        print_approach(&pair.report, inputs.file.unit);
    }
    if let Program::Machine(readings) = &inputs.program {
        let stated = inputs.program.machine().map_or("", Machine::name);
        match readings.len() {
            1 => message!("machine: {stated}"),
            count => message!("machine: {stated}, in {count} readings of the program"),
        }
    }
    for summary in report.summaries() {
        message!("{summary}");
    }
}

/// Prints what remains of the stock, and writes it as an STL file and its deviations from the part as CSV or PLY if asked to.
fn print_stock(
    cut: &CutStock,
    entry: &StockEntry,
    part: &TriangleBvh,
    verdict: Verdict,
) -> Result<(), Failure> {
    let stock = &cut.stock;
    let comparison = stock.compare(part)?;
    message!(
        "stock: {} of {} points remain; {}; {}; {}",
        stock.len(),
        stock.initial_len(),
        cut.resolution(),
        cut.farthest("most over the part", comparison.greatest_excess()),
        cut.farthest("most cut from the part", comparison.deepest_gouge()),
    );
    // The material that a program leaves which was not verified is not known.
    if verdict == Verdict::None {
        let files = [&entry.output, &entry.map].into_iter().flatten();
        files.for_each(|file| {
            message!("not written: {}, as the program was not verified", file.display());
        });
        return Ok(());
    }
    if let Some(output) = &entry.output {
        let mut bytes = Vec::new();
        stock.remaining_mesh()?.write_stl(&mut bytes)?;
        write_file(output, bytes)?;
    }
    if let Some(map) = &entry.map {
        let mut bytes = Vec::new();
        match extension(map).as_deref() == Some("ply") {
            true => comparison.write_ply(&mut bytes)?,
            false => comparison.write_csv(&mut bytes)?,
        }
        write_file(map, bytes)?;
    }
    Ok(())
}

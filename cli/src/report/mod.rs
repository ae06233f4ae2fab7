//! `touchoff report`: one HTML file about a program, to send around.
//!
//! ```text
//! job ──verify──▶ findings ──scene──▶ places ──────┐
//! bodies ──shapes──▶ pieces ──colouring──▶ layers ─┼─scene──▶ the 3-D view ─┐
//! tools ──shapes──▶ profiles ──────────────────────┴─picture─▶ pictures ────┼─page──▶ HTML
//! program ──along──▶ samples, charts ───────────────────────────────────────┤
//!    └──excerpt──▶ lines around findings ───────────────────────────────────┘
//! ```

mod along;
mod colouring;
mod excerpt;
mod page;
mod path;
mod scene;
mod shapes;

use crate::arguments::Report;
use crate::failure::Failure;
use crate::output::{extension, file_name, unreadable, write_file};
use crate::picture::{Heading, Legend, close_up, facets, sheet};
use crate::postures::map::check_part;
use crate::progress::Progress;
use crate::verify::{self, Inputs};
use along::Along;
use colouring::{ColouredBodies, Layer};
use excerpt::{Excerpt, excerpts};
use path::ToolPath;
use scene::{Place, Scene};
use sha2::{Digest, Sha256};
use shapes::ToolShape;
use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use touchoff::{Escaped, FileKind, read_regular_file};
use touchoff_import::files_in_folder;
use touchoff_postures::PostureMap;
use touchoff_verify::JobReport;
use touchoff_verify::job::JobFinding;
use touchoff_verify::stock::PartComparison;

/// Side of a view of the part, in pixels.
const SIDE: usize = 520;
/// Size of the picture of a finding, in pixels, and the number of findings that have one.
const CLOSE_UP: [usize; 2] = [460, 340];
const CLOSE_UPS: usize = 8;

/// Checks a program, writes the report, and returns the exit status of `verify`.
pub(crate) fn report(arguments: Report, json: bool) -> Result<ExitCode, Failure> {
    let start = Instant::now();
    let Report { job: subject, check, map, output } = arguments;
    if extension(&output).as_deref() != Some("html") {
        return Err(Failure::extension("a report ends in `.html`", &output, "html"));
    }
    let is_job = extension(&subject).as_deref() == Some("toml");
    if is_job && check.states_subject() {
        return Err(Failure::Usage(
            "a job file states unit, tools, program, machine and tolerances: leave out these options",
        ));
    }
    if !is_job && check.read_only {
        return Err(Failure::Usage(
            "`--read-only` writes nothing that a job asks for: name a job file, or leave it out",
        ));
    }
    if !is_job && !check.has_subject() {
        return Err(Failure::Usage(
            "a report on a part needs `--unit`, `--tool` and `--program`; or name a job file",
        ));
    }
    let (job_file, part) =
        if is_job { (Some(subject.clone()), None) } else { (None, Some(subject.clone())) };
    let verbose = check.verbose;
    let job = verify::job_file(job_file, part, check)?;
    let other_inputs: Vec<&Path> =
        [Some(&subject), map.as_ref()].into_iter().flatten().map(|file| &**file).collect();
    let inputs = verify::read(job, &[&output], &other_inputs, verbose)?;
    let map = match map {
        Some(file) => Some((PostureMap::read(&file)?, file)),
        None => None,
    };
    if let Some((map, file)) = &map {
        check_part(map, file, &inputs.bodies[0].mesh, &inputs.file.part)?;
    }
    let mut times = vec![("reading the inputs", start.elapsed())];
    let check = Instant::now();
    let job = inputs.job();
    let checked = verify::check(&job, json)?;
    times.push(("proving the motions, and cutting the stock", check.elapsed()));
    message!("{}", checked.headline());
    verify::print(&inputs, &checked, verbose)?;

    let progress = Progress::spinner("writing the report", json);
    let job_file = is_job.then_some(&*subject);
    let map = map.as_ref().map(|(map, file)| NamedMap { map, file });
    let content = Content::new(&inputs, &checked, job_file, map, times)?;
    let html = page::html(&content)?;
    drop(progress);
    let megabytes = html.len() as f64 / 1e6;
    write_file(&output, html)?;
    message!("{}: {megabytes:.1} MB, opens in a browser", output.display());
    Ok(verify::exit(checked.verdict()))
}

/// A posture map and its file.
#[derive(Clone, Copy)]
struct NamedMap<'a> {
    map: &'a PostureMap,
    file: &'a Path,
}

/// A file as it was read.
struct InputFile {
    role: String,
    name: String,
    bytes: usize,
    /// SHA-256 of its content, in hexadecimal digits.
    digest: String,
}

impl InputFile {
    /// Reads a file.
    ///
    /// # Errors
    /// [`Failure::Unreadable`].
    fn read(role: String, file: &Path) -> Result<InputFile, Failure> {
        let name = file.display().to_string();
        let content = read_regular_file(file, FileKind::Geometry)
            .map_err(|source| unreadable(file, source))?;
        let mut digest = String::new();
        for byte in Sha256::digest(&content) {
            // Writing to a String does not fail.
            let _ = write!(digest, "{byte:02x}");
        }
        Ok(InputFile { role, name, bytes: content.len(), digest })
    }
}

/// A picture, as PNG.
struct Picture {
    caption: String,
    png: Vec<u8>,
}

/// The content of a report.
struct Content<'a> {
    inputs: &'a Inputs,
    checked: &'a JobReport<'a>,
    /// The map that colours the part.
    map: Option<NamedMap<'a>>,
    comparison: Option<PartComparison>,
    files: Vec<InputFile>,
    /// Those of the tools, then those of the machine's bodies.
    shapes: Vec<ToolShape>,
    /// The data of the 3-D view as JSON; `null` without a view.
    scene_json: String,
    /// The largest rounding error of a coordinate in the 3-D view, in the unit of the job; `None` without a view.
    scene_rounding: Option<f64>,
    /// Describes how the path is drawn.
    path_caption: String,
    /// One picture per quantity.
    sheets: Vec<Picture>,
    /// The worst findings, by their index.
    close_ups: Vec<(usize, Picture)>,
    /// Set for each finding that has a camera.
    has_place: Vec<bool>,
    /// The lines of the program around each finding.
    excerpts: Vec<Vec<Excerpt>>,
    /// One per tool.
    along: Vec<Along>,
    times: Vec<(&'static str, Duration)>,
}

impl<'a> Content<'a> {
    fn new(
        inputs: &'a Inputs,
        checked: &'a JobReport<'a>,
        job_file: Option<&Path>,
        map: Option<NamedMap<'a>>,
        mut times: Vec<(&'static str, Duration)>,
    ) -> Result<Content<'a>, Failure> {
        let (unit, bodies) = (inputs.file.unit, &inputs.bodies);
        let start = Instant::now();
        let points = along::points(inputs)?;
        let count = checked.tools_at_part().count();
        let along = checked.tools_at_part();
        let along = along.map(|pair| along::follow(checked, &points, pair, count));
        let along = along.filter_map(Result::transpose).collect::<Result<_, Failure>>()?;
        times.push(("depth, clearance and force along the program", start.elapsed()));

        let start = Instant::now();
        let mut shown = ColouredBodies::new(checked, bodies)?;
        if let Some(NamedMap { map, .. }) = map {
            shown.add_map(map, &bodies[0].mesh)?;
        }
        let mut comparison = None;
        if let Some(cut) = checked.cut() {
            let deviations = cut.stock.compare(&bodies[0].bvh)?;
            shown.add_stock(cut, &deviations)?;
            comparison = Some(deviations);
        }
        let tools = checked.job.tools.iter().map(|tool| tool.tool);
        let revolved = checked.job.revolved.iter().map(|body| body.shape);
        let shapes: Vec<ToolShape> =
            tools.chain(revolved).map(|shape| ToolShape::new(shape.info(), unit)).collect();
        let places: Vec<Option<Place>> = checked
            .findings()
            .iter()
            .map(|finding| Place::of(finding, inputs, checked, &shown.bodies, &shapes))
            .collect();
        let pictures = Pictures { inputs, checked, shown: &shown, shapes: &shapes };
        let title = pictures.title();
        let path = ToolPath::new(checked, shown.bodies[0].extent())?;
        let names = pictures.tool_names();
        let scene = Scene::new(&title, unit, &shown, &shapes, &places, &path, &names);
        let sheets =
            shown.layers.iter().map(|layer| pictures.sheet(layer)).collect::<Result<_, _>>()?;
        let mut close_ups: Vec<(usize, Picture)> = Vec::new();
        for (index, (finding, place)) in checked.findings().iter().zip(&places).enumerate() {
            let Some(place) = place else { continue };
            // The worst come first, so a place is left out that the picture of a worse finding shows.
            let mut drawn = close_ups.iter().filter_map(|(drawn, _)| places[*drawn].as_ref());
            if close_ups.len() < CLOSE_UPS && !drawn.any(|drawn| drawn.shows(place)) {
                close_ups.push((index, pictures.close_up(index, finding, place)?));
            }
        }
        times.push(("pictures", start.elapsed()));

        let job_file = job_file.map(|file| ("job".to_owned(), file));
        let map_file = map.map(|map| ("posture map".to_owned(), map.file));
        let named = job_file.into_iter().chain(inputs.files()).chain(map_file);
        let mut files: Vec<InputFile> = Vec::new();
        for (role, input) in named {
            if input.is_dir() {
                for file in files_in_folder(input) {
                    files.push(InputFile::read(role.clone(), &file)?);
                }
            } else {
                files.push(InputFile::read(role, input)?);
            }
        }
        Ok(Content {
            inputs,
            checked,
            map,
            comparison,
            files,
            scene_json: scene::json(&scene)?,
            scene_rounding: scene.map(|scene| scene.rounding_error()),
            path_caption: path.caption(unit),
            sheets,
            close_ups,
            has_place: places.iter().map(Option::is_some).collect(),
            excerpts: excerpts(&inputs.file, checked.findings()),
            shapes,
            along,
            times,
        })
    }
}

/// The common part of all pictures of a report.
struct Pictures<'a> {
    inputs: &'a Inputs,
    checked: &'a JobReport<'a>,
    shown: &'a ColouredBodies,
    shapes: &'a [ToolShape],
}

impl Pictures<'_> {
    /// Draws a quantity on its body, in several views.
    fn sheet(&self, layer: &Layer) -> Result<Picture, Failure> {
        let shown = &self.shown.bodies[layer.body];
        let facets: Vec<_> = facets(shown.corners(), &layer.values, &layer.scale).collect();
        let body =
            if layer.body == 0 { file_name(&self.inputs.file.part) } else { shown.name.clone() };
        let title = format!("{}: {}", Escaped(&body), layer.scale.quantity);
        let heading = Heading { title: title.clone(), subtitle: self.subtitle() };
        let legend = Legend::Scale(&layer.scale);
        let png = sheet(&facets, &heading, &legend, shown.unit, SIDE)?;
        Ok(Picture { caption: title, png })
    }

    /// Draws the place of a finding with the tool.
    fn close_up(
        &self,
        index: usize,
        finding: &JobFinding,
        place: &Place,
    ) -> Result<Picture, Failure> {
        let body = place.body.unwrap_or(0);
        let shown = &self.shown.bodies[body];
        // Each body with findings has a layer of their depths, the first of its layers.
        let layers = &self.shown.layers;
        let layer = layers.iter().find(|layer| layer.body == body).unwrap_or(&layers[0]);
        let plain = vec![None; shown.triangles.len()];
        let values = if layer.body == body { &layer.values } else { &plain };
        let tool = place.tool.as_ref().map(|(tool, pose)| self.shapes[*tool].facets(pose));
        let facets =
            facets(shown.corners(), values, &layer.scale).chain(tool.into_iter().flatten());
        let line = format!("{}:{}", Escaped(&file_name(&self.inputs.file.program)), finding.line);
        let heading = Heading {
            title: format!("{}. {} at {line}", index + 1, finding.rule),
            subtitle: self.title(),
        };
        let png = close_up(facets, &place.camera(), &heading, &layer.scale, shown.unit, CLOSE_UP)?;
        Ok(Picture { caption: format!("{}. {line}: {}", index + 1, finding.text), png })
    }

    /// Describes the part, the program, the tools and the unit.
    fn title(&self) -> String {
        format!("{}: {}", Escaped(&file_name(&self.inputs.file.part)), self.subtitle())
    }

    /// Returns number and name of each tool.
    fn tool_names(&self) -> Vec<String> {
        let tools = self.checked.job.tools.iter();
        tools.map(|tool| format!("{}{}", prefix(tool.number()), tool.tool.info().name)).collect()
    }

    /// Describes the program, the tools and the unit.
    fn subtitle(&self) -> String {
        let names = self.tool_names().join(", ");
        let program = file_name(&self.inputs.file.program);
        let text = format!("{program}, {names}, lengths in {}", self.inputs.file.unit);
        Escaped(&text).to_string()
    }
}

/// Returns a tool's number in the program as it stands before the name.
fn prefix(number: Option<u32>) -> String {
    number.map_or(String::new(), |number| format!("T{number} "))
}

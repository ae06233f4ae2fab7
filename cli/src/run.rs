//! `touchoff run`: a tool along a path. Prints one row per pose, and a summary.

use crate::arguments::Run;
use crate::failure::Failure;
use crate::loaded_tool::LoadedTool;
use crate::output::Output;
use crate::part::{self, DenseSampling, LoadedPart};
use crate::program;
use crate::progress::Progress;
use crate::timing::{Timing, nanoseconds};
use nalgebra::Point3;
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::{IsTerminal, Write};
use std::time::Instant;
use touchoff::certify::{Certifier, Penetration, TriangleBvh};
use touchoff::tool::ToolInfo;
use touchoff::{Contact, Interval, Law, Part, Probe, Unit, Wrench};
use touchoff_verify::ClData;
use touchoff_verify::job::NO_INSIDE;

#[derive(Serialize)]
struct Row<'a> {
    /// Index of the cutter location, from 0.
    location: usize,
    line: usize,
    /// Unit of lengths.
    unit: &'static str,
    contacts: usize,
    depth: f64,
    /// Upper bound on the depth of the whole surface, if one is proved.
    depth_bound: Option<f64>,
    force: [f64; 3],
    torque: [f64; 3],
    niceness: Option<f64>,
    /// Sum of weight times magnitude over the contacts.
    magnitude_integral: f64,
    energy: f64,
    query_time_ns: u64,
    law: String,
    /// The greatest depth per surface in contact.
    surface_depths: BTreeMap<&'a str, f64>,
    #[serde(flatten)]
    certified: Option<Certified<'a>>,
}

impl Row<'_> {
    /// Returns a row with what a wrench tells.
    fn of(evaluation: &Wrench, unit: Unit) -> Self {
        Row {
            location: 0,
            line: 0,
            unit: unit.symbol(),
            contacts: evaluation.colliding,
            depth: evaluation.depth(),
            depth_bound: None,
            force: evaluation.force.into(),
            torque: evaluation.torque.into(),
            niceness: evaluation.niceness,
            magnitude_integral: evaluation.integral,
            energy: evaluation.energy,
            query_time_ns: 0,
            law: evaluation.law.to_string(),
            surface_depths: BTreeMap::new(),
            certified: None,
        }
    }
}

impl Row<'_> {
    /// Returns whether a point or a triangle is inside the tool, or the tool inside the material.
    fn is_in_contact(&self) -> bool {
        let is_proved = |c: &Certified<'_>| c.triangle.is_some() || c.inside == Some(true);
        self.contacts > 0 || self.certified.as_ref().is_some_and(is_proved)
    }

    /// Prints the row for people.
    fn print(&self, out: &mut impl Write, unit: Unit) -> std::io::Result<()> {
        let Row { line, contacts, .. } = self;
        let depth = unit.format_number(self.depth);
        let proved = self.certified.as_ref().map(|c| format!("{}; ", c.format(unit)));
        let surfaces = self.surface_depths.iter();
        let each = surfaces.map(|(name, depth)| format!("{name} {}", unit.format_number(*depth)));
        let (proved, each) = (proved.unwrap_or_default(), each.collect::<Vec<_>>().join(", "));
        writeln!(out, "{line:>8} {contacts:>7} {depth:>12}  {proved}{each}")
    }
}

/// Returns the lower of the upper bounds on the depth of the whole surface, since both hold: the depth of the points plus the
/// sampling error, and the proved depth.
fn depth_bound(
    evaluation: &Wrench,
    sampling_error: Option<f64>,
    certified: Option<&Certified<'_>>,
) -> Option<f64> {
    let sampled = sampling_error.map(|sampling_error| evaluation.depth() + sampling_error);
    let proved = certified.map(|certified| certified.certified_depth[1]);
    [sampled, proved].into_iter().flatten().reduce(f64::min)
}

/// Proved results at a pose.
#[derive(Serialize)]
struct Certified<'a> {
    /// An interval that contains the depth of the part's triangles.
    certified_depth: [f64; 2],
    /// The deepest triangle, if one is inside the tool.
    triangle: Option<u32>,
    /// The tool's surface nearest to it there.
    surface: Option<&'a str>,
    /// True if the tool is inside the material deeper than the triangles show; null if that is unknown.
    inside: Option<bool>,
}

impl<'a> Certified<'a> {
    fn new(penetration: &Penetration, inside: Option<bool>, info: &'a ToolInfo) -> Certified<'a> {
        Certified {
            certified_depth: penetration.depth.into(),
            triangle: penetration.witness.map(|witness| witness.triangle.0),
            surface: penetration.witness.map(|witness| &*info.surface(witness.surface).name),
            inside,
        }
    }

    /// Formats the proved depth for people, as one number if both bounds print alike.
    fn format(&self, unit: Unit) -> String {
        if self.inside == Some(true) && self.triangle.is_none() {
            return "wholly inside the material".to_owned();
        }
        let [low, high] = self.certified_depth.map(|depth| unit.format_number(depth));
        let depth = if low == high { high } else { format!("{low} to {high}") };
        let inside = if self.inside == Some(true) { ", inside the material" } else { "" };
        format!("{depth} {}{inside}", self.surface.unwrap_or_default())
    }
}

/// Runs a tool along a path.
pub(crate) fn run(arguments: &Run, json: bool) -> Result<(), Failure> {
    // Everything that can be wrong is found before the first row is written.
    let loaded = LoadedTool::load(&arguments.tool, &arguments.params)?;
    let tool = loaded.tool();
    let unit = arguments.part.unit;
    let program = program::read(&arguments.program, tool.info(), unit)?;
    let LoadedPart { part, mesh, certify, has_normals } =
        part::load(&arguments.part, Some(tool.info()), DenseSampling::Certify, json)?;
    // A sampling error that needs too many points has become a tolerance of its own; the stricter one holds.
    let certify = [arguments.certify, certify].into_iter().flatten().reduce(f64::min);
    let bvh = match (certify, &mesh) {
        (Some(tolerance), Some(mesh)) => Some((TriangleBvh::new(mesh), tolerance)),
        (Some(_), None) => {
            return Err(part::no_triangles(&arguments.part.part, "--certify"));
        }
        (None, _) => None,
    };
    let mut certifier = match &bvh {
        Some((bvh, tolerance)) => Some((Certifier::new(bvh, tool)?, *tolerance)),
        None => None,
    };
    // The other laws depend on the side of the material.
    let law = if has_normals { arguments.law } else { Law::Gradient };
    about(arguments, law, &part, &program, tool.info());
    part::print_covering_radius(&part, Some(tool), unit);

    let mut out = Output::rows();
    if !json {
        let proved = if certifier.is_some() { "proved; " } else { "" };
        writeln!(out, "    line  points   depth ({unit})  {proved}by surface")?;
    }
    let mut probe = Probe::new(&part, tool)
        .with_law(law)
        .with_weights(arguments.weights)
        .with_centre(arguments.center.unwrap_or(Point3::origin()));
    let proved = part.tree().covering_radius().is_some_and(|cover| cover.proved);
    // An estimated covering radius bounds nothing.
    let sampling_error = probe.sampling_error_bound().filter(|_| proved);
    let mut summary = Summary::default();
    // Rows on the same terminal show the progress themselves.
    let quiet = json || std::io::stdout().is_terminal();
    let progress = Progress::steps(program.locations.len(), "poses", quiet);
    for (index, location) in program.locations.iter().enumerate() {
        progress.advance(1);
        let start = Instant::now();
        let evaluation = probe.wrench(&location.pose);
        let ns = nanoseconds(start.elapsed());
        let contacts = if evaluation.colliding > 0 { probe.contacts(&location.pose) } else { &[] };
        let surfaces = by_surface(contacts, tool.info());
        summary.add(location.line, &evaluation, &surfaces, ns);
        let certified = certifier.as_mut().map(|(certifier, tolerance)| {
            let start = Instant::now();
            let penetration = certifier.deepest(&location.pose, *tolerance);
            let ns = nanoseconds(start.elapsed());
            let inside = certifier.is_inside(&location.pose, penetration.depth.high);
            summary.certify(location.line, &penetration, inside, ns);
            Certified::new(&penetration, inside, tool.info())
        });
        let row = Row {
            location: index,
            line: location.line,
            depth_bound: depth_bound(&evaluation, sampling_error, certified.as_ref()),
            query_time_ns: ns,
            surface_depths: surfaces,
            certified,
            ..Row::of(&evaluation, unit)
        };
        if json {
            out.json(&row)?;
        } else if row.is_in_contact() {
            row.print(&mut out, unit)?;
        }
    }
    out.flush()?;
    drop(progress);
    summary.print(unit);
    if bvh.as_ref().is_some_and(|(bvh, _)| !bvh.has_inside()) {
        message!("{NO_INSIDE}");
    }
    Ok(())
}

/// Prints a description of the input.
fn about(arguments: &Run, law: Law, part: &Part, program: &ClData, info: &ToolInfo) {
    program::print_ignored(std::slice::from_ref(program));
    message!(
        "{} on {} points, {} poses; law {}, weights {}, lengths in {}",
        info.name,
        part.tree().len(),
        program.locations.len(),
        law,
        arguments.weights,
        arguments.part.unit,
    );
}

fn by_surface<'a>(contacts: &[Contact], info: &'a ToolInfo) -> BTreeMap<&'a str, f64> {
    let mut surfaces = BTreeMap::new();
    for contact in contacts {
        let deepest: &mut f64 =
            surfaces.entry(&*info.surfaces[contact.surface.0].name).or_default();
        *deepest = deepest.max(contact.depth);
    }
    surfaces
}

/// Summary of the whole path.
#[derive(Default)]
struct Summary {
    poses: usize,
    in_contact: usize,
    deepest: Option<DeepestPose>,
    surfaces: BTreeMap<String, SurfaceSummary>,
    times: Vec<u64>,
    proved: Option<Proved>,
}

/// The deepest pose and its line.
#[derive(Clone, Copy)]
struct DeepestPose {
    depth: f64,
    line: usize,
}

/// The poses at which a surface is in contact.
struct SurfaceSummary {
    poses: usize,
    deepest: DeepestPose,
}

/// Proved results along the path.
#[derive(Default)]
struct Proved {
    in_contact: usize,
    /// Number of poses at which the tool is inside the material deeper than the triangles show.
    inside: usize,
    /// The line of the first of them.
    first_inside_line: usize,
    /// An interval that contains the greatest depth.
    depth: Interval,
    /// The line of the pose with the greatest depth.
    deepest_line: usize,
    times: Vec<u64>,
}

impl Summary {
    fn add(&mut self, line: usize, evaluation: &Wrench, surfaces: &BTreeMap<&str, f64>, ns: u64) {
        self.poses += 1;
        self.times.push(ns);
        if evaluation.colliding == 0 {
            return;
        }
        self.in_contact += 1;
        let depth = evaluation.depth();
        if self.deepest.as_ref().is_none_or(|deepest| depth > deepest.depth) {
            self.deepest = Some(DeepestPose { depth, line });
        }
        for (name, depth) in surfaces {
            let pose = DeepestPose { depth: *depth, line };
            let summary = self.surfaces.entry((*name).to_owned());
            let summary = summary.or_insert(SurfaceSummary { poses: 0, deepest: pose });
            summary.poses += 1;
            if pose.depth > summary.deepest.depth {
                summary.deepest = pose;
            }
        }
    }

    fn certify(&mut self, line: usize, penetration: &Penetration, inside: Option<bool>, ns: u64) {
        let proved = self.proved.get_or_insert_default();
        proved.times.push(ns);
        proved.in_contact += usize::from(penetration.witness.is_some());
        if inside == Some(true) {
            if proved.inside == 0 {
                proved.first_inside_line = line;
            }
            proved.inside += 1;
        }
        if penetration.depth.high > proved.depth.high {
            (proved.depth, proved.deepest_line) = (penetration.depth, line);
        }
    }

    fn print(mut self, unit: Unit) {
        match self.deepest {
            Some(DeepestPose { depth, line }) => message!(
                "{} of {} poses in contact, deepest {} at line {line}",
                self.in_contact,
                self.poses,
                unit.format(depth),
            ),
            None => message!("none of {} poses in contact", self.poses),
        }
        for (name, SurfaceSummary { poses, deepest }) in &self.surfaces {
            message!(
                "  {name:<12} {poses:>6} poses, deepest {} at line {}",
                unit.format(deepest.depth),
                deepest.line
            );
        }
        message!("query time: {}", Timing::of(&mut self.times));
        if let Some(mut proved) = self.proved {
            if proved.inside > 0 {
                message!(
                    "proved: inside the material, deeper than its triangles show, at {} of {} poses, first at line {}",
                    proved.inside,
                    self.poses,
                    proved.first_inside_line
                );
            }
            let Interval { low, high } = proved.depth;
            message!(
                "proved: {} of {} poses in contact, deepest {} to {} at line {}; time: {}",
                proved.in_contact,
                self.poses,
                unit.format_number(low),
                unit.format(high),
                proved.deepest_line,
                Timing::of(&mut proved.times),
            );
        }
    }
}

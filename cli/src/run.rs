//! `touchoff run`: a tool along a path. Prints one row per pose, and a summary.

use crate::arguments::Run;
use crate::failure::Failure;
use crate::files::{Found, figure, length};
use crate::output::Output;
use crate::part::{self, Fine, Loaded, NO_INSIDE};
use crate::program;
use crate::timing::{Timing, nanoseconds};
use nalgebra::{Point3, Vector3};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Write;
use std::time::Instant;
use touchoff::certify::{Certifier, Penetration, TriangleBvh};
use touchoff::tool::ToolInfo;
use touchoff::{Contact, Part, Probe, Program, Unit, Wrench};

#[derive(Serialize)]
struct Row<'a> {
    pose: usize,
    line: usize,
    colliding: usize,
    depth: f64,
    /// Upper bound on the depth of the whole surface, if one is proved.
    depth_bound: Option<f64>,
    force: [f64; 3],
    torque: [f64; 3],
    niceness: Option<f64>,
    integral: f64,
    energy: f64,
    ns: u64,
    law: String,
    /// The greatest depth per surface in contact.
    surfaces: BTreeMap<&'a str, f64>,
    #[serde(flatten)]
    certified: Option<Certified<'a>>,
}

/// Proved results at a pose.
#[derive(Serialize)]
struct Certified<'a> {
    /// An interval that contains the depth of the part's triangles.
    deepest: [f64; 2],
    /// The deepest triangle, if one is inside the tool.
    triangle: Option<u32>,
    /// The tool's surface nearest to it there.
    surface: Option<&'a str>,
    /// True if the tool is wholly inside the material, which no triangle shows; null if that is unknown.
    inside: Option<bool>,
}

impl<'a> Certified<'a> {
    fn new(found: &Penetration, inside: Option<bool>, info: &'a ToolInfo) -> Certified<'a> {
        Certified {
            deepest: found.depth,
            triangle: found.witness.map(|witness| witness.triangle),
            surface: found.witness.map(|witness| &*info.surfaces[witness.surface].name),
            inside,
        }
    }

    /// Formats the proved depth for people, as one number if both bounds print alike.
    fn shown(&self, unit: Unit) -> String {
        if self.inside == Some(true) {
            return "wholly inside the material".to_owned();
        }
        let [low, high] = self.deepest.map(|depth| figure(depth, unit));
        let depth = if low == high { high } else { format!("{low} to {high}") };
        format!("{depth} {}", self.surface.unwrap_or_default())
    }
}

/// Runs a tool along a path.
pub(crate) fn run(wanted: &Run, json: bool) -> Result<(), Failure> {
    // Everything that can be wrong is found before the first row is written.
    let found = Found::find(&wanted.tool, &wanted.given)?;
    let tool = found.tool();
    let unit = wanted.part.unit;
    let program = program::read(&wanted.path, tool.info(), unit)?;
    let Loaded { part, mesh, prove } = part::load(&wanted.part, Some(tool.info()), Fine::Proof)?;
    let certify = [wanted.certify, prove].into_iter().flatten().reduce(f64::min);
    let bvh = match (certify, &mesh) {
        (Some(tolerance), Some(mesh)) => Some((TriangleBvh::new(mesh), tolerance)),
        (Some(_), None) => {
            let file = wanted.part.part.display().to_string();
            return Err(Failure::NoTriangles { file, what: "--certify" });
        }
        (None, _) => None,
    };
    let mut certifier = match &bvh {
        Some((bvh, tolerance)) => Some((Certifier::new(bvh, tool)?, *tolerance)),
        None => None,
    };
    about(wanted, &part, &program, tool.info());
    part::about(&part, Some(tool), unit);

    let mut out = Output::rows();
    if !json {
        let proved = if certifier.is_some() { "proved; " } else { "" };
        writeln!(out, "    line  points   depth ({unit})  {proved}by surface")?;
    }
    let mut probe = Probe::new(&part, tool)
        .with_law(wanted.law)
        .with_weights(wanted.weights)
        .with_centre(wanted.center.unwrap_or(Point3::origin()));
    let proved = part.tree().covering_radius().is_some_and(|cover| cover.proved);
    let unseen = probe.sampling_error_bound().filter(|_| proved);
    let mut summary = Summary::default();
    for (index, stop) in program.locations.iter().enumerate() {
        let start = Instant::now();
        let evaluation = probe.wrench(&stop.pose);
        let ns = nanoseconds(start.elapsed());
        let contacts = if evaluation.colliding > 0 { probe.contacts(&stop.pose) } else { &[] };
        let surfaces = by_surface(contacts, tool.info());
        summary.add(stop.line, &evaluation, &surfaces, ns);
        let certified = certifier.as_mut().map(|(certifier, tolerance)| {
            let start = Instant::now();
            let found = certifier.deepest(&stop.pose, *tolerance);
            let ns = nanoseconds(start.elapsed());
            let inside = match found.witness {
                Some(_) => Some(false),
                None => certifier.is_buried(&stop.pose),
            };
            summary.certify(stop.line, (&found, inside), ns);
            Certified::new(&found, inside, tool.info())
        });
        if json {
            let seen = unseen.map(|unseen| evaluation.depth() + unseen);
            let proved = certified.as_ref().map(|certified| certified.deepest[1]);
            let bound = [seen, proved].into_iter().flatten().reduce(f64::min);
            let row = row((index, stop.line), (&evaluation, bound), ns, surfaces, certified);
            serde_json::to_writer(&mut out, &row)?;
            writeln!(out)?;
        } else if evaluation.colliding > 0
            || certified.as_ref().is_some_and(|c| c.triangle.is_some() || c.inside == Some(true))
        {
            let proved = certified.map(|c| format!("{}; ", c.shown(unit)));
            let each: Vec<String> = surfaces
                .iter()
                .map(|(name, depth)| format!("{name} {}", figure(*depth, unit)))
                .collect();
            let depth = figure(evaluation.depth(), unit);
            let (line, points) = (stop.line, evaluation.colliding);
            let (proved, each) = (proved.unwrap_or_default(), each.join(", "));
            writeln!(out, "{line:>8} {points:>7} {depth:>12}  {proved}{each}")?;
        }
    }
    out.flush()?;
    summary.print(unit);
    if bvh.is_some_and(|(bvh, _)| !bvh.has_inside()) {
        say!("{NO_INSIDE}");
    }
    Ok(())
}

/// Prints a description of the input.
fn about(wanted: &Run, part: &Part, program: &Program, info: &ToolInfo) {
    program::passed_over(program);
    say!(
        "{} on {} points, {} poses; law {}, weights {}, lengths in {}",
        info.name,
        part.tree().len(),
        program.locations.len(),
        wanted.law,
        wanted.weights,
        wanted.part.unit,
    );
}

fn by_surface<'a>(contacts: &[Contact], info: &'a ToolInfo) -> BTreeMap<&'a str, f64> {
    let mut surfaces = BTreeMap::new();
    for contact in contacts {
        let deepest: &mut f64 = surfaces.entry(&*info.surfaces[contact.surface].name).or_default();
        *deepest = deepest.max(contact.depth);
    }
    surfaces
}

fn row<'a>(
    (pose, line): (usize, usize),
    (evaluation, depth_bound): (&Wrench, Option<f64>),
    ns: u64,
    surfaces: BTreeMap<&'a str, f64>,
    certified: Option<Certified<'a>>,
) -> Row<'a> {
    let parts = |v: Vector3<f64>| [v.x, v.y, v.z];
    Row {
        pose,
        line,
        colliding: evaluation.colliding,
        depth: evaluation.depth(),
        depth_bound,
        force: parts(evaluation.force),
        torque: parts(evaluation.torque),
        niceness: evaluation.niceness,
        integral: evaluation.integral,
        energy: evaluation.energy,
        ns,
        law: evaluation.law.to_string(),
        surfaces,
        certified,
    }
}

/// Summary of the whole path.
#[derive(Default)]
struct Summary {
    poses: usize,
    in_contact: usize,
    /// Depth and line of the deepest pose.
    deepest: Option<(f64, usize)>,
    /// Per surface: number of poses in contact, greatest depth and its line.
    surfaces: BTreeMap<String, (usize, f64, usize)>,
    times: Vec<u64>,
    proved: Option<Proved>,
}

/// Proved results along the path.
#[derive(Default)]
struct Proved {
    in_contact: usize,
    /// Number of poses at which the tool is wholly inside the material, and the line of the first.
    inside: (usize, usize),
    /// An interval that contains the greatest depth, and its line.
    deepest: ([f64; 2], usize),
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
        if self.deepest.is_none_or(|(depth, _)| evaluation.depth() > depth) {
            self.deepest = Some((evaluation.depth(), line));
        }
        for (name, depth) in surfaces {
            let entry = self.surfaces.entry((*name).to_owned()).or_insert((0, -1.0, line));
            entry.0 += 1;
            if *depth > entry.1 {
                (entry.1, entry.2) = (*depth, line);
            }
        }
    }

    fn certify(&mut self, line: usize, (found, inside): (&Penetration, Option<bool>), ns: u64) {
        let proved = self.proved.get_or_insert_default();
        proved.times.push(ns);
        proved.in_contact += usize::from(found.witness.is_some());
        if inside == Some(true) {
            let (count, first) = proved.inside;
            proved.inside = (count + 1, if count == 0 { line } else { first });
        }
        if found.depth[1] > proved.deepest.0[1] {
            proved.deepest = (found.depth, line);
        }
    }

    fn print(mut self, unit: Unit) {
        match self.deepest {
            Some((depth, line)) => say!(
                "{} of {} poses in contact, deepest {} at line {line}",
                self.in_contact,
                self.poses,
                length(depth, unit),
            ),
            None => say!("none of {} poses in contact", self.poses),
        }
        for (name, (poses, depth, line)) in &self.surfaces {
            say!("  {name:<12} {poses:>6} poses, deepest {} at line {line}", length(*depth, unit));
        }
        let timing = Timing::of(&mut self.times);
        say!(
            "time a query: {:.2} µs on average, {:.2} median, {:.2} p99, {:.2} at most",
            timing.avg / 1e3,
            timing.p50 as f64 / 1e3,
            timing.p99 as f64 / 1e3,
            timing.max as f64 / 1e3,
        );
        if let Some(mut proved) = self.proved {
            let timing = Timing::of(&mut proved.times);
            if let (count @ 1.., line) = proved.inside {
                say!(
                    "proved: wholly inside the material at {count} of {} poses, first at line {line}",
                    self.poses
                );
            }
            let ([low, high], line) = proved.deepest;
            say!(
                "proved: {} of {} poses in contact, deepest {} to {} at line {line}; {:.2} µs on average, \
                 {:.2} median, {:.2} p99, {:.2} at most",
                proved.in_contact,
                self.poses,
                figure(low, unit),
                length(high, unit),
                timing.avg / 1e3,
                timing.p50 as f64 / 1e3,
                timing.p99 as f64 / 1e3,
                timing.max as f64 / 1e3,
            );
        }
    }
}

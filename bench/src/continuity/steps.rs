//! The largest step of the force in a micrometre of motion along the scenes' paths.

use super::walk::{moved, pose};
use super::{Change, Walk};
use nalgebra::Vector3;
use touchoff::scenes::Path;
use touchoff::{Cloud, Law, Mesh, Part, Pose, Probe, Tool};

/// The length of a step, mm.
pub const STEP: f64 = 1e-3;
/// How far around a place of a first look every step is looked at, mm.
const REACH: f64 = 0.1;
/// Around how many places.
const PLACES: usize = 6;

/// A part whose points have their places in the cloud for triangles.
///
/// # Panics
/// If the count is none.
pub fn part(mesh: &Mesh, count: usize, seed: u64) -> Part {
    let cloud = Cloud::blue(mesh, count, seed).expect("a count that 32 bits hold");
    let ids = (0..cloud.len() as u32).collect();
    let lists = (cloud.points().to_vec(), cloud.normals().to_vec(), cloud.weights().to_vec());
    let cloud = Cloud::new(lists.0, lists.1, ids, lists.2, cloud.unit());
    Part::from_cloud(&cloud.expect("a cloud's own lists"))
}

/// A step of force and torque at a fraction of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Step {
    /// Where it begins.
    pub at: f64,
    /// Of the force.
    pub force: f64,
    /// Of the torque about the tip.
    pub torque: f64,
}

/// The largest steps of a tool along a path.
#[derive(Clone, Debug)]
pub struct Row {
    /// The tool.
    pub tool: String,
    /// The path.
    pub path: Path,
    /// The law.
    pub law: Law,
    /// How many steps were looked at.
    pub steps: usize,
    /// The one with the largest step of the force.
    pub force: Step,
    /// The one with the largest step of the torque.
    pub torque: Step,
    /// The largest force and torque of all.
    pub peaks: [f64; 2],
    /// What the largest step of the force is made of.
    pub change: Change,
    /// The median of the steps within a tenth of a millimetre of it.
    pub median: f64,
}

/// Looks at each step of a walk, with its felt force and torque before it.
fn steps(
    probe: &mut Probe<'_>,
    walk: impl Iterator<Item = (f64, Pose)>,
    mut see: impl FnMut(Step, [f64; 2]),
) {
    let mut last: Option<(f64, Pose, Vector3<f64>, Vector3<f64>)> = None;
    for (at, pose) in walk {
        let felt = probe.wrench(&pose);
        if let Some((from, before, force, torque)) = &last
            // Where a path begins anew.
            && moved(before, &pose) <= STEP
        {
            let (df, dt) = (felt.force - force, felt.torque - torque);
            let step = Step { at: *from, force: df.norm(), torque: dt.norm() };
            see(step, [force.norm(), torque.norm()]);
        }
        last = Some((at, pose, felt.force, felt.torque));
    }
}

/// Every step, or around the worst of so many stations each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Look {
    /// Every step of the path.
    All,
    /// One step at each of so many stations; then every step around the worst of them.
    Stations(usize),
}

/// The largest steps of a tool along a path.
pub fn row(part: &Part, tool: &dyn Tool, path: Path, law: Law, look: Look) -> Row {
    let mut probe = Probe::new(part, tool).law(law);
    let mut worst = [Step::default(); 2];
    let (mut count, mut peaks) = (0, [0.0; 2]);
    let mut see = |step: Step, [force, torque]: [f64; 2]| {
        count += 1;
        peaks = [f64::max(peaks[0], force), f64::max(peaks[1], torque)];
        if step.force > worst[0].force {
            worst[0] = step;
        }
        if step.torque > worst[1].torque {
            worst[1] = step;
        }
    };
    match look {
        Look::All => steps(&mut probe, Walk::new(path, 0.0, 1.0, STEP), &mut see),
        Look::Stations(stations) => {
            let mut first = Vec::new();
            for k in 0..stations {
                let walk = Walk::new(path, k as f64 / stations as f64, 1.0, STEP).take(2);
                steps(&mut probe, walk, |step, peaks| {
                    first.push(step);
                    see(step, peaks);
                });
            }
            for of in [|step: &Step| step.force, |step: &Step| step.torque] {
                first.sort_by(|a, b| of(b).total_cmp(&of(a)));
                for step in first.iter().take(PLACES) {
                    let walk = Walk::around(path, step.at, REACH, STEP);
                    steps(&mut probe, walk, &mut see);
                }
            }
        }
    }
    let [force, torque] = worst;
    let mut near = Vec::new();
    steps(&mut probe, Walk::around(path, force.at, REACH, STEP), |step, _| near.push(step.force));
    near.sort_by(f64::total_cmp);
    let median = near.get(near.len() / 2).copied().unwrap_or(0.0);
    let change = change(&mut probe, tool, path, law, force.at);
    let tool = tool.card().name.to_string();
    Row { tool, path, law, steps: count, force, torque, peaks, change, median }
}

/// What the step at a fraction of a path is made of.
fn change(probe: &mut Probe<'_>, tool: &dyn Tool, path: Path, law: Law, at: f64) -> Change {
    let contacts: Vec<_> = Walk::new(path, at, 1.0, STEP)
        .take(2)
        .map(|(_, pose)| probe.contacts(&pose).to_vec())
        .collect();
    match contacts.as_slice() {
        [before, after] => Change::between(before, after, law, tool.card()),
        _ => Change::default(),
    }
}

/// The force around a place, by how far the tool has gone, in µm.
pub fn around(part: &Part, tool: &dyn Tool, path: Path, law: Law, at: f64) -> Vec<[f64; 2]> {
    let mut probe = Probe::new(part, tool).law(law);
    let (mut gone, mut last) = (0.0, None);
    let walk = Walk::around(path, at, REACH, STEP / 2.0);
    let mut points = Vec::new();
    for (_, here) in walk {
        gone += last.map_or(0.0, |last| 1e3 * moved(&last, &here));
        last = Some(here);
        points.push([gone, probe.wrench(&here).force.norm()]);
    }
    let middle = pose(path, at);
    // Counted from the place.
    let first = Walk::around(path, at, REACH, STEP / 2.0).next();
    let before = first.map_or(0.0, |(_, start)| 1e3 * moved(&start, &middle));
    points.iter_mut().for_each(|point| point[0] -= before);
    points
}

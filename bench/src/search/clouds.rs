//! Depths of clouds beside what `Probe::error` and `Probe::depth_bound` allow.

use super::poses::{Numbers, numbers, pose, told};
use super::{Answer, Climb, Effort, Find, Question};
use crate::certified::brute::Brute;
use crate::certified::poses;
use nalgebra::{Point3, Vector3};
use touchoff::{Cloud, Mesh, Part, Pose, Probe, Tool, Unit};
use touchoff_tests::oracle::Nearest;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::draw::Draw;
use touchoff_tests::oracle::reference::{At, Reference};

/// Points of the cloud.
const POINTS: usize = 300;

/// A bumpy sheet that is as wide as the tool, moved away from the origin, in mm.
///
/// # Panics
/// If the tool has no size.
pub fn sheet(tool: &dyn Tool, away: f64) -> Mesh {
    let card = tool.card();
    let half = 1.2 * card.radius() * card.unit.to(Unit::Millimetre);
    let sheet = poses::bumpy(half.max(2.0), 6).expect("a positive width");
    let off = Vector3::new(away, -0.7 * away, 0.3 * away);
    let vertices = sheet.vertices().iter().map(|p| p + off).collect();
    Mesh::new(vertices, sheet.triangles().to_vec(), Unit::Millimetre).expect("the same sheet")
}

/// A cloud of a mesh whose points' triangles are their places in it.
///
/// # Panics
/// Never: what a cloud gives makes one.
pub fn numbered(mesh: &Mesh) -> Cloud {
    let cloud = Cloud::blue(mesh, POINTS, 5).expect("a count that 32 bits hold");
    let ids = (0..cloud.len() as u32).collect();
    let (points, normals) = (cloud.points().to_vec(), cloud.normals().to_vec());
    Cloud::new(points, normals, ids, cloud.weights().to_vec(), cloud.unit()).expect("its own lists")
}

/// The depth of a point of the world in a tool, to 256 bits but for one rounding in the tool's frame, in mm.
pub fn depth(reference: &Reference, pose: &Pose, point: &Point3<f64>, length: f64) -> f64 {
    let off: Vec<Big> =
        (0..3).map(|k| &Big::exactly(point[k]) - &Big::exactly(pose.tip()[k])).collect();
    let turn = pose.rotation();
    let at = [0, 1, 2].map(|axis| {
        let part = |k: usize| &Big::exactly(turn[(k, axis)]) * &off[k];
        let sum = &(&part(0) + &part(1)) + &part(2);
        (&sum / &Big::exactly(length)).to_f64()
    });
    reference.depth(&At::new(at)).to_f64() * length
}

/// How far felt depths are from those of the given points at most, by [`Probe::error`]; with a zero where nothing is felt.
pub fn error(
    probe: &mut Probe<'_>,
    cloud: &Cloud,
    reference: &Reference,
    pose: &Pose,
    length: f64,
) -> f64 {
    let allowed = probe.error().unwrap_or(0.0);
    // The reference's point is rounded in the tool's frame.
    let rounding = reference.scale() * f64::EPSILON / 2.0 * length;
    let contacts = probe.contacts(pose);
    // Of many contacts some.
    let stride = contacts.len().div_ceil(12).max(1);
    let felt = contacts.iter().step_by(stride).map(|contact| {
        let point = cloud.points()[contact.triangle as usize];
        let off = (contact.depth - depth(reference, pose, &point, length)).abs();
        (off - rounding) / allowed
    });
    felt.fold(0.0, f64::max)
}

/// The worst of both.
pub fn hunt(
    tool: &dyn Tool,
    (oracle, reference): (&Nearest, &Reference),
    effort: Effort,
    draw: &mut Draw,
) -> Vec<Answer> {
    let length = tool.card().unit.to(Unit::Millimetre);
    let mut errors = Answer {
        question: Question::CloudError,
        find: Find::default(),
        seeds: 0.0,
        bar: Some(1.0),
    };
    for away in [0.0, 1e3, 1e6] {
        let mesh = sheet(tool, away);
        let cloud = numbered(&mesh);
        let part = Part::from_cloud(&cloud);
        let mut probe = Probe::new(&part, tool);
        let value = |numbers: Numbers| {
            pose(numbers).map_or(0.0, |pose| error(&mut probe, &cloud, reference, &pose, length))
        };
        let at = format!("sheet at {away}");
        climbed(&mut errors, value, &at, (&mesh, oracle, length), effort.steps / 12, draw);
    }
    let mut bounds =
        Answer { question: Question::DepthBound, find: Find::default(), ..errors.clone() };
    bounds.seeds = 0.0;
    let mesh = sheet(tool, 0.0);
    let part = Part::from_mesh(&mesh, POINTS, 5).expect("a count that 32 bits hold");
    let mut probe = Probe::new(&part, tool);
    let brute = Brute::new(&mesh, oracle, length);
    let mut inner = draw.clone();
    let value = |numbers: Numbers| {
        let Some(pose) = pose(numbers) else { return 0.0 };
        let found = probe.deepest(&pose).map_or(0.0, |deepest| deepest.depth);
        let most = brute.deepest(&brute.seen(&pose), &mut inner, &mut 0);
        (most - found) / probe.unseen().unwrap_or(0.0)
    };
    climbed(&mut bounds, value, "sheet", (&mesh, oracle, length), effort.steps / 24, draw);
    vec![errors, bounds]
}

/// Climbs from the worst of some poses.
pub(super) fn climbed(
    answer: &mut Answer,
    mut value: impl FnMut(Numbers) -> f64,
    at: &str,
    (mesh, oracle, length): (&Mesh, &Nearest, f64),
    steps: usize,
    draw: &mut Draw,
) {
    let starts = (0..steps.max(8)).map(|_| {
        let start = numbers(&poses::pose(mesh, oracle, length, draw));
        (value(start), start)
    });
    let mut starts: Vec<(f64, Numbers)> = starts.collect();
    starts.sort_by(|a, b| b.0.total_cmp(&a.0));
    answer.seeds = answer.seeds.max(starts[0].0);
    for (_, start) in starts.iter().take(4) {
        let climb = Climb { steps: steps / 2, reach: 0.1 };
        let best = climb.from(*start, draw, &mut value);
        answer.find.see(best.value, || (format!("{at}, {}", told(best.place)), Vec::new()));
    }
}

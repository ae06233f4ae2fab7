//! Item 10: invalid or minimal input, which must give typed errors or meaningful results.

use super::ledger::{Item, Kind, Ledger, Row};
use super::scene::{PointSet, ProbeCheck};
use super::translated::pose;
use super::truth::Subject;
use nalgebra::{Point3, Vector3};
use touchoff::TriangleId;
use touchoff::{Cloud, Mesh, Part, Pose, Probe, Sampling, Unit};
use touchoff_tests::oracle::rng::Rng;

/// Rejected; the location is the message.
const REJECTED: Kind = Kind::informational("refused", "");
/// Invalid input that was accepted, or valid input that was rejected.
const WRONG_OUTCOME: Kind = Kind::forbidden_event("taken, or refused, wrongly");
const SENSELESS_RESULT: Kind = Kind::forbidden_event("no sense");

const MM: Unit = Unit::Millimetre;

/// Validates clouds of one point, of equal points and of points that are all inside, for one tool.
pub(super) fn small_clouds(subject: &Subject, poses: usize, rng: &mut Rng, ledger: &mut Ledger) {
    let single = PointSet::near_tool(subject, 1, 2f64.powi(-30), rng);
    let same = |count: usize| PointSet {
        points: vec![single.points[0]; count],
        normals: vec![single.normals[0]; count],
        weights: vec![0.5; count],
        unit: single.unit,
    };
    let interior = points_inside(subject, 40, rng);
    let (tool, truth) = (subject.tool, &*subject.truth);
    for point_set in [single.clone(), same(2), same(16), same(17), same(300), interior.clone()] {
        for k in 0..poses {
            let pose = if k == 0 { Pose::default() } else { pose(Point3::origin(), rng) };
            let placed = point_set.transformed(&pose, 2f64.powi(-30));
            let part = placed.part();
            ProbeCheck { tool, truth, point_set: &placed, part: &part }.check(&pose, ledger);
        }
    }
    let part = interior.part();
    let contacts = Probe::new(&part, tool).contacts(&Pose::default()).len();
    ledger.count(SENSELESS_RESULT, contacts != interior.points.len(), || {
        format!("{contacts} of all are felt")
    });
}

/// Returns points that are all inside, by at least a thousandth of the tool's radius.
fn points_inside(subject: &Subject, count: usize, rng: &mut Rng) -> PointSet {
    let mut point_set = PointSet::near_tool(subject, count, 2f64.powi(-30), rng);
    let [radius, height] = subject.oracle.extent();
    let mut attempts = 0;
    for p in &mut point_set.points {
        loop {
            let [x, y] = [0; 2].map(|_| rng.between(-radius, radius));
            let candidate = [x, y, rng.between(0.0, height)];
            attempts += 1;
            assert!(attempts < 1_000_000, "a tool has an inside");
            if subject.oracle.signed_distance(candidate) < -1e-3 * radius {
                *p = Point3::from(candidate);
                break;
            }
        }
    }
    point_set
}

/// Makes a cloud of three points after `change` has made one thing wrong.
fn cloud(change: impl Fn(&mut Lists)) -> Result<String, String> {
    let mut lists = Lists {
        points: vec![Point3::origin(); 3],
        normals: vec![Vector3::z(); 3],
        ids: [0, 1, 2].map(TriangleId).to_vec(),
        weights: vec![1.0; 3],
    };
    change(&mut lists);
    let Lists { points, normals, ids, weights } = lists;
    let cloud = Cloud::new(points, normals, ids, weights, MM).map_err(|e| e.to_string())?;
    Ok(format!("{} points", cloud.len()))
}

struct Lists {
    points: Vec<Point3<f64>>,
    normals: Vec<Vector3<f64>>,
    ids: Vec<TriangleId>,
    weights: Vec<f64>,
}

/// Makes a mesh of these corners and triangles, and samples points on it.
fn mesh(corners: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<String, String> {
    let corners = corners.iter().map(|p| Point3::from(*p)).collect();
    let mesh = Mesh::new(corners, triangles.to_vec(), MM).map_err(|e| e.to_string())?;
    let mut description = format!("{} triangles", mesh.triangles().len());
    for cloud in
        [Cloud::sample(&mesh, Sampling::monte_carlo(50)), Cloud::sample(&mesh, Sampling::new(50))]
    {
        let cloud = cloud.map_err(|e| e.to_string())?;
        let finite = cloud.points().iter().all(|p| p.iter().all(|c| c.is_finite()))
            && cloud.normals().iter().all(|n| (n.norm() - 1.0).abs() < 1e-12)
            && cloud.weights().iter().all(|w| w.is_finite() && *w >= 0.0);
        if !finite {
            return Ok("a cloud without sense".to_owned());
        }
        description += &format!(", {} points", cloud.len());
    }
    Ok(description)
}

fn pose_from_axis(tip: [f64; 3], axis: [f64; 3]) -> Result<String, String> {
    let pose = Pose::from_axis(Point3::from(tip), Vector3::from(axis));
    pose.map(|_| "a pose".to_owned()).map_err(|e| e.to_string())
}

fn pose_from_quaternion(quaternion: [f64; 4]) -> Result<String, String> {
    let pose = Pose::from_quaternion(Point3::origin(), quaternion);
    pose.map(|_| "a pose".to_owned()).map_err(|e| e.to_string())
}

/// The input, whether it must be rejected, and the result.
type Outcome = (&'static str, bool, Result<String, String>);

fn outcomes() -> Vec<Outcome> {
    let nan = f64::NAN;
    let infinite = f64::INFINITY;
    let tetrahedron = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let with_coordinate = |corner: usize, value: f64| {
        let mut corners = tetrahedron;
        corners[corner][1] = value;
        corners
    };
    let flat = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]];
    let with_face = |face: [u32; 3]| {
        let mut faces = faces.to_vec();
        faces.push(face);
        faces
    };
    vec![
        (
            "cloud: no point",
            true,
            cloud(|lists| {
                lists.points.clear();
                lists.normals.clear();
                lists.ids.clear();
                lists.weights.clear();
            }),
        ),
        ("cloud: a normal too few", true, cloud(|lists| lists.normals.truncate(2))),
        ("cloud: NaN", true, cloud(|lists| lists.points[1].y = nan)),
        ("cloud: infinite", true, cloud(|lists| lists.points[1].y = -infinite)),
        ("cloud: 1e61", true, cloud(|lists| lists.points[1].y = 1e61)),
        ("cloud: 1e60", false, cloud(|lists| lists.points[1].y = 1e60)),
        ("cloud: normal 0", true, cloud(|lists| lists.normals[2] = Vector3::zeros())),
        ("cloud: normal NaN", true, cloud(|lists| lists.normals[2].x = nan)),
        ("cloud: normal infinite", true, cloud(|lists| lists.normals[2].x = infinite)),
        ("cloud: normal of 1e-320", true, cloud(|lists| lists.normals[2] *= 1e-320)),
        ("cloud: weight NaN", true, cloud(|lists| lists.weights[0] = nan)),
        ("cloud: weight -1", true, cloud(|lists| lists.weights[0] = -1.0)),
        ("cloud: weight infinite", true, cloud(|lists| lists.weights[0] = infinite)),
        ("cloud: weights 0", false, cloud(|lists| lists.weights = vec![0.0; 3])),
        ("cloud: weight 1e308", false, cloud(|lists| lists.weights = vec![1e308; 3])),
        ("mesh: nothing", true, mesh(&[], &[])),
        ("mesh: no triangle", true, mesh(&tetrahedron, &[])),
        ("mesh: tetrahedron", false, mesh(&tetrahedron, &faces)),
        ("mesh: a triangle without area", false, mesh(&tetrahedron, &with_face([0, 1, 1]))),
        ("mesh: only triangles without area", true, mesh(&flat, &[[0, 1, 2], [1, 2, 3]])),
        ("mesh: no such vertex", true, mesh(&tetrahedron, &with_face([0, 1, 4]))),
        ("mesh: NaN", true, mesh(&with_coordinate(3, nan), &faces)),
        ("mesh: infinite", true, mesh(&with_coordinate(3, infinite), &faces)),
        ("mesh: a sliver of 1e-300", false, mesh(&with_coordinate(2, 1e-300), &faces)),
        ("pose: NaN", true, pose_from_axis([nan, 0.0, 0.0], [0.0, 0.0, 1.0])),
        ("pose: infinite", true, pose_from_axis([0.0, infinite, 0.0], [0.0, 0.0, 1.0])),
        ("pose: axis 0", true, pose_from_axis([0.0; 3], [0.0; 3])),
        ("pose: axis NaN", true, pose_from_axis([0.0; 3], [0.0, nan, 1.0])),
        ("pose: axis 2", true, pose_from_axis([0.0; 3], [0.0, 0.0, 2.0])),
        ("pose: quaternion 0", true, pose_from_quaternion([0.0; 4])),
        ("pose: quaternion NaN", true, pose_from_quaternion([0.0, 0.0, 0.0, nan])),
        ("pose: quaternion 1e-160", true, pose_from_quaternion([1e-160, 0.0, 0.0, 1e-160])),
    ]
}

/// Checks the input that does not depend on a tool.
pub(super) fn invalid_input(item: Item) -> Vec<Row> {
    let mut rows = Vec::new();
    for (name, must_fail, outcome) in outcomes() {
        let mut ledger = Ledger::new(item, name);
        match &outcome {
            Ok(message) => {
                ledger.count(WRONG_OUTCOME, must_fail, || message.clone());
                ledger
                    .count(SENSELESS_RESULT, message.contains("without sense"), || message.clone());
            }
            Err(message) => {
                ledger.count(WRONG_OUTCOME, !must_fail, || message.clone());
                ledger.record_info(REJECTED, 1, 0.0, message);
            }
        }
        rows.extend(ledger.rows());
    }
    rows.extend(huge_weights(item));
    rows
}

/// Tests weights near overflow: the sums must stay finite.
fn huge_weights(item: Item) -> Vec<Row> {
    let mut ledger = Ledger::new(item, "cloud: weight 1e300, felt");
    let points = vec![Point3::new(0.0, 0.0, 0.5); 20];
    let ids = (0..20).map(TriangleId).collect();
    let cloud = Cloud::new(points, vec![Vector3::z(); 20], ids, vec![1e300; 20], MM);
    let part = Part::from_cloud(&cloud.expect("finite weights"));
    let tool = tools_library::find("D2Ball").expect("a tool of the library");
    let wrench = Probe::new(&part, tool).wrench(&Pose::default());
    let finite = wrench.force.iter().chain(&wrench.torque).all(|c| c.is_finite());
    ledger.count(SENSELESS_RESULT, !finite, || format!("{wrench:?}"));
    ledger.rows()
}

//! A tool among several bodies.

use super::{Certifier, Clearance, MotionVerdict, Penetration, PoseVerdict, ToolPoint, Witness};
use crate::interval::Interval;
use crate::motion::Motion;
use crate::pose::Pose;
use crate::scene::SceneError;
use crate::unit::Unit;
use nalgebra::{Point3, Vector3};

/// A tool among several bodies, such as a part, a clamp and a table, each in a frame of its own. There is one answer for
/// all of them, with the name of the body that decides it.
///
/// Each body has a [`Certifier`] of the tool, with its own allowances. The pose of the tool relative to a body is computed
/// to some units in the last place of the coordinates, which the answers do not count.
///
/// ```
/// use nalgebra::{Isometry3, Point3, Vector3};
/// use touchoff::certify::{CertifiedScene, Certifier, TriangleBvh};
/// use touchoff::{Pose, Unit, mesh::shapes};
/// # touchoff::tool! {
/// #     tool Ball "6 mm ball" {
/// #         units mm;
/// #         profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; }
/// #         niceness cutting: 1;
/// #     }
/// # }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let cube = shapes::cuboid(Point3::origin(), Point3::new(20., 20., 20.), Unit::Millimetre)?;
/// let cube = TriangleBvh::new(&cube);
/// let mut scene = CertifiedScene::new(Unit::Millimetre);
/// scene.add_body("part", Certifier::new(&cube, &Ball)?, Pose::default())?;
/// scene.add_body("clamp", Certifier::new(&cube, &Ball)?, Isometry3::translation(40., 0., 0.).try_into()?)?;
///
/// let pose = Pose::from_axis(Point3::new(30.0, 10.0, 10.0), Vector3::x())?;
/// let nearest = scene.signed_distance(&pose, 1e-6).expect("a body");
/// assert!(nearest.body == "clamp" && nearest.answer.contains(4.0));
/// # Ok(()) }
/// ```
#[derive(Clone, Debug)]
pub struct CertifiedScene<'a> {
    unit: Unit,
    bodies: Vec<Body<'a>>,
}

#[derive(Clone, Debug)]
struct Body<'a> {
    name: String,
    frame: Pose,
    certifier: Certifier<'a>,
}

/// An answer about several bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BodyAnswer<'s, T> {
    /// The name of the body that decides it.
    pub body: &'s str,
    /// The answer.
    pub answer: T,
}

impl<'a> CertifiedScene<'a> {
    /// Creates a scene without bodies, whose poses and answers are in `unit`.
    pub fn new(unit: Unit) -> CertifiedScene<'a> {
        CertifiedScene { unit, bodies: Vec::new() }
    }

    /// Adds a body with the certifier of the tool there; `frame` is the pose of its frame in the world.
    ///
    /// # Errors
    /// Fails if the body's unit differs from the scene's.
    pub fn add_body(
        &mut self,
        name: impl Into<String>,
        certifier: Certifier<'a>,
        frame: Pose,
    ) -> Result<(), SceneError> {
        let part = certifier.setting.bvh.unit();
        if part != self.unit {
            return Err(SceneError { part, scene: self.unit });
        }
        self.bodies.push(Body { name: name.into(), frame, certifier });
        Ok(())
    }

    /// Moves the bodies of a name. Returns whether there is one.
    pub fn move_body(&mut self, name: &str, frame: Pose) -> bool {
        let mut known = false;
        for body in self.bodies.iter_mut().filter(|body| body.name == name) {
            body.frame = frame;
            known = true;
        }
        known
    }

    /// Asks each body; `ask` takes the body's frame, and converts the answer to the world.
    fn answers<'s, T>(
        &'s mut self,
        ask: impl Fn(&mut Certifier<'a>, &Pose) -> T,
    ) -> impl Iterator<Item = BodyAnswer<'s, T>> {
        self.bodies.iter_mut().map(move |Body { name, frame, certifier }| BodyAnswer {
            body: name,
            answer: ask(certifier, frame),
        })
    }

    /// Checks the tool at a pose as [`Certifier::check_pose`] does, and returns the gravest verdict: contact, inside the
    /// material, undecided, nearer than a margin, only the surface checked, and then clear. `None` without a body.
    pub fn check_pose(&mut self, pose: &Pose) -> Option<BodyAnswer<'_, PoseVerdict>> {
        let answers =
            self.answers(|certifier, frame| match certifier.check_pose(&pose.relative_to(frame)) {
                PoseVerdict::Touching(witness) => PoseVerdict::Touching(witness.in_world(frame)),
                PoseVerdict::Near(witness) => PoseVerdict::Near(witness.in_world(frame)),
                other => other,
            });
        answers.min_by_key(|answer| answer.answer.rank())
    }

    /// Checks the tool along a motion as [`Certifier::check_motion`] does, and returns the gravest verdict, in the order of
    /// [`CertifiedScene::check_pose`]. `None` without a body.
    pub fn check_motion(
        &mut self,
        motion: &Motion,
        tolerance: f64,
    ) -> Option<BodyAnswer<'_, MotionVerdict>> {
        let answers = self.answers(|certifier, frame| {
            match certifier.check_motion(&motion.relative_to(frame), tolerance) {
                MotionVerdict::Touching(at, witness) => {
                    MotionVerdict::Touching(at, witness.in_world(frame))
                }
                MotionVerdict::Near(at, witness) => {
                    MotionVerdict::Near(at, witness.in_world(frame))
                }
                other => other,
            }
        });
        answers.min_by_key(|answer| answer.answer.rank())
    }

    /// Computes the deepest penetration of any body into the tool, as [`Certifier::deepest`] does. `None` without a body.
    pub fn deepest(&mut self, pose: &Pose, tolerance: f64) -> Option<BodyAnswer<'_, Penetration>> {
        let answers = self.answers(|certifier, frame| {
            let found = certifier.deepest(&pose.relative_to(frame), tolerance);
            Penetration { witness: found.witness.map(|witness| witness.in_world(frame)), ..found }
        });
        answers.reduce(|one, other| {
            let [a, b] = [one.answer.depth, other.answer.depth];
            let mut deeper = if b.low > a.low { other } else { one };
            deeper.answer.depth = Interval::new(a.low.max(b.low), a.high.max(b.high));
            deeper
        })
    }

    /// Computes the distance of the nearest body, as [`Certifier::clearance`] does. `None` without a body.
    pub fn clearance(&mut self, pose: &Pose, tolerance: f64) -> Option<BodyAnswer<'_, Clearance>> {
        let answers = self.answers(|certifier, frame| {
            let found = certifier.clearance(&pose.relative_to(frame), tolerance);
            let on_tool = found.on_tool.map(|on_tool| ToolPoint {
                point: to_world(frame, on_tool.point),
                normal: frame.rotation() * on_tool.normal,
            });
            let witness = found.witness.map(|witness| witness.in_world(frame));
            Clearance { witness, on_tool, ..found }
        });
        answers.reduce(|one, other| {
            let [a, b] = [one.answer.distance, other.answer.distance];
            let mut nearer = if b.high < a.high { other } else { one };
            nearer.answer.distance = lesser(a, b);
            nearer
        })
    }

    /// Computes the least signed distance of all bodies, as [`Certifier::signed_distance`] does. `None` without a body.
    pub fn signed_distance(
        &mut self,
        pose: &Pose,
        tolerance: f64,
    ) -> Option<BodyAnswer<'_, Interval>> {
        let answers = self.answers(|certifier, frame| {
            certifier.signed_distance(&pose.relative_to(frame), tolerance)
        });
        answers.reduce(|one, other| {
            let answer = lesser(one.answer, other.answer);
            BodyAnswer { answer, ..if other.answer.high < one.answer.high { other } else { one } }
        })
    }
}

/// Returns the interval of the lesser of two numbers.
fn lesser(a: Interval, b: Interval) -> Interval {
    Interval::new(a.low.min(b.low), a.high.min(b.high))
}

impl Witness {
    fn in_world(self, frame: &Pose) -> Witness {
        Witness { point: to_world(frame, self.point), ..self }
    }
}

fn to_world(frame: &Pose, point: Point3<f64>) -> Point3<f64> {
    // The point keeps its bits at the origin, as the pose does that was taken relative to it.
    if *frame == Pose::default() {
        return point;
    }
    frame.tip() + frame.rotation() * Vector3::from(point.coords)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::TriangleBvh;
    use crate::mesh::{Mesh, shapes};
    use crate::tool::Interpreted;
    use nalgebra::{Isometry3, UnitQuaternion};
    use std::sync::LazyLock;

    static MILL: LazyLock<Interpreted> = LazyLock::new(|| {
        r#"tool Mill "a bull nose on a shank" {
            units mm;
            profile {
                start (0, 0);
                line to (3, 0) as face cutting;
                arc to (4, 1) center (3, 1) as corner cutting;
                line to (4, 12) as flute cutting;
                line to (3, 12), (3, 30), (0, 30) as shank;
            }
            niceness cutting: 1;
        }"#
        .parse()
        .expect("a tool")
    });

    const UNIT: Unit = Unit::Millimetre;

    /// The oracle moves the vertices instead of the frame, and asks each body for itself.
    #[test]
    fn frames_agree_with_moved_meshes() -> Result<(), Box<dyn std::error::Error>> {
        let meshes = [
            shapes::cuboid(Point3::new(-8., -6., -5.), Point3::new(8., 6., 5.), UNIT)?,
            shapes::sphere(7.0, 3, UNIT)?,
            shapes::tube(4.0, 9.0, 12.0, 24, 3, UNIT)?,
        ];
        let names = ["block", "sphere", "tube"];
        let frames = [0.0, 1.0, 2.0].map(|k| {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.3 * k, 0.7 - k, 0.2));
            Isometry3::from_parts(Vector3::new(20.0 * k - 20.0, 3.0 * k, -2.0 * k).into(), turn)
        });
        let trees = meshes.each_ref().map(TriangleBvh::new);
        let moved: Vec<TriangleBvh> = meshes
            .iter()
            .zip(&frames)
            .map(|(mesh, frame)| {
                let vertices = mesh.vertices().iter().map(|vertex| frame * vertex);
                Mesh::new(vertices, mesh.triangles().to_vec(), UNIT)
                    .map(|mesh| TriangleBvh::new(&mesh))
            })
            .collect::<Result<_, _>>()?;
        let mut scene = CertifiedScene::new(UNIT);
        for ((name, tree), frame) in names.iter().zip(&trees).zip(&frames) {
            scene.add_body(*name, Certifier::new(tree, &*MILL)?, Pose::default())?;
            assert!(scene.move_body(name, Pose::try_from(*frame)?));
        }
        assert!(!scene.move_body("table", Pose::default()));
        let mut others =
            moved.iter().map(|tree| Certifier::new(tree, &*MILL)).collect::<Result<Vec<_>, _>>()?;
        let (mut contacts, mut apart, mut clear) = (0, 0, 0);
        for k in 0..300 {
            let at = f64::from(k);
            let axis = Vector3::new((0.7 * at).sin(), (1.3 * at).cos(), 0.4 + at.sin()).normalize();
            let tip = Point3::new(
                30.0 * (0.37 * at).sin(),
                9.0 * (0.91 * at).cos(),
                8.0 * (0.53 * at).sin(),
            );
            let pose = Pose::from_axis(tip, axis)?;
            let best = others
                .iter_mut()
                .map(|other| other.signed_distance(&pose, 1e-9))
                .enumerate()
                .min_by(|(_, a), (_, b)| a.high.total_cmp(&b.high))
                .expect("three bodies");
            let found = scene.signed_distance(&pose, 1e-9).expect("three bodies");
            assert_eq!(found.body, names[best.0], "{k}");
            let slack = 1e-12;
            assert!(
                found.answer.low <= best.1.high + slack && best.1.low <= found.answer.high + slack
            );
            let is_contact = best.1.high < 0.0;
            let checked = scene.check_pose(&pose).expect("three bodies");
            match checked.answer {
                PoseVerdict::Clear => assert!(!is_contact),
                _ => assert!(is_contact),
            }
            if is_contact {
                contacts += 1;
                let deepest = scene.deepest(&pose, 1e-9).expect("three bodies");
                let witness = deepest.answer.witness.expect("a contact").point;
                assert!(deepest.body == names[best.0] || deepest.answer.depth.low > 0.0);
                assert!((witness - tip).norm() < 40.0);
            } else {
                apart += 1;
                let nearest = scene.clearance(&pose, 1e-9).expect("three bodies").answer;
                let [part, tool] = [
                    nearest.witness.expect("a point").point,
                    nearest.on_tool.expect("a point").point,
                ];
                // Both points are where they say: their distance is that of the bodies.
                assert!(((part - tool).norm() - nearest.distance.low).abs() < 1e-8, "{k}");
                let normal = nearest.on_tool.expect("a point").normal;
                assert!((normal - (part - tool).normalize()).norm() < 1e-6, "{k}");
            }
            let to = Pose::from_axis(tip + Vector3::new(2.0, -1.0, 3.0), axis)?;
            let motion = Motion::new(&pose, &to)?;
            let all_clear =
                others.iter_mut().all(|other| other.check_motion(&motion, 1e-6).is_clear());
            let checked = scene.check_motion(&motion, 1e-6).expect("three bodies");
            assert_eq!(checked.answer.is_clear(), all_clear, "{k}");
            clear += usize::from(all_clear);
        }
        println!("{contacts} contacts, {apart} apart, {clear} clear motions");
        assert!(contacts > 50 && apart > 50 && clear > 20);
        let inch = shapes::sphere(1.0, 2, Unit::Inch)?;
        let inch = TriangleBvh::new(&inch);
        let refused = scene.add_body("inch", Certifier::new(&inch, &*MILL)?, Pose::default());
        assert_eq!(refused, Err(SceneError { part: Unit::Inch, scene: UNIT }));
        assert_eq!(CertifiedScene::new(UNIT).check_pose(&Pose::default()), None);
        Ok(())
    }
}

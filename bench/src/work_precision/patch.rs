//! Patches of which everything is known: what touches them, where, and what it does.

use super::contact::{Contact, DEPTH};
use super::cutter::Cutter;
use super::truth::Truth;
use nalgebra::{Point3, Rotation3, Vector3};
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::sync::OnceLock;
use touchoff::mesh::shapes;
use touchoff::{Cloud, Mesh, Pose, Unit};
use touchoff_tests::oracle::draw::Draw;
use touchoff_tests::oracle::{Oracle, fig_7_3_exact};

/// A patch and its tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Patch {
    /// A contact in closed form: CF1 to CF5.
    Contact(Contact),
    /// CF8: a plane through the axis of `Fig73Exact`, larger than its section.
    Section,
    /// CF9: a square in a plane, wholly where depth is affine.
    Affine,
}

/// Half of the square that holds the section, and how far the section's middle goes from its middle.
const SHEET: f64 = 24.0;
const ROAM: f64 = 12.0;
/// Of the tool of fig. 7.3, its length, its largest radius, and the area of the half of its section.
const LENGTH: u32 = 20;
const WIDE: u32 = 5;
const HALF_SECTION: f64 = 69.785_398_163_397_45;
/// The deepest of the section: the housing's radius.
const DEEPEST: f64 = 5.0;

/// Half of the square in the housing's end: three times a power of two, so that centroids of its triangles
/// are numbers of few bits.
const SQUARE: f64 = 0.75;
/// How deep its middle is, how far from the axis at most, and how tilted.
const UNDER: f64 = 2.0;
const ASIDE: f64 = 0.5;
const TILT: f64 = 0.4;

const UNIT: Unit = Unit::Millimetre;

impl Patch {
    /// All of them.
    pub(super) const ALL: [Patch; 7] = [
        Patch::Contact(Contact::BallInPlane),
        Patch::Contact(Contact::SideInPlane),
        Patch::Contact(Contact::BallOnBall),
        Patch::Contact(Contact::BallInCavity),
        Patch::Contact(Contact::SideInBore),
        Patch::Section,
        Patch::Affine,
    ];

    /// Its number among the closed forms.
    pub(super) fn name(self) -> &'static str {
        match self {
            Patch::Contact(contact) => contact.name(),
            Patch::Section => "CF8",
            Patch::Affine => "CF9",
        }
    }

    /// What touches what.
    pub(super) fn about(self) -> String {
        match self {
            Patch::Contact(contact) => format!("{}; {DEPTH} deep", contact.about()),
            Patch::Section => {
                "a plane through the axis of `Fig73Exact`, so that the whole section is inside; force and torque by \
                 quadrature of the oracle"
                    .to_owned()
            }
            Patch::Affine => {
                "a square wholly in the end of `Fig73Exact`'s housing, where depth is the distance from its back: force is \
                 exact for centroids of triangles with their areas"
                    .to_owned()
            }
        }
    }

    /// Its tool.
    pub(super) fn cutter(self) -> Cutter<'static> {
        match self {
            Patch::Contact(contact) if contact.is_of_a_sphere() => Cutter::UNIT_SPHERE,
            _ => Cutter::FIG_73_EXACT,
        }
    }

    /// Whether the thesis's magnitudes, which are all that the peers know, are true depths here: on ball and
    /// flute they are.
    pub(super) fn is_of_ball_or_flute(self) -> bool {
        matches!(self, Patch::Contact(contact) if !contact.is_of_a_sphere())
    }

    /// Whether its triangles are the true surface.
    pub(super) fn is_flat(self) -> bool {
        match self {
            Patch::Contact(contact) => contact.is_flat(),
            Patch::Section | Patch::Affine => true,
        }
    }

    /// The patch that clouds are drawn on.
    ///
    /// # Panics
    /// Never: the patches are sound.
    pub(super) fn mesh(self) -> Mesh {
        match self {
            Patch::Contact(contact) => contact.mesh(),
            Patch::Section => shapes::plane(SHEET, 1, UNIT).expect("a sound square"),
            Patch::Affine => squares(1),
        }
    }

    /// By how much the patch is larger than what of it is inside the tool.
    pub(super) fn times(self) -> f64 {
        let inside = match self {
            Patch::Contact(contact) => contact.area(),
            Patch::Section => 2.0 * HALF_SECTION,
            Patch::Affine => 4.0 * SQUARE * SQUARE,
        };
        self.mesh().survey().area / inside
    }

    /// A cloud of the patch, carried to the true surface.
    pub(super) fn exact(self, cloud: Cloud) -> Cloud {
        match self {
            Patch::Contact(contact) => contact.exact(cloud),
            Patch::Section | Patch::Affine => cloud,
        }
    }

    /// About so many centroids of triangles, where they make force exact.
    pub(super) fn centroids(self, count: usize) -> Option<Cloud> {
        let divisions = ((count as f64 / 2.0).sqrt().log2().round() as u32).max(1);
        (self == Patch::Affine).then(|| Cloud::centroids(&squares(1 << divisions)))
    }

    /// To what share of what is typical force, torque and depth are known.
    pub(super) fn known(self) -> [f64; 3] {
        const ROUNDING: f64 = 1e-15;
        match self {
            Patch::Section => [section().1, section().1, ROUNDING],
            _ => [ROUNDING; 3],
        }
    }

    /// A pose of the tool, anywhere on the patch, and what it feels there.
    ///
    /// # Panics
    /// Never: poses are finite.
    pub(super) fn place(self, draw: &mut Draw) -> (Pose, Truth) {
        match self {
            Patch::Contact(contact) => {
                let placed = contact.place(draw);
                let truth = Truth { force: placed.force, torque: placed.torque, depth: DEPTH };
                (placed.pose, truth)
            }
            Patch::Section => through_the_axis(draw),
            Patch::Affine => in_the_end(draw),
        }
    }
}

fn squares(divisions: u32) -> Mesh {
    shapes::plane(SQUARE, divisions, UNIT).expect("a sound square")
}

/// Integrals over half of the section: of magnitude, of its part along the axis, of the moment of the
/// magnitude along the axis.
struct Half {
    integral: f64,
    along: f64,
    moment: f64,
}

/// By the middles of squares, so many to the millimetre: corners of the profile are corners of squares.
fn half_section(fine: u32) -> Half {
    let tool = fig_7_3_exact();
    let step = 1.0 / f64::from(fine);
    let at = |k: u32| step * (f64::from(k) + 0.5);
    let row = |k: u32| {
        let mut sums = [0.0; 3];
        for z in (0..fine * LENGTH).map(at) {
            if let Some(felt) = tool.sense([at(k), 0.0, z]) {
                let m = felt.magnitude;
                let parts = [m, m * felt.direction[2], m * z];
                sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
            }
        }
        sums
    };
    let rows: Vec<[f64; 3]> = (0..fine * WIDE).into_par_iter().map(row).collect();
    let [integral, along, moment] =
        [0, 1, 2].map(|k: usize| step * step * rows.iter().map(|row| row[k]).sum::<f64>());
    Half { integral, along, moment }
}

/// The integrals, and to what share they are known: what halving the spacing changed.
fn section() -> &'static (Half, f64) {
    const FINE: u32 = 100;
    static SECTION: OnceLock<(Half, f64)> = OnceLock::new();
    SECTION.get_or_init(|| {
        let [coarse, fine] = [FINE, 2 * FINE].map(half_section);
        let off = |a: f64, b: f64| (a - b).abs();
        let change = [
            off(coarse.integral, fine.integral) / fine.integral,
            off(coarse.along, fine.along) / fine.integral,
            off(coarse.moment, fine.moment) / fine.moment,
        ];
        (fine, change.into_iter().fold(0.0, f64::max))
    })
}

fn through_the_axis(draw: &mut Draw) -> (Pose, Truth) {
    let (half, _) = section();
    let (sin, cos) = draw.between(0.0, TAU).sin_cos();
    let axis = Vector3::new(cos, sin, 0.0);
    let [x, y] = [0; 2].map(|_| draw.between(-ROAM, ROAM));
    let tip = Point3::new(x, y, 0.0) - f64::from(LENGTH) / 2.0 * axis;
    let normal = Vector3::z();
    // What points away from the axis is the same on both sides of it.
    let force = 2.0 * (half.integral * normal - half.along * axis);
    let torque = 2.0 * half.moment * axis.cross(&normal);
    let pose = Pose::from_axis(tip, axis).expect("a finite pose");
    (pose, Truth { force, torque, depth: DEEPEST })
}

fn in_the_end(draw: &mut Draw) -> (Pose, Truth) {
    let normal = Vector3::z();
    // The part is under the square, the tool comes from there.
    let across = normal.cross(&Vector3::from(draw.direction())).normalize();
    let axis = Rotation3::new(across * draw.between(0.0, TILT)) * -normal;
    let aside = axis.cross(&Vector3::from(draw.direction())).normalize();
    let tip = Point3::from(aside * draw.between(0.0, ASIDE) - axis * (f64::from(LENGTH) - UNDER));
    let pose = Pose::from_axis(tip, axis).expect("a finite pose");
    // Depth is UNDER - axis · x at a place x of the square.
    let area = 4.0 * SQUARE * SQUARE;
    let push = normal - axis;
    let slope = Vector3::new(-axis.x, -axis.y, 0.0);
    let moment = area * (UNDER * -tip.coords + SQUARE * SQUARE / 3.0 * slope);
    let truth = Truth {
        force: area * UNDER * push,
        torque: moment.cross(&push),
        depth: UNDER + SQUARE * (slope.x.abs() + slope.y.abs()),
    };
    (pose, truth)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_section_is_the_printed_one() {
        let (half, known) = section();
        assert!((half.integral / 117.863_898_104_678_9 - 1.0).abs() < 1e-6, "{}", half.integral);
        assert!(*known < 2e-5, "{known}");
    }

    /// Only what is felt of the whole square, however it was drawn: the oracle at a fine grid says the same.
    #[test]
    fn the_square_is_wholly_in_the_end() {
        let tool = fig_7_3_exact();
        let mut draw = Draw::new(1);
        for _ in 0..20 {
            let (pose, truth) = in_the_end(&mut draw);
            let n = 40;
            let (mut force, mut torque, mut deepest) = (Vector3::zeros(), Vector3::zeros(), 0.0f64);
            let step = 2.0 * SQUARE / f64::from(n);
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let at = |k: i32| step * (f64::from(k) + 0.5) - SQUARE;
                let arm = Point3::new(at(i), at(j), 0.0) - pose.tip();
                let felt = tool.sense(pose.rotation().tr_mul(&arm).into()).expect("inside");
                let toward = pose.rotation() * Vector3::from(felt.direction);
                let push = step * step * felt.magnitude * (Vector3::z() - toward);
                force += push;
                torque += arm.cross(&push);
                deepest = deepest.max(felt.depth);
            }
            assert!((force - truth.force).norm() < 1e-9 * force.norm(), "{force} {}", truth.force);
            assert!((torque - truth.torque).norm() < 1e-3 * torque.norm());
            assert!(deepest <= truth.depth && truth.depth < deepest + step);
        }
    }
}

//! Patches with known solutions: the tool, its pose, and the exact force, torque and depth.

use super::contact::{Contact, DEPTH};
use super::cutter::Cutter;
use super::truth::Truth;
use nalgebra::{Point3, Rotation3, Vector3};
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::sync::OnceLock;
use touchoff::mesh::shapes;
use touchoff::{Cloud, Mesh, Pose, Unit};
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::{Oracle, fig_7_3_exact};

/// A patch and its tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Patch {
    /// A contact in closed form: CF1 to CF5.
    Contact(Contact),
    /// CF8: a plane through the axis of `Fig73Exact`, larger than its section.
    Section,
    /// CF9: a square that lies entirely where depth is affine.
    Affine,
}

/// Half the side of the square that contains the section, and the largest offset of the section's centre per
/// coordinate, mm.
const HALF_SHEET: f64 = 24.0;
const MAX_CENTRE_OFFSET: f64 = 12.0;
/// Length and largest radius of the tool of fig. 7.3, mm, and the area of half of its section, mm².
const TOOL_LENGTH: u32 = 20;
const MAX_RADIUS: u32 = 5;
const HALF_SECTION: f64 = 69.785_398_163_397_45;
/// The greatest depth in the section, mm: the housing's radius.
const MAX_DEPTH: f64 = 5.0;

/// Half the side of the square in the housing's end, mm. It is three times a power of two, so that the centroids of its
/// triangles are numbers with few bits.
const HALF_SQUARE: f64 = 0.75;
/// Depth of the square's centre, mm; its largest distance from the axis, mm; the largest tilt, rad.
const CENTRE_DEPTH: f64 = 2.0;
const MAX_AXIS_DISTANCE: f64 = 0.5;
const MAX_TILT: f64 = 0.4;

const UNIT: Unit = Unit::Millimetre;

impl Patch {
    /// All patches.
    pub(super) const ALL: [Patch; 7] = [
        Patch::Contact(Contact::BallInPlane),
        Patch::Contact(Contact::SideInPlane),
        Patch::Contact(Contact::BallOnBall),
        Patch::Contact(Contact::BallInCavity),
        Patch::Contact(Contact::SideInBore),
        Patch::Section,
        Patch::Affine,
    ];

    /// Returns its name among the closed forms.
    pub(super) fn name(self) -> &'static str {
        match self {
            Patch::Contact(contact) => contact.name(),
            Patch::Section => "CF8",
            Patch::Affine => "CF9",
        }
    }

    /// Returns a description of the tool and the patch.
    pub(super) fn description(self) -> String {
        match self {
            Patch::Contact(contact) => format!("{}; {DEPTH} deep", contact.description()),
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

    /// Returns the tool.
    pub(super) fn cutter(self) -> Cutter<'static> {
        match self {
            Patch::Contact(contact) if contact.is_sphere_cap() => Cutter::UNIT_SPHERE,
            _ => Cutter::FIG_73_EXACT,
        }
    }

    /// Returns whether the thesis's magnitudes, the only ones that the peers know, are true depths here. They are on
    /// the ball and the flute.
    pub(super) fn touches_ball_or_flute(self) -> bool {
        matches!(self, Patch::Contact(contact) if !contact.is_sphere_cap())
    }

    /// Returns whether the patch's triangles are the true surface.
    pub(super) fn is_flat(self) -> bool {
        match self {
            Patch::Contact(contact) => contact.is_flat(),
            Patch::Section | Patch::Affine => true,
        }
    }

    /// Returns the patch on which clouds are sampled.
    ///
    /// # Panics
    /// Never: the patches are valid meshes.
    pub(super) fn mesh(self) -> Mesh {
        match self {
            Patch::Contact(contact) => contact.mesh(),
            Patch::Section => shapes::plane(HALF_SHEET, 1, UNIT).expect("a sound square"),
            Patch::Affine => square_mesh(1),
        }
    }

    /// Returns the ratio of the patch's area to the area inside the tool.
    pub(super) fn area_ratio(self) -> f64 {
        let inside = match self {
            Patch::Contact(contact) => contact.area(),
            Patch::Section => 2.0 * HALF_SECTION,
            Patch::Affine => 4.0 * HALF_SQUARE * HALF_SQUARE,
        };
        self.mesh().diagnostics().area / inside
    }

    /// Projects a cloud of the patch to the true surface.
    pub(super) fn exact(self, cloud: Cloud) -> Cloud {
        match self {
            Patch::Contact(contact) => contact.exact(cloud),
            Patch::Section | Patch::Affine => cloud,
        }
    }

    /// Returns about `count` centroids of triangles, for the patch where they make the force exact.
    pub(super) fn centroids(self, count: usize) -> Option<Cloud> {
        let divisions = ((count as f64 / 2.0).sqrt().log2().round() as u32).max(1);
        (self == Patch::Affine).then(|| Cloud::centroids(&square_mesh(1 << divisions)))
    }

    /// Returns the relative accuracy of the true force, torque and depth, as shares of the typical values.
    pub(super) fn accuracy(self) -> [f64; 3] {
        const ROUNDING: f64 = 1e-15;
        match self {
            Patch::Section => [section_integrals().1, section_integrals().1, ROUNDING],
            _ => [ROUNDING; 3],
        }
    }

    /// Returns a random pose of the tool on the patch, and the true values there.
    ///
    /// # Panics
    /// Never: the poses are finite.
    pub(super) fn random_placement(self, rng: &mut Rng) -> (Pose, Truth) {
        match self {
            Patch::Contact(contact) => {
                let placed = contact.random_placement(rng);
                let truth = Truth { force: placed.force, torque: placed.torque, depth: DEPTH };
                (placed.pose, truth)
            }
            Patch::Section => pose_through_axis(rng),
            Patch::Affine => pose_in_housing_end(rng),
        }
    }
}

fn square_mesh(divisions: u32) -> Mesh {
    shapes::plane(HALF_SQUARE, divisions, UNIT).expect("a sound square")
}

/// Integrals over half of the section: of the magnitude, of the axial component of the magnitude times the direction,
/// and of the moment of the magnitude along the axis.
struct SectionIntegrals {
    integral: f64,
    along: f64,
    moment: f64,
}

/// Integrates by the midpoint rule, with `squares_per_mm` squares per millimetre. Corners of the profile are corners
/// of squares.
fn integrate_half_section(squares_per_mm: u32) -> SectionIntegrals {
    let tool = fig_7_3_exact();
    let step = 1.0 / f64::from(squares_per_mm);
    let midpoint = |k: u32| step * (f64::from(k) + 0.5);
    let row = |k: u32| {
        let mut sums = [0.0; 3];
        for z in (0..squares_per_mm * TOOL_LENGTH).map(midpoint) {
            if let Some(evaluation) = tool.evaluate([midpoint(k), 0.0, z]) {
                let m = evaluation.magnitude;
                let parts = [m, m * evaluation.direction[2], m * z];
                sums.iter_mut().zip(parts).for_each(|(sum, term)| *sum += term);
            }
        }
        sums
    };
    let rows: Vec<[f64; 3]> = (0..squares_per_mm * MAX_RADIUS).into_par_iter().map(row).collect();
    let [integral, along, moment] =
        [0, 1, 2].map(|k: usize| step * step * rows.iter().map(|row| row[k]).sum::<f64>());
    SectionIntegrals { integral, along, moment }
}

/// Returns the integrals and their relative accuracy, which is the change when the spacing was halved.
fn section_integrals() -> &'static (SectionIntegrals, f64) {
    const SQUARES_PER_MM: u32 = 100;
    static SECTION: OnceLock<(SectionIntegrals, f64)> = OnceLock::new();
    SECTION.get_or_init(|| {
        let [coarse, fine] = [SQUARES_PER_MM, 2 * SQUARES_PER_MM].map(integrate_half_section);
        let difference = |a: f64, b: f64| (a - b).abs();
        let change = [
            difference(coarse.integral, fine.integral) / fine.integral,
            difference(coarse.along, fine.along) / fine.integral,
            difference(coarse.moment, fine.moment) / fine.moment,
        ];
        (fine, change.into_iter().fold(0.0, f64::max))
    })
}

fn pose_through_axis(rng: &mut Rng) -> (Pose, Truth) {
    let (integrals, _) = section_integrals();
    let (sin, cos) = rng.between(0.0, TAU).sin_cos();
    let axis = Vector3::new(cos, sin, 0.0);
    let [x, y] = [0; 2].map(|_| rng.between(-MAX_CENTRE_OFFSET, MAX_CENTRE_OFFSET));
    let tip = Point3::new(x, y, 0.0) - f64::from(TOOL_LENGTH) / 2.0 * axis;
    let normal = Vector3::z();
    // Radial components on the two sides of the axis cancel; normal and axial ones are equal and add up.
    let force = 2.0 * (integrals.integral * normal - integrals.along * axis);
    let torque = 2.0 * integrals.moment * axis.cross(&normal);
    let pose = Pose::from_axis(tip, axis).expect("a finite pose");
    (pose, Truth { force, torque, depth: MAX_DEPTH })
}

fn pose_in_housing_end(rng: &mut Rng) -> (Pose, Truth) {
    let normal = Vector3::z();
    // The part is below the square, and the tool comes from there.
    let tilt_axis = normal.cross(&Vector3::from(rng.direction())).normalize();
    let axis = Rotation3::new(tilt_axis * rng.between(0.0, MAX_TILT)) * -normal;
    let offset_direction = axis.cross(&Vector3::from(rng.direction())).normalize();
    let tip = Point3::from(
        offset_direction * rng.between(0.0, MAX_AXIS_DISTANCE)
            - axis * (f64::from(TOOL_LENGTH) - CENTRE_DEPTH),
    );
    let pose = Pose::from_axis(tip, axis).expect("a finite pose");
    // The depth at a point x of the square is UNDER - axis · x.
    let area = 4.0 * HALF_SQUARE * HALF_SQUARE;
    let force_direction = normal - axis;
    let slope = Vector3::new(-axis.x, -axis.y, 0.0);
    let moment = area * (CENTRE_DEPTH * -tip.coords + HALF_SQUARE * HALF_SQUARE / 3.0 * slope);
    let truth = Truth {
        force: area * CENTRE_DEPTH * force_direction,
        torque: moment.cross(&force_direction),
        depth: CENTRE_DEPTH + HALF_SQUARE * (slope.x.abs() + slope.y.abs()),
    };
    (pose, truth)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_of_the_section_are_the_printed_ones() {
        let (integrals, accuracy) = section_integrals();
        assert!(
            (integrals.integral / 117.863_898_104_678_9 - 1.0).abs() < 1e-6,
            "{}",
            integrals.integral
        );
        assert!(*accuracy < 2e-5, "{accuracy}");
    }

    /// Compares with the oracle on a fine grid: the square is entirely inside, and the sums agree for random poses.
    #[test]
    fn the_square_is_wholly_in_the_housing_end() {
        let tool = fig_7_3_exact();
        let mut rng = Rng::new(1);
        for _ in 0..20 {
            let (pose, truth) = pose_in_housing_end(&mut rng);
            let n = 40;
            let (mut force, mut torque, mut deepest) = (Vector3::zeros(), Vector3::zeros(), 0.0f64);
            let step = 2.0 * HALF_SQUARE / f64::from(n);
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let coordinate = |k: i32| step * (f64::from(k) + 0.5) - HALF_SQUARE;
                let arm = Point3::new(coordinate(i), coordinate(j), 0.0) - pose.tip();
                let evaluation =
                    tool.evaluate(pose.rotation().tr_mul(&arm).into()).expect("inside");
                let direction = pose.rotation() * Vector3::from(evaluation.direction);
                let force_part = step * step * evaluation.magnitude * (Vector3::z() - direction);
                force += force_part;
                torque += arm.cross(&force_part);
                deepest = deepest.max(evaluation.depth);
            }
            assert!((force - truth.force).norm() < 1e-9 * force.norm(), "{force} {}", truth.force);
            assert!((torque - truth.torque).norm() < 1e-3 * torque.norm());
            assert!(deepest <= truth.depth && truth.depth < deepest + step);
        }
    }
}

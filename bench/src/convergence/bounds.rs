//! What the covering radius ε promises of a ball of radius r = 1: nothing is deeper than what is found
//! and ε more, so nothing deeper than ε is missed; on a plane nothing deeper than `r - √(r² - ε²)`.

use super::{Pattern, radius};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;
use touchoff::mesh::shapes;
use touchoff::{Cloud, Mesh, Part, Pose, Probe, Unit};
use touchoff_tests::oracle::draw::Draw;

/// Points to the square of the unit.
pub const DENSITY: f64 = 13.0;
/// Half of the plane, and the box.
const HALF: f64 = 20.0;
const BOX: [f64; 3] = [6.0, 8.0, 10.0];
const UNIT: Unit = Unit::Millimetre;

/// Where the ball is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Above a plane.
    Plane,
    /// About a box: at its sides, edges and corners, each as often.
    Outside,
    /// In a hollow of the shape of that box, alike.
    Hollow,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Row {
    /// Where the ball was.
    pub place: Place,
    /// What it touched.
    pub pattern: Pattern,
    /// The largest covering radius of the clouds.
    pub radius: f64,
    /// How often each was tried.
    pub placements: usize,
    /// How often a ball deeper than `r - √(r² - ε²)` was missed: never on a plane.
    pub beyond_flat: usize,
    /// How often a ball deeper than ε was missed: never.
    pub beyond: usize,
    /// How often what was found and ε more was less than the depth: never.
    pub too_deep: usize,
    /// The most by which the depth was more than what was found, by ε, and the mean.
    pub most: f64,
    /// See `most`.
    pub mean: f64,
}

impl Place {
    /// All of them.
    pub const ALL: [Place; 3] = [Place::Plane, Place::Outside, Place::Hollow];

    /// The words for it.
    pub fn name(self) -> &'static str {
        match self {
            Place::Plane => "a plane",
            Place::Outside => "about a box",
            Place::Hollow => "in a hollow",
        }
    }

    fn mesh(self) -> Mesh {
        match self {
            Place::Plane => shapes::plane(HALF, 1, UNIT).expect("a plane"),
            _ => shapes::cuboid(Point3::origin(), Point3::from(BOX), UNIT).expect("a box"),
        }
    }

    /// A middle of the ball from which the surface is so far, and no nearer.
    fn middle(self, far: f64, draw: &mut Draw) -> Point3<f64> {
        if self == Place::Plane {
            let [x, y] = [0; 2].map(|_| draw.between(-HALF, HALF));
            return Point3::new(x, y, far);
        }
        // The directions in which the nearest place is at an end of the box, and which end.
        let first = (draw.bits() % 3) as usize;
        let ends = 1 + (draw.bits() % 3) as usize;
        let along = match ends {
            1 => [1.0, 0.0, 0.0],
            2 => {
                let (sin, cos) = draw.between(0.0, FRAC_PI_2).sin_cos();
                [cos, sin, 0.0]
            }
            _ => draw.direction().map(f64::abs),
        };
        let mut middle = Point3::origin();
        for (k, along) in along.into_iter().enumerate() {
            let axis = (first + k) % 3;
            let high = draw.bits().is_multiple_of(2);
            let from_end = match self {
                // Beside an edge of the hollow both sides are as near.
                Place::Hollow if k < ends => -far,
                Place::Hollow => -draw.between(1.0, BOX[axis] - 1.0),
                _ if k < ends => far * along,
                _ => -draw.between(0.0, BOX[axis]),
            };
            middle[axis] = if high { BOX[axis] + from_end } else { -from_end };
        }
        middle
    }
}

/// Counts of one cloud.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    radius: f64,
    beyond_flat: usize,
    beyond: usize,
    too_deep: usize,
    most: f64,
    sum: f64,
}

/// So many placements on each of so many clouds.
pub fn row(place: Place, pattern: Pattern, clouds: usize, placements: usize, seed: u64) -> Row {
    let mesh = place.mesh();
    let points = (DENSITY * mesh.survey().area).round() as usize;
    let one = |k: usize| {
        let seed = seed.wrapping_mul(1 << 20) + k as u64;
        look(place, &pattern.cloud(&mesh, points, seed), placements, &mut Draw::new(!seed))
    };
    let seen: Vec<Seen> = (0..clouds).into_par_iter().map(one).collect();
    let count = |of: fn(&Seen) -> usize| seen.iter().map(of).sum();
    let most = |of: fn(&Seen) -> f64| seen.iter().map(of).fold(0.0, f64::max);
    let all = clouds * placements;
    Row {
        place,
        pattern,
        radius: most(|seen| seen.radius),
        placements: all,
        beyond_flat: count(|seen| seen.beyond_flat),
        beyond: count(|seen| seen.beyond),
        too_deep: count(|seen| seen.too_deep),
        most: most(|seen| seen.most),
        mean: seen.iter().map(|seen| seen.sum).sum::<f64>() / all as f64,
    }
}

fn look(place: Place, cloud: &Cloud, placements: usize, draw: &mut Draw) -> Seen {
    let radius = radius(cloud);
    let part = Part::from_cloud(cloud);
    let ball = tools_library::find("UnitSphere").expect("a tool of the library");
    let mut probe = Probe::new(&part, ball);
    // What single precision takes away from a depth.
    let rounding = probe.error().expect("the ball's depth is as steep as is proved") + 1e-12;
    let mut seen = Seen { radius, ..Seen::default() };
    let pose = |depth: f64, draw: &mut Draw| {
        let middle = place.middle(1.0 - depth, draw);
        let axis = Vector3::from(draw.direction());
        Pose::from_axis(middle - axis, axis).expect("a finite pose")
    };
    // The shallowest that are certain, then any.
    let flat = radius * radius / (1.0 + (1.0 - radius * radius).max(0.0).sqrt());
    for _ in 0..placements {
        if radius < 1.0 {
            seen.beyond_flat += usize::from(!probe.detect(&pose(flat + rounding, draw)));
            seen.beyond += usize::from(!probe.detect(&pose(radius + rounding, draw)));
        }
        // As often shallow as deep: the bound is nearest where the middle is at the surface.
        let depth = match draw.bits() % 2 {
            0 => 10f64.powf(draw.between(-4.0, 0.0)),
            _ => 1.0 - 10f64.powf(draw.between(-4.0, 0.0)),
        };
        let found = probe.deepest(&pose(depth, draw)).map_or(0.0, |deepest| deepest.depth);
        let short = depth - found;
        seen.too_deep += usize::from(short > radius + rounding);
        seen.most = seen.most.max(short / radius);
        seen.sum += short / radius;
    }
    seen
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Middles are as far from the surface as they are said to be.
    #[test]
    fn middles_are_where_they_should_be() {
        let mut draw = Draw::new(5);
        for _ in 0..1000 {
            let far = draw.between(0.0, 1.0);
            let out = Place::Outside.middle(far, &mut draw);
            let nearest = Point3::from(std::array::from_fn(|k| out[k].clamp(0.0, BOX[k])));
            assert!(((out - nearest).norm() - far).abs() < 1e-12, "{out} {far}");
            let within = Place::Hollow.middle(far, &mut draw);
            let nearest = (0..3).map(|k| within[k].min(BOX[k] - within[k]));
            assert!((nearest.fold(f64::INFINITY, f64::min) - far).abs() < 1e-12, "{within} {far}");
        }
    }
}

//! Spheres: centre and radius.

use crate::contender;
use crate::formula::{RADIUS, TIP};
use crate::split::{Bounds, Item};
use crate::volume::{Frame, MARGIN, Place, Volume, dot, least, most};

/// How often the centre is moved to where the sphere becomes smaller.
const STEPS: usize = 30;

pub(crate) struct Sphere;

impl Volume<4> for Sphere {
    type Seen = Frame;

    /// Nearly the smallest: from the middle of the box the centre goes toward the farthest point, a
    /// second of the way, a third, and so on (Bădoiu and Clarkson 2003).
    fn about(items: &[Item]) -> [f32; 4] {
        let bounds = Bounds::of(items);
        let mut centre = [0, 1, 2].map(|axis| bounds.middle(axis));
        let mut best = (f64::INFINITY, centre);
        for step in 0..STEPS {
            let (squared, farthest) = farthest(items, centre);
            if squared < best.0 {
                best = (squared, centre);
            }
            for axis in 0..3 {
                centre[axis] += (farthest[axis] - centre[axis]) / (step + 2) as f64;
            }
        }
        let [x, y, z] = best.1.map(|c| c as f32);
        [x, y, z, best.0.sqrt() as f32]
    }

    fn seen(frame: &Frame) -> Frame {
        *frame
    }

    #[inline(always)]
    fn may_touch<const W: usize>(frame: &Frame, volumes: &[[f32; W]; 4], lane: usize) -> bool {
        let (d, z, radius) = seen(frame, volumes, lane);
        let beside = most(d - radius, 0.0);
        Place { low: z - radius, high: z + radius, beside: beside * beside }.may_touch()
    }
}

/// The same spheres, held to the distance from the tool instead of to its largest radius over a
/// stretch: what only spheres can have for so little.
pub(crate) struct ByDistance;

impl Volume<4> for ByDistance {
    type Seen = Frame;

    fn about(items: &[Item]) -> [f32; 4] {
        Sphere::about(items)
    }

    fn seen(frame: &Frame) -> Frame {
        *frame
    }

    #[inline(always)]
    fn may_touch<const W: usize>(frame: &Frame, volumes: &[[f32; W]; 4], lane: usize) -> bool {
        let (d, z, radius) = seen(frame, volumes, lane);
        (clearance(d, z) <= radius) & (z - radius <= TIP as f32)
    }
}

/// Distance of a centre from the axis, its place along it, and the radius with its margin.
#[inline(always)]
fn seen<const W: usize>(frame: &Frame, volumes: &[[f32; W]; 4], lane: usize) -> (f32, f32, f32) {
    let centre = [volumes[0][lane], volumes[1][lane], volumes[2][lane]];
    let x = dot(frame.rows[0], centre) + frame.origin[0];
    let y = dot(frame.rows[1], centre) + frame.origin[1];
    let z = dot(frame.rows[2], centre) + frame.origin[2];
    ((x * x + y * y).sqrt(), z, volumes[3][lane] + MARGIN)
}

/// No more than the distance from the tool, as if it went on for ever beyond its housing; at most 0
/// inside. Of cutter and ball, of the taper and spindle by their two sides, of the housing.
#[inline(always)]
fn clearance(d: f32, z: f32) -> f32 {
    let below = least(z - 1.0, 0.0);
    let cutter = (d * d + below * below).sqrt() - 1.0;
    let spindle = most(d - 3.0, (d - z + 4.0) * std::f32::consts::FRAC_1_SQRT_2);
    let (beside, under) = (most(d - RADIUS as f32, 0.0), most(9.0 - z, 0.0));
    let housing = (beside * beside + under * under).sqrt();
    least(cutter, least(spindle, housing))
}

/// The point farthest from a centre, and the square of how far.
fn farthest(items: &[Item], centre: [f64; 3]) -> (f64, [f64; 3]) {
    let squared = |item: &Item| {
        let from = [0, 1, 2].map(|axis| item.at[axis] - centre[axis]);
        (contender::dot(from, from), item.at)
    };
    items.iter().map(squared).fold((-1.0, centre), |a, b| if b.0 > a.0 { b } else { a })
}

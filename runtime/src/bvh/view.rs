//! A part as a tool sees it: what is the same at every pose, and what changes.

use super::Frame;
use crate::pose::Pose;
use crate::tool::{Card, Shape};

/// The unit roundoff of `f32`.
const ROUNDOFF: f64 = 1.0 / 16_777_216.0;
/// The sizes of a tool whose coordinates and their squares are good numbers in `f32`.
const SIZES: [f64; 2] = [1e-12, 1e12];

/// The most slabs; the compiler makes no more than 24.
pub(crate) const SLABS: usize = 32;

/// The part of a query that is the same at every pose of a tool at a part. Lengths are in the tool's unit.
///
/// Boxes and points are held to the tool's envelope in `f32`, with a margin for what that rounds.
pub(crate) struct QuerySetup {
    /// The tool's unit of length in the part's.
    pub(crate) length: f64,
    /// The tree's unit in the part's, and in the tool's.
    scale: f64,
    pub(crate) unit: f64,
    pub(crate) reach: Reach,
    /// Whether the format holds what is seen; if not, no point is ruled out.
    pub(crate) fits: bool,
    /// How far the format can take a place, in the tool's unit.
    pub(crate) margin: f64,
    /// Where the middle of a part that the tool reaches can be along the axis, and how far from it.
    along: [f64; 2],
    across: f64,
}

/// What a tool reaches, widened by the margin.
pub(crate) struct Reach {
    /// Low end, high end and squared radius of each slab.
    pub(crate) slabs: [[f32; 3]; SLABS],
    /// A bit for each slab that there is.
    pub(crate) all: u32,
    /// Low and high end along x and y, if it has no axis.
    pub(crate) across: Option<[[f32; 2]; 2]>,
}

impl QuerySetup {
    /// `length` is the length of the tool's unit in the part's.
    ///
    /// A coordinate in the tool's frame is a sum of three products and one term; with the rounding
    /// of the factors themselves it errs by less than 8 units of roundoff of the sum of their
    /// sizes. Twice that is allowed for. No part is looked at that is farther away than tool and
    /// part are large, so the margin is the same at every pose.
    pub(crate) fn new(frame: &Frame, card: &Card, length: f64) -> QuerySetup {
        let unit = frame.scale / length;
        let part = unit * 3f64.sqrt() * f64::from(frame.size);
        let (size, [low, high]) = (card.size(), card.reach());
        let margin = 16.0 * ROUNDOFF * (size + 4.0 * part);
        let reach = Reach::new(card, margin);
        let fits =
            [size, unit].iter().all(|v| (SIZES[0]..=SIZES[1]).contains(v)) && reach.is_finite();
        // What `f64` rounds is less than this by far.
        let part = part * (1.0 + 1e-9) + 1e-9 * size;
        QuerySetup {
            length,
            scale: frame.scale,
            unit,
            fits,
            margin,
            reach,
            along: [low - part, high + part],
            across: (card.radius() + part).powi(2),
        }
    }

    /// Looks from a pose; whether the tool may reach the part from there.
    #[inline]
    pub(crate) fn set_pose(&self, frame: &Frame, pose: &Pose, view: &mut PoseTransform) -> bool {
        let (rotation, tip) = (pose.rotation(), pose.tip());
        let per_length = 1.0 / self.length;
        for axis in 0..3 {
            view.from_tip[axis] = frame.origin[axis] - tip[axis];
        }
        let from = view.from_tip;
        let mut seen = [0.0; 3];
        for axis in 0..3 {
            // The rotation's columns are the tool's axes.
            let row = [rotation[(0, axis)], rotation[(1, axis)], rotation[(2, axis)]];
            let place = row[0] * from[0] + row[1] * from[1] + row[2] * from[2];
            seen[axis] = place * per_length;
            view.origin[axis] = seen[axis] as f32;
            view.carry[axis] = row.map(|part| part * per_length);
            view.rows[axis] = row.map(|part| (part * self.unit) as f32);
        }
        view.scale = self.scale;
        let [x, y, z] = seen;
        // Written so that what is not a number may be reached.
        !(z < self.along[0] || z > self.along[1] || x * x + y * y > self.across)
    }
}

impl Reach {
    fn new(card: &Card, margin: f64) -> Reach {
        let low = |v: f64| ((v - margin) as f32).next_down();
        let high = |v: f64| ((v + margin) as f32).next_up();
        let (mut slabs, mut all) = ([[0f32; 3]; SLABS], 0);
        for (index, slab) in card.envelope.iter().enumerate() {
            let radius = slab.radius + margin;
            // Two roundings more, to the format and of the comparison's own square.
            let squared = ((radius * radius * (1.0 + 8.0 * ROUNDOFF)) as f32).next_up();
            let here = [low(slab.low), high(slab.high), squared];
            // Of more slabs than there is room for the last takes up the rest.
            let place: &mut [f32; 3] = &mut slabs[index.min(SLABS - 1)];
            *place = if index < SLABS {
                here
            } else {
                [place[0].min(here[0]), place[1].max(here[1]), place[2].max(here[2])]
            };
            all |= 1 << index.min(SLABS - 1);
        }
        let across = match card.shape {
            Shape::Revolved => None,
            Shape::Solid { across } => Some(across.map(|[from, to]| [low(from), high(to)])),
        };
        Reach { slabs, all, across }
    }

    fn is_finite(&self) -> bool {
        let across = self.across.iter().flatten().flatten();
        self.slabs.iter().flatten().chain(across).all(|v| v.is_finite())
    }
}

/// A part seen from a tool at a pose.
#[derive(Default)]
pub(crate) struct PoseTransform {
    /// From the tree's frame and unit to the tool's.
    pub(crate) rows: [[f32; 3]; 3],
    /// The cloud's origin in the tool's frame and unit.
    pub(crate) origin: [f32; 3],
    /// The cloud's origin from the tip, and the tree's unit, in the part's frame and unit.
    from_tip: [f64; 3],
    pub(crate) scale: f64,
    /// From the part's frame and unit to the tool's.
    pub(crate) carry: [[f64; 3]; 3],
}

impl PoseTransform {
    /// The centre of a leaf, given in the tree's unit, from the tip in the part's frame.
    #[inline(always)]
    pub(crate) fn leaf_from_tip(&self, centre: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| self.from_tip[axis] + self.scale * centre[axis])
    }

    /// From the tree's frame and unit to the tool's, in `f64`: the rows, and the origin there.
    pub(crate) fn exactly(&self) -> ([[f64; 3]; 3], [f64; 3]) {
        let [x, y, z] = self.from_tip;
        let origin = self.carry.map(|row| row[0] * x + row[1] * y + row[2] * z);
        (self.carry.map(|row| row.map(|part| part * self.scale)), origin)
    }

    /// A place given in the tree's unit, in the tool's frame and unit.
    #[inline(always)]
    pub(crate) fn seen(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let [a, b, c] = &self.rows;
        let along = |row: &[f32; 3], from: f32| x * row[0] + y * row[1] + z * row[2] + from;
        [along(a, self.origin[0]), along(b, self.origin[1]), along(c, self.origin[2])]
    }
}

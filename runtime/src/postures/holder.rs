//! How far a tool has to stick out of its holder.

use crate::bvh::WIDTH;
use crate::certify::Facets;
use crate::tool::{Card, Piece};
use nalgebra::{Point3, Vector3};

/// A holder seen from below: what it covers, from its nose upward. Lengths are in the part's unit.
///
/// The holder is what a tool's file mounts above the first: surfaces called `nut.…` where the outline begins
/// with one called `cutter.…`.
#[derive(Clone, Debug)]
pub(crate) struct Holder {
    /// Within this radius nothing of it is lower, above its nose, than this; both grow.
    steps: Vec<[f64; 2]>,
    /// The least stick-out: the highest of what cuts.
    cutting: f64,
    /// How far the tool sticks out as it is: the height of the nose.
    pub(crate) own: f64,
    /// To what triangles are cut up before all of one is taken to be as high as its highest place.
    fine: f64,
}

/// A slope is as many steps.
const STEPS: usize = 16;

/// Triangles are cut up to this part of the holder's radius.
const FINE: f64 = 1.0 / 64.0;

impl Holder {
    /// That of a tool, its unit of length in the part's; `None` if it has none.
    pub(crate) fn new(card: &Card, length: f64) -> Option<Holder> {
        let mount = |piece: &Piece| {
            card.surfaces[piece.surface].name.split_once('.').map(|(mount, _)| mount)
        };
        let first = mount(card.outline.first()?)?;
        let pieces = card.outline.iter().filter(|piece| mount(piece) != Some(first));
        let mut corners: Vec<[f64; 2]> = Vec::new();
        for piece in pieces {
            // An arc is one step, as far out as it comes, and as low.
            let [from, to] = [piece.from, piece.to];
            let count = if piece.circle.is_some() { 1 } else { STEPS };
            for k in 0..count {
                let at = |k: usize, part: usize| {
                    from[part] + (to[part] - from[part]) * k as f64 / count as f64
                };
                let (low, high) = (at(k, 1).min(at(k + 1, 1)), at(k, 0).max(at(k + 1, 0)));
                let bulge = piece.circle.filter(|arc| arc.convex);
                let radius = bulge.map_or(high, |arc| high.max(arc.centre[0] + arc.radius));
                // The material on its left, it goes outward below its centre.
                let below = bulge.filter(|arc| from[0] <= arc.centre[0] && arc.centre[0] <= to[0]);
                let low = below.map_or(low, |arc| low.min(arc.centre[1] - arc.radius));
                corners.push([radius * length, low * length]);
            }
        }
        let nose = corners.iter().map(|corner| corner[1]).reduce(f64::min)?;
        corners.sort_by(|a, b| b[0].total_cmp(&a[0]).then(a[1].total_cmp(&b[1])));
        // From the widest inward, what is lower than all that is wider.
        let mut steps: Vec<[f64; 2]> = Vec::new();
        for [radius, z] in corners {
            let height = z - nose;
            if steps.last().is_none_or(|[_, lowest]| height < *lowest) {
                steps.push([radius, height]);
            }
        }
        steps.reverse();
        let cuts = card.outline.iter().filter(|piece| card.surfaces[piece.surface].cutting);
        let cutting = cuts.flat_map(|piece| [piece.from[1], piece.to[1]]).fold(0.0, f64::max);
        let widest = steps.last().map_or(0.0, |[radius, _]| *radius);
        Some(Holder { steps, cutting: cutting * length, own: nose, fine: FINE * widest })
    }

    /// How far above the nose it is at least, so far from the axis; `None` where it does not reach.
    fn height(&self, d: f64) -> Option<f64> {
        self.steps.iter().find(|[radius, _]| d <= *radius).map(|[_, height]| *height)
    }

    /// How far a tool has to stick out for the holder to touch nothing, where it stands; `None` if that is
    /// not less than what is enough. The holder is taken to go on upward as wide as it ever was, so that it
    /// is no less than what is needed, by a step's height and the size of a cut triangle at most.
    pub(crate) fn least(
        &self,
        facets: &Facets,
        (tip, axis): (&Point3<f64>, &Vector3<f64>),
        enough: Option<f64>,
    ) -> Option<f64> {
        let stop = enough.unwrap_or(f64::INFINITY);
        let mut least = self.cutting;
        let frame = &facets.frame;
        let middle = Point3::from(frame.origin) - tip;
        let mut stack = vec![(0, 0)];
        while least < stop
            && let Some((level, index)) = stack.pop()
        {
            for lane in 0..facets.children(level, index) {
                let child = index * WIDTH + lane;
                let Some(boxes) = facets.levels.get(level).map(|boxes| &boxes[index]) else {
                    let corners = facets.corners[child].map(|p| Point3::from(p) - tip);
                    least = least.max(self.triangle(corners, axis, least));
                    continue;
                };
                let part =
                    |list: &[[f32; WIDTH]; 3], k: usize| f64::from(list[k][lane]) * frame.scale;
                let centre = middle + Vector3::from_fn(|k, _| part(&boxes.centre, k));
                let half = Vector3::from_fn(|k, _| part(&boxes.half, k)) * WIDER;
                let along = centre.dot(axis);
                let high = along + half.dot(&axis.abs());
                let reach = half.norm();
                let near = ((centre - axis * along).norm() - reach).max(0.0);
                if self.height(near).is_some_and(|height| high - height > least) {
                    stack.push((level + 1, child));
                }
            }
        }
        (least < stop).then_some(least)
    }

    /// What a triangle, its corners from the tip, asks for at least, if that is more.
    fn triangle(&self, corners: [Vector3<f64>; 3], axis: &Vector3<f64>, least: f64) -> f64 {
        let mut most = least;
        let mut pieces = vec![corners];
        while let Some([a, b, c]) = pieces.pop() {
            let heights = [a, b, c].map(|corner| corner.dot(axis));
            let high = heights.into_iter().fold(f64::NEG_INFINITY, f64::max);
            let middle = (a + b + c) / 3.0;
            let reach =
                [a, b, c].map(|corner| (corner - middle).norm()).into_iter().fold(0.0, f64::max);
            let near = ((middle - axis * middle.dot(axis)).norm() - reach).max(0.0);
            let Some(needed) = self.height(near).map(|height| high - height) else { continue };
            if needed <= most {
                continue;
            }
            if reach <= self.fine {
                most = needed;
                continue;
            }
            // The longest side is halved.
            let sides = [(b - a).norm(), (c - b).norm(), (a - c).norm()];
            let [a, b, c] = match () {
                () if sides[0] >= sides[1] && sides[0] >= sides[2] => [a, b, c],
                () if sides[1] >= sides[2] => [b, c, a],
                () => [c, a, b],
            };
            let half = (a + b) / 2.0;
            pieces.extend([[a, half, c], [half, b, c]]);
        }
        most
    }
}

/// Boxes are known in `f32`.
const WIDER: f64 = 1.0 + 1e-6;

#[cfg(test)]
mod tests;

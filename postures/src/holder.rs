//! Stick-out that a tool needs so that its holder clears the part.

use nalgebra::{Point3, Vector3};
use touchoff::certify::{BoxVisitor, TriangleBvh};
use touchoff::tool::{Circle, ProfileSegment, ToolInfo};

/// The underside of a holder as a step function of the radius, upward from its nose. Lengths are in the part's
/// unit.
///
/// The holder consists of the components that the file of a tool mounts above the first: surfaces called
/// `nut.…` where the outline begins with one called `cutter.…`.
#[derive(Clone, Debug)]
pub(crate) struct Holder {
    /// Pairs of radius and height, both ascending: within the radius no point of the holder is lower than the
    /// height above its nose.
    steps: Vec<[f64; 2]>,
    /// The least stick-out: the height of the highest cutting point.
    cutting: f64,
    /// Stick-out of the tool as it is: the height of the nose.
    stickout: f64,
}

/// Steps per straight segment of the profile.
const STEPS_PER_SEGMENT: usize = 16;

impl Holder {
    /// Creates the holder of a tool, or returns `None` if it has none. `length` is the factor from the tool's
    /// unit of length to the part's.
    pub(crate) fn new(info: &ToolInfo, length: f64) -> Option<Holder> {
        let first = mount(info, info.outline.first()?)?;
        let pieces = info.outline.iter().filter(|segment| mount(info, segment) != Some(first));
        let corners: Vec<Corner> =
            pieces.flat_map(|segment| ring_corners(segment, length)).collect();
        let nose = corners.iter().map(|corner| corner.lowest).reduce(f64::min)?;
        let steps = underside(corners, nose);
        let cutting_segments =
            info.outline.iter().filter(|segment| info.surface(segment.surface).cutting);
        let cutting = cutting_segments
            .flat_map(|segment| [segment.from[1], segment.to[1]])
            .fold(0.0, f64::max);
        Some(Holder { steps, cutting: cutting * length, stickout: nose })
    }

    /// Returns the least height of the holder above its nose at a distance `d` from the axis; `None` beyond its
    /// radius.
    fn height(&self, d: f64) -> Option<f64> {
        self.steps.iter().find(|[radius, _]| d <= *radius).map(|[_, height]| *height)
    }

    /// Returns the stick-out that a triangle needs, or `required` if that is more. Its corners are relative to the
    /// tip.
    ///
    /// A point needs its height less that of the first step that reaches it. Wider steps are higher, so the triangle needs
    /// the most, over all steps, of its greatest height within the step's radius less the step's height.
    fn triangle(&self, corners: [Vector3<f64>; 3], axis: &Vector3<f64>, required: f64) -> f64 {
        let triangle = AxialTriangle::new(corners, axis);
        let highest = triangle.heights.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let nearest = triangle.least_distance();
        let mut required = required;
        for [radius, height] in self.steps.iter().skip_while(|[radius, _]| *radius < nearest) {
            // Neither this step nor a higher one asks for more.
            if highest - height <= required {
                break;
            }
            if let Some(within) = triangle.highest_within(*radius) {
                required = required.max(within - height);
            }
        }
        required
    }
}

/// A triangle, and its corners as heights along an axis through the origin and vectors across it.
struct AxialTriangle {
    corners: [Vector3<f64>; 3],
    /// The normal, of any length.
    normal: Vector3<f64>,
    axis: Vector3<f64>,
    heights: [f64; 3],
    across: [Vector3<f64>; 3],
}

impl AxialTriangle {
    fn new(corners: [Vector3<f64>; 3], axis: &Vector3<f64>) -> AxialTriangle {
        let heights = corners.map(|corner| corner.dot(axis));
        let across = [0, 1, 2].map(|k| corners[k] - axis * heights[k]);
        let [a, b, c] = corners;
        let normal = (b - a).cross(&(c - a));
        AxialTriangle { corners, normal, axis: *axis, heights, across }
    }

    /// Returns at most the distance of the triangle from the axis: how far it is in the direction of its centroid.
    fn least_distance(&self) -> f64 {
        let [a, b, c] = self.across;
        let middle = a + b + c;
        let least =
            self.across.map(|corner| corner.dot(&middle)).into_iter().fold(f64::INFINITY, f64::min);
        least / middle.norm()
    }

    /// Returns the greatest height of a point at most `radius` from the axis, up to rounding; `None` if there is none.
    ///
    /// Height is linear on the triangle, and its points within the radius are a convex set. Height is greatest where an
    /// edge ends or leaves the cylinder of that radius, or at the highest point that the triangle's plane has on the cylinder.
    fn highest_within(&self, radius: f64) -> Option<f64> {
        let edges = [[0, 1], [1, 2], [2, 0]].map(|edge| self.highest_of_edge(edge, radius));
        let heights = edges.into_iter().chain([self.highest_inside(radius)]);
        heights.flatten().reduce(f64::max)
    }

    /// The same of the points of an edge.
    fn highest_of_edge(&self, [from, to]: [usize; 2], radius: f64) -> Option<f64> {
        let (start, along) = (self.across[from], self.across[to] - self.across[from]);
        // The points with |start + t along| ≤ radius.
        let (square, half) = (along.norm_squared(), start.dot(&along));
        let beyond = start.norm_squared() - radius * radius;
        let discriminant = half * half - square * beyond;
        let [first, last] = if square > 0.0 {
            if discriminant < 0.0 {
                return None;
            }
            [-1.0, 1.0].map(|sign| (sign * discriminant.sqrt() - half) / square)
        } else if beyond > 0.0 {
            return None;
        } else {
            [0.0, 1.0]
        };
        let (first, last) = (first.max(0.0), last.min(1.0));
        let height = |t: f64| self.heights[from] + (self.heights[to] - self.heights[from]) * t;
        (first <= last).then(|| height(first).max(height(last)))
    }

    /// Returns the greatest height of the triangle's plane at a distance `radius` from the axis, if it is there in the
    /// triangle.
    fn highest_inside(&self, radius: f64) -> Option<f64> {
        let AxialTriangle { corners: [a, b, c], normal, axis, .. } = self;
        let slope = normal.dot(axis);
        // A plane along the axis has no highest point there.
        if slope == 0.0 {
            return None;
        }
        let level = normal - axis * slope;
        // A plane across the axis is as high everywhere, on the axis, too.
        let across = match level.norm() {
            0.0 => level,
            length => level * (-slope.signum() * radius / length),
        };
        let height = (a - across).dot(normal) / slope;
        let point = across + axis * height;
        let is_inside = [[a, b], [b, c], [c, a]]
            .iter()
            .all(|[from, to]| (*to - *from).cross(&(point - *from)).dot(normal) >= 0.0);
        is_inside.then_some(height)
    }
}

/// Returns the name of the component that a segment of the profile belongs to, if the tool's file mounts it.
fn mount<'a>(info: &'a ToolInfo, segment: &ProfileSegment) -> Option<&'a str> {
    info.surface(segment.surface).name.split_once('.').map(|(mount, _)| mount)
}

/// The lower outer corner of a ring of a holder, in the part's unit.
struct Corner {
    /// The largest distance of the ring's points from the axis.
    radius: f64,
    /// The height of its lowest point above the tip.
    lowest: f64,
}

/// Returns the corners of rings that enclose a segment of the profile: one of an arc, several of a straight segment.
/// `length` is the factor from the tool's unit of length to the part's.
fn ring_corners(segment: &ProfileSegment, length: f64) -> impl Iterator<Item = Corner> {
    let ProfileSegment { from, to, circle, .. } = *segment;
    let count = if circle.is_some() { 1 } else { STEPS_PER_SEGMENT };
    (0..count).map(move |k| {
        let [start, end] = [k, k + 1].map(|k| {
            [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * k as f64 / count as f64)
        });
        let (mut radius, mut lowest) = (start[0].max(end[0]), start[1].min(end[1]));
        if let Some(Circle { centre, radius: arc_radius, .. }) = circle.filter(|arc| arc.convex) {
            radius = radius.max(centre[0] + arc_radius);
            // With the material on its left, an arc runs outward below its centre.
            if from[0] <= centre[0] && centre[0] <= to[0] {
                lowest = lowest.min(centre[1] - arc_radius);
            }
        }
        Corner { radius: radius * length, lowest: lowest * length }
    })
}

/// Returns the steps of the underside of rings, as radii and heights above the nose, both ascending.
fn underside(mut corners: Vec<Corner>, nose: f64) -> Vec<[f64; 2]> {
    corners.sort_by(|a, b| b.radius.total_cmp(&a.radius).then(a.lowest.total_cmp(&b.lowest)));
    // From the widest inward, keep each corner that is lower than all wider ones.
    let mut steps: Vec<[f64; 2]> = Vec::new();
    for Corner { radius, lowest } in corners {
        let height = lowest - nose;
        if steps.last().is_none_or(|[_, last_height]| height < *last_height) {
            steps.push([radius, height]);
        }
    }
    steps.reverse();
    steps
}

/// Least stick-outs of a holder at a part, for several postures each.
pub(crate) struct LeastStickout<'a> {
    holder: Holder,
    bvh: &'a TriangleBvh,
    /// The triangle that asked for the most in the posture before: it is likely to do so in the next, which is then found
    /// sooner. The results do not depend on it.
    binding: Option<[Point3<f64>; 3]>,
}

impl<'a> LeastStickout<'a> {
    pub(crate) fn new(holder: Holder, bvh: &'a TriangleBvh) -> LeastStickout<'a> {
        LeastStickout { holder, bvh, binding: None }
    }

    /// Returns the least stick-out at which the holder touches nothing in some posture, at most that of the tool as it is;
    /// `None` without postures. They are given by their tips and their axes, unit vectors. The holder is taken to continue
    /// upward at the largest radius so far. The result is therefore no less than what is needed but for rounding, and
    /// exceeds it by at most the height of a step.
    pub(crate) fn of(
        &mut self,
        postures: impl IntoIterator<Item = (Point3<f64>, Vector3<f64>)>,
    ) -> Option<f64> {
        let mut least: Option<f64> = None;
        for (tip, axis) in postures {
            let mut search = StickoutSearch {
                holder: &self.holder,
                tip,
                axis,
                origin: self.bvh.origin() - tip,
                limit: least.unwrap_or(f64::INFINITY),
                required: self.holder.cutting,
                binding: self.binding,
            };
            if let Some(corners) = self.binding {
                search.triangle(corners);
            }
            self.bvh.visit(&mut search);
            self.binding = search.binding;
            if search.required < search.limit {
                least = Some(search.required);
            }
        }
        least.map(|least| least.min(self.holder.stickout))
    }
}

/// A search for the stick-out of a holder at a pose.
struct StickoutSearch<'a> {
    holder: &'a Holder,
    tip: Point3<f64>,
    axis: Vector3<f64>,
    /// Origin of the boxes, relative to the tip.
    origin: Vector3<f64>,
    /// The stick-out at which the search ends.
    limit: f64,
    /// The stick-out that the triangles need which were visited.
    required: f64,
    /// The one among them that needs it.
    binding: Option<[Point3<f64>; 3]>,
}

impl BoxVisitor for StickoutSearch<'_> {
    fn enters(&mut self, centre: Vector3<f64>, half: Vector3<f64>) -> bool {
        let centre = self.origin + centre;
        let half = half * BOX_ROUNDING_FACTOR;
        let height_of_centre = centre.dot(&self.axis);
        let high = height_of_centre + half.dot(&self.axis.abs());
        // No point of the box is nearer to the axis than it is in the direction of the centre.
        let across = centre - self.axis * height_of_centre;
        let distance = across.norm();
        let min_distance = distance - half.dot(&across.abs()) / distance;
        let lowest = self.holder.height(min_distance.max(0.0));
        self.required < self.limit && lowest.is_some_and(|height| high - height > self.required)
    }

    fn triangle(&mut self, corners: [Point3<f64>; 3]) {
        if self.required < self.limit {
            let relative = corners.map(|corner| corner - self.tip);
            let required = self.holder.triangle(relative, &self.axis, self.required);
            if required > self.required {
                (self.required, self.binding) = (required, Some(corners));
            }
        }
    }
}

/// Factor that covers the rounding of boxes, which are stored in `f32`.
const BOX_ROUNDING_FACTOR: f64 = 1.0 + 1e-6;

#[cfg(test)]
mod tests;

//! Circles about the axis on which the depth of an overhanging profile can be greatest in a triangle.
//!
//! Where depth is greatest inside a triangle, some convex combination of the gradients toward the nearest
//! features is normal to the triangle, or 0. In the first case the point is on the meridian. In the second it is
//! *critical*: the centre of an arc, midway between two points of the profile on a common normal, or equally far
//! from three features. Without overhangs depth does not grow away from the axis, so an equally deep point lies
//! nearer to the axis, on the meridian or on an edge. With overhangs a critical point is a circle about the axis,
//! which a triangle crosses anywhere.
//!
//! Between parallel lines, or arcs about one centre, the critical points form a line of the half plane along
//! which depth is constant. A triangle crosses its surface of revolution in curves. Closed curves meet the
//! meridian (`docs/certified.md`). The others end on an edge, or at the height of an end of that line. At such an
//! end a foot is an end of a feature, or a third feature is as near.

use crate::certify::tool_model::feature::{Feature, MeridianPoint, dot, minus, norm};
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::section::Section;
use crate::tool::Circle;

/// Returns the heights of these circles; `None` if there are too many.
pub(super) fn heights(section: &Section) -> Option<Vec<f64>> {
    let mut heights = Owners::default().find_peaks(section, false)?;
    let mut add = |[a, b]: [MeridianPoint; 2]| {
        let middle = [0, 1].map(|k| f64::midpoint(a[k], b[k]));
        let half = 0.5 * norm(minus(a, b));
        let nearest = (section.unsigned_distance(middle) - half).abs() <= section.error;
        if middle[0] > 0.0 && half > section.error && nearest && section.contains(middle) {
            heights.push(middle[1]);
        }
    };
    let features = &section.features;
    let ends: Vec<MeridianPoint> = features.iter().flat_map(|feature| feature.ends).collect();
    for (index, feature) in features.iter().enumerate() {
        for end in &ends {
            normals(feature, *end).for_each(|point| add([*end, point]));
        }
        for other in &features[..index] {
            match (&feature.circle, &other.circle) {
                (None, None) => {}
                (Some(circle), None) => common(other, circle).into_iter().for_each(&mut add),
                (None, Some(circle)) => common(feature, circle).into_iter().for_each(&mut add),
                (Some(one), Some(_)) => {
                    for point in normals(other, one.centre) {
                        normals(feature, point).for_each(|own| add([own, point]));
                    }
                }
            }
        }
    }
    for (index, end) in ends.iter().enumerate() {
        ends[..index].iter().for_each(|other| add([*end, *other]));
    }
    heights.sort_by(f64::total_cmp);
    heights.dedup_by(|upper, lower| *upper - *lower <= 0.25 * section.error);
    Some(heights)
}

/// Returns the points of a feature's line or circle whose normal passes through a point.
fn normals(feature: &Feature, p: MeridianPoint) -> impl Iterator<Item = MeridianPoint> + use<> {
    let points = match &feature.circle {
        None => {
            let at = dot(feature.along, minus(p, feature.ends[0]));
            let foot = [0, 1].map(|k| feature.ends[0][k] + at * feature.along[k]);
            [Some(foot), None]
        }
        Some(Circle { centre, radius, .. }) => {
            let offset = minus(p, *centre);
            let distance = norm(offset);
            [1.0, -1.0].map(|side| {
                let at = |k: usize| centre[k] + side * radius * (offset[k] / distance);
                (distance > 0.0).then(|| [at(0), at(1)])
            })
        }
    };
    points.into_iter().flatten()
}

/// Returns the pairs of points of a line and a circle on their common normal.
fn common(line: &Feature, circle: &Circle) -> [[MeridianPoint; 2]; 2] {
    let Circle { centre, radius, .. } = *circle;
    let at = dot(line.along, minus(centre, line.ends[0]));
    let foot = [0, 1].map(|k| line.ends[0][k] + at * line.along[k]);
    let normal = [-line.along[1], line.along[0]];
    [radius, -radius].map(|radius| [foot, [0, 1].map(|k| centre[k] + radius * normal[k])])
}

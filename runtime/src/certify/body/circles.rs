//! Circles about the axis on which a profile that overhangs can be deepest in a triangle.
//!
//! Where depth is greatest inside a triangle, some mixture of the gradients toward the nearest features is
//! normal to it, or 0. In the first case the place is on the meridian. In the second it is *critical*: the centre
//! of an arc; midway between two places of the profile on a common normal; or as far from three features.
//! Without overhangs depth does not grow away from the axis, so that a place as deep lies nearer to the axis, on the
//! meridian or on an edge. With them a critical place is a circle, which a triangle crosses anywhere.
//!
//! Between parallel lines, or arcs about one centre, critical places are a line of the half plane on which
//! depth is the same. A triangle crosses what this is about the axis in curves: closed ones, which are
//! symmetrical to the meridian, and such as end on an edge or at the height of an end of that line. There a foot
//! is an end of a feature, or a third feature is as near.

use crate::certify::body::feature::{Feature, Place, dot, minus, norm};
use crate::certify::body::owners::Owners;
use crate::certify::body::section::Section;
use crate::tool::Circle;

/// The heights of such circles; `None` where there are too many.
pub(super) fn heights(section: &Section) -> Option<Vec<f64>> {
    let mut heights = Owners::default().find_peaks(section, false)?;
    let mut add = |[a, b]: [Place; 2]| {
        let middle = [0, 1].map(|k| f64::midpoint(a[k], b[k]));
        let half = 0.5 * norm(minus(a, b));
        let nearest = (section.away(middle) - half).abs() <= section.error;
        if middle[0] > 0.0 && half > section.error && nearest && section.contains(middle) {
            heights.push(middle[1]);
        }
    };
    let features = &section.features;
    let ends: Vec<Place> = features.iter().flat_map(|feature| feature.ends).collect();
    for (index, feature) in features.iter().enumerate() {
        for end in &ends {
            normals(feature, *end).for_each(|place| add([*end, place]));
        }
        for other in &features[..index] {
            match (&feature.circle, &other.circle) {
                (None, None) => {}
                (Some(circle), None) => common(other, circle).into_iter().for_each(&mut add),
                (None, Some(circle)) => common(feature, circle).into_iter().for_each(&mut add),
                (Some(one), Some(_)) => {
                    for place in normals(other, one.centre) {
                        normals(feature, place).for_each(|own| add([own, place]));
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

/// The places of a feature's line or circle whose normal goes through a place.
fn normals(feature: &Feature, p: Place) -> impl Iterator<Item = Place> + use<> {
    let places = match &feature.circle {
        None => {
            let at = dot(feature.along, minus(p, feature.ends[0]));
            let foot = [0, 1].map(|k| feature.ends[0][k] + at * feature.along[k]);
            [Some(foot), None]
        }
        Some(Circle { centre, radius, .. }) => {
            let way = minus(p, *centre);
            let far = norm(way);
            [1.0, -1.0].map(|side| {
                let at = |k: usize| centre[k] + side * radius * (way[k] / far);
                (far > 0.0).then(|| [at(0), at(1)])
            })
        }
    };
    places.into_iter().flatten()
}

/// The places of a line and a circle on their common normal.
fn common(line: &Feature, circle: &Circle) -> [[Place; 2]; 2] {
    let Circle { centre, radius, .. } = *circle;
    let at = dot(line.along, minus(centre, line.ends[0]));
    let foot = [0, 1].map(|k| line.ends[0][k] + at * line.along[k]);
    let normal = [-line.along[1], line.along[0]];
    [radius, -radius].map(|radius| [foot, [0, 1].map(|k| centre[k] + radius * normal[k])])
}

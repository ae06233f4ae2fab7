//! Boxes along axes of their own: centre, and three axes as long as half the box.

use crate::contender::dot;
use crate::split::{Bounds, Item};
use crate::volume::{self, Frame, Place, Volume};
use nalgebra::{Matrix3, Vector3};

pub(crate) struct Obb;

impl Volume<12> for Obb {
    type Seen = Frame;

    /// Along the principal axes of the points, or along the part's if that is the smaller surface.
    fn about(items: &[Item]) -> [f32; 12] {
        let own = Oriented::along(principal(items), items);
        let part = Oriented::along([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], items);
        let chosen = if own.bounds.surface() < part.bounds.surface() { own } else { part };
        chosen.written()
    }

    fn seen(frame: &Frame) -> Frame {
        *frame
    }

    #[inline(always)]
    fn may_touch<const W: usize>(frame: &Frame, volumes: &[[f32; W]; 12], lane: usize) -> bool {
        let vector =
            |from: usize| [volumes[from][lane], volumes[from + 1][lane], volumes[from + 2][lane]];
        let (centre, axes) = (vector(0), [vector(3), vector(6), vector(9)]);
        let Frame { rows, origin } = frame;
        let along = |row: [f32; 3]| volume::dot(row, centre);
        let reach = |row: [f32; 3]| {
            let [a, b, c] = axes;
            volume::dot(row, a).abs() + volume::dot(row, b).abs() + volume::dot(row, c).abs()
        };
        Place::of_box(
            [along(rows[0]) + origin[0], along(rows[1]) + origin[1], along(rows[2]) + origin[2]],
            [reach(rows[0]), reach(rows[1]), reach(rows[2])],
        )
        .may_touch()
    }
}

/// A box along some axes, its ends measured along them.
struct Oriented {
    axes: [[f64; 3]; 3],
    bounds: Bounds,
}

impl Oriented {
    fn along(axes: [[f64; 3]; 3], items: &[Item]) -> Oriented {
        let seen = items.iter().map(|item| axes.map(|axis| dot(axis, item.at)));
        Oriented { axes, bounds: Bounds::of_places(seen) }
    }

    fn written(&self) -> [f32; 12] {
        let mut written = [0.0; 12];
        for part in 0..3 {
            for (axis, way) in self.axes.iter().enumerate() {
                written[part] += (way[part] * self.bounds.middle(axis)) as f32;
                written[3 + 3 * axis + part] = (way[part] * self.bounds.side(axis) / 2.0) as f32;
            }
        }
        written
    }
}

/// The eigenvectors of the points' covariance.
fn principal(items: &[Item]) -> [[f64; 3]; 3] {
    let place = |item: &Item| Vector3::from(item.at);
    let mean = items.iter().map(place).sum::<Vector3<f64>>() / items.len() as f64;
    let spread = |item: &Item| (place(item) - mean) * (place(item) - mean).transpose();
    let covariance = items.iter().map(spread).sum::<Matrix3<f64>>();
    let axes = covariance.symmetric_eigen().eigenvectors;
    [0, 1, 2].map(|axis| axes.column(axis).into_owned().into())
}

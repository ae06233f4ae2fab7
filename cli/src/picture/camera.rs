//! Orthographic cameras.

use nalgebra::{Point3, Vector3};

/// A direction of view.
#[derive(Clone, Copy)]
pub(crate) struct View {
    pub(crate) name: &'static str,
    /// Direction from the part to the eye.
    pub(crate) toward: [f64; 3],
    /// Upward direction in the picture; not parallel to `toward`.
    pub(crate) up: [f64; 3],
}

/// The views that a part is shown in.
pub(crate) const VIEWS: [View; 4] = [
    View { name: "from above", toward: [1.0, -1.5, 1.3], up: [0.0, 0.0, 1.0] },
    View { name: "from below", toward: [1.0, -1.5, -1.3], up: [0.0, 0.0, 1.0] },
    View { name: "top", toward: [0.0, 0.0, 1.0], up: [0.0, 1.0, 0.0] },
    View { name: "bottom", toward: [0.0, 0.0, -1.0], up: [0.0, 1.0, 0.0] },
];

/// Share of the picture's shorter side that the shown extent fills.
const FILLED: f64 = 0.92;

/// An orthographic camera.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    /// The point in the middle of the picture.
    pub(super) centre: Point3<f64>,
    toward: Vector3<f64>,
    up: Vector3<f64>,
    /// The length that fills the shorter side of the picture, but for a margin.
    extent: f64,
    /// Distance in front of the centre beyond which nothing is shown.
    pub(super) cut: f64,
}

impl Camera {
    /// Returns a camera that looks at `centre` from a direction; `up` is any direction that is not parallel to it.
    pub(crate) fn new(centre: Point3<f64>, [toward, up]: [Vector3<f64>; 2], extent: f64) -> Camera {
        Camera { centre, toward: toward.normalize(), up, extent, cut: f64::INFINITY }
    }

    /// Returns the camera without what is nearer to the eye than its centre by more than a distance.
    pub(crate) fn with_cut(self, cut: f64) -> Camera {
        Camera { cut, ..self }
    }

    /// Returns a camera that shows all points in a view.
    pub(crate) fn fitted(view: &View, points: impl Iterator<Item = Point3<f64>>) -> Camera {
        let [toward, up] = [view.toward, view.up].map(Vector3::from);
        let camera = Camera::new(Point3::origin(), [toward, up], 1.0);
        let frame = camera.frame();
        let mut spans = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for point in points {
            for (span, axis) in spans.iter_mut().zip(&frame) {
                let at = point.coords.dot(axis);
                *span = [span[0].min(at), span[1].max(at)];
            }
        }
        let middle = spans.map(|[low, high]| f64::midpoint(low, high));
        let centre = frame[0] * middle[0] + frame[1] * middle[1] + frame[2] * middle[2];
        let [across, along, _] = spans.map(|[low, high]| high - low);
        let extent = across.max(along);
        let extent = if extent > 0.0 { extent } else { 1.0 };
        Camera { centre: centre.into(), extent, ..camera }
    }

    /// Returns the directions to the right, upward, and toward the eye.
    pub(crate) fn frame(&self) -> [Vector3<f64>; 3] {
        let right = self.up.cross(&self.toward).normalize();
        [right, self.toward.cross(&right), self.toward]
    }

    /// Returns the number of pixels per unit of length in a picture of a size.
    pub(crate) fn pixels_per_length(&self, size: [usize; 2]) -> f64 {
        size[0].min(size[1]) as f64 * FILLED / self.extent
    }
}

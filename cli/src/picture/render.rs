//! Orthographic cameras, and rendering of triangles with edges that show their shape.
//!
//! A colour that stands for a value is drawn as it is in the legend: neither light nor distance changes it. Shape shows
//! by dark lines where the surface bends or hides another. Only triangles without a value are shaded.

use nalgebra::{Point3, Vector3};

/// A direction of view.
#[derive(Clone, Copy)]
pub(super) struct View {
    pub(super) name: &'static str,
    /// Direction from the part to the eye.
    toward: [f64; 3],
    /// Upward direction in the picture; not parallel to `toward`.
    up: [f64; 3],
}

/// The views that a part is shown in.
pub(super) const VIEWS: [View; 4] = [
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
    centre: Point3<f64>,
    toward: Vector3<f64>,
    up: Vector3<f64>,
    /// The length that fills the shorter side of the picture, but for a margin.
    extent: f64,
    /// Distance in front of the centre beyond which nothing is shown.
    cut: f64,
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
    pub(super) fn fitted(view: &View, points: impl Iterator<Item = Point3<f64>>) -> Camera {
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
    pub(super) fn frame(&self) -> [Vector3<f64>; 3] {
        let right = self.up.cross(&self.toward).normalize();
        [right, self.toward.cross(&right), self.toward]
    }

    /// Returns the number of pixels per unit of length in a picture of a size.
    pub(super) fn pixels_per_length(&self, size: [usize; 2]) -> f64 {
        size[0].min(size[1]) as f64 * FILLED / self.extent
    }
}

/// The look of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Paint {
    /// A colour that stands for a value, and is never shaded.
    Value([u8; 3]),
    /// A plain surface, shaded.
    Plain([u8; 3]),
    /// A shaded surface through which others are seen.
    Glass([u8; 3]),
}

/// A triangle to draw.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet {
    pub(crate) corners: [Point3<f64>; 3],
    pub(crate) paint: Paint,
}

/// A picture, row by row from the top, as red, green and blue.
pub(super) struct Image {
    pub(super) size: [usize; 2],
    pub(super) pixels: Vec<[u8; 3]>,
}

/// Samples per pixel along each side, for antialiasing.
const FINER: usize = 2;
/// Brightness of what lies in the shade, from 0 to 1.
const SHADE: f64 = 0.72;
/// Cosine of the angle between neighbouring surfaces from which an edge is drawn, 35°.
const CREASE: f64 = 0.82;
/// Difference in distance, in samples, from which one surface hides another.
const STEP: f64 = 4.0;
/// Colour of edges.
const EDGE: [f64; 3] = [34.0, 34.0, 34.0];
/// Opacity of edges and of glass.
const EDGE_OPACITY: f64 = 0.8;
const GLASS_OPACITY: f64 = 0.35;

/// The surface that is seen at a sample.
#[derive(Clone, Copy)]
struct Sample {
    /// Distance toward the eye, in samples.
    near: f64,
    normal: Vector3<f64>,
    colour: [f64; 3],
}

const NOTHING: Sample =
    Sample { near: f64::NEG_INFINITY, normal: Vector3::new(0.0, 0.0, 0.0), colour: [255.0; 3] };

/// Draws facets on white, in a picture of `size` pixels. What is nearer to the eye than the camera's limit is cut away.
pub(super) fn render(
    facets: impl Iterator<Item = Facet>,
    camera: &Camera,
    size: [usize; 2],
) -> Image {
    let fine = size.map(|side| side * FINER);
    let frame = camera.frame();
    let [right, up, toward] = frame;
    let light = (toward + 0.5 * up - 0.4 * right).normalize();
    let scale = camera.pixels_per_length(fine);
    let [mut solid, mut glass] = [(); 2].map(|()| vec![NOTHING; fine[0] * fine[1]]);
    for Facet { corners, paint } in facets {
        let [a, b, c] = corners;
        let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) else { continue };
        // A triangle that faces away is seen from behind.
        let normal = if normal.dot(&toward) < 0.0 { -normal } else { normal };
        // The normal in the picture's frame, whose y axis points downward.
        let seen = Vector3::new(normal.dot(&right), -normal.dot(&up), normal.dot(&toward));
        let bright = SHADE + (1.0 - SHADE) * normal.dot(&light).max(0.0);
        let (layer, colour) = match paint {
            Paint::Value(colour) => (&mut solid, colour.map(f64::from)),
            Paint::Plain(colour) => (&mut solid, colour.map(|part| bright * f64::from(part))),
            Paint::Glass(colour) => (&mut glass, colour.map(|part| bright * f64::from(part))),
        };
        let corners = corners.map(|corner| {
            let [x, y, near] = frame.map(|axis| scale * (corner - camera.centre).dot(&axis));
            [0.5 * fine[0] as f64 + x, 0.5 * fine[1] as f64 - y, near]
        });
        let limit = scale * camera.cut;
        fill(corners, fine, |at, near| {
            if near > layer[at].near && near <= limit {
                layer[at] = Sample { near, normal: seen, colour };
            }
        });
    }
    let shown: Vec<[f64; 3]> = (0..solid.len())
        .map(|at| {
            let colour = solid[at].colour;
            let below =
                if is_edge(&solid, at, fine[0]) { mix(colour, EDGE, EDGE_OPACITY) } else { colour };
            if glass[at].near <= solid[at].near {
                return below;
            }
            let pane = mix(below, glass[at].colour, GLASS_OPACITY);
            if is_edge(&glass, at, fine[0]) { mix(pane, EDGE, EDGE_OPACITY) } else { pane }
        })
        .collect();
    let pixels = (0..size[0] * size[1]).map(|at| {
        let [x, y] = [at % size[0], at / size[0]];
        let mut sum = [0.0; 3];
        for k in 0..FINER * FINER {
            let sample = shown[(y * FINER + k / FINER) * fine[0] + x * FINER + k % FINER];
            sum = [0, 1, 2].map(|part| sum[part] + sample[part]);
        }
        sum.map(|part| (part / (FINER * FINER) as f64).round() as u8)
    });
    Image { size, pixels: pixels.collect() }
}

fn mix(below: [f64; 3], above: [f64; 3], opacity: f64) -> [f64; 3] {
    [0, 1, 2].map(|part| below[part] + opacity * (above[part] - below[part]))
}

/// Returns whether the surface at a sample bends, ends, or hides another one, toward the sample to its right or below it.
fn is_edge(layer: &[Sample], at: usize, width: usize) -> bool {
    let here = layer[at];
    let right = (at % width + 1 < width).then_some((at + 1, 0));
    let below = (at + width < layer.len()).then_some((at + width, 1));
    [right, below].into_iter().flatten().any(|(neighbour, axis)| {
        let there = layer[neighbour];
        match (here.near.is_finite(), there.near.is_finite()) {
            (false, false) => false,
            (true, true) => {
                // On a plane, the distance changes from sample to sample by this. One that is seen from its edge has no slope;
                // the limit stands for a steep one.
                let [one, other] =
                    [here.normal, there.normal].map(|normal| -normal[axis] / normal.z.max(0.05));
                let [low, high] = [one.min(other), one.max(other)];
                let step = there.near - here.near;
                here.normal.dot(&there.normal) < CREASE || step < low - STEP || step > high + STEP
            }
            _ => true,
        }
    })
}

/// Returns twice the area of the triangle of two corners and a point, below 0 if they run the other way.
fn cross(p: [f64; 3], q: [f64; 3], [x, y]: [f64; 2]) -> f64 {
    (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
}

/// Visits the samples whose centres lie in a triangle, with the third coordinate there.
fn fill([a, b, c]: [[f64; 3]; 3], size: [usize; 2], mut visit: impl FnMut(usize, f64)) {
    let area = cross(a, b, [c[0], c[1]]);
    if area == 0.0 {
        return;
    }
    let [columns, rows] = [0, 1].map(|axis| {
        let parts = [a[axis], b[axis], c[axis]];
        let low = parts.into_iter().fold(f64::INFINITY, f64::min).floor().max(0.0) as usize;
        let high = parts.into_iter().fold(0.0, f64::max).ceil() as usize;
        low..high.min(size[axis])
    });
    for y in rows {
        for x in columns.clone() {
            let at = [x as f64 + 0.5, y as f64 + 0.5];
            // Barycentric coordinates, of the same sign in both orientations.
            let shares =
                [cross(b, c, at), cross(c, a, at), cross(a, b, at)].map(|part| part / area);
            if shares.iter().all(|share| *share >= 0.0) {
                visit(y * size[0] + x, shares[0] * a[2] + shares[1] * b[2] + shares[2] * c[2]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plate of two triangles, in the plane z = 0.
    fn plate(paint: Paint) -> Vec<Facet> {
        let corner = |x: f64, y: f64| Point3::new(x, y, 0.0);
        let [a, b, c, d] = [corner(0.0, 0.0), corner(4.0, 0.0), corner(4.0, 4.0), corner(0.0, 4.0)];
        [[a, b, c], [a, c, d]].map(|corners| Facet { corners, paint }).into()
    }

    #[test]
    fn a_value_keeps_its_colour_in_every_view() {
        for view in &VIEWS {
            let facets = plate(Paint::Value([70, 140, 35]));
            let corners = facets.iter().flat_map(|facet| facet.corners);
            let image = render(facets.iter().copied(), &Camera::fitted(view, corners), [60, 60]);
            let middle = image.pixels[30 * 60 + 30];
            assert_eq!(middle, [70, 140, 35], "{}", view.name);
            assert_eq!(image.pixels[0], [255; 3]);
        }
    }

    #[test]
    fn what_is_nearer_than_the_cut_is_left_out() {
        let facets = plate(Paint::Value([70, 140, 35]));
        let corners = facets.iter().flat_map(|facet| facet.corners);
        let camera = Camera::fitted(&VIEWS[2], corners).with_cut(-1.0);
        let image = render(facets.iter().copied(), &camera, [20, 20]);
        assert!(image.pixels.iter().all(|pixel| *pixel == [255; 3]));
    }

    #[test]
    fn glass_shows_what_is_behind_it() {
        let mut facets = plate(Paint::Value([0, 0, 0]));
        facets.extend(plate(Paint::Glass([255, 0, 0])).into_iter().map(|facet| Facet {
            corners: facet.corners.map(|corner| corner + Vector3::z()),
            ..facet
        }));
        let corners = facets.iter().flat_map(|facet| facet.corners);
        let image = render(facets.iter().copied(), &Camera::fitted(&VIEWS[2], corners), [60, 60]);
        let [red, green, blue] = image.pixels[30 * 60 + 25];
        assert!((70..100).contains(&red) && green == 0 && blue == 0, "{red} {green} {blue}");
    }
}

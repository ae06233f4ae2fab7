//! Orthographic rendering of a mesh, with one colour per triangle.

use nalgebra::Vector3;
use touchoff::{Mesh, TriangleId};

/// A view of a part.
#[derive(Clone, Copy)]
pub(super) struct View {
    pub(super) name: &'static str,
    /// Direction from the part to the eye.
    pub(super) toward: [f64; 3],
    /// Upward direction in the picture; not parallel to `toward`.
    pub(super) up: [f64; 3],
}

/// The views that a part is shown in.
pub(super) const VIEWS: [View; 4] = [
    View { name: "from above", toward: [1.0, -1.5, 1.3], up: [0.0, 0.0, 1.0] },
    View { name: "from below", toward: [1.0, -1.5, -1.3], up: [0.0, 0.0, 1.0] },
    View { name: "top", toward: [0.0, 0.0, 1.0], up: [0.0, 1.0, 0.0] },
    View { name: "bottom", toward: [0.0, 0.0, -1.0], up: [0.0, 1.0, 0.0] },
];

/// A picture, row by row from the top, as red, green and blue.
pub(super) struct Image {
    pub(super) side: usize,
    pub(super) pixels: Vec<[u8; 3]>,
}

/// Samples per pixel along each side, for antialiasing.
const FINER: usize = 2;
/// Free margin on each side, as a fraction of the picture.
const MARGIN: f64 = 0.04;
/// Brightness of what lies in the shade, from 0 to 1.
const SHADE: f64 = 0.45;

/// Draws a mesh on white, in a square of `side` by `side` pixels. Triangles that face away are seen from behind.
pub(super) fn render(mesh: &Mesh, colours: &[[u8; 3]], view: &View, side: usize) -> Image {
    let toward = Vector3::from(view.toward).normalize();
    let right = Vector3::from(view.up).cross(&toward).normalize();
    let up = toward.cross(&right);
    let light = (toward + 0.5 * up - 0.4 * right).normalize();
    let [across, along] = [right, up].map(|axis| span(mesh, &axis));
    let fine = side * FINER;
    let scale =
        fine as f64 * (1.0 - 2.0 * MARGIN) / (across[1] - across[0]).max(along[1] - along[0]);
    let to_pixel = |at: f64, [low, high]: [f64; 2]| {
        0.5 * fine as f64 + scale * (at - f64::midpoint(low, high))
    };
    let mut depth = vec![f64::NEG_INFINITY; fine * fine];
    let mut pixels = vec![[255.0; 3]; fine * fine];
    for id in 0..mesh.triangles().len() as u32 {
        let Some(normal) = mesh.normal(TriangleId(id)) else { continue };
        let corners = mesh.triangle(TriangleId(id)).map(|corner| {
            let [x, y, near] = [right, up, toward].map(|axis| corner.coords.dot(&axis));
            [to_pixel(x, across), fine as f64 - to_pixel(y, along), near]
        });
        let facing = if normal.dot(&toward) < 0.0 { -normal } else { normal };
        let bright = SHADE + (1.0 - SHADE) * facing.dot(&light).max(0.0);
        let colour = colours[id as usize].map(|part| f64::from(part) * bright);
        fill(corners, fine, |at, near| {
            if near > depth[at] {
                depth[at] = near;
                pixels[at] = colour;
            }
        });
    }
    let mean = |x: usize, y: usize| {
        let mut sum = [0.0; 3];
        for k in 0..FINER * FINER {
            let pixel = pixels[(y * FINER + k / FINER) * fine + x * FINER + k % FINER];
            sum = [0, 1, 2].map(|part| sum[part] + pixel[part]);
        }
        sum.map(|part| (part / (FINER * FINER) as f64).round() as u8)
    };
    let pixels = (0..side * side).map(|at| mean(at % side, at / side)).collect();
    Image { side, pixels }
}

/// Returns the extent of a mesh along a direction.
fn span(mesh: &Mesh, axis: &Vector3<f64>) -> [f64; 2] {
    let along = mesh.vertices().iter().map(|vertex| vertex.coords.dot(axis));
    along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
}

/// Visits the pixels whose centres lie in a triangle, with the third coordinate there.
fn fill([a, b, c]: [[f64; 3]; 3], side: usize, mut visit: impl FnMut(usize, f64)) {
    let cross = |p: [f64; 3], q: [f64; 3], [x, y]: [f64; 2]| {
        (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
    };
    let area = cross(a, b, [c[0], c[1]]);
    if area == 0.0 {
        return;
    }
    let span = |axis: usize| {
        let parts = [a[axis], b[axis], c[axis]];
        let low = parts.into_iter().fold(f64::INFINITY, f64::min).floor().max(0.0) as usize;
        let high = parts.into_iter().fold(0.0, f64::max).ceil() as usize;
        low..high.min(side)
    };
    for y in span(1) {
        for x in span(0) {
            let at = [x as f64 + 0.5, y as f64 + 0.5];
            let shares =
                [cross(b, c, at), cross(c, a, at), cross(a, b, at)].map(|part| part / area);
            if shares.iter().all(|share| *share >= 0.0) {
                visit(y * side + x, shares[0] * a[2] + shares[1] * b[2] + shares[2] * c[2]);
            }
        }
    }
}

//! A generated part with hollows and bosses.

use nalgebra::Point3;
use touchoff::{Mesh, MeshError, Unit};

/// Width of the block, and height of its bottom, mm.
const WIDTH: f64 = 40.0;
const BOTTOM_HEIGHT: f64 = -16.0;

/// Returns the height of the top, mm: a bowl, a dome, a groove and a step. A ball of 4 mm fits into the bowl, and a
/// ball of 2 mm into the groove.
fn top_height(x: f64, y: f64) -> f64 {
    let dome = (-((x - 9.0).powi(2) + (y - 8.0).powi(2)) / 18.0).exp();
    let bowl = (-((x + 8.0).powi(2) + (y - 7.0).powi(2)) / 24.0).exp();
    let groove = (-((y + 6.0 + 0.1 * x) / 2.2).powi(2)).exp();
    let step = 1.0 / (1.0 + (-(y + 13.0) * 4.0).exp());
    6.0 * dome - 7.0 * bowl - 4.0 * groove + 3.0 * (step - 1.0) + 0.3 * (0.9 * x).sin()
}

/// Returns a block with this top, in mm, closed and oriented outward. Its top has `squares` squares per side; its sides
/// and its bottom are divided into strips.
pub(super) fn relief(squares: u32) -> Result<Mesh, MeshError> {
    let n = squares;
    let coordinate = |k: u32| WIDTH * (f64::from(k) / f64::from(n) - 0.5);
    let mut vertices = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            let [x, y] = [i, j].map(coordinate);
            vertices.push(Point3::new(x, y, top_height(x, y)));
        }
    }
    let top_index = |[i, j]: [u32; 2]| j * (n + 1) + i;
    let mut triangles = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let [a, b, c, d] = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(top_index);
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    // Duplicate the rim, counter-clockwise from above, at the height of the bottom, and add the bottom's centre.
    let side = |side: fn(u32, u32) -> [u32; 2]| (0..n).map(move |k| top_index(side(k, n)));
    let sides = side(|k, _| [k, 0]).chain(side(|k, n| [n, k]));
    let sides = sides.chain(side(|k, n| [n - k, n])).chain(side(|k, n| [0, n - k]));
    let rim: Vec<u32> = sides.collect();
    let first = vertices.len() as u32;
    for k in &rim {
        let Point3 { coords: top } = vertices[*k as usize];
        vertices.push(Point3::new(top.x, top.y, BOTTOM_HEIGHT));
    }
    let bottom_centre = vertices.len() as u32;
    vertices.push(Point3::new(0.0, 0.0, BOTTOM_HEIGHT));
    let count = rim.len() as u32;
    for k in 0..count {
        let next = (k + 1) % count;
        let [a, b] = [rim[k as usize], rim[next as usize]];
        let [c, d] = [first + next, first + k];
        triangles.extend([[a, d, c], [a, c, b], [d, bottom_centre, c]]);
    }
    Mesh::new(vertices, triangles, Unit::Millimetre)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_relief_is_a_solid() {
        let diagnostics = relief(12).expect("a block").diagnostics();
        assert!(diagnostics.is_solid(), "{:?}", diagnostics.findings());
    }
}

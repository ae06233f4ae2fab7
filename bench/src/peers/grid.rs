//! The tool's field in space, at the corners of cubes.
//!
//! Cubes of `CELL` mm over the tool's box and `AROUND` mm about it: 3.2 million `f32`, 13 MB. At
//! the corners stands the magnitude inside and by the surface, and minus the true distance elsewhere;
//! between eight corners it is interpolated. That errs by the order of the cell's square, and by that
//! of the cell where the tool has edges.

use super::formula;
use super::shell::{Field, STEEPEST};
use crate::race::contender::dot;
use std::sync::OnceLock;
use touchoff_tests::oracle::{Oracle, fig_7_3_exact};

/// The side of a cell, mm.
const CELL: f64 = 0.1;
/// How far the grid goes beyond the tool, mm.
const AROUND: f64 = 1.0;
/// The tool's box, from where to where along the axes.
const BOX: [[f64; 2]; 3] = [[-5.0, 5.0], [-5.0, 5.0], [0.0, formula::TIP]];
/// So near to the surface the field is the magnitude, which goes on outside, not the distance.
const BAND: f64 = 2.0 * CELL;

/// The field at the corners of cubes.
#[derive(Clone)]
pub struct Grid {
    count: [usize; 3],
    /// x fastest.
    field: Vec<f32>,
}

impl Grid {
    /// That of the tool, which is worked out once.
    pub fn known() -> Grid {
        static GRID: OnceLock<Grid> = OnceLock::new();
        GRID.get_or_init(Grid::default).clone()
    }
}

impl Default for Grid {
    /// Of the tool.
    fn default() -> Grid {
        let exact = fig_7_3_exact();
        let count =
            BOX.map(|[low, high]| ((high - low + 2.0 * AROUND) / CELL).round() as usize + 1);
        let at = |axis: usize, k: usize| BOX[axis][0] - AROUND + CELL * k as f64;
        let mut field = Vec::with_capacity(count[0] * count[1] * count[2]);
        for k in 0..count[2] {
            for j in 0..count[1] {
                for i in 0..count[0] {
                    let p = [at(0, i), at(1, j), at(2, k)];
                    let distance = exact.signed_distance(p);
                    let value = if distance > BAND { -distance } else { formula::magnitude(p) };
                    field.push(value as f32);
                }
            }
        }
        Grid { count, field }
    }
}

impl Grid {
    /// A point in cells from the grid's corner.
    fn cells(p: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| (p[axis] - BOX[axis][0] + AROUND) / CELL)
    }

    fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.count[1] + j) * self.count[0] + i
    }
}

impl Field for Grid {
    fn clearance(&self, p: [f64; 3]) -> f64 {
        let mut beyond = 0.0;
        let mut corner = [0; 3];
        for (axis, cells) in Self::cells(p).into_iter().enumerate() {
            let most = (self.count[axis] - 1) as f64;
            let held = cells.clamp(0.0, most);
            beyond += (cells - held) * (cells - held);
            corner[axis] = (held + 0.5) as usize;
        }
        let field = -f64::from(self.field[self.index(corner)]);
        let distance = if field > STEEPEST * BAND { field } else { field / STEEPEST };
        // The corner may be half a cell's diagonal away from the point, or from where the point's
        // nearest in the grid is; the tool lies behind that one.
        let distance = (distance - 0.866_1 * CELL).max(0.0);
        (distance * distance + beyond * CELL * CELL).sqrt()
    }

    fn sense(&self, p: [f64; 3]) -> Option<(f64, [f64; 3])> {
        let cells = Self::cells(p);
        let mut corner = [0; 3];
        let mut part = [0.0; 3];
        for axis in 0..3 {
            if cells[axis] < 0.0 || cells[axis] >= (self.count[axis] - 1) as f64 {
                return None;
            }
            corner[axis] = cells[axis] as usize;
            part[axis] = cells[axis] - corner[axis] as f64;
        }
        let [x, y, z] = part;
        let first = self.index(corner);
        let (row, plane) = (self.count[0], self.count[0] * self.count[1]);
        // Along x: values and slopes of four edges.
        let edge = |at: usize| {
            let (low, high) = (f64::from(self.field[at]), f64::from(self.field[at + 1]));
            (low + x * (high - low), high - low)
        };
        let (a, b) = (edge(first), edge(first + row));
        let (c, d) = (edge(first + plane), edge(first + plane + row));
        let (low, high) = (a.0 + y * (b.0 - a.0), c.0 + y * (d.0 - c.0));
        let value = low + z * (high - low);
        if value < 0.0 {
            return None;
        }
        let mix = |a: f64, b: f64, part: f64| a + part * (b - a);
        let away = [
            -mix(mix(a.1, b.1, y), mix(c.1, d.1, y), z),
            -mix(b.0 - a.0, d.0 - c.0, z),
            low - high,
        ];
        let length = dot(away, away).sqrt();
        let way = if length > 0.0 { away.map(|c| c / length) } else { [1.0, 0.0, 0.0] };
        Some((value, way))
    }
}

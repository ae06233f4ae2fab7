//! The tool's field in the half plane through a point and the axis, at the corners of squares.
//!
//! Squares of `CELL` mm: 0.33 million `f32`, 1.3 MB, for the same tool as the grid in space, five
//! times as fine. What stands at the corners is the same.

use super::formula;
use super::shell::{Field, STEEPEST};
use std::sync::OnceLock;
use touchoff_tests::oracle::{Oracle, fig_7_3_exact};

/// The side of a cell, mm.
const CELL: f64 = 0.02;
/// How far the grid goes beyond the tool, mm.
const AROUND: f64 = 1.0;
/// So near to the surface the field is the magnitude, which goes on outside, not the distance.
const BAND: f64 = 2.0 * CELL;

/// The field at the corners of squares.
#[derive(Clone)]
pub struct GridDz {
    /// Corners along d and along z.
    count: [usize; 2],
    /// d fastest.
    field: Vec<f32>,
}

impl GridDz {
    /// That of the tool, which is worked out once.
    pub fn known() -> GridDz {
        static GRID: OnceLock<GridDz> = OnceLock::new();
        GRID.get_or_init(GridDz::default).clone()
    }
}

impl Default for GridDz {
    /// Of the tool.
    fn default() -> GridDz {
        let exact = fig_7_3_exact();
        let cells = |length: f64| (length / CELL).round() as usize + 1;
        let count = [cells(formula::RADIUS + AROUND), cells(formula::TIP + 2.0 * AROUND)];
        let mut field = Vec::with_capacity(count[0] * count[1]);
        for j in 0..count[1] {
            for i in 0..count[0] {
                let p = [CELL * i as f64, 0.0, CELL * j as f64 - AROUND];
                let distance = exact.signed_distance(p);
                let value = if distance > BAND { -distance } else { formula::magnitude(p) };
                field.push(value as f32);
            }
        }
        GridDz { count, field }
    }
}

impl GridDz {
    /// Distance from the axis, and both coordinates in cells.
    fn cells(p: [f64; 3]) -> (f64, [f64; 2]) {
        let d = (p[0] * p[0] + p[1] * p[1]).sqrt();
        (d, [d / CELL, (p[2] + AROUND) / CELL])
    }
}

impl Field for GridDz {
    fn clearance(&self, p: [f64; 3]) -> f64 {
        let mut beyond = 0.0;
        let mut corner = [0; 2];
        for (axis, cells) in Self::cells(p).1.into_iter().enumerate() {
            let held = cells.clamp(0.0, (self.count[axis] - 1) as f64);
            beyond += (cells - held) * (cells - held);
            corner[axis] = (held + 0.5) as usize;
        }
        let field = -f64::from(self.field[corner[1] * self.count[0] + corner[0]]);
        let distance = if field > STEEPEST * BAND { field } else { field / STEEPEST };
        // The corner may be half a cell's diagonal away from the point, or from where the point's
        // nearest in the grid is; the tool lies behind that one.
        let distance = (distance - 0.707_2 * CELL).max(0.0);
        (distance * distance + beyond * CELL * CELL).sqrt()
    }

    fn sense(&self, p: [f64; 3]) -> Option<(f64, [f64; 3])> {
        let (d, [across, along]) = Self::cells(p);
        let most = self.count.map(|count| (count - 1) as f64);
        if across >= most[0] || !(0.0..most[1]).contains(&along) {
            return None;
        }
        let (i, j) = (across as usize, along as usize);
        let (x, z) = (across - i as f64, along - j as f64);
        let at = j * self.count[0] + i;
        let edge = |at: usize| {
            let (near, far) = (f64::from(self.field[at]), f64::from(self.field[at + 1]));
            (near + x * (far - near), far - near)
        };
        let (low, high) = (edge(at), edge(at + self.count[0]));
        let value = low.0 + z * (high.0 - low.0);
        if value < 0.0 {
            return None;
        }
        let (out, up) = (-(low.1 + z * (high.1 - low.1)), low.0 - high.0);
        let length = (out * out + up * up).sqrt();
        if length == 0.0 || d == 0.0 {
            return Some((value, [1.0, 0.0, 0.0]));
        }
        let radial = out / (length * d);
        Some((value, [radial * p[0], radial * p[1], up / length]))
    }
}

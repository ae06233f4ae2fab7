//! The commands `sweep`, `map` and `path`: try tool postures at every triangle, print or draw the result, and plan a
//! path over it. `picture` draws a map on its part; `post` and `joints` write G-code, and `prove` checks what is written.

mod joints;
mod left_out;
pub(crate) mod map;
pub(crate) mod path;
pub(crate) mod picture;
mod post;
mod prove;
mod refine;
pub(crate) mod sweep;
mod touched;

use touchoff::{Mesh, TriangleId, Unit};

/// Formats a fraction in percent; 0 % of an empty whole.
fn percent(amount: f64, whole: f64) -> String {
    format!("{:.1} %", if whole > 0.0 { 100.0 * amount / whole } else { 0.0 })
}

/// A number of triangles, and an area.
#[derive(Clone, Copy, Default)]
struct TriangleTotals {
    triangles: usize,
    /// In the square of the mesh's unit.
    area: f64,
}

impl TriangleTotals {
    /// Counts the triangles of which a fraction above 0 belongs to a set, and adds up the area of the set.
    fn count(mesh: &Mesh, fraction: impl Fn(TriangleId) -> f64) -> TriangleTotals {
        mesh.ids().fold(TriangleTotals::default(), |totals, id| TriangleTotals {
            triangles: totals.triangles + usize::from(fraction(id) > 0.0),
            area: totals.area + fraction(id) * mesh.area(id),
        })
    }

    /// Formats these totals as percentages of `all`.
    fn percent_of(self, all: TriangleTotals) -> String {
        let triangles = percent(self.triangles as f64, all.triangles as f64);
        format!("{triangles} of the triangles, {} of the area", percent(self.area, all.area))
    }
}

/// Returns the default depth tolerance of postures, 0.01 mm, in `unit`. Recordings of the haptic loop use it too.
pub(crate) fn default_tolerance(unit: Unit) -> f64 {
    0.01 * Unit::Millimetre.factor_to(unit)
}

#[cfg(test)]
mod tests {
    use super::percent;

    #[test]
    fn nothing_is_no_percentage_of_nothing() {
        assert_eq!(percent(0.0, 0.0), "0.0 %");
        assert_eq!(percent(3.0, 0.0), "0.0 %");
        assert_eq!(percent(1.0, 8.0), "12.5 %");
    }
}

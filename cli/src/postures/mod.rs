//! The posture commands: sweeps, maps and paths.

pub(crate) mod map;
pub(crate) mod path;
mod picture;
mod render;
pub(crate) mod sweep;

use touchoff::{Mesh, TriangleId, Unit};

/// Formats a share of a whole in percent.
fn percent(part: f64, whole: f64) -> String {
    format!("{:.1} %", 100.0 * part / if whole > 0.0 { whole } else { 1.0 })
}

/// The number of triangles in a set, and their total area.
#[derive(Clone, Copy, Default)]
struct Share {
    triangles: usize,
    area: f64,
}

impl Share {
    /// Counts the triangles of a mesh for which `predicate` holds.
    fn of_all(mesh: &Mesh, predicate: impl Fn(TriangleId) -> bool) -> Share {
        let ids = (0..mesh.triangles().len() as u32).map(TriangleId).filter(|id| predicate(*id));
        ids.fold(Share::default(), |share, id| Share {
            triangles: share.triangles + 1,
            area: share.area + mesh.area(id),
        })
    }

    fn of(self, all: Share) -> String {
        let triangles = percent(self.triangles as f64, all.triangles as f64);
        format!("{triangles} of the triangles, {} of the area", percent(self.area, all.area))
    }
}

/// Returns the default tolerance, a hundredth of a millimetre, in a unit.
pub(crate) fn default_tolerance(unit: Unit) -> f64 {
    0.01 * Unit::Millimetre.factor_to(unit)
}

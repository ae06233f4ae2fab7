//! Where tools stand well at a part: found without a hand, looked at, led over.

pub(crate) mod map;
pub(crate) mod path;
mod picture;
mod render;
pub(crate) mod sweep;

use touchoff::{Mesh, Unit};

/// A share of the whole.
fn percent(part: f64, whole: f64) -> String {
    format!("{:.1} %", 100.0 * part / if whole > 0.0 { whole } else { 1.0 })
}

/// Of some triangles how many there are, and their area as a share of the part's.
#[derive(Clone, Copy, Default)]
struct Share {
    triangles: usize,
    area: f64,
}

impl Share {
    /// Those of a mesh that are meant.
    fn of_all(mesh: &Mesh, meant: impl Fn(u32) -> bool) -> Share {
        let ids = (0..mesh.triangles().len() as u32).filter(|id| meant(*id));
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

/// The tolerance if none is given: a hundredth of a millimetre.
pub(crate) fn usual(unit: Unit) -> f64 {
    0.01 * Unit::Millimetre.to(unit)
}

//! Other methods, where the feature `peers` has them.

use super::lineup::{Kind, Lineup};
use touchoff::Mesh;

#[cfg(feature = "peers")]
mod built {
    use super::{Kind, Lineup, Mesh};
    use crate::peers::{brute, fidget, parry_bvh, parry_contact, thesis};
    use crate::race::contender::{Contender, Workpiece};
    use crate::work_precision::row::Label;

    fn piece(mesh: &Mesh, kind: &Kind) -> Workpiece {
        Workpiece { mesh: mesh.clone(), cloud: kind.cloud.clone(), part: kind.part.clone() }
    }

    pub(super) fn points(lineup: &mut Lineup<'_>, mesh: &Mesh, kind: &Kind) {
        let piece = piece(mesh, kind);
        let all: [Box<dyn Contender>; 5] = [
            Box::new(brute::Scalar::new(&piece)),
            Box::new(brute::Lanes::new(&piece)),
            Box::new(thesis::Thesis::new(&piece)),
            Box::new(parry_bvh::ParryBvh::new(&piece)),
            Box::new(fidget::Fidget::new(&piece)),
        ];
        for contender in all {
            lineup.add_of_the_thesis(kind.label(contender.name()), contender);
        }
    }

    pub(super) fn triangles(lineup: &mut Lineup<'_>, mesh: &Mesh) {
        let contact = parry_contact::ParryContact::new(mesh);
        lineup.add(Label::triangles(contact.name()), Box::new(contact));
    }
}

/// Those that ask points.
pub(super) fn add_points(lineup: &mut Lineup<'_>, mesh: &Mesh, kind: &Kind) {
    #[cfg(feature = "peers")]
    built::points(lineup, mesh, kind);
    #[cfg(not(feature = "peers"))]
    let _ = (lineup, mesh, kind);
}

/// Those that ask the part's triangles: they know the solid, not the thesis's magnitudes.
pub(super) fn add_triangles(lineup: &mut Lineup<'_>, mesh: &Mesh) {
    #[cfg(feature = "peers")]
    built::triangles(lineup, mesh);
    #[cfg(not(feature = "peers"))]
    let _ = (lineup, mesh);
}

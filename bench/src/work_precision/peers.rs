//! Other methods, if the feature `peers` is enabled.

use super::lineup::{Kind, Lineup};
use touchoff::Mesh;

#[cfg(feature = "peers")]
mod built {
    use super::{Kind, Lineup, Mesh};
    use crate::peers::{brute, fidget, parry_bvh, parry_contact, thesis};
    use crate::race::contender::Contender;
    use crate::work_precision::row::Label;

    pub(super) fn points(lineup: &mut Lineup<'_>, kind: &Kind) {
        let all: [Box<dyn Contender>; 5] = [
            Box::new(brute::Scalar::new(&kind.cloud)),
            Box::new(brute::Lanes::new(&kind.cloud)),
            Box::new(thesis::Thesis::new(&kind.cloud)),
            Box::new(parry_bvh::ParryBvh::new(&kind.cloud)),
            Box::new(fidget::Fidget::new(&kind.cloud)),
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

/// Adds the methods that use points.
pub(super) fn add_points(lineup: &mut Lineup<'_>, kind: &Kind) {
    #[cfg(feature = "peers")]
    built::points(lineup, kind);
    #[cfg(not(feature = "peers"))]
    let _ = (lineup, kind);
}

/// Adds the methods that use the part's triangles. They know the solid, not the thesis's magnitudes.
pub(super) fn add_triangles(lineup: &mut Lineup<'_>, mesh: &Mesh) {
    #[cfg(feature = "peers")]
    built::triangles(lineup, mesh);
    #[cfg(not(feature = "peers"))]
    let _ = (lineup, mesh);
}

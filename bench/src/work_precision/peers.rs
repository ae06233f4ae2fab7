//! Other methods, if the feature `peers` is enabled.

use super::lineup::{LabelledCloud, Lineup};
use touchoff::Mesh;

#[cfg(feature = "peers")]
mod built {
    use super::{LabelledCloud, Lineup, Mesh};
    use crate::peers::{brute, fidget, parry_bvh, parry_contact, thesis};
    use crate::race::contender::Contender;
    use crate::work_precision::row::Label;

    pub(super) fn points(lineup: &mut Lineup<'_>, cloud: &LabelledCloud) {
        let contenders: [Box<dyn Contender>; 5] = [
            Box::new(brute::Scalar::new(&cloud.cloud)),
            Box::new(brute::Lanes::new(&cloud.cloud)),
            Box::new(thesis::Thesis::new(&cloud.cloud)),
            Box::new(parry_bvh::ParryBvh::new(&cloud.cloud)),
            Box::new(fidget::Fidget::new(&cloud.cloud)),
        ];
        for contender in contenders {
            lineup.add_with_thesis_magnitudes(cloud.label(contender.name()), contender);
        }
    }

    pub(super) fn triangles(lineup: &mut Lineup<'_>, mesh: &Mesh) {
        let contact = parry_contact::ParryContact::new(mesh);
        lineup.add(Label::triangles(contact.name()), Box::new(contact));
    }
}

/// Adds the methods that use points.
pub(super) fn add_points(lineup: &mut Lineup<'_>, cloud: &LabelledCloud) {
    #[cfg(feature = "peers")]
    built::points(lineup, cloud);
    #[cfg(not(feature = "peers"))]
    let _ = (lineup, cloud);
}

/// Adds the methods that use the part's triangles. They know the solid, not the thesis's magnitudes.
pub(super) fn add_triangles(lineup: &mut Lineup<'_>, mesh: &Mesh) {
    #[cfg(feature = "peers")]
    built::triangles(lineup, mesh);
    #[cfg(not(feature = "peers"))]
    let _ = (lineup, mesh);
}

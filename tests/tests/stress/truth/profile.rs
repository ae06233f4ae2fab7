//! Tools defined by profiles: depth is the distance to the nearest feature.

use super::{ExactPoint, RegionValues, Truth};
use touchoff::Tool;
use touchoff_tests::oracle::Nearest;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::reference::{QueryPoint, Reference};
use touchoff_tests::oracle::restated::Restated;
use touchoff_tests::profiles::owners;

/// The true values of a profile tool, from its restatement.
pub(crate) struct Profiled {
    reference: Reference,
    /// The owners in the reference that each region in the tool info corresponds to.
    owners: Vec<Vec<usize>>,
}

impl Profiled {
    pub(crate) fn new(tool: &dyn Tool, restated: &Restated) -> Profiled {
        let owners = owners(tool, &Nearest::new(restated));
        Profiled { reference: Reference::new(restated), owners }
    }
}

impl Truth for Profiled {
    fn scale(&self) -> f64 {
        self.reference.scale()
    }

    fn depth(&self, p: &ExactPoint) -> Big {
        self.reference.depth(&QueryPoint::of(p.clone()))
    }

    fn owner(&self, p: &ExactPoint) -> Option<usize> {
        let owner = self.reference.owner(&QueryPoint::of(p.clone()))?;
        self.owners.iter().position(|owners| owners.contains(&owner))
    }

    fn region_values(&self, p: &ExactPoint, region: usize) -> Option<RegionValues> {
        let point = QueryPoint::of(p.clone());
        let distance_to = |owner: &usize| self.reference.distance_to(&point, *owner);
        let mut nearest = None;
        for owner in self.owners.get(region)? {
            let distance = distance_to(owner);
            if nearest.as_ref().is_none_or(|(min_distance, _)| distance < *min_distance) {
                nearest = Some((distance, *owner));
            }
        }
        let (depth, owner) = nearest?;
        Some(RegionValues {
            excess_distance: (&depth - &self.reference.depth(&point).abs()).to_f64().max(0.0),
            direction: self.reference.direction(&point, owner),
            singularity_distance: self.reference.singularity_distance(&point, owner),
            depth,
        })
    }
}

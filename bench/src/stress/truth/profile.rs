//! Tools defined by profiles: depth is the distance to the nearest feature.

use super::{Claim, Place, Truth};
use touchoff::Tool;
use touchoff_tests::accuracy;
use touchoff_tests::oracle::Nearest;
use touchoff_tests::oracle::reference::{At, Reference};
use touchoff_tests::oracle::restated::Restated;

/// The true values of a profile tool, from its restatement.
pub struct Profiled {
    reference: Reference,
    /// The owners in the reference that each region in the tool info corresponds to.
    owners: Vec<Vec<usize>>,
}

impl Profiled {
    /// Computes the true values of a tool from its restatement.
    pub fn new(tool: &dyn Tool, restated: &Restated) -> Profiled {
        let owners = accuracy::owners(tool, &Nearest::new(restated));
        Profiled { reference: Reference::new(restated), owners }
    }
}

impl Truth for Profiled {
    fn scale(&self) -> f64 {
        self.reference.scale()
    }

    fn depth(&self, p: &Place) -> touchoff_tests::oracle::big::Big {
        self.reference.depth(&At::of(p.clone()))
    }

    fn owner(&self, p: &Place) -> Option<usize> {
        let owner = self.reference.owner(&At::of(p.clone()))?;
        self.owners.iter().position(|owners| owners.contains(&owner))
    }

    fn claim(&self, p: &Place, region: usize) -> Option<Claim> {
        let point = At::of(p.clone());
        let distance_to = |owner: &usize| self.reference.distance_to(&point, *owner);
        let mut nearest = None;
        for owner in self.owners.get(region)? {
            let distance = distance_to(owner);
            if nearest.as_ref().is_none_or(|(min_distance, _)| distance < *min_distance) {
                nearest = Some((distance, *owner));
            }
        }
        let (depth, owner) = nearest?;
        Some(Claim {
            behind: (&depth - &self.reference.depth(&point).abs()).to_f64().max(0.0),
            direction: self.reference.direction(&point, owner),
            singular: self.reference.singular(&point, owner),
            depth,
        })
    }
}

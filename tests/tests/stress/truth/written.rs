//! The thesis's tool with its own magnitudes, and the two solids, in 256 bits.

use super::{ExactPoint, RegionValues, Truth};
use touchoff::Tool;
use touchoff_tests::oracle::Body;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::fig73::{REGIONS, ThesisPoint};
use touchoff_tests::oracle::reference::{QueryPoint, Reference, power_above};
use touchoff_tests::oracle::restated::Restated;

/// Returns the place in a list of names of each region in the tool info.
fn indices(tool: &dyn Tool, names: &[&str]) -> Vec<Option<usize>> {
    let index_of = |name: &str| names.iter().position(|known| *known == name);
    tool.info().regions.iter().map(|region| index_of(&region.name)).collect()
}

/// Returns the region in the tool info that has a place in the list of names.
fn region_of(indices: &[Option<usize>], place: usize) -> Option<usize> {
    indices.iter().position(|index| *index == Some(place))
}

/// The true values of `Fig73`: its magnitude inside, and the distance from its solid outside.
pub(super) struct Magnitudes {
    solid: Reference,
    indices: Vec<Option<usize>>,
}

impl Magnitudes {
    pub(super) fn new(tool: &dyn Tool, solid: &Restated) -> Magnitudes {
        Magnitudes { solid: Reference::new(solid), indices: indices(tool, &REGIONS) }
    }
}

impl Truth for Magnitudes {
    fn scale(&self) -> f64 {
        self.solid.scale()
    }

    fn depth(&self, p: &ExactPoint) -> Big {
        let at = QueryPoint::of(p.clone());
        let point = ThesisPoint::new(at.dz());
        match point.owner() {
            Some(region) => point.magnitude(region),
            None => -&self.solid.depth(&at).abs(),
        }
    }

    fn owner(&self, p: &ExactPoint) -> Option<usize> {
        let owner = ThesisPoint::new(QueryPoint::of(p.clone()).dz()).owner()?;
        region_of(&self.indices, owner)
    }

    fn region_values(&self, p: &ExactPoint, region: usize) -> Option<RegionValues> {
        let region = (*self.indices.get(region)?)?;
        let at = QueryPoint::of(p.clone());
        let point = ThesisPoint::new(at.dz());
        Some(RegionValues {
            depth: point.magnitude(region),
            excess_distance: point.outside(region).to_f64(),
            direction: at.lift(&point.direction(region)),
            singularity_distance: point.singularity_distance(region),
        })
    }
}

pub(super) struct Faces {
    body: Body,
    size: f64,
    indices: Vec<Option<usize>>,
}

impl Faces {
    pub(super) fn new(tool: &dyn Tool, body: Body) -> Faces {
        use touchoff_tests::oracle::Oracle;
        let size = body.extent().into_iter().fold(0.0, f64::max);
        Faces { body, size, indices: indices(tool, &body.regions()) }
    }
}

impl Truth for Faces {
    fn scale(&self) -> f64 {
        power_above(self.size)
    }

    fn depth(&self, p: &ExactPoint) -> Big {
        self.body.depth(p)
    }

    fn owner(&self, p: &ExactPoint) -> Option<usize> {
        let (region, inward) = self.body.nearest(p);
        if inward.is_negative() { None } else { region_of(&self.indices, region) }
    }

    fn region_values(&self, p: &ExactPoint, region: usize) -> Option<RegionValues> {
        let region = (*self.indices.get(region)?)?;
        let face = self.body.face(region);
        Some(RegionValues {
            depth: face.inward(p),
            excess_distance: self.body.excess_distance(region, p).to_f64(),
            direction: face.direction(p),
            singularity_distance: face.singularity_distance(p),
        })
    }
}

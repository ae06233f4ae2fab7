//! True values at points in 256 bits, for every library tool: of a profile from its restatement, of the thesis's tool
//! and the two solids from equations written separately.

use crate::prelude::*;
use touchoff::Tool;
use touchoff_tests::oracle::fig73::{REGIONS, ThesisPoint};
use touchoff_tests::oracle::reference::{Reference, power_above};
use touchoff_tests::oracle::restated::Restated;
use touchoff_tests::oracle::{Body, Fig73, Meridian, restated};
use touchoff_tests::profiles::{self, owners};

pub(crate) use touchoff_tests::oracle::space::{Triple as ExactPoint, exactly as to_exact};

/// The values of a region at a point, whether or not the region owns the point.
pub(crate) struct RegionValues {
    /// The depth by the region's own formula, or the magnitude if the tool takes that as its depth.
    pub(crate) depth: Big,
    /// Distance by which the point misses the region: the excess of the distance to the region's surface over that to
    /// the nearest surface, or the violation of its conditions.
    pub(crate) excess_distance: f64,
    /// The unit vector toward the region's surface.
    pub(crate) direction: ExactPoint,
    /// The distance to the nearest point at which the direction is undefined.
    pub(crate) singularity_distance: f64,
}

pub(crate) trait Truth: Send + Sync {
    /// Returns S, the next power of two above the tool's largest coordinate.
    fn scale(&self) -> f64;

    /// Returns 1 ulp(S).
    fn ulp(&self) -> f64 {
        f64::EPSILON * self.scale()
    }

    /// Returns the depth of a point inside, 0 on the surface, and minus the distance from the surface outside.
    fn depth(&self, p: &ExactPoint) -> Big;

    /// Returns the index of the region that owns a point, in the tool's list. On a border it is one of the neighbours.
    fn owner(&self, p: &ExactPoint) -> Option<usize>;

    /// Returns the values of a region at a point, or `None` if there is no such region.
    fn region_values(&self, p: &ExactPoint, region: usize) -> Option<RegionValues>;
}

/// A library tool, its true values, and an oracle in doubles for finding points.
pub(crate) struct Subject {
    pub(crate) tool: &'static dyn Tool,
    pub(crate) truth: Box<dyn Truth>,
    pub(crate) oracle: Box<dyn Oracle>,
}

impl Subject {
    pub(crate) fn name(&self) -> &'static str {
        self.oracle.name()
    }

    /// Returns S.
    pub(crate) fn scale(&self) -> f64 {
        self.truth.scale()
    }
}

/// Returns every library tool, sorted by name.
pub(crate) fn subjects() -> Vec<Subject> {
    let find = |name: &str| touchoff_tools::find(name).expect("a tool of the library");
    let mut subjects: Vec<Subject> = profiles::tools()
        .into_iter()
        .map(|(tool, restated)| Subject {
            tool,
            truth: Box::new(Profiled::new(tool, &restated)),
            oracle: Box::new(Nearest::new(&restated)),
        })
        .collect();
    let exact = restated::of("Fig73Exact").expect("it is restated");
    subjects.push(Subject {
        tool: find("Fig73"),
        truth: Box::new(Magnitudes::new(find("Fig73"), &exact)),
        oracle: Box::new(Fig73::default()),
    });
    for body in [Body::Block, Body::LBracket] {
        let tool = find(body.name());
        let truth = Box::new(Faces::new(tool, body));
        subjects.push(Subject { tool, truth, oracle: Box::new(body) });
    }
    subjects.sort_by_key(Subject::name);
    subjects
}

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
        self.reference.depth(&Meridian::of(p.clone()))
    }

    fn owner(&self, p: &ExactPoint) -> Option<usize> {
        let owner = self.reference.owner(&Meridian::of(p.clone()))?;
        self.owners.iter().position(|owners| owners.contains(&owner))
    }

    fn region_values(&self, p: &ExactPoint, region: usize) -> Option<RegionValues> {
        let point = Meridian::of(p.clone());
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
struct Magnitudes {
    solid: Reference,
    indices: Vec<Option<usize>>,
}

impl Magnitudes {
    fn new(tool: &dyn Tool, solid: &Restated) -> Magnitudes {
        Magnitudes { solid: Reference::new(solid), indices: indices(tool, &REGIONS) }
    }
}

impl Truth for Magnitudes {
    fn scale(&self) -> f64 {
        self.solid.scale()
    }

    fn depth(&self, p: &ExactPoint) -> Big {
        let at = Meridian::of(p.clone());
        let point = ThesisPoint::new(&at.dz);
        match point.owner() {
            Some(region) => point.magnitude(region),
            None => -&self.solid.depth(&at).abs(),
        }
    }

    fn owner(&self, p: &ExactPoint) -> Option<usize> {
        let owner = ThesisPoint::new(&Meridian::of(p.clone()).dz).owner()?;
        region_of(&self.indices, owner)
    }

    fn region_values(&self, p: &ExactPoint, region: usize) -> Option<RegionValues> {
        let region = (*self.indices.get(region)?)?;
        let at = Meridian::of(p.clone());
        let point = ThesisPoint::new(&at.dz);
        Some(RegionValues {
            depth: point.magnitude(region),
            excess_distance: point.outside(region).to_f64(),
            direction: at.lift(&point.direction(region)),
            singularity_distance: point.singularity_distance(region),
        })
    }
}

struct Faces {
    body: Body,
    size: f64,
    indices: Vec<Option<usize>>,
}

impl Faces {
    fn new(tool: &dyn Tool, body: Body) -> Faces {
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

/// The true values agree with the oracles in doubles, on which points are chosen.
#[test]
fn agrees_with_the_oracles_in_doubles() {
    let subjects = subjects();
    assert_eq!(subjects.len(), touchoff_tools::TOOLS.len());
    for subject in &subjects {
        let (oracle, scale) = (&subject.oracle, subject.scale());
        let [radius, height] = oracle.extent();
        let mut rng = Rng::new(3);
        for _ in 0..700 {
            let [x, y] = [0; 2].map(|_| rng.between(-1.1 * radius, 1.1 * radius));
            let p = [x, y, rng.between(-0.1 * height, 1.1 * height)];
            let name = subject.name();
            let depth = subject.truth.depth(&to_exact(p)).to_f64();
            let evaluation = oracle.evaluate(p);
            let expected = evaluation.map_or_else(|| -oracle.signed_distance(p), |s| s.magnitude);
            assert!((depth - expected).abs() < 1e-13 * scale, "{name} {p:?}");
            let owner = subject.truth.owner(&to_exact(p));
            assert_eq!(owner.is_some(), evaluation.is_some(), "{name} {p:?}");
            let (Some(owner), Some(evaluation)) = (owner, evaluation) else { continue };
            let values =
                subject.truth.region_values(&to_exact(p), owner).expect("it owns the point");
            assert_eq!(values.excess_distance, 0.0, "{name} {p:?}");
            assert!((values.depth.to_f64() - expected).abs() < 1e-13 * scale, "{name} {p:?}");
            let singularity_distance = oracle.singularity_distance(p);
            let difference = (values.singularity_distance - singularity_distance).abs();
            let is_same = values.singularity_distance == singularity_distance;
            assert!(is_same || difference < 1e-12 * scale, "{name} {p:?}");
            for (u, v) in values.direction.iter().zip(evaluation.direction) {
                let tolerance = 1e-13 * (1.0 + scale / singularity_distance);
                assert!((u.to_f64() - v).abs() < tolerance, "{name} {p:?}");
            }
        }
    }
}

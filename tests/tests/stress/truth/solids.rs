//! The block and the bracket in 256 bits: the distance to each face, and the faces that are relevant at each point.

use super::{ExactPoint, RegionValues, Truth};
use touchoff::Tool;
use touchoff_tests::oracle::big::Big;

/// The true values of a solid.
pub(super) struct Faces {
    shape: Shape,
    /// The index in [`Shape::regions`] of each region in the tool info.
    indices: Vec<Option<usize>>,
}

#[derive(Clone, Copy)]
enum Shape {
    Block,
    Bracket,
}

/// The nearest feature of a region.
#[derive(Clone, Copy)]
enum Face {
    /// The plane on which a coordinate equals `at`. The depth is `sign * (coordinate - at)`, so `sign` gives the side
    /// of the material.
    Plane { axis: usize, at: f64, sign: f64 },
    /// Both planes `y = ±half`.
    Sides { half: f64 },
    /// The wall of the hole.
    Bore,
    /// The inner edge.
    Edge,
}

/// The zone of the solid in which a region may lie.
#[derive(Clone, Copy, PartialEq)]
enum Zone {
    Anywhere,
    /// The horizontal leg, up to the inner edge.
    Lying,
    /// The part below and behind the inner edge.
    Heel,
    /// The vertical leg, from the inner edge upward.
    Standing,
}

const WALL: f64 = -4.0;
const LEDGE: f64 = 6.0;

const fn plane(axis: usize, at: f64, sign: f64) -> Face {
    Face::Plane { axis, at, sign }
}

const BLOCK: [(&str, Zone, Face); 6] = [
    ("left", Zone::Anywhere, plane(0, -20.0, 1.0)),
    ("right", Zone::Anywhere, plane(0, 20.0, -1.0)),
    ("front", Zone::Anywhere, plane(1, -15.0, 1.0)),
    ("back", Zone::Anywhere, plane(1, 15.0, -1.0)),
    ("bottom", Zone::Anywhere, plane(2, 0.0, 1.0)),
    ("top", Zone::Anywhere, plane(2, 20.0, -1.0)),
];

const BRACKET: [(&str, Zone, Face); 13] = [
    ("lying_bottom", Zone::Lying, plane(2, 0.0, 1.0)),
    ("lying_top", Zone::Lying, plane(2, LEDGE, -1.0)),
    ("lying_end", Zone::Lying, plane(0, 20.0, -1.0)),
    ("lying_side", Zone::Lying, Face::Sides { half: 10.0 }),
    ("bore", Zone::Lying, Face::Bore),
    ("heel_bottom", Zone::Heel, plane(2, 0.0, 1.0)),
    ("heel_back", Zone::Heel, plane(0, -10.0, 1.0)),
    ("heel_side", Zone::Heel, Face::Sides { half: 10.0 }),
    ("heel_edge", Zone::Heel, Face::Edge),
    ("standing_back", Zone::Standing, plane(0, -10.0, 1.0)),
    ("standing_inner", Zone::Standing, plane(0, WALL, -1.0)),
    ("standing_side", Zone::Standing, Face::Sides { half: 10.0 }),
    ("standing_top", Zone::Standing, plane(2, 24.0, -1.0)),
];

impl Shape {
    fn regions(self) -> &'static [(&'static str, Zone, Face)] {
        match self {
            Shape::Block => &BLOCK,
            Shape::Bracket => &BRACKET,
        }
    }
}

fn length(a: &Big, b: &Big) -> Big {
    (&(a * a) + &(b * b)).sqrt()
}

/// Returns the vector from the hole's axis.
fn from_bore_axis(p: &ExactPoint) -> [Big; 2] {
    [&p[0] - &Big::exactly(10.0), p[1].clone()]
}

/// Returns the vector from the inner edge.
fn from_edge(p: &ExactPoint) -> [Big; 2] {
    [&p[0] - &Big::exactly(WALL), &p[2] - &Big::exactly(LEDGE)]
}

impl Face {
    /// Returns the signed distance inside the face; for the edge, the distance from it.
    fn inward(self, p: &ExactPoint) -> Big {
        match self {
            Face::Plane { axis, at, sign } => &Big::exactly(sign) * &(&p[axis] - &Big::exactly(at)),
            Face::Sides { half } => &Big::exactly(half) - &p[1].abs(),
            Face::Bore => {
                let [x, y] = from_bore_axis(p);
                &length(&x, &y) - &Big::decimal(3.3)
            }
            Face::Edge => {
                let [x, z] = from_edge(p);
                length(&x, &z)
            }
        }
    }

    fn direction(self, p: &ExactPoint) -> ExactPoint {
        let zero = Big::zero;
        match self {
            Face::Plane { axis, sign, .. } => {
                std::array::from_fn(|k| if k == axis { Big::exactly(-sign) } else { zero() })
            }
            Face::Sides { .. } => {
                let sign = if p[1].is_negative() { -1.0 } else { 1.0 };
                [zero(), Big::exactly(sign), zero()]
            }
            Face::Bore => {
                let [x, y] = from_bore_axis(p);
                let norm = length(&x, &y);
                [-&(&x / &norm), -&(&y / &norm), zero()]
            }
            Face::Edge => {
                let [x, z] = from_edge(p);
                match length(&x, &z) {
                    norm if norm == zero() => [zero(), zero(), Big::exactly(1.0)],
                    norm => [-&(&x / &norm), zero(), -&(&z / &norm)],
                }
            }
        }
    }

    /// Returns the distance to the nearest point at which the direction is undefined, or for which another direction is
    /// equally good.
    fn singularity_distance(self, p: &ExactPoint) -> f64 {
        match self {
            Face::Plane { .. } => f64::INFINITY,
            Face::Sides { .. } => f64::INFINITY,
            Face::Bore | Face::Edge => {
                let [a, b] =
                    if matches!(self, Face::Bore) { from_bore_axis(p) } else { from_edge(p) };
                length(&a, &b).to_f64()
            }
        }
    }
}

/// Returns the distance by which a point is outside a zone.
fn distance_from_zone(zone: Zone, p: &ExactPoint) -> Big {
    let [beyond_wall, above_ledge] = from_edge(p);
    let max = |a: Big, b: Big| if a > b { a } else { b };
    let signed = match zone {
        Zone::Anywhere => Big::zero(),
        Zone::Lying => -&beyond_wall,
        Zone::Heel => max(beyond_wall, above_ledge),
        Zone::Standing => max(beyond_wall, -&above_ledge),
    };
    max(signed, Big::zero())
}

impl Faces {
    pub(super) fn block(tool: &dyn Tool) -> Faces {
        Faces::new(tool, Shape::Block)
    }

    pub(super) fn bracket(tool: &dyn Tool) -> Faces {
        Faces::new(tool, Shape::Bracket)
    }

    fn new(tool: &dyn Tool, shape: Shape) -> Faces {
        let index_of = |name: &str| shape.regions().iter().position(|region| region.0 == name);
        let indices = tool.info().regions.iter().map(|region| index_of(&region.name)).collect();
        Faces { shape, indices }
    }

    /// Returns the nearest face in the point's zone, and the depth of the point, negative outside. Zones meet in
    /// planes; there the zone counts in which the point is deeper.
    fn nearest(&self, p: &ExactPoint) -> (usize, Big) {
        let zones = [Zone::Anywhere, Zone::Lying, Zone::Heel, Zone::Standing];
        let containing =
            zones.into_iter().filter(|zone| distance_from_zone(*zone, p) == Big::zero());
        let mut best: Option<(usize, Big)> = None;
        for candidate in containing.filter_map(|zone| self.nearest_in(zone, p)) {
            if best.as_ref().is_none_or(|(_, max_depth)| candidate.1 > *max_depth) {
                best = Some(candidate);
            }
        }
        best.expect("every place is in a zone that has faces")
    }

    fn nearest_in(&self, selected_zone: Zone, p: &ExactPoint) -> Option<(usize, Big)> {
        let mut best: Option<(usize, Big)> = None;
        for (region, (_, zone, face)) in self.shape.regions().iter().enumerate() {
            if *zone != selected_zone {
                continue;
            }
            let inward = face.inward(p);
            if best.as_ref().is_none_or(|(_, min_depth)| inward < *min_depth) {
                best = Some((region, inward));
            }
        }
        best
    }

    /// Returns the distance from a point outside to the boxes of the solid, or to the hole if that is nearest.
    fn distance_outside(&self, p: &ExactPoint) -> Big {
        let to_box = |low: [f64; 3], high: [f64; 3]| {
            let squares = (0..3).map(|k| {
                let below = &Big::exactly(low[k]) - &p[k];
                let above = &p[k] - &Big::exactly(high[k]);
                let outside = if below > above { below } else { above };
                if outside.is_negative() { Big::zero() } else { &outside * &outside }
            });
            squares.fold(Big::zero(), |sum, square| &sum + &square).sqrt()
        };
        match self.shape {
            Shape::Block => to_box([-20.0, -15.0, 0.0], [20.0, 15.0, 20.0]),
            Shape::Bracket => {
                let lying = to_box([-10.0, -10.0, 0.0], [20.0, 10.0, LEDGE]);
                let standing = to_box([-10.0, -10.0, 0.0], [WALL, 10.0, 24.0]);
                let [x, y] = from_bore_axis(p);
                let bore = &Big::decimal(3.3) - &length(&x, &y);
                let lying = if bore.is_negative() {
                    lying
                } else {
                    // Over the hole, its rim is the nearest point of the horizontal leg.
                    length(&bore, &lying)
                };
                if lying < standing { lying } else { standing }
            }
        }
    }
}

impl Truth for Faces {
    fn scale(&self) -> f64 {
        32.0
    }

    fn depth(&self, p: &ExactPoint) -> Big {
        let (_, inward) = self.nearest(p);
        if inward.is_negative() { -&self.distance_outside(p) } else { inward }
    }

    fn owner(&self, p: &ExactPoint) -> Option<usize> {
        let (region, inward) = self.nearest(p);
        let index = || self.indices.iter().position(|index| *index == Some(region));
        if inward.is_negative() { None } else { index() }
    }

    fn region_values(&self, p: &ExactPoint, region: usize) -> Option<RegionValues> {
        let region = (*self.indices.get(region)?)?;
        let (_, zone, face) = self.shape.regions()[region];
        let depth = face.inward(p);
        // Beyond the border to a neighbouring zone, the point misses the region by at least its distance from the zone.
        let excess_distance = (&depth - &self.nearest(p).1).abs();
        let zone_distance = distance_from_zone(zone, p);
        let excess_distance =
            if zone_distance > excess_distance { zone_distance } else { excess_distance };
        Some(RegionValues {
            excess_distance: excess_distance.to_f64(),
            direction: face.direction(p),
            singularity_distance: face.singularity_distance(p),
            depth,
        })
    }
}

//! Ways off the surface: retracts along the tool's axis, and links between two postures away from the part.

use super::PathPlanner;
use nalgebra::{Point3, Unit, Vector3};
use std::f64::consts::FRAC_PI_3;
use touchoff::Pose;
use touchoff::certify::TriangleBvh;

/// A sphere about the part, twice as large as one that holds the tips of all tools that touch the part. A tool
/// that has moved there along its axis has that axis within 30 degrees of the outward direction, and the whole
/// part below its tip.
#[derive(Debug)]
pub(crate) struct RetractSphere {
    centre: Point3<f64>,
    /// Radius of the sphere that holds the tips of all tools that touch the part.
    tip_radius: f64,
    /// Least distance from a surface at which feed changes to rapid traverse, in the part's unit.
    lead: f64,
}

/// A move off the surface along the tool's axis: a short lead in feed, and then out to the sphere.
#[derive(Clone, Copy)]
pub(super) struct RetractLeg {
    pub(super) lead_end: Pose,
    pub(super) outer: Pose,
}

/// The ends of a link: postures on the surface, each with the height along its axis up to which it moves in feed.
struct LinkEnds<'a> {
    from: &'a Pose,
    to: &'a Pose,
    leads: [f64; 2],
}

/// A way between two postures off the surface. The last motion, to the second posture, is in feed.
struct RapidLink {
    /// The cutter locations between the postures, each with a flag that is set if the tool arrives in rapid
    /// traverse.
    locations: Vec<(Pose, bool)>,
    /// Length of the tip's path, in the part's unit.
    length: f64,
}

/// Length of the lead in feed, as a fraction of half the diagonal of the part's box.
const LEAD: f64 = 1.0 / 32.0;

/// Radius of the sphere to which the tool retracts in full, in radii of the one that holds the tips.
const OUTER_RADIUS: f64 = 2.0;

/// Radii of the spheres on which links lead around the part, in the same unit.
const LINK_RADII: [f64; 3] = [1.05, 1.4, OUTER_RADIUS];

/// Difference of tips, as a fraction of their coordinates, and of axes in radians that is rounding: an angle near 0
/// rounds to 1e-8.
const SAME: f64 = 1e-7;

impl RetractSphere {
    /// Creates the sphere about a part and its stock. `reach` is the largest distance between the tip and a contact.
    pub(crate) fn new(
        part: &TriangleBvh,
        stock: Option<&TriangleBvh>,
        reach: f64,
    ) -> RetractSphere {
        let [part_low, part_high] = part.bounds();
        let [stock_low, stock_high] = stock.map_or([part_low, part_high], TriangleBvh::bounds);
        let [low, high] = [part_low.inf(&stock_low), part_high.sup(&stock_high)];
        let half = 0.5 * (high - low).norm();
        RetractSphere {
            centre: low + 0.5 * (high - low),
            tip_radius: half + reach,
            lead: LEAD * 0.5 * (part_high - part_low).norm(),
        }
    }

    /// Returns the lowest lift of a link, in the part's unit.
    pub(crate) fn lead(&self) -> f64 {
        self.lead
    }

    /// Returns the distance along its axis at which a pose leaves the sphere of a radius about the part; `None` for a
    /// pose outside.
    fn exit(&self, pose: &Pose, radius: f64) -> Option<f64> {
        let (from, axis) = (pose.tip() - self.centre, pose.axis());
        let height = from.dot(&axis);
        let within = radius * radius - from.norm_squared();
        (within > 0.0).then(|| (height * height + within).sqrt() - height)
    }

    /// Returns the distance along its axis at which a pose leaves the sphere of full retracts; `None` for a pose outside.
    pub(crate) fn outer_exit(&self, pose: &Pose) -> Option<f64> {
        self.exit(pose, OUTER_RADIUS * self.tip_radius)
    }

    /// Returns whether the tool reaches the part in no direction of its axis.
    pub(crate) fn is_away(&self, pose: &Pose) -> bool {
        (pose.tip() - self.centre).norm() > self.tip_radius
    }

    /// Returns the height along its axis at which a pose changes from feed to rapid traverse: the lead, or the least of
    /// twice the lead, four times the lead and so on at which the tool touches no stock.
    fn lead_of(&self, planner: &mut PathPlanner<'_>, pose: &Pose) -> f64 {
        let exit = self.outer_exit(pose).unwrap_or(0.0);
        let mut height = self.lead;
        while height < exit && !lifted(pose, height).is_some_and(|pose| planner.is_off_stock(&pose))
        {
            height *= 2.0;
        }
        height
    }

    /// Returns the move off the surface from a posture, if it is proved.
    pub(super) fn leg(&self, planner: &mut PathPlanner<'_>, pose: &Pose) -> Option<RetractLeg> {
        let exit = self.outer_exit(pose)?;
        let lead = self.lead_of(planner, pose);
        // The lead ends before the sphere, so that both motions have a length.
        let lead_end = lifted(pose, if lead < exit { lead } else { 0.5 * exit })?;
        let outer = lifted(pose, exit)?;
        (planner.is_clear(pose, &lead_end) && planner.is_free(&lead_end, &outer))
            .then_some(RetractLeg { lead_end, outer })
    }

    /// Returns the cutter locations of the shortest proved way between two postures off the surface; `None` if no way
    /// is proved.
    pub(super) fn link(
        &self,
        planner: &mut PathPlanner<'_>,
        from: &Pose,
        to: &Pose,
    ) -> Option<Vec<(Pose, bool)>> {
        let mut links = self.links(planner, from, to);
        links.sort_by(|one, other| one.length.total_cmp(&other.length));
        let clear = links.into_iter().find(|link| link.is_clear(planner, from, to));
        clear.map(|link| link.locations)
    }

    /// Returns the ways between two postures that are worth a proof, in no order.
    fn links(&self, planner: &mut PathPlanner<'_>, from: &Pose, to: &Pose) -> Vec<RapidLink> {
        let leads = [from, to].map(|pose| self.lead_of(planner, pose));
        let ends = LinkEnds { from, to, leads };
        let mut links = self.hops(&ends);
        for radius in LINK_RADII {
            links.extend(self.links_around(planner, &ends, radius * self.tip_radius));
        }
        links
    }

    /// Returns the links that lift both ends along their axes and lead straight across, lift by lift.
    fn hops(&self, ends: &LinkEnds<'_>) -> Vec<RapidLink> {
        let [out, back] = [ends.from, ends.to].map(|pose| self.outer_exit(pose).unwrap_or(0.0));
        let mut hops = Vec::new();
        // Each lift is twice the one before, so that the lowest clear one is found to within a factor of two.
        let mut height = ends.leads[0].max(ends.leads[1]);
        while height < out.min(back) {
            hops.extend(ends.raised([height; 2], &[]));
            height *= 2.0;
        }
        hops
    }

    /// Returns the links around the part on a sphere: out along the first axis, around, and in along the second axis.
    fn links_around(
        &self,
        planner: &PathPlanner<'_>,
        ends: &LinkEnds<'_>,
        radius: f64,
    ) -> Vec<RapidLink> {
        let LinkEnds { from, to, .. } = *ends;
        let Some((out, back)) = self.exit(from, radius).zip(self.exit(to, radius)) else {
            return Vec::new();
        };
        let (Some(first), Some(last)) = (lifted(from, out), lifted(to, back)) else {
            return Vec::new();
        };
        let ways = self.ways_between(planner, &first, &last);
        ways.iter().filter_map(|way| ends.raised([out, back], way)).collect()
    }

    /// Returns the angle, up to 60°, of the longest chord of a sphere that comes no nearer to the centre than the tips of
    /// tools that touch the part.
    fn longest_chord(&self, radius: f64) -> f64 {
        let chord = 2.0 * (self.tip_radius / radius).min(1.0).acos();
        chord.min(FRAC_PI_3)
    }

    /// Returns the pose above the part, with the axis along +z, on the sphere to which the tool retracts in full.
    pub(super) fn top(&self) -> Option<Pose> {
        let tip = self.centre + Vector3::z() * (OUTER_RADIUS * self.tip_radius);
        Pose::from_axis(tip, Vector3::z()).ok()
    }

    /// Returns the poses from one pose on a sphere to another, both included, on a way that is proved.
    pub(super) fn way(
        &self,
        planner: &mut PathPlanner<'_>,
        from: &Pose,
        to: &Pose,
    ) -> Option<Vec<Pose>> {
        let ways = self.ways_between(planner, from, to).into_iter().map(|between| {
            let mut way = vec![*from];
            way.extend(between);
            way.push(*to);
            way
        });
        let ways: Vec<Vec<Pose>> = ways.collect();
        ways.into_iter().find(|way| way.windows(2).all(|ends| planner.is_free(&ends[0], &ends[1])))
    }

    /// Returns ways between two poses on a sphere, as the poses between them: upright, around on a great circle, and
    /// over to the second axis. Where the axis may not point outward, it points as near to that as it may, and a second
    /// way leads over the top.
    fn ways_between(&self, planner: &PathPlanner<'_>, from: &Pose, to: &Pose) -> Vec<Vec<Pose>> {
        let radius = (from.tip() - self.centre).norm();
        let [first, last] = [from, to].map(|pose| (pose.tip() - self.centre) / radius);
        let chord = self.longest_chord(radius);
        let mut ways = vec![great_circle(first, last, chord)];
        if !ways[0].iter().all(|direction| planner.range.allows(direction)) {
            let top = Vector3::z();
            let mut over = great_circle(first, top, chord);
            over.extend(great_circle(top, last, chord).into_iter().skip(1));
            ways.push(over);
        }
        let poses = ways.iter().map(|directions| {
            let poses = directions.iter().map(|direction| {
                let axis = planner.range.clamped(direction)?;
                Pose::from_axis(self.centre + direction * radius, axis).ok()
            });
            poses.collect::<Option<Vec<Pose>>>()
        });
        let mut ways: Vec<Vec<Pose>> = poses.flatten().collect();
        // An end that is upright already is no way to go.
        ways.iter_mut()
            .for_each(|way| way.retain(|pose| !is_same(pose, from) && !is_same(pose, to)));
        ways
    }
}

impl LinkEnds<'_> {
    /// Returns the link that lifts its ends by heights along their axes, with the cutter locations of the way between
    /// the lifted ends.
    fn raised(&self, heights: [f64; 2], way: &[Pose]) -> Option<RapidLink> {
        let LinkEnds { from, to, leads } = *self;
        let mut locations = Vec::with_capacity(way.len() + 4);
        if heights[0] > leads[0] {
            locations.push((lifted(from, leads[0])?, false));
        }
        locations.push((lifted(from, heights[0])?, heights[0] > leads[0]));
        locations.extend(way.iter().map(|pose| (*pose, true)));
        locations.push((lifted(to, heights[1])?, true));
        if heights[1] > leads[1] {
            locations.push((lifted(to, leads[1])?, true));
        }
        Some(RapidLink::new(from, locations, to))
    }
}

impl RapidLink {
    fn new(from: &Pose, locations: Vec<(Pose, bool)>, to: &Pose) -> RapidLink {
        let mut length = 0.0;
        let mut tip = from.tip();
        for pose in locations.iter().map(|(pose, _)| pose).chain([to]) {
            length += (pose.tip() - tip).norm();
            tip = pose.tip();
        }
        RapidLink { locations, length }
    }

    /// Returns whether all motions of the link are proved.
    fn is_clear(&self, planner: &mut PathPlanner<'_>, from: &Pose, to: &Pose) -> bool {
        let mut stops = vec![(*from, false)];
        stops.extend(&self.locations);
        stops.push((*to, false));
        // From the middle on: a way across is obstructed more often than the retracts at its ends.
        let mut motions: Vec<&[(Pose, bool)]> = stops.windows(2).collect();
        let middle = motions.len() / 2;
        motions.rotate_left(middle);
        motions.into_iter().all(|ends| match (&ends[0].0, &ends[1]) {
            (from, (to, true)) => planner.is_free(from, to),
            (from, (to, false)) => planner.is_clear(from, to),
        })
    }
}

/// Returns whether two poses away from the part are the same but for rounding.
fn is_same(one: &Pose, other: &Pose) -> bool {
    let distance = (one.tip() - other.tip()).norm();
    distance <= SAME * one.tip().coords.norm() && one.axis().angle(&other.axis()) <= SAME
}

/// Returns a pose moved along its axis, toward the spindle.
fn lifted(pose: &Pose, height: f64) -> Option<Pose> {
    pose.translated(pose.axis() * height).ok()
}

/// Returns directions on a great circle from one to another, at most an angle apart, both ends included.
fn great_circle(first: Vector3<f64>, last: Vector3<f64>, chord: f64) -> Vec<Vector3<f64>> {
    let turn = first.angle(&last);
    // Between opposite directions any great circle will do, and between equal ones there is no turn.
    let axis = Unit::try_new(first.cross(&last), 1e-9)
        .or_else(|| Unit::try_new(first.cross(&Vector3::x()), 1e-3))
        .unwrap_or_else(Vector3::y_axis);
    let segments = (turn / chord).ceil().max(1.0);
    let directions = (0..=segments as usize)
        .map(|k| nalgebra::Rotation3::from_axis_angle(&axis, turn * k as f64 / segments) * first);
    directions.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::range::AxisRange;
    use crate::path::tilt::TiltLimit;
    use crate::{Directions, Rules};
    use std::f64::consts::PI;
    use std::sync::LazyLock;
    use touchoff::mesh::shapes;
    use touchoff::tool::Interpreted;

    static MILL: LazyLock<Interpreted> = LazyLock::new(|| {
        r#"tool Mill "a ball on a neck, in a wider holder" {
            units mm;
            profile {
                start (0, 0);
                arc to (3, 3) center (0, 3) as ball cutting;
                line to (3, 12) as flute cutting;
                line to (2.5, 12), (2.5, 20) as neck;
                line to (9, 20), (9, 40), (0, 40) as holder;
            }
            niceness cutting: 1;
        }"#
        .parse()
        .expect("a tool")
    });

    /// The oracle proves every way, and takes the shortest that is proved.
    #[test]
    fn takes_the_shortest_of_all_proved_ways() {
        let mesh =
            shapes::tube(6.0, 12.0, 16.0, 24, 4, touchoff::Unit::Millimetre).expect("a tube");
        let bvh = TriangleBvh::new(&mesh);
        let rules = Rules { tolerance: 0.01, niceness: 0.0, allowed: Vec::new() };
        let tilt = TiltLimit::new(PI).expect("an angle");
        let range = AxisRange { tilt, machine: None };
        let mut planner = PathPlanner::new(&bvh, None, &*MILL, &rules, range).expect("a planner");
        let sphere = RetractSphere::new(&bvh, None, planner.placement.reach());
        // The ball is a little off the part, inside and outside.
        let mut poses = Vec::new();
        for direction in Directions::spread(12).list() {
            let axis = Vector3::from(*direction);
            for id in mesh.ids().step_by(29) {
                let centre = mesh.triangle(id)[0] + mesh.normal(id).expect("a normal") * 3.05;
                let pose = Pose::from_axis(centre - axis * 3.0, axis).expect("a pose");
                if planner.validator.accepts(&pose) {
                    poses.push(pose);
                }
            }
        }
        let mut shorter = 0;
        let pairs: Vec<(&Pose, &Pose)> = poses
            .iter()
            .zip(poses.iter().skip(1))
            .chain(poses.iter().zip(poses.iter().skip(17)))
            .collect();
        for (from, to) in &pairs {
            let links = sphere.links(&mut planner, from, to);
            let full = links.iter().map(|link| link.length).fold(0.0, f64::max);
            let proved = links.into_iter().filter(|link| {
                let poses = link.locations.iter().map(|(pose, _)| pose).chain([*to]);
                poses
                    .fold((true, *from), |(clear, from), to| {
                        (clear & planner.is_clear(from, to), to)
                    })
                    .0
            });
            let shortest = proved.map(|link| link.length).fold(f64::INFINITY, f64::min);
            let taken = sphere.link(&mut planner, from, to);
            let taken = taken.map(|locations| RapidLink::new(from, locations, to).length);
            assert_eq!(taken.unwrap_or(f64::INFINITY), shortest, "{from:?} {to:?}");
            shorter += usize::from(shortest < 0.5 * full);
        }
        println!("{} pairs, {shorter} of them with a link near the part", pairs.len());
        assert!(pairs.len() > 50 && shorter * 2 > pairs.len(), "{shorter} of {}", pairs.len());
    }

    /// Chords between the directions stay outside the sphere of the tips.
    #[test]
    fn the_way_around_stays_off_the_tips() {
        let mesh = shapes::sphere(10.0, 3, touchoff::Unit::Millimetre).expect("a sphere");
        let sphere = RetractSphere::new(&TriangleBvh::new(&mesh), None, 3.0);
        let directions = Directions::spread(20);
        let mut chords = 0;
        for (first, last) in directions.list().iter().zip(directions.list().iter().rev()) {
            for radius in LINK_RADII {
                let chord = sphere.longest_chord(radius * sphere.tip_radius);
                let way = great_circle(Vector3::from(*first), Vector3::from(*last), chord);
                for ends in way.windows(2) {
                    let middle = 0.5 * (ends[0] + ends[1]);
                    assert!(middle.norm() * radius > 1.0 - 1e-9, "{middle:?} at {radius}");
                    chords += 1;
                }
                assert!((way[0] - Vector3::from(*first)).norm() < 1e-9);
                assert!((way[way.len() - 1] - Vector3::from(*last)).norm() < 1e-9);
            }
        }
        assert!(chords > 300, "{chords}");
    }
}

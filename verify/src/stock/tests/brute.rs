//! Random motions against all points at many times, with depths written by hand.

use super::*;
use touchoff::SurfaceId;

/// The signed depth of a point `[d, z]` in a tool, negative outside, and its distances from the surfaces that
/// cut and that do not.
struct Depth {
    signed: f64,
    cutting: f64,
    other: f64,
}

/// `Mill`: a cylinder with a radius of 3 from 0 to 30, of which the lowest 10 and the bottom cut.
fn mill([d, z]: [f64; 2]) -> Depth {
    let (side, bottom, top) = (3.0 - d, z, 30.0 - z);
    let signed = inside_or_out(side, bottom.min(top));
    let along_flute = side.hypot((z - 10.0).max(0.0));
    let along_shank = side.hypot((10.0 - z).max(0.0));
    Depth { signed, cutting: bottom.min(along_flute), other: top.min(along_shank) }
}

/// `Ball`: a ball with a radius of 3 under a cylinder up to 30.
fn ball([d, z]: [f64; 2]) -> Depth {
    let (side, top) = (3.0 - d, 30.0 - z);
    let from_ball = 3.0 - d.hypot(z - 3.0);
    let signed = if z < 3.0 { from_ball } else { inside_or_out(side, top) };
    let to_equator = side.hypot(z - 3.0);
    let (cutting, along_shank) = if z < 3.0 { (from_ball, to_equator) } else { (to_equator, side) };
    Depth { signed, cutting, other: top.min(along_shank) }
}

/// The signed depth in a corner of two right-angled faces, given the depths from each.
fn inside_or_out(one: f64, other: f64) -> f64 {
    if one >= 0.0 || other >= 0.0 { one.min(other) } else { -one.hypot(other) }
}

/// A motion: the tip moves on a line, the axis turns on a great circle.
struct Path {
    tips: [Vector3<f64>; 2],
    axes: [Vector3<f64>; 2],
}

impl Path {
    fn angle(&self) -> f64 {
        self.axes[0].cross(&self.axes[1]).norm().atan2(self.axes[0].dot(&self.axes[1]))
    }

    /// Returns tip and axis at a time.
    fn at(&self, time: f64) -> [Vector3<f64>; 2] {
        let (angle, [first, last]) = (self.angle(), self.axes);
        let axis =
            (first * ((1.0 - time) * angle).sin() + last * (time * angle).sin()) / angle.sin();
        [self.tips[0] + (self.tips[1] - self.tips[0]) * time, axis]
    }

    /// The coordinates `[d, z]` of a point at a time.
    fn local(&self, [tip, axis]: [Vector3<f64>; 2], point: Vector3<f64>) -> [f64; 2] {
        let relative = point - tip;
        let z = relative.dot(&axis);
        [(relative - z * axis).norm(), z]
    }
}

/// Rounding: of stored points, and of depths.
const ROUNDING: f64 = 3e-6;

#[derive(Clone, Copy, Default)]
struct Tally {
    motions: usize,
    removed: usize,
    contacts: usize,
    undecided: usize,
}

/// A tool, and the depths in it.
type ToolDepth<'a> = (&'a dyn Tool, fn([f64; 2]) -> Depth);

/// Moves a tool through a stock, and checks every point and every contact.
fn check(
    stock: &mut Stock,
    (tool, depth): ToolDepth<'_>,
    path: &Path,
    mode: MotionMode,
    tolerance: f64,
    tally: &mut Tally,
) {
    let before = nodes(stock);
    let reach = 30f64.hypot(3.0);
    let travel = (path.tips[1] - path.tips[0]).norm() + path.angle() * reach;
    let [from, to] =
        [0, 1].map(|k| Pose::from_axis(path.tips[k].into(), path.axes[k]).expect("a pose"));
    let motion = Motion::new(&from, &to).expect("a motion");
    let found = stock.advance(tool, &|time| motion.pose(time), travel, mode, tolerance);
    let found = found.expect("advanced");
    let after = nodes(stock);
    let step = stock.step();
    let intervals = (travel / step).ceil() as usize;
    const FINER: usize = 8;
    let frames: Vec<_> =
        (0..=intervals * FINER).map(|k| path.at(k as f64 / (intervals * FINER) as f64)).collect();
    let mut deepest = [0.0f64; 2];
    let (mut points, mut doubtful) = ([0usize; 2], [0usize; 2]);
    for ((at, was_left), (_, is_left)) in before.iter().zip(&after).filter(|((_, was), _)| *was) {
        assert!(*was_left);
        let at = Vector3::from(*at);
        // As the samples decide: cut at the first sample at which a cutting surface is the nearest, in
        // contact before.
        let (mut removed, mut undecided, mut cut) = (false, false, false);
        let mut contact = [f64::NEG_INFINITY; 2];
        // Over all times: the greatest depth, and the greatest depth near a surface that cuts and no other.
        let (mut greatest, mut surely_cut) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        for (index, frame) in frames.iter().enumerate() {
            let [d, z] = path.local(*frame, at);
            if d > 4.0 || !(-1.0..=31.0).contains(&z) {
                continue;
            }
            let Depth { signed, cutting, other } = depth([d, z]);
            greatest = greatest.max(signed);
            if mode == MotionMode::Feed && cutting + step < other {
                surely_cut = surely_cut.max(signed);
            }
            if index % FINER != 0 || cut {
                continue;
            }
            undecided |= signed.abs() < ROUNDING;
            if signed >= 0.0 {
                undecided |= (cutting - other).abs() < ROUNDING;
                let surface = usize::from(other < cutting);
                if mode == MotionMode::Feed && surface == 0 {
                    (removed, cut) = (true, true);
                } else if signed > tolerance - ROUNDING {
                    undecided |= signed < tolerance + ROUNDING;
                    contact[surface] = contact[surface].max(signed);
                    removed = true;
                }
            }
        }
        if !undecided {
            assert_eq!(*is_left, !removed, "{at} {greatest}");
        }
        for surface in 0..2 {
            let in_contact = contact[surface] > tolerance;
            if undecided {
                doubtful[surface] += 1;
            } else if in_contact {
                points[surface] += 1;
                deepest[surface] = deepest[surface].max(contact[surface]);
            }
        }
        // Nothing else is removed, and whatever is deeper than half a step is.
        let between = 0.5 * step / FINER as f64 + ROUNDING;
        assert!(*is_left || greatest > -between, "{at} {greatest}");
        assert!(!*is_left || surely_cut < 0.5 * step + ROUNDING, "{at} {surely_cut}");
        tally.removed += usize::from(!is_left);
        tally.undecided += usize::from(undecided);
    }
    for surface in 0..2 {
        let contact = found.iter().find(|contact| contact.surface == SurfaceId(surface));
        let count = contact.map_or(0, |contact| contact.points);
        assert!(
            (points[surface]..=points[surface] + doubtful[surface]).contains(&count),
            "{count} points, expected {}",
            points[surface]
        );
        if let Some(contact) = contact {
            let expected = deepest[surface];
            assert!(
                (contact.depth - expected).abs() < ROUNDING || doubtful[surface] > 0,
                "{contact:?} {expected}"
            );
            let there = depth(path.local(path.at(contact.time), contact.point.coords)).signed;
            assert!((there - contact.depth).abs() < ROUNDING, "{contact:?} {there}");
            tally.contacts += 1;
        }
    }
    tally.motions += 1;
}

/// Cuts balls, mills and their shanks through a block in random directions, turning as they go.
#[test]
fn random_motions_agree_with_brute_force() {
    let mut tally = Tally::default();
    for (seed, tool, depth) in
        [(1, &Mill as &dyn Tool, mill as fn([f64; 2]) -> Depth), (2, &Ball, ball), (3, &Mill, mill)]
    {
        let mut random = Random(seed);
        let mut stock = block([-7.0; 3], [7.0; 3], 0.875);
        for k in 0..8 {
            let from = 50.0 * direction(&mut random);
            let aside = 4.0 * direction(&mut random);
            let axis = direction(&mut random);
            let turned = (axis + 0.6 * direction(&mut random)).normalize();
            let path = Path { tips: [from, 2.0 * aside - from], axes: [axis, turned] };
            let mode = if k % 4 == 3 { MotionMode::Rapid } else { MotionMode::Feed };
            let tolerance = [0.0, 0.05, 0.5][k % 3];
            check(&mut stock, (tool, depth), &path, mode, tolerance, &mut tally);
        }
    }
    let Tally { motions, removed, contacts, undecided } = tally;
    println!(
        "{motions} motions, {removed} points removed, {contacts} contacts, {undecided} points undecided"
    );
    assert!(removed > 3000 && contacts > 10 && undecided < removed / 100);
}

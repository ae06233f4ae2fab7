//! `regions smooth w`: the depth stays, the direction is the normal of the profile that is rounded by growing balls, which
//! shares nothing with the compiler.

use super::derived::FIG_7_3;
use super::outline::{Outline, P2};
use super::tool;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};
use touchoff::Level;
use touchoff::tool::Interpreted;
use touchoff_dsl::CheckedTool;
use touchoff_dsl::interpret::{Evaluation, Interpreter};
use touchoff_tests::checks::assert_near;
use touchoff_tests::evaluations::evaluate_points;
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::segment::Segment;
use touchoff_tests::oracle::vector::{add, cross, dot, norm, sub};
use touchoff_tests::texts::{assert_each_refused, compiled};

/// A smoothed tool, and the same tool by nearest features.
struct Pair {
    smooth: Box<CheckedTool>,
    /// The same, as the runtime evaluates it.
    planned: Interpreted,
    nearest: Box<CheckedTool>,
    /// The rounded profile, in the file's frame.
    rounded: Vec<Segment<f64>>,
    /// The tip's z if the spindle lies toward smaller z; otherwise the tip is at 0.
    down: Option<f64>,
    extent: P2,
}

/// Returns the text of a profile whose corners are rounded.
fn smoothed(text: &str, w: &str) -> String {
    text.replacen("} }", &format!("}} regions smooth {w}; }}"), 1)
}

/// Returns fig. 7.3 by the table of centres; every fan has the tangent length `w`.
fn thesis(w: f64) -> Pair {
    let (t, rho) = (w * FRAC_1_SQRT_2, w * (1.0 + SQRT_2));
    let rounded = vec![
        Segment::line([0.0, 0.0], [5.0 - w, 0.0]),
        Segment::about([5.0 - w, 0.0], [5.0, w], [5.0 - w, w], true),
        Segment::line([5.0, w], [5.0, 11.0 - w]),
        Segment::about([5.0, 11.0 - w], [5.0 - w, 11.0], [5.0 - w, 11.0 - w], true),
        Segment::line([5.0 - w, 11.0], [3.0 + w, 11.0]),
        Segment::about([3.0 + w, 11.0], [3.0, 11.0 + w], [3.0 + w, 11.0 + w], false),
        Segment::line([3.0, 11.0 + w], [3.0, 13.0 - w]),
        Segment::about([3.0, 13.0 - w], [3.0 - t, 13.0 + t], [3.0 - rho, 13.0 - w], true),
        Segment::line([3.0 - t, 13.0 + t], [1.0 + t, 15.0 - t]),
        Segment::about([1.0 + t, 15.0 - t], [1.0, 15.0 + w], [1.0 + rho, 15.0 + w], false),
        Segment::line([1.0, 15.0 + w], [1.0, 19.0]),
        Segment::about([1.0, 19.0], [0.0, 20.0], [0.0, 19.0], true),
    ];
    let smooth = smoothed(FIG_7_3, &w.to_string());
    Pair {
        smooth: tool(&smooth).expect("fits"),
        planned: Interpreted::from_text("smooth.tool", &smooth).expect("fits"),
        nearest: tool(FIG_7_3).expect("good"),
        rounded: rounded.into_iter().filter(|piece| piece.length() > 1e-9).collect(),
        down: Some(20.0),
        extent: [5.0, 20.0],
    }
}

/// Returns a profile whose corners are rounded.
fn profile(outline: &Outline, w: f64) -> Pair {
    let rounded = rounded(outline, w);
    let [low, high] = outline.profile.extent();
    let nearest = outline.text();
    let smooth = smoothed(&nearest, &w.to_string());
    Pair {
        smooth: tool(&smooth).expect("fits"),
        planned: Interpreted::from_text("smooth.tool", &smooth).expect("fits"),
        nearest: tool(&nearest).expect("good"),
        rounded: rounded.iter().map(|piece| lowered(piece, low[1])).collect(),
        down: None,
        extent: [high[0], high[1] - low[1]],
    }
}

/// Returns the pieces of a profile, shortened where arcs round its corners.
fn rounded(outline: &Outline, w: f64) -> Vec<Segment<f64>> {
    let pieces = outline.segments();
    let fans: Vec<Option<Segment<f64>>> = (0..=pieces.len()).map(|k| fan(outline, k, w)).collect();
    let mut rounded: Vec<Segment<f64>> = Vec::new();
    for (k, piece) in pieces.iter().enumerate() {
        if k == 0 {
            rounded.extend(fans[0]);
        }
        let from = fans[k].map_or(piece.from, |fan| fan.to);
        let to = fans[k + 1].map_or(piece.to, |fan| fan.from);
        if norm(&sub(&to, &from)) > 1e-9 {
            rounded.push(piece.between(from, to));
        }
        rounded.extend(fans[k + 1]);
    }
    rounded
}

/// Returns the arc of the corner before a piece, behind the last for their number, if the profile turns there. It
/// is the ball at `w` from the corner on one of its pieces, grown until it touches the other.
fn fan(outline: &Outline, k: usize, w: f64) -> Option<Segment<f64>> {
    let turn = outline.profile.turn(k);
    if turn.abs() < 1e-9 {
        return None;
    }
    let side = turn.signum();
    let away = |piece: &Segment<f64>, at_end: bool| {
        let part = w / piece.length();
        let from = piece.at(if at_end { 1.0 - part } else { part });
        (from, piece.outward(&from).map(|part| -side * part))
    };
    let before = k.checked_sub(1).map(|k| (&outline.segments()[k], true));
    let pieces = [before, outline.segments().get(k).map(|piece| (piece, false))];
    let corner = outline.profile.vertex(k);
    let arc = |from: P2, to: P2, centre: P2| Segment::about(from, to, centre, turn > 0.0);
    if let [None, Some((piece, at_end))] | [Some((piece, at_end)), None] = pieces {
        let (from, normal) = away(piece, at_end);
        let centre = add(&from, &normal, &(-from[0] / normal[0]));
        let radius = norm(&sub(&from, &centre));
        let up = if at_end == (turn > 0.0) { radius } else { -radius };
        let (centre, pole) = ([0.0, centre[1]], [0.0, centre[1] + up]);
        return Some(if at_end { arc(from, pole, centre) } else { arc(pole, from, centre) });
    }
    let [Some(before), Some(after)] = pieces else { return None };
    let found = [(before, after), (after, before)].map(|(one, other)| {
        let (from, normal) = away(one.0, one.1);
        let (mut radius, mut most) = (0.0, 1e3);
        for _ in 0..200 {
            let middle = f64::midpoint(radius, most);
            let free = side * other.0.inward(&add(&from, &normal, &middle)) > middle;
            if free { radius = middle } else { most = middle }
        }
        let centre = add(&from, &normal, &radius);
        let to = add(&centre, &other.0.outward(&centre), &(side * radius));
        let piece = if one.1 { arc(from, to, centre) } else { arc(to, from, centre) };
        (norm(&sub(&to, corner)), piece)
    });
    // The nearer of the two touches both pieces no farther than `w`.
    found.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, piece)| piece)
}

fn lowered(piece: &Segment<f64>, by: f64) -> Segment<f64> {
    piece.map(|p| add(p, &[0.0, by], &-1.0), f64::clone)
}

impl Pair {
    fn turned(&self, [d, z]: P2) -> P2 {
        [d, self.down.map_or(z, |tip| tip - z)]
    }

    /// Returns the direction of an evaluation, in the file's frame.
    fn direction(&self, evaluation: &Evaluation) -> P2 {
        let [x, _, z] = evaluation.direction;
        [x, if self.down.is_some() { -z } else { z }]
    }

    /// Returns the normal of the rounded profile, the distance to its piece's centre, and how much farther the next
    /// piece with another normal is.
    fn normal(&self, p: P2) -> (P2, f64, f64) {
        // Beyond the arc of a convex corner the tool goes on to the corner; behind other pieces it ends.
        let is_in_tool = |piece: &&Segment<f64>| {
            piece.inward(&p) >= 0.0 || piece.circle.is_some_and(|round| round.convex)
        };
        let facing = self.rounded.iter().filter(|piece| piece.faces(&p)).filter(is_in_tool);
        let mut all: Vec<(f64, &Segment<f64>)> =
            facing.map(|piece| (piece.inward(&p).abs(), piece)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let Some(&(min_distance, owner)) = all.first() else { return ([0.0; 2], 0.0, 0.0) };
        let normal = owner.outward(&p);
        let other = all.iter().find(|(_, piece)| norm(&sub(&piece.outward(&p), &normal)) > 1e-6);
        let centre_distance =
            owner.circle.map_or(f64::INFINITY, |round| norm(&sub(&p, &round.centre)));
        (normal, centre_distance, other.map_or(f64::INFINITY, |other| other.0 - min_distance))
    }

    /// Asserts that depths are those of nearest features, bit by bit, and directions those of the rounded profile, and that the
    /// plan has both as the text has them. Returns the mean angle to the direction by nearest features.
    fn agrees(&self, count: u32) -> f64 {
        let (mut smooth, mut nearest) =
            (Interpreter::new(&self.smooth), Interpreter::new(&self.nearest));
        let mut rng = Rng::new(21);
        let point = |_| [rng.between(0.0, self.extent[0]), rng.between(0.0, self.extent[1])];
        let points: Vec<P2> = (0..count).map(point).collect();
        let in_space = points.iter().map(|p| self.turned(*p)).map(|[d, z]| [d, 0.0, z]);
        let in_space: Vec<[f64; 3]> = in_space.collect();
        let planned = evaluate_points(&self.planned, Level::new(), &in_space);
        let (mut compared, mut inside, mut angles) = (0, 0u32, 0.0);
        for ((p, at), planned) in points.into_iter().zip(in_space).zip(planned) {
            let (evaluation, plain) = (smooth.evaluate(at, 1.0), nearest.evaluate(at, 1.0));
            let (Some(evaluation), Some(plain)) = (evaluation, plain) else {
                assert_eq!(evaluation.is_some(), plain.is_some(), "inside at {p:?}");
                continue;
            };
            inside += 1;
            assert_eq!(evaluation.depth, plain.depth, "at {p:?}");
            let surface = |tool: &CheckedTool, region: usize| {
                tool.model.surfaces[tool.model.regions[region].surface].name.clone()
            };
            assert_eq!(
                surface(&self.smooth, evaluation.region),
                surface(&self.nearest, plain.region)
            );
            let direction = self.direction(&evaluation);
            angles += angle(direction, self.direction(&plain));
            let (expected_normal, centre_distance, margin) = self.normal(p);
            if margin > 1e-9 && centre_distance > 1e-6 {
                compared += 1;
                let planned = planned.expect("inside");
                assert_near(planned.depth, evaluation.depth, 1e-13 * self.extent[1], p);
                let off = [0, 1, 2].map(|k| planned.direction[k] - evaluation.direction[k]);
                assert_near(off.into_iter().fold(0.0, f64::hypot), 0.0, 1e-12, (p, planned));
                let off = norm(&sub(&direction, &expected_normal));
                assert_near(off, 0.0, 1e-12 + 1e-13 / centre_distance, (p, direction));
            }
        }
        assert!(compared * 100 > inside * 99 && inside * 10 > count, "{compared} of {inside}");
        angles / f64::from(inside)
    }

    /// Returns the largest turn of the direction from step to step along the surface, just below it.
    fn steps(&self, surface: &[Segment<f64>], step: f64) -> f64 {
        let mut interpreter = Interpreter::new(&self.smooth);
        let (mut last, mut max_turn) = (None, 0.0f64);
        for piece in surface {
            let length = piece.length();
            let count = (length / step).ceil() as u32;
            for k in 0..=count {
                let on = piece.at(f64::from(k) / f64::from(count));
                let [d, z] = self.turned(add(&on, &piece.outward(&on), &-1e-9));
                let evaluation = interpreter.evaluate([d.abs(), 0.0, z], 1.0);
                let Some(evaluation) = evaluation else { continue };
                assert!(evaluation.depth < 2e-9);
                let direction = self.direction(&evaluation);
                max_turn = max_turn.max(last.map_or(0.0, |last| angle(last, direction)));
                last = Some(direction);
            }
        }
        max_turn
    }

    /// Returns depths at which the direction jumps, on straight ways through the inside.
    fn jumps(&self, count: usize, rho: f64) -> Vec<f64> {
        let mut interpreter = Interpreter::new(&self.smooth);
        let mut evaluation = |p: P2| {
            let [d, z] = self.turned(p);
            let evaluation = interpreter.evaluate([d, 0.0, z], 1.0)?;
            Some((self.direction(&evaluation), evaluation.depth))
        };
        let mut rng = Rng::new(22);
        let mut depths = Vec::new();
        for _ in 0..count {
            let a = [rng.between(0.0, self.extent[0]), rng.between(0.0, self.extent[1])];
            let b = [(a[0] + rng.between(-0.1, 0.1)).abs(), a[1] + rng.between(-0.1, 0.1)];
            let (mut a, mut b) = (a, b);
            while norm(&sub(&b, &a)) > 1e-9 {
                let middle = [0, 1].map(|k| f64::midpoint(a[k], b[k]));
                let (Some(first), Some(half), Some(last)) =
                    (evaluation(a), evaluation(middle), evaluation(b))
                else {
                    break;
                };
                if angle(first.0, last.0) < 1e-3 + 1e-6 * norm(&sub(&b, &a)) / rho {
                    break;
                }
                if angle(first.0, half.0) > angle(half.0, last.0) { b = middle } else { a = middle }
            }
            if norm(&sub(&b, &a)) <= 1e-9 {
                depths.extend(evaluation(a).map(|evaluation| evaluation.1));
            }
        }
        depths
    }
}

fn angle(a: P2, b: P2) -> f64 {
    cross(&a, &b).atan2(dot(&a, &b)).abs()
}

#[test]
fn the_thesis_tool_turns_in_fans() {
    for (w, mean, jump) in [(0.5, 0.034, 0.48), (1.0, 0.079, 0.98)] {
        let pair = thesis(w);
        let angle = pair.agrees(60_000);
        assert!((angle - mean).abs() < 2e-3, "{angle} rad on average for {w}");
        let surface = Outline::parse("0 0, 5 0, 5 11, 3 11, 3 13, 1 15, 1 19, 0 20 about 0 19");
        for step in [1e-1, 1e-3, 1e-5] {
            let most = pair.steps(surface.segments(), step);
            assert!(most <= step / w * (1.0 + 1e-6) + 1e-8, "{most} in {step} for {w}");
        }
        let jumps = pair.jumps(30_000, w);
        assert!(jumps.len() > 50 && jumps.iter().all(|depth| *depth >= jump), "{jumps:?}");
    }
}

/// Fans of small corners reach under larger ones and must not claim points that are nearer to those. Beside arcs, the
/// direction turns a little faster than beside lines.
#[test]
fn fans_are_the_rounded_profiles() {
    let of_lines = 1e-6;
    let of_arcs = 1e-3;
    for (vertices, w, excess) in [
        // A tip on the axis, one that points inward, a blunt one.
        ("0 0, 3 3, 3 10, 0 10", 0.5, of_lines),
        ("0 1, 3 0, 3 10, 0 10", 0.5, of_lines),
        ("0 0, 3 1, 3 10, 0 12", 1.0, of_lines),
        // A step under a flange, a flange, and a skirt around a pin.
        ("0 0, 2 0, 2 3, 6 3, 6 4, 0 4", 0.5, of_lines),
        ("0 0, 6 0, 6 1, 2 1, 2 3, 0 3", 0.5, of_lines),
        ("0 0, 2 0, 2 3, 4 3, 4 -2, 9 -2, 9 8, 0 8", 0.5, of_lines),
        // A tooth whose tip is nearer to the flange across a gap than to its own arc.
        ("0 0, 5 0, 5 9.9, 3 8, 3 10, 8 10, 8 20, 0 20", 0.3, of_lines),
        // A ball under a step, and a dome.
        ("0 0, 3 3 about 0 3, 5 3, 5 9, 0 10 radius 7", 0.5, of_arcs),
        // A pointed tip of an arc, a groove between two beads, an edge between two hollows.
        (
            "0 0, 3 2 radius 4, 3 4 radius 1.2, 3 6 radius 1.2, 4 9 hollow radius 5,
             2 11 hollow radius 4, 0 11",
            0.4,
            of_arcs,
        ),
        // A hollow tip and a hollow flank.
        ("0 1, 2 0 radius 5, 3 4 hollow radius 6, 5 5 hollow radius 2.5, 5 9, 0 9", 0.4, of_arcs),
        // A convex and a concave arc at a reflex corner, and at a convex one.
        ("0 0, 2 0, 2.5 3 radius 3, 5 4 hollow radius 2, 4 7 radius 3, 0 7", 0.6, of_arcs),
        // Corners of two degrees, where the fan touches a tight arc far from the corner.
        (
            "0 0, 3 0, 5 1.9 radius 1.98, 5 5, 6 5.98 hollow radius 0.99, 8 6, 8 9, 0 9",
            0.3,
            of_arcs,
        ),
        // A hollow tip at the top, where a border follows the normal at the arc's end on the axis.
        (
            "0 0, 3.101 0, 3.416 0.7, 3.445 2.827 radius 4.526, 3.345 5.698 hollow radius 6.598,
             1.708 8.106 hollow radius 3.436, 0 9.106 hollow radius 4.232",
            0.0384,
            of_arcs,
        ),
    ] {
        let outline = Outline::parse(vertices);
        let pair = profile(&outline, w);
        pair.agrees(20_000);
        // An arc may reach lower than its ends.
        let low = outline.tip();
        let surface: Vec<Segment<f64>> =
            outline.segments().iter().map(|piece| lowered(piece, low)).collect();
        let rho = pair.rounded.iter().filter_map(|piece| piece.circle).map(|round| round.radius);
        let rho = rho.fold(f64::INFINITY, f64::min);
        for step in [1e-2, 1e-4] {
            let most = pair.steps(&surface, step);
            assert!(most <= step / rho * (1.0 + excess) + 1e-8, "{most} in {step} on {vertices}");
        }
    }
}

/// On the axis itself the direction lies along it.
#[test]
fn a_smooth_tip_points_along_the_axis() {
    let pair = profile(&Outline::parse("0 0, 3 3, 3 10, 0 10"), 0.5);
    let mut interpreter = Interpreter::new(&pair.smooth);
    for z in [1e-9, 0.1, 0.5] {
        let evaluation = interpreter.evaluate([0.0, 0.0, z], 1.0).expect("inside");
        assert_eq!(evaluation.direction, [0.0, 0.0, -1.0]);
    }
}

#[test]
fn fans_that_do_not_fit_are_refused() {
    let thesis = "\
1.5 => do not fit on the segment of length 2 | (3, 11) | at most 1
1.0001 => do not fit on the segment of length 2 | at most 1
0 => the tangent length must be more than 0
-1 => the tangent length must be more than 0";
    assert_each_refused(thesis, |w| compiled(smoothed(FIG_7_3, w)));
    let beads =
        Outline::parse("0 0, 3 3 about 0 3, 4 4 about 3 4, 3.4 5.4 hollow radius 1, 4 6, 4 9, 0 9");
    let round = "\
1.2 => do not fit on the segment of length | write a tangent length of at most 0.
5 => write a tangent length of at most 0.";
    assert_each_refused(round, |w| compiled(smoothed(&beads.text(), w)));
}

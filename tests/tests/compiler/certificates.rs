//! Certificates of tools: against the known results for the thesis's, against evaluations, and for tools that are
//! wrong.

use touchoff::Level;
use touchoff::tool::PointEvaluation;
use touchoff_dsl::interpret::Interpreter;
use touchoff_dsl::prove::{Certificate, Pair};
use touchoff_dsl::source::Source;
use touchoff_dsl::{CheckedTool, compile};
use touchoff_tests::evaluations::evaluate_points;
use touchoff_tests::library::{self, library};
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::profile::Profile;
use touchoff_tests::oracle::reference::Reference;
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::oracle::space::exactly;
use touchoff_tests::oracle::vector::{add, distance, sub};
use touchoff_tests::oracle::{Meridian, Nearest};
use touchoff_tests::points::to_space;
use touchoff_tests::profiles::{owners, tools};
use touchoff_tests::texts::{accepted, compiled, tool};

fn checked(source: &Source) -> Box<CheckedTool> {
    accepted(compile(source))
}

fn proved(text: &str) -> Certificate {
    Certificate::prove(&tool(text))
}

/// Returns the least and the greatest ratio of depth to the distance to the surface.
fn bounds(proved: &Certificate) -> (f64, f64) {
    (proved.lower_slope().expect("a lower bound"), proved.lipschitz().expect("an upper bound"))
}

/// Returns the turn between two regions in degrees, and the least depth at which they meet.
fn border(tool: &CheckedTool, proved: &Certificate, names: [&str; 2]) -> ([f64; 2], f64) {
    let region = |name: &str| tool.model.regions.iter().position(|region| region.name == name);
    let pair = Pair { own: region(names[0]).expect("a region"), other: region(names[1]) };
    let mut found = proved.borders.iter().filter(|b| b.sides == pair && b.has_equal_depths());
    let border = found.next().expect("a border");
    assert!(found.next().is_none());
    let angle = border.direction_angle;
    ([angle.low, angle.high].map(f64::to_degrees), border.depth.low)
}

#[test]
fn the_thesis_magnitudes_are_up_to_root_5_of_the_distance() {
    let tool = library::checked("fig_7_3");
    let proved = Certificate::prove(&tool);
    assert!(proved.is_continuous() && !proved.is_exact());
    let (least, most) = bounds(&proved);
    assert!((most - 5f64.sqrt()).abs() < 1e-12 && (least - 1.0).abs() < 1e-8, "{least} {most}");
    assert!(proved.examined_boxes <= 3_500, "{}", proved.examined_boxes);
    // Equation 7.1: regions whose magnitude is a distance.
    let distances: Vec<bool> = proved.regions.iter().map(|region| region.is_distance).collect();
    assert_eq!(distances, [true, true, true, false, true, false, false, true, true]);
    let steep: Vec<f64> =
        proved.regions.iter().map(|region| region.gradient_length.high.powi(2).round()).collect();
    assert_eq!(steep, [1.0, 1.0, 1.0, 2.0, 1.0, 2.0, 5.0, 1.0, 1.0]);
    let half = 0.5f64.atan().to_degrees();
    for (names, degrees) in [
        (["I", "II"], 90.0),
        (["II", "III"], 90.0),
        (["IV", "V"], 45.0),
        (["VI", "VII"], 45.0 - half),
        (["VII", "VIII"], half),
    ] {
        let ([low, high], depth) = border(&tool, &proved, names);
        assert!(low <= degrees && degrees <= high && high - low < 1e-6, "{names:?}: {low} {high}");
        assert!(depth == 0.0, "{names:?}");
    }
}

#[test]
fn info_has_the_proved_bounds() {
    use touchoff::Tool;
    let info = touchoff_tools::Fig73.info();
    assert!(info.depth.lipschitz.is_some_and(|most| (most - 5f64.sqrt()).abs() < 1e-12));
    assert!(info.depth.lower_slope.is_some_and(|slope| (slope - 1.0).abs() < 1e-8));
    for tool in touchoff_tools::TOOLS.iter().filter(|tool| tool.info().is_exact()) {
        let depth = tool.info().depth;
        assert_eq!([depth.lower_slope, depth.lipschitz], [Some(1.0); 2], "{}", tool.info().name);
    }
}

#[test]
fn the_exact_tool_is_exact() {
    let tool = library::checked("fig_7_3_exact");
    let proved = Certificate::prove(&tool);
    assert!(proved.is_exact() && proved.examined_boxes <= 3_500, "{}", proved.examined_boxes);
    // The parabola: from 0.93 rad at the axis to a right angle, nowhere less than 2 deep.
    let ([low, high], depth) = border(&tool, &proved, ["spindle/housing.1", "housing.2"]);
    assert!(low < 53.13 && low > 45.0 && (90.0..91.0).contains(&high), "{low} {high}");
    assert!((1.9..=2.0).contains(&depth), "{depth}");
}

#[test]
fn every_tool_of_the_library_is_proved() {
    for source in library() {
        let tool = checked(&source);
        let proved = Certificate::prove(&tool);
        let name = tool.model.name.as_str();
        assert!(proved.is_continuous(), "{name}");
        // The thesis's magnitudes are no distances.
        assert_eq!(proved.is_exact(), name != "Fig73", "{name}");
        let slack = proved.slack / tool.extent.scale();
        // About 1e-10 of it is the difference between depths, and four times that the distance of the surface from
        // the profile.
        assert!(slack < 5e-10, "{name}: {slack:e}");
    }
}

/// Ends of arcs written with the digits of a double are, but for rounding, on a common circle and tangent to the
/// next piece.
#[test]
fn profiles_that_are_smooth_but_for_rounding_are_proved() {
    let proved = proved(
        "tool T { units mm; tip z = 7.03125; profile {
           start (0, 7.03125);
           arc to (1.6639025899620146, 7.897422863661937) center (0, 9.0625) as s0;
           arc to (2.119173151801022, 8.21620674298658)
             center (2.32946362594682, 7.4313920091267125) concave as s1;
           line to (0, 8.21620674298658) as s2;
         } }",
    );
    assert!(proved.is_exact(), "{:?}", proved.undecided.first());
    assert!(proved.slack < 1e-7, "{}", proved.slack);
}

#[test]
fn sampled_values_keep_the_proved_bounds() {
    for source in library() {
        let tool = checked(&source);
        let proved = Certificate::prove(&tool);
        let cell = tool.extent.cell();
        let mut rng = Rng::new(7);
        let mut interpreter = Interpreter::new(&tool);
        let slack = 1e-12 * tool.extent.scale();
        let mut before: Option<([f64; 3], f64)> = None;
        for k in 0..4_000 {
            let p = cell.sides.map(|side| rng.between(side.low, side.high));
            // Every second point lies close to the one before.
            let last = before.filter(|_| k % 2 == 1);
            let p = last.map_or(p, |(last, _)| add(&last, &sub(&p, &last), &0.001));
            let Some(evaluation) = interpreter.evaluate(p, 1.0) else { continue };
            let facts = &proved.regions[evaluation.region];
            let depth = evaluation.depth;
            let region = &tool.model.regions[evaluation.region].name;
            let name = format!("{}, {region}: {depth}", tool.model.name);
            let [low, high] = [facts.depth.low - slack, facts.depth.high + slack];
            assert!(low <= depth && depth <= high, "{name}");
            assert!(evaluation.niceness <= facts.niceness.high.max(0.0) + 1e-12, "{name}");
            if let (Some(most), Some((last, last_depth))) = (proved.lipschitz(), before) {
                let step = distance(&p, &last);
                // Regions that no border joins may lie between two points of different parts.
                assert!((depth - last_depth).abs() <= most * step + slack, "{name} after {step}");
            }
            before = Some((p, depth));
        }
    }
}

#[test]
fn a_steeper_depth_has_a_larger_bound() {
    for factor in [1.0, 2.5] {
        let proved = ball(&format!("{factor}*(1 - hypot(d, z - 1))"), "away from (0, 1)");
        let (least, most) = bounds(&proved);
        assert_eq!(proved.is_exact(), factor == 1.0);
        assert!((most - factor).abs() < 1e-12 && (least - factor).abs() < 1e-8);
    }
}

/// Returns what is proved of a ball of radius 1.
fn ball(depth: &str, direction: &str) -> Certificate {
    proved(&format!(
        "tool Ball {{ units mm; region ball where hypot(d, z - 1) <= 1 {{
           depth: {depth}; direction: {direction}; }} }}"
    ))
}

/// Returns a ball of radius 3 with a core of radius 1 that has a depth of its own.
fn core(depth: &str) -> String {
    format!(
        "tool Core {{ units mm; curve r = hypot(d, z - 3);
           region core where r <= 1 {{ depth: {depth}; direction: away from (0, 3); }}
           region shell where 1 <= r <= 3 {{ depth: 3 - r; direction: away from (0, 3); }}
         }}"
    )
}

/// Number of points of a region that are enough to show its rounding.
const MIN_POINTS: usize = 300;

#[test]
fn rounding_is_below_its_bound_and_above_a_tenth_of_it() {
    let all: Vec<Box<CheckedTool>> = library().iter().map(checked).collect();
    let mut loosest = (0.0, String::new());
    for (compiled, restated) in tools() {
        let name = &compiled.info().name;
        let tool = all.iter().find(|tool| tool.model.name == **name).expect("each has a file");
        let proved = Certificate::prove(tool);
        let reference = Reference::new(&restated);
        let owners = owners(compiled, &Nearest::new(&restated));
        let mut worst = vec![0.0f64; proved.regions.len()];
        let mut counts = vec![0; proved.regions.len()];
        let mut rng = Rng::new(11);
        let [x, _, z] = tool.extent.cell().sides;
        let points: Vec<[f64; 3]> = (0..40_000)
            .map(|_| {
                let (d, azimuth) = (rng.between(x.low, x.high), rng.azimuth());
                to_space([d, rng.between(z.low, z.high)], azimuth)
            })
            .collect();
        let evaluations = evaluate_points(compiled, Level::new(), &points);
        for (p, evaluation) in points.iter().zip(evaluations) {
            let Some(PointEvaluation { region, depth, .. }) = evaluation else { continue };
            let at = Meridian::of(exactly(*p));
            let exact = owners[region].iter().map(|owner| reference.distance_to(&at, *owner));
            let off = exact.map(|exact| (&Big::exactly(depth) - &exact).abs().to_f64());
            let off = off.fold(f64::INFINITY, f64::min);
            worst[region] = worst[region].max(off);
            counts[region] += 1;
        }
        for (region, facts) in proved.regions.iter().enumerate() {
            let (bound, seen) = (facts.rounding_error, worst[region]);
            let place = format!("{name}, {}", tool.model.regions[region].name);
            // The reference has 256 bits.
            assert!(seen <= bound + 1e-60, "{place}: {seen:e} over {bound:e}");
            // A proof that did not finish has boxes that are too large to be tight.
            let is_tight = proved.undecided.is_empty() && counts[region] >= MIN_POINTS;
            if is_tight && seen > 1e-60 && bound / seen > loosest.0 {
                loosest = (bound / seen, place);
            }
        }
    }
    assert!(loosest.0 < 10.0, "{loosest:?}");
}

#[test]
fn jumps_are_found() {
    let said = |depth: &str| {
        let compiled = compiled(core(depth));
        assert!(compiled.tool().is_none());
        compiled.diagnostics().iter().map(|report| report.message()).collect::<Vec<_>>()
    };
    // A depth of 4 instead of 2 at the core.
    let wrong = said("2*(3 - r)");
    assert!(wrong.len() == 1 && wrong[0].contains("depth jumps from 4 to 2"), "{wrong:?}");
    // The difference is (1 + r)/2, whose square's other root is 0 at the core.
    let wrong = said("3.5 - r/2");
    assert!(wrong.len() == 1 && wrong[0].contains("depth jumps from 3 to 2"), "{wrong:?}");
    assert!(proved(&core("3 - r")).is_exact());
    // No jump, but a kink: its steepness is known as precisely as its boxes are small.
    let (least, most) = bounds(&proved(&core("2 + 2*(1 - r)")));
    assert!((0.85..=1.0).contains(&least) && (most - 2.0).abs() < 1e-12, "{least} {most}");
}

/// A depth that is least in the middle leads nowhere from there, however steep it is around it.
#[test]
fn a_pit_in_the_middle_bounds_nothing() {
    let ring = |depth: &str| {
        proved(&format!(
            "tool Ring {{ units mm; let m = 6; curve r = hypot(d - m, z - 3);
               region core where r <= 1 {{ depth: {depth}; direction: away from (6, 3); }}
               region shell where 1 <= r, r <= 3 {{ depth: 3 - r; direction: away from (6, 3); }}
             }}"
        ))
    };
    assert!(ring("3 - r").is_exact());
    // A depth of 1 in the middle, which is 3 from the surface.
    let pits = ["1 + r", "1 + max(r, 0.5)"].map(ring);
    assert_eq!(pits.each_ref().map(Certificate::lower_slope), [None; 2]);
    assert!(pits[0].lipschitz().is_some());
    // Four slopes that rise from a point.
    let proved = proved(
        "tool Frame { units mm; tip z = 2; curve u = d - 5; curve v = z - 5;
           region low where abs(u) <= -v, -v <= 1 { depth: 1 - v; direction: (0, 1); }
           region high where abs(u) <= v, v <= 1 { depth: 1 + v; direction: (0, 1); }
           region near where abs(v) <= -u, -u <= 1 { depth: 1 - u; direction: (1, 0); }
           region far where abs(v) <= u, u <= 1 { depth: 1 + u; direction: (1, 0); }
           region below where -3 <= v, v <= -1, abs(u) <= -v { depth: 3 + v; direction: (0, 1); }
           region above where 1 <= v, v <= 3, abs(u) <= v { depth: 3 - v; direction: (0, 1); }
           region inner where -3 <= u, u <= -1, abs(v) <= -u { depth: 3 + u; direction: (1, 0); }
           region outer where 1 <= u, u <= 3, abs(v) <= u { depth: 3 - u; direction: (1, 0); }
         }",
    );
    assert!(proved.is_continuous() && proved.lipschitz().is_some(), "{:?}", proved.undecided);
    let slope = proved.lower_slope();
    assert!(slope.is_none_or(|least| least <= 1.0 / 3.0), "{slope:?}");
}

/// On the lower side of a step the slopes of both sides may lead on, so that depth is least there. The step is as
/// small as rounding, so depth counts as continuous.
#[test]
fn a_step_along_a_border_leaves_no_lower_bound() {
    let rod = |step: &str| {
        proved(&format!(
            "tool Rod {{ units mm; curve low = z - 3; curve top = 9 - z; curve r = 3 - hypot(d, z - 3);
               curve side = 3 - d;
               region ball where low <= 0, r >= 0 {{ depth: r; direction: away from (0, 3); }}
               region rod where low >= 0, 0 <= side <= top {{ depth: side + {step}; }}
               region end where low >= 0, 0 <= top <= side {{ depth: top + {step}; }} }}"
        ))
    };
    assert!(rod("0").is_exact());
    let proved = rod("1e-11");
    let is_continuous = proved.lipschitz().is_some() && proved.slack >= 1e-11;
    assert!(is_continuous, "{:?}", proved.undecided.first());
    assert_eq!(proved.lower_slope(), None);
}

/// A depth that is 0 at a point inside leads to no surface. Around the point it is a length, as depths beside
/// corners are.
#[test]
fn a_point_inside_at_which_depth_is_0_bounds_nothing() {
    let proved = proved(
        "tool Point { units mm; curve ball = 3 - hypot(d, z - 3); curve spot = hypot(d - 1, z - 3);
           region ball where 0 <= ball <= spot { depth: ball; }
           region spot where spot <= ball { depth: spot; direction: toward (1, 3); } }",
    );
    assert!(proved.lipschitz().is_some_and(|most| (most - 1.0).abs() < 1e-12));
    assert!(proved.lower_slope().is_none() && !proved.is_exact(), "{:?}", proved.lower_slope());
}

/// Beside the corner of a convex and a concave arc, eight chords per edge gave a sliver to the wrong arc.
#[test]
fn slivers_beside_corners_have_their_own_depth() {
    let profile = Profile::<f64>::parse(
        "0 0, 2.00214 2.90705, 4.41515 5.623 radius 1.869372, 3.03072 7.923 hollow radius 8.06307,
         1.144 11.157, 4.66107 14.59491 hollow radius 4.88365, 0 13.587",
    );
    let surfaces = ["a cutting", "b cutting", "c", "e", "a cutting", "top"];
    let drawn = profile.text(f64::to_string, |k| surfaces[k].to_owned());
    let tool = tool(format!("tool Sliver {{ units mm; {drawn} }}"));
    let mut interpreter = Interpreter::new(&tool);
    let mut rng = Rng::new(11);
    let mut inside = 0;
    for _ in 0..20_000 {
        let p = [rng.between(4.3, 4.45), 0.0, rng.between(5.5, 5.7)];
        let Some(evaluation) = interpreter.evaluate(p, 1.0) else { continue };
        let distance = profile.depth(&[p[0], p[2]]);
        let error = (evaluation.depth - distance).abs();
        assert!(error < 1e-12, "{p:?}: {} of {distance}", evaluation.depth);
        inside += 1;
    }
    assert!(inside > 5_000, "{inside}");
}

/// A direction that vanishes wherever it could be compared is not reported as straight.
#[test]
fn a_direction_that_is_never_known_is_not_straight() {
    let proved = proved(
        "solid Two { units mm; curve large = 20 - hypot(x, y, z); curve small = 2 - hypot(x - 30, y, z);
           region large where large >= 0 { depth: large; direction: away from (0, 0, 0); }
           region small where small >= 0 { depth: small; direction: (-y, x - 30, 0); } }",
    );
    let small = proved.regions[1].direction_error;
    assert!(small.is_none_or(|aside| aside.high > 1.5), "{small:?}");
}

/// The certificate has the exact angle of a direction, and the points where it vanishes.
#[test]
fn direction_errors_are_reported() {
    let of = |direction: &str| ball("1 - hypot(d, z - 1)", direction).regions.remove(0);
    let straight = of("away from (0, 1)");
    assert_eq!(straight.direction_error.map(|a| (a.low, a.high)), Some((0.0, 0.0)));
    let [cell] = &straight.singular_cells[..] else { panic!("{:?}", straight.singular_cells) };
    assert!(straight.turns_on_axis);
    let [d, _, z] = cell.sides;
    assert!(d.low <= 0.0 && z.low <= 1.0 && 1.0 <= z.high && z.high - z.low < 0.01);
    let reversed = of("toward (0, 1)").direction_error;
    assert!(reversed.is_some_and(|aside| aside.low > 3.1), "{reversed:?}");
    let aside = of("(1, 0)");
    let off = aside.direction_error.expect("it is known somewhere");
    let [least, most] = [off.low, off.high].map(f64::to_degrees);
    assert!(least < 1.0 && (90.0..95.0).contains(&most), "{least} {most}");
    assert!(aside.singular_cells.is_empty() && aside.turns_on_axis);
}

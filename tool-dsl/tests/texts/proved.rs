//! Tools whose depth is proved to be the distance to the surface, and some similar ones whose depth is not.

use touchoff_dsl::prove::Certificate;
use touchoff_dsl::source::Source;
use touchoff_dsl::{CheckedTool, compile};

fn tool(text: &str) -> Option<Box<CheckedTool>> {
    compile(&Source::new("t.tool", text)).into_tool()
}

/// Asserts that the depth of a tool is proved to be the distance to its surface.
fn is_proved(text: &str) {
    let tool = tool(text).unwrap_or_else(|| panic!("refused: {text}"));
    let proved = Certificate::prove(&tool);
    assert!(proved.is_exact(), "{text}\n{:?}", proved.undecided.first());
    assert!(proved.slack < 1e-9 * tool.extent.scale(), "{text}\n{:e}", proved.slack);
}

/// Returns a ring of teeth around a bore that a web closes, with the given bore and edges.
fn annular(start: &str, bore: &str, edges: &str, regions: &str) -> String {
    format!(
        "tool Annular {{ units mm; tip z = 0;
           profile {{ start {start}; {bore} {edges}
             line to (6, 25) as flute cutting; line to (6, 40), (0, 40) as shank; }} {regions} }}"
    )
}

#[test]
fn annular_cutters_are_proved() {
    let plain = "line to (4, 20), (4, 0.5) as bore;";
    let filleted = "line to (3, 20) as bore; arc to (4, 19) radius 1 concave as bore; line to (4, 0.5) as bore;";
    let domed = "arc to (4, 20) radius 8 concave as bore; line to (4, 0.5) as bore;";
    let chamfers = "line to (4.5, 0), (5.5, 0), (6, 0.5) as edge cutting;";
    let rounded = "arc to (4.5, 0) radius 0.5 as edge cutting; line to (5.5, 0) as edge cutting;
        arc to (6, 0.5) radius 0.5 as edge cutting;";
    for edges in [chamfers, rounded] {
        for (start, bore) in [("(0, 20)", plain), ("(0, 20)", filleted), ("(0, 22)", domed)] {
            is_proved(&annular(start, bore, edges, ""));
        }
        is_proved(&annular("(0, 20)", plain, edges, "regions smooth 0.2;"));
    }
}

/// A tool with a border between two flat arcs, which is not a polynomial.
const HOLLOW: &str = "tool Hollow { units mm; tip z = 0;
    profile { start (0, 1); arc to (2, 0) radius 5 as tip; arc to (3, 4) radius 6 concave as tip;
      arc to (5, 5) radius 2.5 concave as tip; line to (5, 9), (0, 9) as nut; } regions nearest; }";

#[test]
fn borders_of_flat_arcs_are_proved() {
    is_proved(HOLLOW);
}

#[test]
fn fans_are_proved() {
    is_proved(&HOLLOW.replace("nearest", "smooth 0.4"));
    let shapes = [
        "start (0, 0); arc to (3, 3) center (0, 3) as ball; line to (5, 3), (5, 9), (0, 9) as nut;",
        "start (0, 0); line to (2, 0), (2, 10) as pin; line to (4, 10), (4, 30), (0, 30) as nut;",
        "start (0, 0); line to (3, 3), (3, 20), (5, 20), (6, 22), (0, 25) as nut;",
        "start (0, 0); arc to (3, 2) radius 4 as tip; arc to (3, 4) radius 1.2 as bead;
         arc to (3, 6) radius 1.2 as bead; arc to (4, 9) radius 5 concave as neck;
         arc to (2, 11) radius 4 concave as neck; line to (0, 11) as nut;",
        "start (0, 0); line to (2, 0) as face; arc to (2.5, 3) radius 3 as bead;
         arc to (5, 4) radius 2 concave as bead; arc to (4, 7) radius 3 as bead; line to (0, 7) as nut;",
    ];
    for shape in shapes {
        for length in ["0.2", "0.4"] {
            is_proved(&format!(
                "tool T {{ units mm; profile {{ {shape} }} regions smooth {length}; }}"
            ));
        }
    }
}

/// Half a ball of radius 2 on a cylinder of radius 1 along x.
const HALF_BALL: &str = "solid HalfBall { units mm;
    curve ball = 2 - hypot(x, y, z); curve away = hypot(y, z); curve side = 1 - away; curve end = 6 - x;
    curve edge = hypot(x, away - 1);
    region ball where x <= 0, away >= 1, 0 <= ball <= -x { depth: ball; }
    region step where x <= 0, away >= 1, -x <= ball { depth: -x; }
    region core as ball where x <= 0, away <= 1, 0 <= ball <= edge { depth: ball; }
    region rim as step where x <= 0, away <= 1, edge <= ball { depth: edge; }
    region stem where x >= 0, 0 <= side <= end { depth: side; }
    region end where x >= 0, 0 <= end <= side { depth: end; } }";

/// Returns the same solid along another axis.
fn along(axis: char) -> String {
    let turned = |c: char| match (axis, c) {
        ('y', 'x' | 'y' | 'z') => char::from(b'x' + (c as u8 - b'x' + 1) % 3),
        ('z', 'x' | 'y' | 'z') => char::from(b'x' + (c as u8 - b'x' + 2) % 3),
        _ => c,
    };
    // Only single letters are coordinates; `away` is not one.
    let letters: Vec<char> = HALF_BALL.chars().collect();
    let alone = |k: usize| {
        [k.checked_sub(1), Some(k + 1)]
            .into_iter()
            .flatten()
            .all(|k| !letters.get(k).is_some_and(|c| c.is_alphanumeric()))
    };
    letters.iter().enumerate().map(|(k, c)| if alone(k) { turned(*c) } else { *c }).collect()
}

#[test]
fn solids_of_revolution_are_proved() {
    for axis in ['x', 'y', 'z'] {
        is_proved(&along(axis));
    }
}

/// Facts proved in a half plane are stated for space: extents, shares, directions and errors.
#[test]
fn solids_of_revolution_are_judged_in_space() {
    let solid = tool(HALF_BALL).expect("a solid");
    let proved = Certificate::prove(&solid);
    let share = |name: &str| {
        let named = solid.model.regions.iter().zip(&proved.regions);
        named.filter(|(region, _)| region.name == name).map(|(_, facts)| facts.share).sum::<f64>()
    };
    // The volume is 16 π/3 + 6 π, of which the end has a cone's π/3.
    let expected = 1.0 / (16.0 + 18.0);
    assert!((share("end") - expected).abs() < 0.01, "{} {expected}", share("end"));
    // A direction that does not turn with the point is examined all around the axis.
    let aslant = HALF_BALL.replace(
        "<= end { depth: side; }",
        "<= end { depth: side; direction: (0, 1, 0) allow oblique; }",
    );
    let solid = tool(&aslant).expect("a solid");
    let proved = Certificate::prove(&solid);
    let mut regions = solid.model.regions.iter();
    let stem = regions.position(|region| region.name == "stem").expect("the region `stem`");
    let angle = proved.regions[stem].direction_error.expect("an enclosed angle");
    // Where y is negative, (0, 1, 0) points straight inward: π.
    assert!(angle.high > 3.1, "{angle:?}");
    // A depth that jumps, all around the axis or on one side only, is refused or not proved continuous.
    for wrong in ["0.9*edge", "edge + 0.01*max(y, 0)"] {
        let text = HALF_BALL.replace("depth: edge", &format!("depth: {wrong}"));
        let compiled = compile(&Source::new("t.tool", &text));
        if let Some(tool) = compiled.tool() {
            assert!(!Certificate::prove(tool).is_continuous(), "{wrong}");
        } else {
            // The errors for a depth that is not 0 on the surface, and for one that jumps between regions.
            let is_jump = |code: &str| matches!(code, "T0617" | "T0620");
            let errors = compiled.diagnostics();
            let jump = errors.iter().find(|error| is_jump(error.code()));
            let message = jump.unwrap_or_else(|| panic!("{wrong}: {errors:?}")).message();
            // It is where the stem meets the half ball, all around it.
            let place = message.split(['(', ')']).nth(1).expect("a place");
            let place: Vec<f64> =
                place.split(", ").map(|word| word.parse().expect("a number")).collect();
            assert!(
                place[0].abs() < 1e-3 && (place[1].hypot(place[2]) - 1.0).abs() < 1e-3,
                "{message}"
            );
        }
    }
}

/// Depths of one region that are the smaller or the larger of several, and what is proved of them: the factors by which
/// they exceed the distance at most, and at least.
#[test]
fn the_smaller_and_the_larger_of_distances_are_proved_by_their_parts() {
    let cases = [
        // The cylinder of case 22, with its conditions in other forms, and with a part that is never the smallest.
        ("tool", "region a where 0 <= z <= 20, d <= 3 { depth: min(3 - d, z, 20 - z); }", Some(1.0), Some(1.0)),
        ("tool", "region a where 0 <= min(3 - d, z, 20 - z) { depth: min(3 - d, min(z, 20 - z)); }", Some(1.0), Some(1.0)),
        ("tool", "region a where 0 <= z <= 2, d <= 3 { depth: min(3 - d, z, 2 - z, 5 - d); }", Some(1.0), Some(1.0)),
        ("solid", "region a where 0 <= z <= 20, x^2 + y^2 <= 9 { depth: min(z, 20 - z, 3 - hypot(x, y)); }", Some(1.0), Some(1.0)),
        ("solid", "region a where -9 <= x <= 9, -8 <= y <= 8, 0 <= z <= 2 { depth: min(9 - abs(x), 8 - abs(y), z, 2 - z); }", Some(1.0), Some(1.0)),
        // With a part of twice the steepness.
        ("tool", "region a where 0 <= z <= 20, d <= 3 { depth: min(2*(3 - d), z, 20 - z); }", Some(2.0), Some(1.0)),
        // Two regions, each with such a depth; and a ball below one.
        ("tool", "region a where 0 <= z <= 20, d <= 3 { depth: min(3 - d, z); }
                  region b where 20 <= z <= 30, d <= 3 { depth: min(3 - d, 30 - z); }", Some(1.0), Some(1.0)),
        ("tool", "region a where hypot(d, z - 3) <= 3, z <= 3 { depth: 3 - hypot(d, z - 3); }
                  region b where 3 <= z <= 30, d <= 3 { depth: min(3 - d, 30 - z); }", Some(1.0), Some(1.0)),
        // The larger of two blocks' depths is continuous; at the inner edge it is no multiple of the distance.
        ("solid", "curve a = min(x, 20 - x, y, 10 - y, z, 5 - z); curve b = min(x, 5 - x, y, 10 - y, z, 30 - z);
                   region l where max(a, b) >= 0 { depth: max(a, b); }", Some(1.0), None),
        // A part that ends before the solid does leaves a depth of 0 inside.
        ("tool", "region a where 0 <= z <= 20, d <= 3 { depth: min(3 - d, z, 20 - z); }
                  region b where 20 <= z <= 30, d <= 3 { depth: min(3 - d, 30 - z, z - 20); }", Some(1.0), None),
    ];
    for (domain, regions, steepest, least) in cases {
        let text = format!("{domain} T {{ units mm; {regions} }}");
        let tool = tool(&text).unwrap_or_else(|| panic!("refused: {text}"));
        let proved = Certificate::prove(&tool);
        let near = |found: Option<f64>, expected: Option<f64>| match (found, expected) {
            (Some(found), Some(expected)) => (found - expected).abs() < 1e-8,
            (found, expected) => found == expected,
        };
        assert!(near(proved.lipschitz(), steepest), "{text}: {:?}", proved.lipschitz());
        assert!(near(proved.lower_slope(), least), "{text}: {:?}", proved.lower_slope());
    }
}

/// Depths that are less than any multiple of the distance at some point, where each two regions by themselves would
/// lead down; and one that jumps between two of the points at which the prover's boxes see no jump.
#[test]
fn hollows_where_regions_meet_are_not_proved() {
    // A pit in the middle of three slopes, where each two lead to the third.
    let sides = "curve a = -(z - 3.1); curve b = 0.8*(d - 8) + 0.6*(z - 3.1); curve c = -0.8*(d - 8) + 0.6*(z - 3.1);";
    let pit = |inner: &str, outer: &str| {
        let region = |own: &str, [other, third]: [&str; 2]| {
            format!(
                "region in{own} where {own} >= {other}, {own} >= {third}, {own} <= 1 {{ depth: {inner}; }}
                 region out{own} where {own} >= {other}, {own} >= {third}, 1 <= {own}, {outer} >= 0 {{ depth: {outer}; }} "
            )
            .replace("OWN", own)
        };
        let regions = [("a", ["b", "c"]), ("b", ["a", "c"]), ("c", ["a", "b"])];
        let regions: String = regions.map(|(own, others)| region(own, others)).concat();
        format!("tool T {{ units mm; {sides} {regions} }}")
    };
    let on_axis = "tool T { units mm; curve up = z - 3.1; curve a = d + up; curve b = d - up;
        region inup where up >= 0, a <= 1 { depth: 0.1 + 2*a; } region inlow where up <= 0, b <= 1 { depth: 0.1 + 2*b; }
        region outup where up >= 0, 1 <= a <= 3.1 { depth: 3.1 - a; }
        region outlow where up <= 0, 1 <= b <= 3.1 { depth: 3.1 - b; } }";
    // A ring around a circle on which depth is a little below 0, which is not the outside.
    let ring = "tool T { units mm; curve r = hypot(d - 5, z - 2);
        region inner where r <= 1 { depth: r - 0.000000001; }
        region outer where 1 <= r <= 1.999999999 { depth: 1.999999999 - r; } }";
    // On `wall` the depths differ by `l` where that is above 0, which is between two heights only.
    let jump = "tool T { units mm; curve up = z - 3.2mm; curve wall = d - 1mm;
        curve l = (z - 1.405mm)*(z - 1.445mm)/1mm; curve fu = 6*(3.2mm - d - up); curve fl = 6*(3.2mm - d + up);
        curve au = fu - l + hypot(l, wall); curve al = fl - l + hypot(l, wall);
        region iu where wall <= 0, up >= 0, fu >= 0 { depth: fu; } region il where wall <= 0, up <= 0, fl >= 0 { depth: fl; }
        region ou where wall >= 0, up >= 0, au >= 0, d <= 5, z <= 9 { depth: au; }
        region ol where wall >= 0, up <= 0, al >= 0, d <= 5, z >= -3 { depth: al; } }";
    let texts = [
        (pit("0.1 + 2*OWN", "3.1 - OWN"), true),
        (on_axis.to_owned(), true),
        (ring.to_owned(), true),
        (jump.to_owned(), false),
    ];
    for (text, is_continuous) in texts {
        let Some(tool) = tool(&text) else { panic!("refused: {text}") };
        let proved = Certificate::prove(&tool);
        assert_eq!(proved.lower_slope(), None, "{text}");
        assert_eq!(tool.bounds().lower_slope, None, "{text}");
        assert_eq!(proved.lipschitz().is_some(), is_continuous, "{text}");
    }
}

/// A tool for which nothing is proved says so when it is built, and its table has no bound that says nothing.
#[test]
fn a_tool_that_cannot_be_certified_is_warned_of_while_it_is_compiled() {
    let text = "tool T { units mm; region rod where d <= 3, 0 <= z <= 20 { depth: (3 - d)*z*(20 - z)/(100 + d*z); } }";
    let compiled = compile(&Source::new("t.tool", text));
    let codes: Vec<_> = compiled.diagnostics().iter().map(|found| found.code()).collect();
    assert_eq!(codes, ["T0624"]);
    let bounds = compiled.into_tool().expect("a tool").bounds();
    assert!(bounds.lipschitz.is_none() && bounds.rounding_error < 1e-9, "{bounds:?}");
}

/// A condition has no sign where a number under its root is negative, be it in a disc of a micrometre, so that nothing can
/// be concluded from it.
#[test]
fn a_root_that_does_not_exist_somewhere_is_found() {
    let rod = |root: &str| {
        format!(
            "tool T {{ units mm; curve root = sqrt({root});
               region rod where d <= 3, 0 <= z <= 20, root >= 0 {{ depth: min(3 - d, z, 20 - z); }} }}"
        )
    };
    for root in
        ["3 + d*z/4", "(d - 1)^2 + (z - 5)^2 + 0.000001", "d^2 + z^2 - d*z", "d^2 + z^2 - d*z + 1"]
    {
        is_proved(&rod(root));
    }
    for missing in ["(d - 1)^2 + (z - 5)^2 - 0.000001", "abs(d - 1.00001) + abs(z - 5) - 0.001"] {
        let tool = tool(&rod(missing)).unwrap_or_else(|| panic!("refused: {missing}"));
        let proved = Certificate::prove(&tool);
        assert_eq!([proved.lipschitz(), proved.lower_slope()], [None; 2], "{missing}");
        assert_eq!(tool.bounds().lipschitz, None, "{missing}");
        let [warning] = &proved.diagnostics(&tool)[..] else { panic!("no warning: {missing}") };
        assert!(warning.message().contains("under a root of a condition"), "{warning:?}");
    }
}

/// Tapers so small that the features on both sides are nearly equally near, beside arcs and lines, and chords in place of an
/// arc, whose normals meet in nearly one point.
#[test]
fn what_hardly_turns_is_proved() {
    for exponent in 2..=7 {
        for sign in ["", "-"] {
            for corner in
                ["arc to (5, 3) center (3, 3) as nose cutting;", "line to (5, 3) as nose cutting;"]
            {
                is_proved(&format!(
                    "tool Tapered {{ units mm; let t = {sign}1e-{exponent};
                       profile {{ start (0, 0); line to (3, 1) as face cutting; {corner}
                         line to (5 + 20*t, 23) as flute cutting; line to (5 + 20*t, 40), (0, 40) as shank; }} }}"
                ));
            }
        }
    }
    let chord = |k: u32| {
        let (sine, cosine) = (f64::from(k) / 24.0 * std::f64::consts::FRAC_PI_2).sin_cos();
        format!("({:.9}, {:.9})", 5.0 * sine, 5.0 - 5.0 * cosine)
    };
    let chords: Vec<String> = (1..=24).map(chord).collect();
    let text = format!(
        "tool Chords {{ units mm; profile {{ start (0, 0); line to {} as ball cutting;
           line to (5, 20) as flute cutting; line to (5, 40), (0, 40) as shank; }} }}",
        chords.join(", ")
    );
    is_proved(&text);
    // About three for each chord: two borders, and the side of the surface.
    let tests = tool(&text).expect("a tool").tree.test_count();
    assert!(tests < 4 * 24, "{tests}");
}

/// A zig-zag whose boxes are too many rests on its partition.
#[test]
fn profiles_of_many_segments_are_proved() {
    let points: String =
        (1..238).map(|k| format!("({}, {k}), ", 10.0 + 0.5 * f64::from(k % 2))).collect();
    let text = format!(
        "tool T {{ units mm; profile {{ start (0, 0); line to (10, 0), {points}(0, 237) as a cutting; }} }}"
    );
    is_proved(&text);
    let tool = tool(&text).expect("a tool");
    assert_eq!(Certificate::prove(&tool).diagnostics(&tool).len(), 0);
}

/// A depth that falls toward a plane in the middle is 0 or small there, far from the surface. The sides of boxes lie in that plane.
#[test]
fn valleys_between_boxes_are_found() {
    for (valley, exact) in [("abs(x)", false), ("0.5 + max(x, 0 - x)", false), ("9 - abs(x)", true)]
    {
        let text = format!(
            "solid T \"a block\" {{ units mm; region all where abs(x) <= 5, abs(y) <= 4, -5 <= z <= 5 {{
               depth: min(5 - abs(x), 4 - abs(y), 5 - abs(z), {valley}); }} }}"
        );
        let checked = tool(&text);
        let proved = checked.map(|tool| Certificate::prove(&tool));
        assert_eq!(proved.is_some_and(|proved| proved.is_exact()), exact, "{valley}");
    }
}

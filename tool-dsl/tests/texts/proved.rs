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
            assert!(errors.iter().any(|error| is_jump(error.code())), "{wrong}: {errors:?}");
        }
    }
}

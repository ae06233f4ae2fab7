//! Texts that once were accepted wrongly, took forever or took the process down.

use tool_dsl::diagnostic::any_error;
use tool_dsl::source::Source;
use tool_dsl::{Compiled, compile, emit};
use touchoff::{Pose, PoseError};

fn compiled(items: &str) -> Compiled {
    compile(&Source::new("t.tool", format!("tool T {{ units mm; {items} }}")))
}

/// Returns the messages of a text that must be refused.
fn refused(items: &str) -> String {
    let compiled = compiled(items);
    assert!(any_error(compiled.diagnostics()) && compiled.tool().is_none(), "{items} was taken");
    compiled.diagnostics().iter().map(|r| r.message()).collect::<Vec<_>>().join("; ")
}

/// A sum whose second part is no constant is computed before it is compared.
#[test]
fn an_expanded_sphere_compiles() {
    let ball = "region ball where z*z - 6mm*z + d^2 <= 0 { depth: 3 - hypot(d, z - 3); }";
    let tool = compiled(ball).into_tool().expect("a ball");
    let code = emit::source_code(&tool);
    let contains = code.split("fn contains(").nth(1).expect("it has one");
    assert!(
        contains.split('}').next().is_some_and(|body| body.contains("let q = x * x + y * y")),
        "{contains}"
    );
}

/// A curve without a value beyond d = 3 has no side there.
#[test]
fn a_curve_that_is_undefined_somewhere_is_refused() {
    let message = refused(
        "curve s = sqrt(9 - d^2); region core where s >= 1, 0 <= z <= 5 { depth: min(z, 5 - z); }",
    );
    assert!(message.contains("square root of a negative number"), "{message}");
}

/// No part of the tool lies outside its slabs, even a last sliver.
#[test]
fn the_envelope_reaches_the_end() {
    let tool = compiled(
        "region a where d <= 1, 0 <= z <= 40 { depth: min(1 - d, min(z, 40.00003 - z)); direction: (1, 0); }
         region b where d <= 1, 40 <= z <= 40.00003 { depth: min(1 - d, 40.00003 - z); direction: (1, 0); }",
    );
    let tool = tool.into_tool().expect("a cylinder in two");
    assert!(tool.envelope().iter().any(|slab| slab.high >= 40.00003));
}

#[test]
fn small_tools_are_linted_as_thoroughly() {
    let text = "tool T { units m; let r = 1e-5;
        region a where hypot(d, z - r) <= r { depth: r - hypot(d, z - r); }
        region b where hypot(d, z - 1.5*r) <= r { depth: r - hypot(d, z - 1.5*r); } }";
    let compiled = compile(&Source::new("t.tool", text));
    assert!(compiled.diagnostics().iter().any(|report| report.code() == "T0608"));
}

#[test]
fn rejects_tools_beyond_the_limits() {
    let chain = |first: &str, step: fn(usize) -> String, count: usize| {
        let mut items = format!("curve c0 = {first};");
        for k in 1..=count {
            items += &format!("curve c{k} = {};", step(k - 1));
        }
        items
            + &format!(
                "region r where hypot(d, z - 3) <= 3 {{ depth: 3 - hypot(d, z - 3); niceness: c{count}; }}"
            )
    };
    assert!(
        refused(&chain("d*d", |k| format!("c{k} + d*d*{}", k + 1), 1000))
            .contains("nested too deeply")
    );
    assert!(refused(&format!("let a = 1{};", "+1".repeat(100_000))).contains("too many operands"));
    assert!(refused("let a = 1e300000000;").contains("out of range"));
    assert!(refused("let a = ((2^16)^16)^16;").contains("out of range"));
    assert!(refused("let a = tan(90deg);").contains("right angle"));
    assert!(refused(&"/*".repeat(100_000)).contains("nested"));
    // Doubling is no growth: the polynomial of a shared sum is made once.
    let doubled = "curve c0 = d;".to_owned()
        + &(1..=28).map(|k| format!("curve c{k} = c{0} + c{0};", k - 1)).collect::<String>()
        + "region r where hypot(d, z - 3) <= 3, c28 <= 4e9 { depth: 3 - hypot(d, z - 3); }";
    assert!(compiled(&doubled).tool().is_some());
    assert!(compiled(&doubled.replace("c0 = d;", "c0 = sqrt(d^2 + 1);")).tool().is_some());
}

/// One mistake is reported once, however often the name it defines is used.
#[test]
fn consequential_errors_are_not_reported() {
    let message = refused(
        "let a = 1/0; let b = a + 1; region r where hypot(d, z - b) <= a { depth: a - d; }",
    );
    assert_eq!(message, "division by zero");
}

#[test]
fn rejects_a_pose_beyond_the_coordinate_limit() {
    let tip = nalgebra::Point3::new(0.0, 0.0, -1.7e308);
    assert_eq!(Pose::from_axis(tip, nalgebra::Vector3::z()), Err(PoseError::NotFinite));
}

/// Warnings accompany a tool that is accepted.
#[test]
fn warnings_do_not_reject_a_tool() {
    let said = |items: &str| {
        let compiled = compiled(items);
        assert!(compiled.tool().is_some(), "{items}");
        compiled.diagnostics().iter().map(|report| report.message()).collect::<Vec<_>>().join("; ")
    };
    let ball =
        |depth: &str| format!("region ball where hypot(d, z - 3) <= 3 {{ depth: {depth}; }}");
    let exact = ball("3 - hypot(d, z - 3)");
    assert_eq!(said(&exact), "");
    assert_eq!(said(&format!("let neck = 3; {exact}")), "`neck` is never used");
    let root = said(&ball("sqrt(9 - d^2 - (z - 3)^2)"));
    assert!(root.starts_with("`depth` of ball has an infinite slope at ("), "{root}");
    let steep = said(&ball("1000*(3 - hypot(d, z - 3))"));
    assert_eq!(steep, "");
    let idle =
        said(&format!("{exact} region far where hypot(d, z - 3) <= 3, z >= 30 {{ depth: z; }}"));
    assert!(idle.starts_with("region far contains none of the"), "{idle}");
}

//! Texts that once were accepted wrongly, took forever or took the process down.

use touchoff_dsl::diagnostic::{Diagnostic, any_error};
use touchoff_dsl::source::Source;
use touchoff_dsl::{Compiled, compile, emit};

fn compiled(items: &str) -> Compiled {
    compile(&Source::new("t.tool", format!("tool T {{ units mm; {items} }}")))
}

/// Returns the codes of a tool's diagnostics, in the order of the text.
fn codes(compiled: &Compiled) -> Vec<&'static str> {
    compiled.diagnostics().iter().map(Diagnostic::code).collect()
}

/// Returns the codes of a text that must be refused.
fn refused(items: &str) -> Vec<&'static str> {
    let compiled = compiled(items);
    assert!(any_error(compiled.diagnostics()) && compiled.tool().is_none(), "{items} was taken");
    codes(&compiled)
}

/// A sum whose second part is no constant is computed before it is compared.
#[test]
fn an_expanded_sphere_compiles() {
    let ball = "region ball where z*z - 6mm*z + d^2 <= 0 { depth: 3 - hypot(d, z - 3); }";
    let tool = compiled(ball).into_tool().expect("a ball");
    let code = emit::source_code(&tool);
    let evaluator = code.split("fn evaluate_lanes<").nth(1).expect("it has one");
    let test = evaluator.split("let test1").next().expect("it begins with a test");
    assert!(test.contains("let q = x * x + y * y"), "{evaluator}");
}

/// A curve without a value beyond d = 3 has no side there.
#[test]
fn a_curve_that_is_undefined_somewhere_is_refused() {
    let found = refused(
        "curve s = sqrt(9 - d^2); region core where s >= 1, 0 <= z <= 5 { depth: min(z, 5 - z); }",
    );
    assert!(found.contains(&"T0611"), "{found:?}");
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
    assert!(codes(&compile(&Source::new("t.tool", text))).contains(&"T0608"));
}

#[test]
fn rejects_tools_beyond_the_limits() {
    let chain = |first: &str, step: fn(usize) -> String, count: usize| {
        let mut items = format!("curve c0 = {first};");
        for k in 1..=count {
            items += &format!("curve c{k} = {};", step(k - 1));
        }
        let ball = "region r where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3);";
        format!("{items} {ball} niceness: c{count}; }}")
    };
    let steps = chain("d*d", |k| format!("c{k} + d*d*{}", k + 1), 1000);
    let sum = format!("let a = 1{};", "+1".repeat(100_000));
    for (items, code) in [(&steps, "T0221"), (&sum, "T0108")] {
        let found = refused(items);
        assert!(found.contains(&code), "{code} is not in {found:?}");
    }
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
    let found = refused(
        "let a = 1/0; let b = a + 1; region r where hypot(d, z - b) <= a { depth: a - d; }",
    );
    assert_eq!(found, ["T0224"]);
}

/// Warnings accompany a tool that is accepted.
#[test]
fn warnings_do_not_reject_a_tool() {
    let warnings = |items: &str| {
        let compiled = compiled(items);
        assert!(compiled.tool().is_some(), "{items}");
        codes(&compiled)
    };
    let ball =
        |depth: &str| format!("region ball where hypot(d, z - 3) <= 3 {{ depth: {depth}; }}");
    let exact = ball("3 - hypot(d, z - 3)");
    assert_eq!(warnings(&exact), [""; 0]);
    assert_eq!(warnings(&format!("let neck = 3; {exact}")), ["T0207"]);
    assert_eq!(warnings(&ball("sqrt(9 - d^2 - (z - 3)^2)")), ["T0618"]);
    assert_eq!(warnings(&ball("1000*(3 - hypot(d, z - 3))")), [""; 0]);
    let idle = format!("{exact} region far where hypot(d, z - 3) <= 3, z >= 30 {{ depth: z; }}");
    assert_eq!(warnings(&idle), ["T0610"]);
}

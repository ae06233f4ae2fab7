//! Absurd input: enormous sizes, deep nesting, thousands of everything, bytes that are no text. Each is refused at
//! once with a clear message; an input that took long would be noticed here.

use std::path::PathBuf;
use touchoff_dsl::diagnostic::{Diagnostic, Severity};
use touchoff_dsl::source::Source;
use touchoff_dsl::{Compiled, compile};

const BALL: &str = "region ball where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); }";

fn compiled(text: impl Into<String>) -> Compiled {
    compile(&Source::new("t.tool", text))
}

/// Returns a tool of which only some items matter.
fn tool(items: &str) -> String {
    format!("tool T {{\n    units mm;\n    {items}\n    {BALL}\n}}\n")
}

/// Returns a tool of one profile.
fn profile(rest: &str) -> String {
    format!("tool T {{ units mm; profile {{ start (0, 0); line to {rest} }} }}")
}

fn numbered(count: usize, item: impl Fn(usize) -> String) -> String {
    (0..count).map(item).collect()
}

fn errors(compiled: &Compiled) -> Vec<String> {
    let errors = compiled.diagnostics().iter().filter(|report| report.severity == Severity::Error);
    errors.map(Diagnostic::message).collect()
}

/// Returns a text's errors: few enough to read, each with a remedy and a place that can be shown.
fn refused(text: &str) -> Vec<String> {
    let compiled = compiled(text);
    let start: String = text.chars().take(200).collect();
    assert!(compiled.tool().is_none() && !errors(&compiled).is_empty(), "{start} was taken");
    let count = compiled.diagnostics().len();
    assert!(count <= 51, "{count} reports of {start}");
    for report in compiled.diagnostics() {
        assert!(!report.help().is_empty(), "no remedy: {}", report.message());
        assert!(report.render(&compiled.sources, false).contains(&report.message()));
    }
    errors(&compiled)
}

#[test]
fn rejects_sizes_beyond_the_limits() {
    for text in [
        profile("(1e300, 0), (1e300, 1e300), (0, 1e300) as pin;"),
        profile("(1e-300, 0), (1e-300, 1e-300), (0, 1e-300) as pin;"),
        tool("let a = 1e999999999;"),
        tool("let a = 1e-999999999;"),
        tool(&format!("let a = {};", "9".repeat(100_000))),
        tool("let a = ((((2^16)^16)^16)^16)^16;"),
        tool("let a = ((((0.5^16)^16)^16)^16)^16;"),
        profile("(1e80*1e80, 0), (1, 1), (0, 1) as pin;"),
    ] {
        let said = refused(&text);
        assert!(said.iter().all(|said| said.contains("out of range")), "{said:?}");
    }
    let tower = format!("let a = {}2{};", "2^(".repeat(30), ")".repeat(30));
    for text in ["curve a = d^1000000000;", &tower] {
        assert!(refused(&tool(text))[0].contains("an exponent must be a multiple"));
    }
    let arc = "profile { start (0, 0); arc to (3, 3) radius 1e80 as ball; line to (0, 9) as top; }";
    let said = refused(&format!("tool T {{ units mm; {arc} }}"));
    assert!(said[0].contains("is too flat between these points"), "{said:?}");
    let huge = "region far where ((d^16)^16)^16 <= 1, 0 <= z <= 1 { depth: 1 - z; }";
    let said = refused(&format!("tool T {{ units m; {huge} }}"));
    assert!(!said[0].contains("square root"), "{said:?}");
}

#[test]
fn rejects_deep_nesting() {
    let paren = format!("let a = {}1{};", "(".repeat(100_000), ")".repeat(100_000));
    let brace = format!("{}{}", "{".repeat(100_000), "}".repeat(100_000));
    for text in [tool(&paren), tool(&brace), "/*".repeat(100_000)] {
        assert!(refused(&text)[0].contains("nested more than 64 levels deep"));
    }
    assert!(refused(&tool(&format!("let a = {}1;", "-".repeat(100_000))))[0].contains("`-`"));
}

#[test]
fn large_files_are_compiled_or_rejected() {
    let region = |k: usize| format!("region r{k} where hypot(d, z) <= {k} {{ depth: {k} - d; }}\n");
    let zigzag = numbered(10_000, |k| format!("({}, {}), ", 1 + k % 2, k + 1));
    let laws = "niceness ball: 1;".repeat(20_000);
    let args = numbered(20_000, |k| format!("d + {k}, ")) + "d";
    let name = "a".repeat(500_000);
    for (text, word) in [
        (tool(&numbered(10_000, region)), "more than 4096 items"),
        (tool(&numbered(1_000, region)), "more than 256 regions"),
        (profile(&format!("{zigzag}(0, 10001) as a;")), "more than 256 segments"),
        (tool(&"a;".repeat(100_000)), "more than 4096 items"),
        (tool(&"{}".repeat(100_000)), "more than 4096 items"),
        (tool(&"let a = 1;".repeat(60_000)), "more than 4096 items"),
        (tool(&"let a = 1;".repeat(4_000)), "`a` is defined twice"),
        (tool(&"x y;".repeat(4_000)), "unknown item `x`"),
        (tool(&numbered(4_000, |k| format!("let a{k} = b{k};"))), "unknown name `b0`"),
        (tool(&laws), "more than 4096 items"),
        (tool(&laws[..60_000]), "two laws give the niceness of `ball`"),
        (tool(&format!("niceness {}ball: 1;", "ball, ".repeat(20_000))), "two laws give"),
        (tool(&format!("curve a = min({args});")), "nested too deeply"),
        (
            tool(&format!("region b where {}d <= 1 {{ depth: d; }}", "z <= 1, ".repeat(20_000))),
            "more than 256 conditions",
        ),
        (tool(&format!("let {name} = 1; let b = {name}c;")), "this name is 500000 letters long"),
        (tool(&" ".repeat(10_000_000)), "bytes long"),
        (format!("tool T {{ {} }}", "a ".repeat(100_000)), "`;` is missing after this"),
    ] {
        let said = refused(&text);
        assert!(said.iter().any(|said| said.contains(word)), "{word}: {said:?}");
    }
}

#[test]
fn rejects_text_that_is_not_a_tool() {
    for (text, word) in [
        ("".to_owned(), "there is no tool in this text"),
        (" \n\n".to_owned(), "there is no tool in this text"),
        ("// nothing\n".to_owned(), "there is no tool in this text"),
        (format!("\u{feff}{}", tool("")), "byte order mark"),
        (tool("let a = 3;\0"), "the invisible character U+0000"),
        (tool("let\u{a0}a = 3;"), "the invisible character U+00A0"),
        (tool("let \u{202e}a = 3;"), "the invisible character U+202E"),
        (tool("let a\u{200b} = 3;"), "the invisible character U+200B"),
        (tool("let 🙂 = 3;"), "`🙂` is not part of the language"),
        (tool("let a = nan;"), "unknown name `nan`"),
        (tool("let a = inf;"), "unknown name `inf`"),
        (
            tool(&format!("let a = {};", "\"".repeat(100_001))),
            "this text has no closing quotation mark",
        ),
        (tool("let a = 3\r\n").replace('\n', "\r\n"), "`;` is missing after this"),
    ] {
        assert!(refused(&text)[0].contains(word), "{word}: {:?}", refused(&text));
    }
    let windows = compiled(tool("").replace('\n', "\r\n"));
    assert!(windows.tool().is_some(), "{:?}", windows.diagnostics());
}

fn folder() -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("bad_input");
    std::fs::create_dir_all(&folder).expect("cargo's target folder can be written to");
    folder
}

fn write(name: &str, bytes: impl AsRef<[u8]>) {
    std::fs::write(folder().join(name), bytes).expect("a writable folder");
}

/// Returns the errors of a tool that mounts a file.
fn mounted(mounts: &str) -> String {
    let text = format!("tool T {{ units mm; {mounts} }}");
    let compiled = compile(&Source::new("t.tool", text).with_path(folder().join("t.tool")));
    assert!(compiled.tool().is_none());
    errors(&compiled).join("; ")
}

#[test]
fn rejects_endless_mounts() {
    let part = "profile { start (0, 0); line to (1, 0), (1, 9), (0, 9) as a; }";
    write("part.tool", format!("tool Part {{ units mm; {part} }}"));
    for k in 0..80 {
        let next = k + 1;
        let twins =
            format!("mount \"twin{next}.tool\" as a; mount \"twin{next}.tool\" as b at z = 4;");
        write(&format!("twin{k}.tool"), format!("tool Twin {{ units mm; {twins} }}"));
    }
    assert_eq!(mounted("mount \"twin0.tool\" as a;"), "more than 64 mounted files");
    let many = numbered(70, |k| format!("mount \"part.tool\" as a{k} at z = {k};"));
    assert!(mounted(&many).contains("more than 64 mounted files"));
    write("ring.tool", "tool Ring { units mm; mount \"ring.tool\" as a; }");
    assert!(mounted("mount \"ring.tool\" as a;").contains("mounts itself"));
}

#[test]
fn rejects_files_that_are_not_text() {
    write("latin.tool", b"tool T {\n    units mm; // fr\xe4ser\n}");
    assert!(mounted("mount \"latin.tool\" as a;").contains("line 2 is no UTF-8 text"));
    write("long.tool", vec![b' '; 10_000_000]);
    assert!(mounted("mount \"long.tool\" as a;").contains("longer than 1048576 bytes"));
    assert!(mounted("mount \".\" as a;").contains("cannot read"));
    #[cfg(unix)]
    assert!(mounted("mount \"/dev/zero\" as a;").contains("is outside the tool's folder"));
}

/// Many regions by hand are planned in seconds.
#[test]
fn a_hundred_balls_in_a_row_compile() {
    let ball = |k: usize| {
        let z = 3 * k + 1;
        format!("region r{k} where hypot(d, z - {z}) <= 1 {{ depth: 1 - hypot(d, z - {z}); }}\n")
    };
    let text = format!("tool T {{ units mm; {} }}", numbered(100, ball));
    assert!(compiled(text).tool().is_some());
}

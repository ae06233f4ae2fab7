//! Texts that the compiler refuses: each gives an error with the reason, on a small stack and without delay.

use std::path::PathBuf;
use touchoff_dsl::source::Source;
use touchoff_dsl::{Compiled, compile, compile_with_arguments, emit, format};

const BALL: &str = "region ball where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); }";

fn tool(items: &str) -> String {
    format!("tool T {{ units mm; {items} {BALL} }}")
}

/// Returns the first error of a tool that is refused.
#[track_caller]
fn error(compiled: &Compiled) -> String {
    let Err(refusal) = &compiled.outcome else { panic!("taken") };
    let first = refusal.errors().next().expect("a refusal has an error");
    assert!(first.render(&compiled.sources, false).contains(&first.message()));
    assert!(!first.message().is_empty());
    first.message()
}

#[track_caller]
fn refused(items: &str) -> String {
    error(&compile(&Source::new("t.tool", tool(items))))
}

/// Runs on a thread whose stack is smaller than any default.
fn on_small_stack<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    let thread = std::thread::Builder::new().stack_size(SMALL);
    thread.spawn(work).expect("a thread").join().expect("no panic")
}

/// The size of that stack in bytes. Threads have 2 MiB by default, a process's main thread mostly 8 MiB.
const SMALL: usize = 1 << 20;

/// Runs everything that reads a text, on a small stack.
fn read(text: String) -> Result<(), String> {
    on_small_stack(move || {
        let source = Source::new("t.tool", text);
        let _ = format::format(&source);
        let _ = emit::tree(&source);
        let compiled = compile(&source);
        match compiled.tool() {
            Some(tool) => {
                assert!(!emit::emit(tool).is_empty() && !emit::dot(tool).is_empty());
                Ok(())
            }
            None => Err(error(&compiled)),
        }
    })
}

/// Compiles a text and returns the codes of its errors.
#[track_caller]
fn codes(text: &str) -> Vec<&'static str> {
    let compiled = compile(&Source::new("t.tool", text));
    let Err(refusal) = &compiled.outcome else { panic!("{text}: accepted") };
    refusal.errors().map(touchoff_dsl::diagnostic::Diagnostic::code).collect()
}

/// A diagnostic of a spelling mistake is for that mistake only, not for similar text elsewhere.
#[test]
fn spelling_mistakes_are_told_apart() {
    let region = |body: &str| format!("tool T {{ units mm; region ball {body} }}");
    assert_eq!(codes(&region("where 0 <= z <= 2 <= d { depth: d; }"))[0], "T0154");
    // In a property, and in an item whose name only begins with `region`.
    assert_eq!(codes(&region("where d <= 3 { depth: d < 3; }"))[0], "T0155");
    assert_eq!(codes(&tool("regions smooth 3 < 4;"))[0], "T0155");

    assert_eq!(codes(&tool("let a = 2,5;"))[0], "T0147");
    // `2.5,1` and `x1,2` are no decimal commas: with a point they would be no numbers either.
    assert_ne!(codes(&tool("let a = 2.5,1;"))[0], "T0147");
    assert_ne!(codes(&tool("let x1 = 2; let a = x1,2;"))[0], "T0147");

    assert_eq!(codes(&format!("\u{feff}{}", tool("")))[0], "T0142");
    assert_eq!(codes(&tool("let a = \u{feff}2;"))[0], "T0144");
    assert_eq!(codes(&format!(" \u{feff}{}", tool("")))[0], "T0144");

    assert_eq!(codes(&tool("let a = 2^3^2;"))[0], "T0136");
    assert_ne!(codes(&tool("let a = ^2;"))[0], "T0136");
    assert_ne!(codes(&tool("let a ^ 2;"))[0], "T0136");

    assert_eq!(codes(&tool("let a = [2];"))[0], "T0156");
    assert_eq!(codes(&tool("let a = 2 − 1;"))[0], "T0141");
}

#[test]
fn names_defined_by_themselves_are_named_with_every_link() {
    for word in ["let", "param", "curve"] {
        assert_eq!(refused(&format!("{word} a = a;")), "`a` is defined in terms of itself");
        assert_eq!(
            refused(&format!("{word} a = 2*(1 + hypot(a, 3));")),
            "`a` is defined in terms of itself"
        );
    }
    assert_eq!(
        refused("let a = b; let b = a;"),
        "`a` is defined in terms of itself: `a` needs `b`, `b` needs `a`"
    );
    assert_eq!(
        refused("let a = b; curve b = d + c; param c = min(1, a); let e = c;"),
        "`a` is defined in terms of itself: `a` needs `b`, `b` needs `c`, `c` needs `a`"
    );
    let given = [Source::new("--set", "a=3")];
    let compiled = compile_with_arguments(&Source::new("t.tool", tool("param a = a;")), &given);
    assert_eq!(error(&compiled), "`a` is defined in terms of itself");
}

#[test]
fn each_cycle_is_said_once() {
    let compiled =
        compile(&Source::new("t.tool", tool("let a = b; let b = a; let c = a; let e = c + e;")));
    let Err(refusal) = &compiled.outcome else { panic!("taken") };
    let said: Vec<String> = refusal.errors().map(|report| report.message()).collect();
    assert_eq!(
        said,
        [
            "`a` is defined in terms of itself: `a` needs `b`, `b` needs `a`",
            "`e` is defined in terms of itself"
        ]
    );
}

#[test]
fn a_cycle_as_long_as_a_file_is_said_too() {
    let links: String = (0..4000).map(|k| format!("let a{k} = a{};", (k + 1) % 4000)).collect();
    let said = read(tool(&links)).expect_err("a cycle");
    assert!(said.starts_with("`a0` is defined in terms of itself: `a0` needs `a1`"), "{said}");
    assert!(said.ends_with("and 3936 more links lead back to `a0`"), "{said}");
}

/// Constants are evaluated before curves, so a constant cannot use a curve, wherever the curve is defined.
#[test]
fn a_curve_is_no_constant() {
    for items in ["curve c = d; let a = c;", "curve c = 3; param a = c;", "curve c = 3; tip z = c;"]
    {
        assert!(refused(items).starts_with("`c` varies from point to point"), "{items}");
    }
}

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("cargo's target folder can be written to");
    folder
}

#[test]
fn a_cycle_in_a_mounted_file_is_said_of_that_file() {
    let folder = folder("cycles");
    let profile = "profile { start (0, 0); line to (1, 0), (1, 9), (0, 9) as a cutting; }";
    for (name, items) in [("let", "let a = a;"), ("curve", "curve a = a; niceness cutting: a;")] {
        let part = format!("tool Part {{ units mm; {items} {profile} }}");
        std::fs::write(folder.join(format!("{name}.tool")), part).expect("a writable folder");
        let text = format!("tool T {{ units mm; mount \"{name}.tool\" as a; }}");
        let compiled = compile(&Source::new("t.tool", text).with_path(folder.join("t.tool")));
        assert_eq!(error(&compiled), "`a` is defined in terms of itself");
        let Err(refusal) = &compiled.outcome else { panic!("taken") };
        let place = refusal.diagnostics()[0].span;
        assert!(compiled.sources.locate(place).0.name.ends_with(&format!("{name}.tool")));
    }
}

/// Each of these once hid its nesting from the limit, or is nested exactly to the limit.
#[test]
fn nesting_is_limited_on_a_small_stack() {
    let limit = "brackets are nested more than 64 levels deep";
    let hidden = |hide: &str| {
        let (open, close) = (format!("({hide}").repeat(5000), ")".repeat(5000));
        read(tool(&format!("let a = {open}1{close};")))
    };
    for hide in ["//)\n", "/*)*/", "/*)))*/", "// \"\n", "/* /* ) */ */"] {
        assert_eq!(hidden(hide), Err(limit.to_owned()), "{hide:?}");
    }
    let braces = format!("tool T {{ x {}", "{ \"}\"".repeat(5000));
    assert_eq!(read(braces), Err(limit.to_owned()));
    // A quote without a closing one hides nothing.
    let quotes = format!("tool T {{ x \"a\\\n{}", "{ \"\\".repeat(5000));
    assert_eq!(read(quotes), Err(limit.to_owned()));
    let deepest = format!("let a = {}1{};", "(".repeat(62), ")".repeat(62));
    assert_eq!(read(tool(&deepest)), Ok(()));
    let comments = format!("{}{} {}", "/*".repeat(64), "*/".repeat(64), tool(""));
    assert_eq!(read(comments.clone()), Ok(()));
    assert!(read(format!("/*{comments}*/")).expect_err("deeper").contains("comments are nested"));
}

#[test]
fn brackets_in_comments_and_texts_do_not_count() {
    let many = "(".repeat(200);
    assert_eq!(read(tool(&format!("// {many}\n /* {many} */ let a = 1;"))), Ok(()));
    let titled = tool("").replace("tool T", &format!("tool T \"{many} /* // */\""));
    assert_eq!(read(titled), Ok(()));
}

/// pest would try 2^n ways to read them.
#[test]
fn comments_that_do_not_end_are_refused_at_once() {
    for count in [1, 30, 60] {
        let text = format!("tool T {{ {}", "/* ".repeat(count));
        assert_eq!(read(text), Err("this comment is not closed".to_owned()));
    }
    assert_eq!(read("tool T { /*/".to_owned()), Err("this comment is not closed".to_owned()));
}

#[test]
fn expressions_are_limited_on_a_small_stack() {
    // The largest number of operands in a sum, in the largest number of brackets, nested on the left and on
    // the right.
    let left = (0..62).fold("a".to_owned(), |inner, _| format!("({inner}){}", " + a".repeat(60)));
    let right = (0..62).fold("a".to_owned(), |inner, _| format!("{}({inner})", "a*".repeat(60)));
    let powers =
        (0..62).fold("a".to_owned(), |inner, _| format!("-({inner})^(-1){}", "*a/a".repeat(31)));
    assert_eq!(read(tool(&format!("let a = 1; curve c = {right};"))), Ok(()));
    for deep in [left, powers] {
        let said = read(tool(&format!("let a = 1; curve c = {deep};"))).expect_err("too deep");
        assert_eq!(said, "this expression nests more than 300 operations");
    }
    let calls =
        (0..62).fold("d".to_owned(), |inner, _| format!("max(0, {inner}{})", "+1".repeat(4)));
    let said = read(tool(&format!("curve c = {calls};"))).expect_err("too deep");
    assert_eq!(said, "this expression nests more than 300 operations");
    let tall: String = (1..=290).map(|k| format!("curve c{k} = sqrt(1 + c{});", k - 1)).collect();
    let tall = tool(&format!("curve c0 = d; {tall} niceness ball: c290;"));
    assert!(read(tall).is_err());
    for signs in ["-".repeat(100_000), "not ".repeat(100_000), "+".repeat(100_000)] {
        assert!(read(tool(&format!("let a = {signs}1;"))).is_err());
    }
}

/// Expressions of the largest allowed height pass through all later stages.
#[test]
fn the_tallest_expressions_compile_on_a_small_stack() {
    let steps: String =
        (1..=140).map(|k| format!("curve c{k} = max(c{} - 1e-3, 0);", k - 1)).collect();
    let text = format!(
        "tool T {{ units mm; curve c0 = d; {steps}
         region ball as ball cutting where hypot(d, z - 3) <= 3 {{ depth: 3 - hypot(d, z - 3); niceness: c140; }} }}"
    );
    assert_eq!(read(text), Ok(()));
    let roots: String = (1..=60).map(|k| format!("curve c{k} = sqrt(1 + c{});", k - 1)).collect();
    let text = format!(
        "tool T {{ units mm; curve c0 = d; {roots}
         region ball as ball cutting where hypot(d, z - 3) <= 3 {{ depth: 3 - hypot(d, z - 3); niceness: c60; }} }}"
    );
    assert_eq!(read(text), Ok(()));
}

/// The chain of files is as deep as the number of files allows.
#[test]
fn mounts_in_mounts_need_no_more_stack() {
    let folder = folder("chain");
    for k in 0..80 {
        let text = format!("tool Deep {{ units mm; mount \"deep{}.tool\" as a; }}", k + 1);
        std::fs::write(folder.join(format!("deep{k}.tool")), text).expect("a writable folder");
    }
    let said = on_small_stack(move || {
        let text = "tool T { units mm; mount \"deep0.tool\" as a; }";
        error(&compile(&Source::new("t.tool", text).with_path(folder.join("t.tool"))))
    });
    assert_eq!(said, "more than 64 mounted files");
}

/// Syntax errors in texts of one line, where every bracket once searched for the beginning of the line.
#[test]
fn long_lines_are_refused_at_once() {
    for braces in ["{}", "({)}", "}"] {
        assert!(read(format!("tool T {{ {}", braces.repeat(25_000))).is_err());
    }
}

/// Makes a folder with tools, and one beside it from which they may not mount.
fn two_folders(name: &str) -> (PathBuf, PathBuf) {
    let both = folder(name);
    let (own, other) = (both.join("own"), both.join("other"));
    for folder in [&own, &other] {
        std::fs::create_dir_all(folder).expect("a writable folder");
        let part = "profile { start (0, 0); line to (1, 0), (1, 9), (0, 9) as a cutting; }";
        let part = format!("tool Part {{ units mm; {part} }}");
        std::fs::write(folder.join("part.tool"), part).expect("a writable folder");
    }
    (own, other)
}

fn mounting(file: &str) -> Source {
    Source::new("t.tool", format!("tool T {{ units mm; mount \"{file}\" as a; }}"))
}

#[test]
fn mounts_stay_below_the_tools_folder() {
    let (own, other) = two_folders("mounts");
    let held = |file: &str| mounting(file).with_path(own.join("t.tool"));
    assert!(compile(&held("part.tool")).tool().is_some());
    assert!(compile(&held("../own/part.tool")).tool().is_some());
    let whole = other.join("part.tool").display().to_string();
    for file in ["../other/part.tool", "../none.tool", "../../x/../y.tool", "/etc/passwd", &whole] {
        let said = error(&compile(&held(file)));
        assert_eq!(said, format!("`{file}` is outside the tool's folder"));
    }
    // A folder above both, set by the caller.
    let above = own.parent().expect("a folder above");
    assert!(compile(&held("../other/part.tool").with_root(above)).tool().is_some());
    let said = error(&compile(&held("/etc/passwd").with_root(above)));
    assert_eq!(said, format!("`/etc/passwd` is outside the folder `{}`", above.display()));
    let here = error(&compile(&held("/etc/passwd").with_root("")));
    assert_eq!(here, "`/etc/passwd` is outside the folder `.`");
    assert!(error(&compile(&held("none.tool"))).starts_with("cannot read"));
}

#[cfg(unix)]
#[test]
fn links_lead_nowhere_else() {
    let (own, other) = two_folders("links");
    let link = own.join("link.tool");
    let _ = std::fs::remove_file(&link);
    std::os::unix::fs::symlink(other.join("part.tool"), &link).expect("a link");
    let said = error(&compile(&mounting("link.tool").with_path(own.join("t.tool"))));
    assert!(said.contains("outside the tool's folder"), "{said}");
}

/// No line of a file that is not a tool is shown.
#[test]
fn the_text_of_other_files_is_not_shown() {
    let (own, _) = two_folders("secrets");
    std::fs::write(own.join("key"), "secret = 1234\n").expect("a writable folder");
    let compiled = compile(&mounting("key").with_path(own.join("t.tool")));
    assert_eq!(error(&compiled), "`key` is not a `.tool` file");
    for report in compiled.diagnostics() {
        assert!(!report.render(&compiled.sources, false).contains("secret"));
    }
}

#[cfg(unix)]
#[test]
fn devices_and_pipes_are_no_tools() {
    for device in ["/dev/zero", "/dev/null"] {
        let error = Source::read(device).expect_err("refused").to_string();
        assert!(error.contains("no regular file"), "{error}");
    }
    let error = Source::read(folder("pipes")).expect_err("a folder").to_string();
    assert!(!error.is_empty());
}

/// Names and texts from files are shown on a terminal.
#[test]
fn what_cannot_be_seen_is_refused_or_escaped() {
    for hidden in ["\u{1b}[31m", "\u{7f}", "\u{9b}31m", "\u{202e}", "\u{2066}", "\u{200f}"] {
        let titled = tool("").replace("tool T", &format!("tool T \"a{hidden}b\""));
        assert!(read(titled).expect_err("refused").contains("invisible character"), "{hidden:?}");
        let mounted = format!("tool T {{ units mm; mount \"{hidden}.tool\" as a; }}");
        assert!(read(mounted).expect_err("refused").contains("invisible character"));
        // A comment may contain it. It is replaced where the line or the name of the file is shown.
        let source =
            Source::new(format!("t{hidden}.tool"), tool(&format!("/*{hidden}*/ let a = b;")));
        let compiled = compile(&source);
        for report in compiled.diagnostics() {
            let shown = report.render(&compiled.sources, false);
            assert!(
                !shown.contains(&hidden[..hidden.chars().next().expect("one").len_utf8()]),
                "{shown:?}"
            );
        }
    }
    assert_eq!(touchoff_dsl::diagnostic::escaped("a\u{1b}\u{202e}é"), "a\\u{1b}\\u{202e}é");
}

#[test]
fn values_that_break_a_profile_are_named() {
    let text = "tool T { units mm; param D = 6; profile { start (0, 0); line to (D/2, 0), (D/2, 9), (0, 9) as a cutting; } }";
    let compiled =
        compile_with_arguments(&Source::new("t.tool", text), &[Source::new("--set", "D=-1")]);
    let Err(refusal) = &compiled.outcome else { panic!("taken") };
    assert!(refusal.errors().all(|report| { report.help().ends_with("given: `D=-1`") }));
    // An error in the argument itself shows the argument anyway.
    let compiled =
        compile_with_arguments(&Source::new("t.tool", text), &[Source::new("--set", "D=x")]);
    let Err(refusal) = &compiled.outcome else { panic!("taken") };
    assert!(refusal.errors().all(|r| !r.help().contains("given: ")));
}

#[test]
fn profiles_that_would_take_minutes_are_refused_at_once() {
    let zigzag = |count: usize| {
        let points = (1..count - 2).map(|k| format!("({}, {k}), ", 10.0 + 0.5 * (k % 2) as f64));
        let points: String = points.collect();
        format!(
            "tool T {{ units mm; profile {{ start (0, 0); line to (10, 0), {points}(0, {}) as a cutting; }}",
            count - 3
        )
    };
    let smooth = |count: usize| read(format!("{} regions smooth 0.05; }}", zigzag(count)));
    assert_eq!(smooth(200), Err("`regions smooth` with more than 128 segments".to_owned()));
    assert_eq!(smooth(24), Ok(()));
}

/// A ring below the tip that no column of samples meets.
#[test]
fn a_tip_above_the_tools_end_is_refused() {
    let said = refused(
        "curve ring = 0.1 - hypot(d - 1.93, z + 20.25); region ring where ring >= 0 { depth: ring; }",
    );
    assert!(said.contains("the tool ends at z = -20.35"), "{said}");
}

/// Remedies that lead to the text that is meant, and not to the next error.
#[test]
fn remedies_name_what_was_meant() {
    let profile = |items: &str| format!("tool T {{ units mm; {items} }}");
    let pin = "profile { start (0, 0); line to (3, 0) as face; line to (3, 20) as flute cutting; line to (0, 20) as top; }";
    for (text, codes, help) in [
        (profile(&format!("let r = q + 3mm; {pin}")), &["T0201"][..], "define"),
        (
            profile(&pin.replace("3, 0", "x, 0").replace("profile", "let x = 3; profile")),
            &["T0205"],
            "another name",
        ),
        (
            profile(&pin.replace("face;", "face; start (3, 0);")),
            &["T0119"],
            "a profile is one line",
        ),
        (profile(&pin.replace("cutting", "cuting")), &["T0119"], "did you mean `cutting`?"),
        (profile(&format!("{pin} niceness cuting: 1;")), &["T0419"], "did you mean `cutting`?"),
        (profile(&format!("{pin} magnitude: depth/d;")), &["T0612"], "write a divisor"),
    ] {
        let compiled = compile(&Source::new("t.tool", text.clone()));
        let found = compiled.diagnostics();
        let found_codes: Vec<_> = found.iter().map(|found| found.code()).collect();
        assert_eq!(found_codes, codes, "{text}");
        assert!(found[0].help().contains(help), "{text}: {}", found[0].help());
    }
}

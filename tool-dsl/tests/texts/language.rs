//! The examples of docs/language.md: each is a whole file and behaves as the page states.
//!
//! A block that is fenced as `tool` compiles without a diagnostic. One that is fenced as `tool,fails` has a comment
//! `// error: …`, and an error on that line with this text. One that is fenced as `tool,soon` is not accepted yet.
//! A first line such as `// ball.tool` gives the file's name, by which other examples mount it.

use std::path::{Path, PathBuf};
use touchoff_dsl::compile;
use touchoff_dsl::diagnostic::{Diagnostic, Severity};
use touchoff_dsl::source::Source;

const LANGUAGE_PAGE: &str = include_str!("../../../docs/language.md");
const ERROR_PREFIX: &str = "// error: ";

struct Example {
    /// The rest of its fence behind `tool`.
    fence: String,
    /// The line of the page at which it begins.
    line: usize,
    text: String,
}

impl Example {
    fn all() -> Vec<Example> {
        let mut all: Vec<Example> = Vec::new();
        let mut open = false;
        for (at, line) in LANGUAGE_PAGE.lines().enumerate() {
            if open && line == "```" {
                open = false;
            } else if open {
                let example = all.last_mut().expect("it was opened");
                example.text += line;
                example.text += "\n";
            } else if let Some(fence) = line.strip_prefix("```tool") {
                open = true;
                all.push(Example { fence: fence.to_owned(), line: at + 2, text: String::new() });
            }
        }
        all
    }

    fn place(&self, folder: &Path) -> PathBuf {
        let first = self.text.lines().next().and_then(|line| line.strip_prefix("// "));
        let name = first.filter(|name| name.ends_with(".tool") && !name.contains(' '));
        folder.join(name.map_or_else(|| format!("line_{}.tool", self.line), str::to_owned))
    }

    /// Returns the diagnostics of a good example; `None` if there are none.
    fn compiles(source: &Source) -> Option<String> {
        let compiled = compile(source);
        let render = |report: &Diagnostic| report.render(&compiled.sources, false);
        // Notes tell what a force law makes of an example.
        let found = compiled.diagnostics().iter().filter(|one| one.severity != Severity::Note);
        let said: Vec<String> = found.map(render).collect();
        (!said.is_empty()).then(|| said.join("\n"))
    }

    /// Returns the complaint about a bad example; `None` if it fails as expected.
    fn fails(&self, source: &Source) -> Option<String> {
        let Some((before, after)) = self.text.split_once(ERROR_PREFIX) else {
            return Some(format!("which error? write `{ERROR_PREFIX}…` where it stands"));
        };
        let (line, expected) = (before.lines().count(), after.lines().next().unwrap_or_default());
        let compiled = compile(source);
        let reports = compiled.diagnostics();
        let found = reports.iter().any(|report| {
            let stands = source.text[..report.span.start].matches('\n').count() + 1;
            report.severity == Severity::Error
                && stands == line
                && report.message().contains(expected)
        });
        (!found).then(|| format!("`{expected}` is not said of its line {line}, but {reports:#?}"))
    }
}

#[test]
fn every_example_has_the_documented_result() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("language");
    std::fs::create_dir_all(&folder).expect("cargo's target folder can be written to");
    let examples = Example::all();
    for example in &examples {
        std::fs::write(example.place(&folder), &example.text).expect("a writable folder");
    }
    let (mut good, mut bad, mut soon, mut wrong) = (0, 0, 0, String::new());
    for example in &examples {
        let source = Source::read(example.place(&folder)).expect("it was written");
        let said = match example.fence.as_str() {
            "" => {
                good += 1;
                Example::compiles(&source)
            }
            ",fails" => {
                bad += 1;
                example.fails(&source)
            }
            ",soon" => {
                soon += 1;
                None
            }
            other => Some(format!("a fence says `tool{other}`")),
        };
        if let Some(said) = said {
            wrong += &format!("docs/language.md:{}: {said}\n\n", example.line);
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
    assert!(good >= 8 && bad >= 5, "{good} good and {bad} bad examples");
    println!("{good} examples compile, {bad} fail as the page says, {soon} are still to come");
}

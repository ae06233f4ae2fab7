//! The documentation: links lead somewhere, and command lines name what exists.

use super::bench::{Bench, stderr};
use super::help::parsed;
use serde_json::Value;
use std::collections::HashMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().expect("the repository")
}

/// Returns the files with this extension in a folder and the folders below, without build outputs and downloads.
fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or(".");
        if path.is_dir() && !name.starts_with('.') && !["node_modules", "target"].contains(&name) {
            found.extend(files(&path, extension));
        } else if path.extension().is_some_and(|found| found == extension) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// A Markdown page: running text, lines of `sh` and `text` blocks, code spans, and anchors as GitHub makes them.
#[derive(Default)]
struct Page {
    prose: String,
    block_lines: Vec<String>,
    spans: Vec<String>,
    anchors: Vec<String>,
}

impl Page {
    fn read(file: &Path) -> Page {
        let mut page = Page::default();
        let mut fence: Option<String> = None;
        for line in std::fs::read_to_string(file).expect("a page").lines() {
            if let Some(language) = line.trim_start().strip_prefix("```") {
                fence = if fence.is_some() { None } else { Some(language.to_owned()) };
            } else if let Some(language) = &fence {
                if ["sh", "text"].contains(&language.as_str()) {
                    page.block_lines.push(line.to_owned());
                }
            } else {
                if let Some(heading) = line.strip_prefix('#') {
                    page.add_anchor(heading.trim_start_matches('#').trim());
                }
                page.prose += line;
                page.prose.push(' ');
            }
        }
        page.spans = page.prose.split('`').skip(1).step_by(2).map(str::to_owned).collect();
        page
    }

    fn add_anchor(&mut self, heading: &str) {
        let kept = |c: &char| c.is_alphanumeric() || " -_".contains(*c);
        let anchor = heading.to_lowercase().chars().filter(kept).collect::<String>();
        let anchor = anchor.replace(' ', "-");
        let earlier = self.anchors.iter().filter(|found| **found == anchor).count();
        let suffix = if earlier > 0 { format!("-{earlier}") } else { String::new() };
        self.anchors.push(anchor + &suffix);
    }

    /// Returns the targets of links to this repository.
    fn links(&self) -> Vec<&str> {
        let targets = self.prose.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        targets.filter(|target| !target.contains("://")).collect()
    }

    /// Returns the commands of blocks, and those of code spans, which may leave arguments out.
    fn commands(&self) -> Vec<(Vec<String>, bool)> {
        let blocks = self.block_lines.iter().flat_map(|line| {
            let line = line.trim().trim_start_matches("$ ");
            line.split(" #").next().unwrap_or(line).split("; ").map(|command| (command, false))
        });
        let spans = self.spans.iter().map(|span| (span.as_str(), true));
        let words = |text: &str| -> Vec<String> {
            let words = text.split_whitespace().filter(|word| *word != "…");
            words.skip_while(|word| word.contains('=')).map(str::to_owned).collect()
        };
        let all = blocks.chain(spans).map(|(text, partial)| (words(text), partial));
        all.filter(|(words, _)| words.len() > 1).collect()
    }
}

fn pages() -> Vec<(String, PathBuf, Page)> {
    let root = root();
    let name = |file: &Path| file.strip_prefix(&root).expect("below it").display().to_string();
    let pages = files(&root, "md");
    pages.into_iter().map(|file| (name(&file), file.clone(), Page::read(&file))).collect()
}

#[test]
fn links_lead_somewhere() {
    let pages = pages();
    let by_path: HashMap<&Path, &Page> =
        pages.iter().map(|(_, file, page)| (file.as_path(), page)).collect();
    let mut wrong = String::new();
    for (name, file, page) in &pages {
        for link in page.links() {
            let (path, anchor) = link.split_once('#').unwrap_or((link, ""));
            let folder = file.parent().expect("a folder");
            let target =
                if path.is_empty() { Ok(file.clone()) } else { folder.join(path).canonicalize() };
            let found = target.is_ok_and(|target| match by_path.get(target.as_path()) {
                Some(page) => anchor.is_empty() || page.anchors.iter().any(|known| known == anchor),
                None => anchor.is_empty(),
            });
            if !found {
                writeln!(wrong, "{name}: {link}").expect("memory");
            }
        }
    }
    assert!(wrong.is_empty(), "links that lead nowhere:\n{wrong}");
}

/// Every `touchoff` command of the pages parses. Those of code blocks are also complete. The measured pages have rows
/// of that name instead.
#[test]
fn commands_of_the_program_parse() {
    let bench = Bench::new();
    let mut count = 0;
    let described = |name: &str| name != "CHANGELOG.md" && !name.starts_with("docs/measured");
    for (name, _, page) in pages().iter().filter(|(name, ..)| described(name)) {
        for (words, partial) in page.commands() {
            let rest = match words[0].as_str() {
                "touchoff" => &words[1..],
                "cargo" => match words
                    .strip_prefix(&["cargo", "run", "--release", "--"].map(String::from))
                {
                    Some(rest) => rest,
                    None => continue,
                },
                _ => continue,
            };
            // Words in capitals stand for a value.
            let is_value = |word: &str| word.chars().all(|c| c.is_ascii_uppercase());
            let value = |word| if word == "COMMAND" { "run" } else { "1" };
            let given = |word| if is_value(word) { value(word) } else { word };
            let words: Vec<&str> = rest.iter().map(|word| given(word.as_str())).collect();
            let output = parsed(&bench, words.clone(), partial);
            let said = stderr(&output);
            assert!(!said.contains("Usage: "), "{name}: touchoff {}: {said}", words.join(" "));
            count += 1;
        }
    }
    assert!(count > 40, "{count} commands found");
}

/// Returns the packages of the workspace, as `cargo metadata` describes them.
fn workspace() -> Vec<Value> {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["metadata", "--no-deps", "--format-version", "1", "--offline"]);
    let output = cargo.current_dir(root()).output().expect("cargo runs");
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    metadata["packages"].as_array().expect("packages").clone()
}

/// Returns the targets with a kind and a name.
fn targets<'a>(packages: &[&'a Value], kind: &str, name: &str) -> Vec<&'a Value> {
    let all = packages.iter().flat_map(|package| package["targets"].as_array().expect("targets"));
    all.filter(|target| target["kind"][0] == kind && target["name"] == name).collect()
}

/// Returns whether a test target has a test or a module whose name contains a filter.
fn has_test(target: &Value, filter: &str) -> bool {
    let main = Path::new(target["src_path"].as_str().expect("a path"));
    let sources = files(main.parent().expect("a folder"), "rs");
    sources.iter().any(|file| {
        let text = std::fs::read_to_string(file).expect("a source");
        let mut names = text.lines().filter_map(|line| line.trim().strip_prefix("fn "));
        let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        stem.contains(filter)
            || names.any(|rest| rest.split('(').next().is_some_and(|name| name.contains(filter)))
    })
}

/// Returns what is wrong with a `cargo` command.
fn check_cargo(workspace: &[Value], words: &[String]) -> Result<(), String> {
    let split = words.iter().position(|word| word == "--").unwrap_or(words.len());
    let after = words.get(split + 1..).unwrap_or_default();
    let mut words = words[1..split].iter().map(String::as_str).peekable();
    let values: HashMap<&str, &str> = words
        .clone()
        .zip(words.clone().skip(1))
        .filter(|(option, value)| option.starts_with('-') && !value.starts_with('-'))
        .collect();
    let package = values.get("-p").copied();
    let packages: Vec<&Value> =
        workspace.iter().filter(|found| package.is_none_or(|name| found["name"] == name)).collect();
    if packages.is_empty() {
        return Err(format!("no package {package:?}"));
    }
    for feature in values.get("--features").into_iter().flat_map(|list| list.split(',')) {
        if packages.iter().all(|package| package["features"][feature].is_null()) {
            return Err(format!("no feature {feature}"));
        }
    }
    for kind in ["test", "example", "bench"] {
        let Some(name) = values.get(format!("--{kind}").as_str()) else { continue };
        let targets = targets(&packages, kind, name);
        let filter = words.find(|word| word == name).and_then(|_| words.next());
        let filter = filter.filter(|word| kind == "test" && !word.starts_with('-'));
        if !targets.iter().any(|target| filter.is_none_or(|filter| has_test(target, filter))) {
            return Err(format!("no {kind} {name} {}", filter.unwrap_or_default()));
        }
    }
    if let (Some("touchoff-bench"), Some(command)) = (package, after.first())
        && !command.starts_with('-')
        && command != "NAME"
    {
        let module = root().join("bench/src/commands").join(command.replace('-', "_"));
        let file = [module.with_extension("rs"), module.join("mod.rs")];
        let text = file.iter().find_map(|file| std::fs::read_to_string(file).ok());
        let text = text.ok_or_else(|| format!("no measurement {command}"))?;
        for option in after.iter().filter_map(|word| word.strip_prefix("--")) {
            if !text.contains(&format!("{}:", option.replace('-', "_"))) {
                return Err(format!("no option --{option} of {command}"));
            }
        }
    }
    Ok(())
}

#[test]
fn cargo_commands_name_what_exists() {
    let workspace = workspace();
    let mut count = 0;
    for (name, _, page) in pages().iter().filter(|(name, ..)| name != "CHANGELOG.md") {
        for (words, _) in page.commands().iter().filter(|(words, _)| words[0] == "cargo") {
            if let Err(error) = check_cargo(&workspace, words) {
                panic!("{name}: {}: {error}", words.join(" "));
            }
            count += 1;
        }
    }
    assert!(count > 15, "{count} commands found");
}

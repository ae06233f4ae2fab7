//! Every stage of a file's way to Rust as text, and whether what is kept of that still is so.

use crate::arguments::Given;
use crate::check;
use crate::failure::Failure;
use crate::output::{refuse_inputs, show, unwritable, write_file};
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fmt::Write;
use std::hash::Hasher;
use std::path::{Path, PathBuf};
use tool_dsl::diagnostic::escaped;
use tool_dsl::prove::Certificate;
use tool_dsl::{CheckedTool, compile_with, emit};

/// Writes the stages of files into a folder, each file's into one of its own.
pub(crate) fn write(folder: &Path, files: &[PathBuf], given: &Given) -> Result<(), Failure> {
    let places = |file: &PathBuf| NAMES.map(|name| folder.join(stem(file)).join(name));
    let outputs: Vec<PathBuf> = files.iter().flat_map(places).collect();
    refuse_inputs(outputs.iter().map(PathBuf::as_path), files.iter().map(PathBuf::as_path))?;
    for file in files {
        let own = folder.join(stem(file));
        std::fs::create_dir_all(&own).map_err(|source| unwritable(&own, source))?;
        for (name, text) in stages(file, given)? {
            write_file(&own.join(name), text)?;
        }
    }
    Ok(())
}

/// Names what a folder holds that is no longer so.
pub(crate) fn check(folder: &Path, files: &[PathBuf], given: &Given) -> Result<(), Failure> {
    let mut stale = Vec::new();
    let mut known = BTreeSet::new();
    for file in files {
        known.insert(stem(file));
        for (name, text) in stages(file, given)? {
            let at = folder.join(stem(file)).join(name);
            if std::fs::read_to_string(&at).ok().as_deref() != Some(&text) {
                stale.push(at);
            }
        }
    }
    let kept = std::fs::read_dir(folder)
        .map_err(|source| Failure::Unreadable { file: folder.display().to_string(), source })?;
    for entry in kept.flatten() {
        if !known.contains(&*entry.file_name()) {
            stale.push(entry.path());
        }
    }
    for at in &stale {
        say!("{}: stale", escaped(&at.display().to_string()));
    }
    if stale.is_empty() { Ok(()) } else { Err(Failure::Stale { count: stale.len() }) }
}

fn stem(file: &Path) -> &OsStr {
    file.file_stem().unwrap_or_default()
}

/// The names of the stages' texts.
const NAMES: [&str; 6] =
    ["tree.txt", "model.txt", "regions.txt", "plan.dot", "rust.txt", "certificate.txt"];

/// What each stage makes of a file, by the name of its text.
fn stages(
    file: &Path,
    given: &Given,
) -> Result<impl Iterator<Item = (&'static str, String)> + use<>, Failure> {
    let source = given.source(file)?;
    let compiled = compile_with(&source, &given.sources());
    let tool = match &compiled.outcome {
        Ok(accepted) => &*accepted.tool,
        Err(refusal) => {
            for diagnostic in refusal.diagnostics() {
                show(diagnostic, &compiled.sources);
            }
            return Err(Failure::Files { wrong: 1, all: 1 });
        }
    };
    let certificate = Certificate::of(tool);
    let mut proved = Vec::new();
    check::table::write(&mut proved, tool, &certificate)?;
    let texts = [
        emit::tree(&source),
        emit::model(tool),
        emit::regions(tool),
        emit::dot(tool),
        functions(tool),
        String::from_utf8_lossy(&proved).into_owned(),
    ];
    Ok(NAMES.into_iter().zip(texts))
}

/// The functions of a tool's Rust: how many lines each has, and a digest of them. All of it would be
/// some hundred thousand lines for a library.
fn functions(tool: &CheckedTool) -> String {
    let mut text = String::new();
    let rust = emit::rust(tool);
    let mut name = "declarations";
    let mut lines = Vec::new();
    for line in rust.lines().chain(["fn "]) {
        if let Some((_, rest)) = line.split_once("fn ") {
            // Writing to a String does not fail.
            let _ = writeln!(text, "{name}: {} lines, {:016x}", lines.len(), digest(&lines));
            name = rest.split(['(', '<']).next().unwrap_or_default();
            lines.clear();
        }
        lines.push(line);
    }
    text
}

fn digest(lines: &[&str]) -> u64 {
    let mut digest = Fnv(0xcbf2_9ce4_8422_2325);
    lines.iter().for_each(|line| digest.write(line.as_bytes()));
    digest.finish()
}

/// Fowler, Noll and Vo's hash, 1a: the same on every machine.
struct Fnv(u64);

impl Hasher for Fnv {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

//! `touchoff import`: tools of CAM systems become `.tool` files, each proved; and the table of a library's tools.

use crate::arguments::Import;
use crate::failure::Failure;
use crate::output::{Output, refuse_inputs};
use crate::progress::Progress;
use serde::Serialize;
use std::io::Write;
use std::path::{Component, Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use touchoff::Escaped;
use touchoff_dsl::compile;
use touchoff_dsl::prove::Certificate;
use touchoff_import::{ImportedTool, Library, write_numbers};

/// The exit status if a tool was left out; `check` has the same for warnings.
pub(crate) const LEFT_OUT: u8 = 3;

/// One line of `import --json`: a tool, or an entry that was left out.
#[derive(Default, Serialize)]
struct Row<'a> {
    source: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    number: Option<u32>,
    #[serde(rename = "type", skip_serializing_if = "Option::is_none")]
    kind: Option<&'a str>,
    title: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    unit: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    diameter: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    flute_length: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    length: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stickout: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    holder: Option<&'a str>,
    /// True if depth is proved to be the distance to the surface; absent with `--list`.
    #[serde(skip_serializing_if = "Option::is_none")]
    proved: Option<bool>,
    notes: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    left_out: Option<&'a str>,
}

/// Imports libraries, and prints one line per tool.
pub(crate) fn import(arguments: &Import, json: bool) -> Result<ExitCode, Failure> {
    let mut out = Output::lines();
    let mut left_out = 0;
    for file in &arguments.files {
        let only = arguments.only.as_deref();
        let target = if arguments.list {
            Target::List { prove: false }
        } else {
            Target::Folder(match &arguments.output {
                Some(output) => output.clone(),
                None => folder_named_after(file)?,
            })
        };
        left_out += Run { file, only, target, json }.library(&mut out)?;
    }
    out.flush()?;
    Ok(if left_out == 0 { ExitCode::SUCCESS } else { ExitCode::from(LEFT_OUT) })
}

/// Returns the folder with the name of a library, in the current folder.
///
/// # Errors
/// If its name without the ending is none of a folder there, as `..` of `...json`, or a link: the folder was not named by the user.
fn folder_named_after(file: &Path) -> Result<PathBuf, Failure> {
    let stem = Path::new(file.file_stem().unwrap_or_default());
    match stem.components().next() {
        Some(Component::Normal(name)) if name == stem && !stem.is_symlink() => Ok(stem.to_owned()),
        _ => Err(Failure::NoFolder { file: file.display().to_string() }),
    }
}

/// Prints the tools of a library with their proofs, and writes nothing.
pub(crate) fn list(file: &Path, json: bool, out: &mut Output) -> Result<(), Failure> {
    Run { file, only: None, target: Target::List { prove: true }, json }.library(out)?;
    Ok(())
}

/// The import of one library.
struct Run<'a> {
    file: &'a Path,
    only: Option<&'a str>,
    target: Target,
    json: bool,
}

/// The destination of the tools.
enum Target {
    List { prove: bool },
    Folder(PathBuf),
}

impl Run<'_> {
    /// Imports the library, and returns the number of tools left out.
    fn library(&self, out: &mut Output) -> Result<usize, Failure> {
        if let Target::Folder(folder) = &self.target {
            // Of what an import writes, the list of numbers alone replaces a file.
            refuse_inputs([&*folder.join("tools.toml")], [self.file])?;
        }
        let library = Library::read(self.file)?;
        let tools = self.wanted(&library)?;
        let mut left_out = 0;
        let (mut written, mut unwritten) = (Vec::new(), Vec::new());
        // A single tool that was asked for says nothing about the others.
        if self.only.is_none() {
            for skipped in library.skipped() {
                self.skip(out, &skipped.name, &skipped.reason)?;
            }
            left_out = library.skipped().len();
            unwritten.extend(library.skipped().iter().filter_map(|skipped| skipped.number));
        }
        if !self.json && !tools.is_empty() {
            line(out, HEAD)?;
        }
        if let Target::List { prove: false } = self.target {
            for tool in &tools {
                self.print(out, tool, None)?;
            }
            return Ok(left_out);
        }
        for (tool, proof) in tools.iter().zip(prove(&tools, self.json)) {
            match proof {
                Ok(exact) => {
                    if let Target::Folder(folder) = &self.target {
                        tool.write_to(folder)?;
                        written.push(*tool);
                    }
                    self.print(out, tool, Some(exact))?;
                }
                Err(reason) => {
                    self.skip(out, tool.entry.label(), &reason)?;
                    left_out += 1;
                    unwritten.extend(tool.entry.number);
                }
            }
        }
        if let Target::Folder(folder) = &self.target {
            write_numbers(folder, &written, &unwritten)?;
        }
        Ok(left_out)
    }

    /// Returns the tools to import.
    fn wanted<'l>(&self, library: &'l Library) -> Result<Vec<&'l ImportedTool>, Failure> {
        let Some(only) = self.only else { return Ok(library.tools().iter().collect()) };
        Ok(vec![library.select(only)?])
    }

    fn print(
        &self,
        out: &mut Output,
        tool: &ImportedTool,
        proved: Option<bool>,
    ) -> Result<(), Failure> {
        let entry = &tool.entry;
        let notes: Vec<String> = entry.notes.iter().map(ToString::to_string).collect();
        if self.json {
            return out.json(&Row {
                source: self.file.display().to_string(),
                file: Some(tool.path()),
                number: entry.number,
                kind: Some(&entry.kind),
                title: &entry.title,
                unit: Some(entry.unit.symbol()),
                diameter: entry.diameter(),
                flute_length: entry.flute_length(),
                length: entry.length(),
                stickout: entry.stickout,
                holder: entry.holder(),
                proved,
                notes,
                left_out: None,
            });
        }
        line(
            out,
            [
                &entry.number.map_or_else(|| "-".to_owned(), |number| format!("T{number}")),
                &Escaped(&entry.kind).to_string(),
                &length(entry.diameter()),
                &length(entry.flute_length()),
                &length(entry.length()),
                &length(entry.stickout),
                entry.unit.symbol(),
                match proved {
                    None => "",
                    Some(true) => "exact",
                    Some(false) => "open",
                },
                &tool.path(),
                &Escaped(entry.holder().unwrap_or("-")).to_string(),
            ],
        )?;
        for note in notes {
            message!("warning: {}: {note}", tool.path());
        }
        Ok(())
    }

    fn skip(&self, out: &mut Output, name: &str, reason: &str) -> Result<(), Failure> {
        if self.json {
            return out.json(&Row {
                source: self.file.display().to_string(),
                title: name,
                left_out: Some(reason),
                ..Row::default()
            });
        }
        message!("left out: {}: {reason}", Escaped(name));
        Ok(())
    }
}

/// The head of the table, in the order of [`line()`].
const HEAD: [&str; 10] =
    ["number", "type", "diameter", "flutes", "length", "stick-out", "", "depth", "file", "holder"];

/// Prints a line of the table.
fn line(out: &mut Output, cells: [&str; 10]) -> Result<(), Failure> {
    let [number, kind, diameter, flutes, length, stickout, unit, depth, file, holder] = cells;
    Ok(writeln!(
        out,
        "{number:<7}{kind:<24}{diameter:>9}{flutes:>9}{length:>9}{stickout:>11} {unit:<5} {depth:<6} {file:<32} {holder}"
    )?)
}

/// Formats a length of the table.
fn length(length: Option<f64>) -> String {
    length.map_or_else(|| "-".to_owned(), |length| format!("{}", (length * 1e4).round() / 1e4))
}

/// The proof of a tool: whether depth is proved to be the distance, or why it does not compile.
type Proof = Result<bool, String>;

/// Compiles and proves tools on all cores.
fn prove(tools: &[&ImportedTool], json: bool) -> Vec<Proof> {
    let progress = Progress::steps(tools.len(), "tools", json);
    let next = AtomicUsize::new(0);
    let cores = thread::available_parallelism().map_or(1, Into::into).min(tools.len().max(1));
    let mut proofs: Vec<(usize, Proof)> = thread::scope(|scope| {
        // Each takes the next open file, since the time of a proof varies with the tool.
        let work = || {
            let mut proofs = Vec::new();
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let Some(tool) = tools.get(index) else { return proofs };
                proofs.push((index, proof(tool)));
                progress.advance(1);
            }
        };
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        workers
            .into_iter()
            .flat_map(|worker| worker.join().expect("a proof does not panic"))
            .collect()
    });
    // Threads end in any order.
    proofs.sort_by_key(|(index, _)| *index);
    proofs.into_iter().map(|(_, proof)| proof).collect()
}

fn proof(tool: &ImportedTool) -> Proof {
    let compiled = compile(&tool.source());
    match compiled.tool() {
        Some(tool) => Ok(Certificate::prove(tool).is_exact()),
        None => {
            let first = compiled.diagnostics().first();
            let reason = first.map_or_else(String::new, |diagnostic| diagnostic.message());
            Err(format!("its dimensions are no solid: {reason}"))
        }
    }
}

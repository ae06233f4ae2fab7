//! Measures the import of tool libraries: reading, compiling and proving.

use rayon::prelude::*;
use serde_json::{Value, json};
use std::error::Error;
use std::time::Instant;
use touchoff_bench::page::Section;
use touchoff_dsl::compile;
use touchoff_dsl::prove::Certificate;
use touchoff_dsl::source::Source;
use touchoff_import::{ImportedTool, Library};
use touchoff_tests::fusion;

/// Number of tools of the library.
const TOOLS: usize = 1_000;

/// Returns the section about one large library.
pub(super) fn section() -> Result<Section, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let text = fusion_library(TOOLS);
    let start = Instant::now();
    let library = Library::parse("library.json".as_ref(), text.as_bytes())?;
    let read = start.elapsed().as_secs_f64();
    let proofs = library.tools().par_iter().map(|tool| prove(tool, folder.path()));
    let proofs: Vec<Option<bool>> = proofs.collect::<Result<_, _>>()?;
    let all = start.elapsed().as_secs_f64();
    let proved = proofs.iter().filter(|proof| **proof == Some(true)).count();
    let body = format!(
        "A library of Fusion 360 with {TOOLS} tools: {} are imported, {} left out. All are read in {read:.2} s, and written, \
         compiled and proved on {} threads in {all:.2} s. Depth is proved to be the distance for {proved} of them, {} do not \
         compile.\n",
        library.tools().len(),
        library.skipped().len(),
        rayon::current_num_threads(),
        proofs.iter().filter(|proof| proof.is_none()).count(),
    );
    Ok(Section { title: "Imported", body })
}

/// Returns a library of Fusion 360 with so many tools, of every type and in sizes from a half to twice the usual.
fn fusion_library(count: usize) -> String {
    let kinds = fusion::tools();
    let tool = |k: usize| {
        let mut tool = kinds[k % kinds.len()].clone();
        scale(&mut tool["geometry"], 0.5 + 1.5 * k as f64 / count as f64);
        tool["description"] = json!(format!("tool {k}"));
        tool
    };
    json!({ "data": (0..count).map(tool).collect::<Vec<_>>() }).to_string()
}

/// Scales the lengths of a tool.
fn scale(value: &mut Value, factor: f64) {
    match value {
        Value::Object(object) => {
            let not_lengths = ["SIG", "TA", "NT", "NOF", "thread-profile-angle", "chamfer-angle"];
            let lengths = object.iter_mut().filter(|(key, _)| !not_lengths.contains(&&***key));
            lengths.for_each(|(_, value)| scale(value, factor));
        }
        Value::Array(list) => list.iter_mut().for_each(|value| scale(value, factor)),
        Value::Number(number) => {
            let scaled = number.as_f64().unwrap_or(0.0) * factor;
            *value = json!((scaled * 1e4).round() / 1e4);
        }
        _ => {}
    }
}

/// Writes, compiles and proves a tool: true if depth is the distance, `None` if it does not compile.
fn prove(tool: &ImportedTool, folder: &std::path::Path) -> Result<Option<bool>, String> {
    let file = tool.write_to(folder).map_err(|error| error.to_string())?;
    let source = Source::read(&file).map_err(|error| error.to_string())?;
    Ok(compile(&source).tool().map(|tool| Certificate::prove(tool).is_exact()))
}

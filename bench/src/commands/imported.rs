//! Measures the import of tool libraries: reading, compiling and proving.

use rayon::prelude::*;
use std::error::Error;
use std::time::Instant;
use touchoff_bench::page::Section;
use touchoff_dsl::compile;
use touchoff_dsl::prove::Certificate;
use touchoff_dsl::source::Source;
use touchoff_import::{ImportedTool, Library};
use touchoff_tests::libraries::fusion_library;

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

/// Writes, compiles and proves a tool: true if depth is the distance, `None` if it does not compile.
fn prove(tool: &ImportedTool, folder: &std::path::Path) -> Result<Option<bool>, String> {
    let file = tool.write_to(folder).map_err(|error| error.to_string())?;
    let source = Source::read(&file).map_err(|error| error.to_string())?;
    Ok(compile(&source).tool().map(|tool| Certificate::prove(tool).is_exact()))
}

//! `touchoff expand`: the Rust code of `.tool` files, or an earlier stage of their compilation.

use crate::arguments::{Expand, Stage};
use crate::failure::Failure;
use crate::loaded_tool::compile_file;
use crate::output::{Output, files_of, refuse_inputs, write_file};
use std::fmt::Write as _;
use std::io::Write as _;
use touchoff_dsl::emit;

/// Prints a stage of the compilation of files, or writes it to a file.
pub(crate) fn expand(arguments: &Expand) -> Result<(), Failure> {
    let Expand { files, stage, params, output } = arguments;
    let mut text = String::new();
    for file in files {
        let compiled = compile_file(file, params)?;
        // Before anything is written: a file without the ending `.tool` mounts others, too.
        refuse_inputs(output.as_deref(), files_of(&compiled.sources))?;
        let Some(tool) = compiled.tool() else {
            return Err(Failure::Files { wrong: 1, all: 1 });
        };
        // Writing to a String does not fail.
        let _ = match stage {
            Stage::Ast => write!(text, "{}", emit::tree(compiled.sources.main())),
            Stage::Model => write!(text, "{}", emit::model(tool)),
            Stage::Regions => write!(text, "{}", emit::regions(tool)),
            Stage::Plan => write!(text, "{}", emit::dot(tool)),
            Stage::Rust => write!(text, "{}", emit::source_code(tool)),
        };
    }
    match output {
        Some(output) => write_file(output, text),
        None => {
            let mut out = Output::lines();
            write!(out, "{text}")?;
            Ok(out.flush()?)
        }
    }
}

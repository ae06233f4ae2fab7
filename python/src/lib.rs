//! Python bindings: arrays of poses in, arrays out.
//!
//! ```text
//! touchoff/*.py ──arrays, checked──▶ _touchoff (this crate) ──▶ touchoff, touchoff-verify, touchoff-postures, touchoff-import
//! ```
//!
//! The Python package `touchoff` checks shapes and types and names its results; this extension module converts poses, runs
//! the queries on all cores without the interpreter's lock, and fills arrays. Nothing is computed here.

// The interpreter hands arguments over by value.
#![allow(clippy::needless_pass_by_value)]

mod error;
mod job;
mod part;
mod pool;
mod poses;
mod queries;
mod sweep;
mod tool;

/// The extension module of the Python package `touchoff`.
#[pyo3::pymodule]
mod _touchoff {
    #[pymodule_export]
    use crate::error::{JobError, ToolError};
    #[pymodule_export]
    use crate::job::check_job;
    #[pymodule_export]
    use crate::part::Part;
    #[pymodule_export]
    use crate::queries::{certified_depth, clearance, contacts, detect, signed_distance, wrench};
    #[pymodule_export]
    use crate::sweep::{Study, merge_shards, read_map, sweep, write_shard};
    #[pymodule_export]
    use crate::tool::{Tool, import_library, tool_names};
    use pyo3::prelude::*;

    /// Loads what numpy has for other extensions: later a signal could be pending.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let empty = numpy::PyArray1::<f64>::zeros(module.py(), 0, false);
        drop(empty);
        module.add("JobFileNotFoundError", crate::error::job_file_not_found(module.py())?)
    }
}

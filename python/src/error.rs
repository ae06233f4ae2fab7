//! Errors as exceptions. Their messages are those of the libraries: what, where, and the remedy.

use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyPermissionError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyType};
use pyo3::{PyErr, create_exception};
use std::error::Error;
use std::io;
use touchoff::mesh::GeometryError;
use touchoff::{CloudError, SavedError};

create_exception!(
    touchoff,
    ToolError,
    PyValueError,
    "A tool's text that does not compile. The message has the diagnostics with their codes."
);
create_exception!(
    touchoff,
    JobError,
    PyValueError,
    "A job or a program that cannot be read or checked. The message names the file and the line."
);

/// The exception for a job whose files are not all there: a `JobError` and a `FileNotFoundError`.
static JOB_FILE_NOT_FOUND: PyOnceLock<Py<PyType>> = PyOnceLock::new();

/// Returns the class of the exception for a job whose files are not all there.
pub(crate) fn job_file_not_found(py: Python<'_>) -> PyResult<&Bound<'_, PyType>> {
    let class = JOB_FILE_NOT_FOUND.get_or_try_init(py, || {
        let bases = (py.get_type::<JobError>(), py.get_type::<PyFileNotFoundError>());
        let items = PyDict::new(py);
        items.set_item("__module__", "touchoff")?;
        items.set_item(
            "__doc__",
            "A job that is not there, or a file that it names. The message names the file.",
        )?;
        let class = py.get_type::<PyType>().call1(("JobFileNotFoundError", bases, items))?;
        PyResult::Ok(class.cast_into::<PyType>()?.unbind())
    });
    class.map(|class| class.bind(py))
}

/// Returns the exception for an input that is refused.
pub(crate) fn refused(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Returns the error of the system that caused an error, if one did.
fn cause<'e>(error: &'e (dyn Error + 'static)) -> Option<&'e io::Error> {
    let mut known = Some(error);
    while let Some(error) = known {
        if let Some(cause) = error.downcast_ref() {
            return Some(cause);
        }
        known = error.source();
    }
    None
}

/// Returns the exception for an error that the system may have caused: an `OSError`, and `FileNotFoundError` or `PermissionError` where
/// it is one; a `ValueError` if it has another cause.
pub(crate) fn reading(error: impl Error + 'static) -> PyErr {
    let message = error.to_string();
    match cause(&error).map(io::Error::kind) {
        None => PyValueError::new_err(message),
        Some(io::ErrorKind::NotFound) => PyFileNotFoundError::new_err(message),
        Some(io::ErrorKind::PermissionDenied) => PyPermissionError::new_err(message),
        Some(_) => PyOSError::new_err(message),
    }
}

/// Returns the exception for a job that cannot be read or checked.
pub(crate) fn job(error: impl Error + 'static) -> PyErr {
    let message = error.to_string();
    if cause(&error).is_none_or(|cause| cause.kind() != io::ErrorKind::NotFound) {
        return JobError::new_err(message);
    }
    Python::attach(|py| match job_file_not_found(py) {
        Ok(class) => PyErr::from_type(class.clone(), message),
        Err(error) => error,
    })
}

/// Returns the exception for a tool that does not compile, or whose file cannot be read.
pub(crate) fn tool(error: touchoff::tool::ToolError) -> PyErr {
    match error {
        touchoff::tool::ToolError::Invalid(diagnostics) => ToolError::new_err(diagnostics),
        unreadable => reading(unreadable),
    }
}

/// A reason for which a part's file is refused.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ReadError {
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    #[error(transparent)]
    Cloud(#[from] CloudError),
    #[error(transparent)]
    Saved(#[from] SavedError),
    /// The file of a part that was pickled has other content.
    #[error(
        "{file} has changed since the part was read from it: its SHA-256 is {digest}, and was {expected}: read the part anew, and \
         pickle that; or restore the file"
    )]
    Changed { file: String, digest: String, expected: String },
}

impl From<ReadError> for PyErr {
    fn from(error: ReadError) -> PyErr {
        reading(error)
    }
}

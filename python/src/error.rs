//! Errors as exceptions. Their messages are those of the libraries: what, where, and the remedy.

use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::{PyErr, create_exception};
use touchoff::mesh::{GeometryError, StlError};

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

/// Returns the exception for an input that is refused.
pub(crate) fn refused(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Returns the exception for a tool that does not compile, or whose file cannot be read.
pub(crate) fn tool(error: touchoff::tool::ToolError) -> PyErr {
    match error {
        touchoff::tool::ToolError::Invalid(diagnostics) => ToolError::new_err(diagnostics),
        unreadable => PyOSError::new_err(unreadable.to_string()),
    }
}

/// Returns the exception for a file of a part.
pub(crate) fn geometry(error: GeometryError) -> PyErr {
    let message = error.to_string();
    match error {
        GeometryError::Unreadable { .. } | GeometryError::Stl(StlError::Unreadable { .. }) => {
            PyOSError::new_err(message)
        }
        _ => PyValueError::new_err(message),
    }
}

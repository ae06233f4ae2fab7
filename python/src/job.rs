//! The verified job.

use crate::error::{job as job_error, refused};
use crate::pool::on_all_cores;
use crate::tool::{LoadError, LoadedTool};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyInt, PyList};
use serde::Serialize;
use std::path::PathBuf;
use touchoff_import::Libraries;
use touchoff_verify::JobFile;
use touchoff_verify::job::{Hand, JobError, JobInputs};

/// A reason for which a job is not checked.
#[derive(Debug, thiserror::Error)]
enum CheckError {
    #[error(transparent)]
    Job(#[from] JobError),
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The keys of a job that is made in Python.
    #[error("job: {0}")]
    Keys(String),
}

/// Returns the error about keys that stand in no file.
fn without_line(error: JobError) -> CheckError {
    match error {
        JobError::File { fault, .. } => CheckError::Keys(fault.to_string()),
        other => CheckError::Job(other),
    }
}

/// The result of a check, as JSON.
#[derive(Serialize)]
struct Checked<R: Serialize, G: Serialize, S: Serialize> {
    verdict: &'static str,
    findings: Vec<R>,
    gaps: Vec<G>,
    refusals: Vec<String>,
    summaries: Vec<String>,
    surface_only: bool,
    sarif: S,
}

/// Returns a value of a job as TOML has it. `key` is its place, such as `tool.1.allow.ball`.
fn value(key: &str, given: &Bound<'_, PyAny>) -> PyResult<toml::Value> {
    if let Ok(entries) = given.cast::<PyDict>() {
        return Ok(toml::Value::Table(table(key, entries)?));
    }
    if let Ok(items) = given.cast::<PyList>() {
        let items = items.iter().enumerate();
        let items = items.map(|(index, item)| value(&format!("{key}[{index}]"), &item));
        return Ok(toml::Value::Array(items.collect::<PyResult<_>>()?));
    }
    // A bool is an int as well, and an int a float.
    if let Ok(given) = given.cast::<PyBool>() {
        return Ok(toml::Value::Boolean(given.is_true()));
    }
    if given.is_instance_of::<PyInt>() {
        let whole = given
            .extract::<i64>()
            .map_err(|_| refused(format!("{key}: the number is too large")))?;
        return Ok(toml::Value::Integer(whole));
    }
    if let Ok(number) = given.extract::<f64>() {
        return match number.is_nan() {
            true => {
                Err(refused(format!("{key}: NaN is no number: give one, or inf for any depth")))
            }
            false => Ok(toml::Value::Float(number)),
        };
    }
    if let Ok(text) = given.extract::<String>() {
        return Ok(toml::Value::String(text));
    }
    let kind = given.get_type().name()?;
    Err(PyTypeError::new_err(format!(
        "{key}: a {kind} cannot stand in a job: give a number, text, a list or names with values; a job reads its files by their paths"
    )))
}

fn table(key: &str, entries: &Bound<'_, PyDict>) -> PyResult<toml::Table> {
    let entries = entries.iter().map(|(name, item)| {
        let name: String = name.extract()?;
        let place = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
        Ok((name, value(&place, &item)?))
    });
    entries.collect()
}

/// Checks a job: `keys` has those of a job file, whose paths are relative to the folder of `path`, or `path` is a job file, whose
/// inputs lie within `root`. Returns the result as JSON.
#[pyfunction]
#[pyo3(signature = (path, keys, root))]
pub(crate) fn check_job(
    py: Python<'_>,
    path: PathBuf,
    keys: Option<Bound<'_, PyDict>>,
    root: Option<PathBuf>,
) -> PyResult<String> {
    let keys = keys.map(|keys| table("", &keys)).transpose()?;
    let checked: Result<String, CheckError> = on_all_cores(py, || {
        let file = match keys {
            None => JobFile::read(&path, root.as_deref())?,
            Some(keys) => {
                let text =
                    toml::to_string(&keys).map_err(|error| CheckError::Keys(error.to_string()))?;
                JobFile::parse(&text, &path).map_err(without_line)?
            }
        };
        let mut libraries = Libraries::default();
        let inputs = JobInputs::read::<CheckError>(file, |named| {
            let (library, root) = (named.library.as_deref(), named.root.as_deref());
            let tool =
                LoadedTool::named(&named.name, library, &named.params, root, &mut libraries)?;
            if let Some(entry) = libraries.entry::<LoadError>(library, &named.name, root)? {
                named.hand = named.hand.or(entry.left_handed.map(Hand::of));
                named.doubts = entry.doubts();
            }
            Ok(tool)
        })?;
        let job = inputs.job();
        let report = job.check(&|_| ())?;
        let checked = Checked {
            verdict: report.verdict().keyword(),
            findings: report.findings().iter().map(|finding| report.row(finding)).collect(),
            gaps: report.gap_rows().collect(),
            refusals: report.refusals().iter().map(ToString::to_string).collect(),
            summaries: report.summaries(),
            surface_only: report.is_surface_only(),
            sarif: report.sarif(&path.to_string_lossy()),
        };
        serde_json::to_string(&checked).map_err(|error| CheckError::Keys(error.to_string()))
    })?;
    checked.map_err(job_error)
}

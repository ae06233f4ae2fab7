//! The verified job.

use crate::error::JobError as PyJobError;
use crate::tool::{LoadError, LoadedTool};
use pyo3::prelude::*;
use serde::Serialize;
use std::path::PathBuf;
use touchoff_verify::job::{JobError, JobInputs};
use touchoff_verify::{JobFile, Verdict};

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

impl From<CheckError> for PyErr {
    fn from(error: CheckError) -> PyErr {
        match error {
            CheckError::Load(error) => error.into(),
            other => PyJobError::new_err(other.to_string()),
        }
    }
}

/// The result of a check, as JSON.
#[derive(Serialize)]
struct Checked<R: Serialize, G: Serialize, S: Serialize> {
    verdict: &'static str,
    findings: Vec<FindingRow<R>>,
    gaps: Vec<G>,
    refusals: Vec<String>,
    summaries: Vec<String>,
    surface_only: bool,
    sarif: S,
}

#[derive(Serialize)]
struct FindingRow<R: Serialize> {
    /// The sentence.
    text: String,
    #[serde(flatten)]
    row: R,
}

/// Checks a job: `keys` has it as JSON, in the format of a job file, or `path` is a job file. Returns the result as JSON.
#[pyfunction]
#[pyo3(signature = (path, keys))]
pub(crate) fn check_job(py: Python<'_>, path: PathBuf, keys: Option<String>) -> PyResult<String> {
    let checked: Result<String, CheckError> = py.detach(|| {
        let file = match keys {
            None => JobFile::read(&path)?,
            Some(keys) => {
                let keys: toml::Table = serde_json::from_str(&keys)
                    .map_err(|error| CheckError::Keys(error.to_string()))?;
                let text =
                    toml::to_string(&keys).map_err(|error| CheckError::Keys(error.to_string()))?;
                JobFile::parse(&text, &path)?
            }
        };
        let inputs = JobInputs::read::<CheckError>(file, |named| {
            Ok(LoadedTool::named(&named.name, named.library.as_deref(), &named.params)?)
        })?;
        let job = inputs.job();
        let report = job.check(&|_| ())?;
        let checked = Checked {
            verdict: match report.verdict() {
                Verdict::Clean => "clean",
                Verdict::Findings => "findings",
                Verdict::None => "none",
            },
            findings: report
                .findings()
                .iter()
                .map(|finding| FindingRow { text: finding.text.clone(), row: report.row(finding) })
                .collect(),
            gaps: report.gap_rows().collect(),
            refusals: report.refusals(),
            summaries: report.summaries(),
            surface_only: report.is_surface_only(),
            sarif: report.sarif(),
        };
        serde_json::to_string(&checked).map_err(|error| CheckError::Keys(error.to_string()))
    });
    Ok(checked?)
}

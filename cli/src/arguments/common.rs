//! Arguments that several commands share.

use super::values::{count, point_count, positive_length};
use clap::Args;
use std::path::{Path, PathBuf};
use touchoff::tool::{Interpreted, ToolError};
use touchoff::{SamplingMethod, Unit};
use touchoff_dsl::source::Source;

/// Values for the params of `.tool` files, and the root of their mounts.
#[derive(Args, Clone, Default)]
pub(crate) struct ParamArguments {
    /// Value for a `param` of the `.tool` file, written as in the language: `--set D=0.25inch`. Can be repeated;
    /// holds for all tools named.
    #[arg(long, value_name = "PARAM=VALUE")]
    set: Vec<String>,
    /// Folder below which the `.tool` file may mount others, and a job may read files [default: its own folder].
    #[arg(long, value_name = "DIR")]
    root: Option<PathBuf>,
}

impl ParamArguments {
    /// Creates the arguments from values as `--set` takes them.
    pub(crate) fn new(set: Vec<String>, root: Option<PathBuf>) -> ParamArguments {
        ParamArguments { set, root }
    }

    /// Returns the values, and the root of mounts.
    pub(crate) fn into_parts(self) -> (Vec<String>, Option<PathBuf>) {
        (self.set, self.root)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.set.is_empty()
    }

    /// Returns the root of mounts and of a library's files.
    pub(crate) fn root(&self) -> Option<&Path> {
        self.root.as_deref()
    }

    /// Returns the values as sources for the compiler.
    pub(crate) fn sources(&self) -> Vec<Source> {
        self.set.iter().map(|text| Source::new("--set", text)).collect()
    }

    /// Reads a `.tool` file, and sets the folder below which it may mount others.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub(crate) fn source(&self, file: &Path) -> Result<Source, ToolError> {
        let source = Interpreted::source(file)?;
        Ok(match &self.root {
            Some(root) => source.with_root(root),
            None => source,
        })
    }
}

/// The source of the tools that are named, and values for their params.
#[derive(Args, Clone, Default)]
pub(crate) struct ToolArguments {
    /// Library of the tools that `--tool` names: one that `touchoff import` reads, with tools by name, title or number,
    /// or a folder of `.tool` files.
    #[arg(long = "tools", value_name = "LIBRARY|DIR")]
    pub(crate) library: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) params: ParamArguments,
}

impl ToolArguments {
    pub(crate) fn is_empty(&self) -> bool {
        self.library.is_none() && self.params.is_empty()
    }
}

/// The part, and the sampling of its points.
#[derive(Args)]
pub(crate) struct PartFile {
    /// Part: a mesh in STL, PLY or OBJ, points with normals in PLY, or a saved `.touchoff`.
    #[arg(long, value_name = "FILE")]
    pub(crate) part: PathBuf,
    /// Unit of the part, which most formats do not store: `mm`, `inch` or `m`.
    #[arg(long)]
    pub(crate) unit: Unit,
    /// Number of points to sample on the surface, from 1 to 100000000; no effect on points and saved parts.
    #[arg(long, value_name = "NUMBER", default_value_t = 20_000, value_parser = point_count)]
    pub(crate) points: u64,
    /// Largest depth that may be missed between points, in the part's unit, instead of a number of points; needs a
    /// mesh. Where `run` would need more than a million points, it proves depth to this tolerance instead.
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, conflicts_with = "points")]
    pub(crate) sampling_error: Option<f64>,
    /// Distribution of the points: `blue`, evenly spread; `random`, uniformly; or `monte-carlo`, as `random` with equal
    /// weights and no covering radius; no effect on points and saved parts.
    #[arg(long, value_name = "METHOD", default_value_t = SamplingMethod::BlueNoise)]
    pub(crate) sampling: SamplingMethod,
    /// Seed of the sampling: the same seed gives the same points; no effect on points and saved parts.
    #[arg(long, value_name = "NUMBER", default_value_t = 1, value_parser = count)]
    pub(crate) seed: u64,
}

/// The part, as triangles.
#[derive(Args)]
pub(crate) struct MeshFile {
    /// Finished part: a mesh in STL, PLY or OBJ.
    #[arg(long, value_name = "FILE")]
    pub(crate) part: PathBuf,
    /// Unit of the part, which most formats do not store: `mm`, `inch` or `m`.
    #[arg(long)]
    pub(crate) unit: Unit,
}

//! Tools that are loaded at run time.

use super::compiled::{evaluate_blocks, evaluate_points};
use super::plan::{Eight, Memory, Plan};
use super::{
    BatchEvaluator, DepthBounds, Derivatives, Dual, Enclosure, EnvelopeSlab, EvaluationEnclosure,
    Evaluations, OutputSelection, Outputs, PointBatch, ProfileSegment, Region, Segment, Surface,
    Symmetry, Ternary, Tool, ToolInfo,
};
use crate::debug::debug;
use crate::id::SurfaceId;
use crate::interval::Interval;
use crate::unit::Unit;
use fearless_simd::{Level, Simd, dispatch};
use std::borrow::Cow;
use std::mem;
use std::path::Path;
use std::str::FromStr;
use touchoff_dsl::bound::lateral_extent;
use touchoff_dsl::domain::Domain;
use touchoff_dsl::prove::Bounds;
use touchoff_dsl::source::Source;
use touchoff_dsl::{Accepted, CheckedTool, compile_with_arguments, diagnostic, digest, model};

/// A tool from a `.tool` file, evaluated by the interpreter.
pub struct Interpreted {
    info: ToolInfo,
    plan: Plan,
    warnings: String,
}

debug!([] Interpreted, "Interpreted", |this| { name: this.info.name });

/// A `.tool` file that could not be loaded. The message is meant for people, and has the position and the remedy.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum ToolError {
    /// The file could not be read.
    #[error("cannot read {file}: {source}{}", remedy(source))]
    Unreadable {
        /// The file.
        file: String,
        /// The cause.
        source: std::io::Error,
    },
    /// The file has errors.
    #[error("{0}")]
    Invalid(String),
}

crate::debug_as_sentence!(ToolError);

impl Interpreted {
    /// Loads a `.tool` file.
    ///
    /// # Errors
    ///
    /// [`ToolError::Unreadable`] if the file cannot be read, [`ToolError::Invalid`] if it does not compile.
    pub fn load(path: impl AsRef<Path>) -> Result<Interpreted, ToolError> {
        Interpreted::parse(&Interpreted::source(path)?)
    }

    /// Reads the text of a `.tool` file.
    ///
    /// # Errors
    ///
    /// [`ToolError::Unreadable`] if the file cannot be read.
    pub fn source(path: impl AsRef<Path>) -> Result<Source, ToolError> {
        let file = diagnostic::escaped(&path.as_ref().display().to_string()).into_owned();
        Source::read(path).map_err(|source| ToolError::Unreadable { file, source })
    }

    /// Compiles a tool's text. `name` stands for a file's in diagnostics; `str::parse` gives `tool`.
    ///
    /// ```
    /// use touchoff::tool::{Interpreted, Tool};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let text = "tool Ball \"6 mm ball\" { units mm; profile { start (0, 0); arc to (0, 6) center (0, 3) as ball; } }";
    /// let tool: Interpreted = text.parse()?;
    /// assert_eq!(tool.info().name, "Ball");
    ///
    /// let error = Interpreted::from_text("ball.tool", &text.replace("(0, 3)", "(0, 2)")).expect_err("no circle");
    /// assert!(error.to_string().contains("ball.tool:1:"));
    /// # Ok(()) }
    /// ```
    ///
    /// # Errors
    ///
    /// [`ToolError::Invalid`] with all diagnostics if the text does not compile.
    pub fn from_text(name: &str, text: &str) -> Result<Interpreted, ToolError> {
        Interpreted::parse(&Source::new(name, text))
    }

    /// Compiles the text of a source.
    ///
    /// # Errors
    ///
    /// [`ToolError::Invalid`] with all diagnostics if the text does not compile.
    pub fn parse(source: &Source) -> Result<Interpreted, ToolError> {
        Interpreted::parse_with(source, &[])
    }

    /// Compiles a tool's text with arguments for its parameters, such as `D = 0.25inch, flute = 18`.
    ///
    /// # Errors
    ///
    /// [`ToolError::Invalid`] with all diagnostics if the text or the arguments do not compile.
    pub fn parse_with(source: &Source, arguments: &[Source]) -> Result<Interpreted, ToolError> {
        let compiled = compile_with_arguments(source, arguments);
        let diagnostics: Vec<String> =
            compiled.diagnostics().iter().map(|r| r.render(&compiled.sources, false)).collect();
        let diagnostics = diagnostics.join("\n\n");
        match compiled.outcome {
            Ok(Accepted { tool, .. }) => {
                Ok(Interpreted { info: info(&tool), plan: Plan::new(&tool), warnings: diagnostics })
            }
            Err(_) => Err(ToolError::Invalid(diagnostics)),
        }
    }

    /// Returns the compiler's warnings; empty if there are none.
    pub fn warnings(&self) -> &str {
        &self.warnings
    }
}

/// Compiles a tool's text, which its diagnostics call `tool`.
impl FromStr for Interpreted {
    type Err = ToolError;

    fn from_str(text: &str) -> Result<Interpreted, ToolError> {
        Interpreted::from_text("tool", text)
    }
}

/// Returns the remedy for a file that cannot be read, unless the error has one.
fn remedy(error: &std::io::Error) -> &'static str {
    match error.kind() {
        std::io::ErrorKind::InvalidData => "",
        _ => ": check the path and its permissions",
    }
}

fn info(tool: &CheckedTool) -> ToolInfo {
    let model = &tool.model;
    ToolInfo {
        name: Cow::Owned(model.name.clone()),
        title: Cow::Owned(model.title.clone().unwrap_or_default()),
        unit: match model.unit {
            model::Unit::Millimetre => Unit::Millimetre,
            model::Unit::Inch => Unit::Inch,
            model::Unit::Metre => Unit::Metre,
        },
        surfaces: model
            .surfaces
            .iter()
            .map(|s| Surface { name: Cow::Owned(s.name.clone()), cutting: s.cutting })
            .collect(),
        regions: model
            .regions
            .iter()
            .map(|r| Region { name: Cow::Owned(r.name.clone()), surface: SurfaceId(r.surface) })
            .collect(),
        envelope: tool
            .envelope()
            .iter()
            .map(|s| EnvelopeSlab::new(s.low, s.high, s.radius))
            .collect(),
        symmetry: match model.domain {
            Domain::HalfPlane => Symmetry::Revolved,
            Domain::Space => Symmetry::Solid {
                extent: lateral_extent(&tool.extent).map(|[low, high]| Interval { low, high }),
            },
        },
        outline: model.outline().map(profile_segment).collect(),
        depth: {
            let Bounds { lower_slope, lipschitz, rounding_error: rounding } = tool.bounds();
            DepthBounds { lower_slope, lipschitz, rounding }
        },
        digest: digest(tool),
    }
}

fn profile_segment(segment: Segment) -> ProfileSegment {
    let Segment { ends: [from, to], circle, surface, .. } = segment;
    ProfileSegment { from, to, circle, surface: SurfaceId(surface) }
}

/// The memory of evaluations, for each type of lane. Enclosures are not reserved.
#[derive(Clone, Debug, Default)]
pub(super) struct EvaluationMemory {
    numbers: Memory<f64, bool>,
    vectors: Memory<Eight, u8>,
    duals: Memory<Dual, bool>,
    enclosures: Memory<Enclosure, Ternary>,
}

impl Tool for Interpreted {
    fn info(&self) -> &ToolInfo {
        &self.info
    }

    fn evaluate(
        &self,
        level: Level,
        outputs: Outputs,
        points: &PointBatch,
        length: f64,
        evaluations: &mut Evaluations,
    ) {
        evaluations.reserve(points, outputs);
        // The memory is taken out while the results are written.
        if points.len() == 1 {
            let mut memory = mem::take(&mut evaluations.memory.numbers);
            let plan = &self.plan;
            evaluate_points(
                outputs,
                points,
                length,
                evaluations,
                |point, unit, present, outputs| {
                    plan.evaluate_lanes(point, unit, present, outputs, &mut memory)
                },
            );
            evaluations.memory.numbers = memory;
            return;
        }
        let mut memory = mem::take(&mut evaluations.memory.vectors);
        dispatch!(level, simd => simd.vectorize(
            #[inline(always)]
            || evaluate_blocks(
                simd, outputs, points, length, evaluations,
                #[inline(always)]
                |point, unit, present, outputs| {
                    self.plan.evaluate_lanes(point, unit, present, outputs, &mut memory)
                },
            ),
        ));
        evaluations.memory.vectors = memory;
    }

    fn enclose(
        &self,
        sides: [Interval; 3],
        reference: [f64; 3],
        scratch: &mut Evaluations,
    ) -> Option<EvaluationEnclosure> {
        // With a profile, distances are known exactly, and no enclosure is as tight.
        if !self.info.outline.is_empty() {
            return None;
        }
        let memory = &mut scratch.memory.enclosures;
        Some(EvaluationEnclosure::evaluated(sides, reference, |point, unit, present, outputs| {
            self.plan.evaluate_lanes(point, unit, present, outputs, memory)
        }))
    }

    fn derivatives(&self, point: [f64; 3], length: f64, scratch: &mut Evaluations) -> Derivatives {
        let outputs = Outputs { direction: true, gradient: true, ..Outputs::INSIDE };
        let (point, unit) = (Dual::point(point), Dual::constant(length));
        let memory = &mut scratch.memory.duals;
        let found = self.plan.evaluate_lanes(point, unit, true, outputs, memory);
        Derivatives::of(found.direction, found.gradient, length)
    }

    fn reserve(&self, evaluations: &mut Evaluations) {
        let EvaluationMemory { numbers, vectors, duals, .. } = &mut evaluations.memory;
        self.plan.reserve(numbers);
        self.plan.reserve(vectors);
        self.plan.reserve(duals);
    }
}

impl BatchEvaluator for Interpreted {
    fn evaluate_outputs<O: OutputSelection>(
        &self,
        level: Level,
        points: &PointBatch,
        length: f64,
        evaluations: &mut Evaluations,
    ) {
        self.evaluate(level, O::OUTPUTS, points, length, evaluations);
    }
}

//! Tools that are loaded at run time.

use super::{
    BatchEvaluator, Circle, DepthBounds, Derivatives, Dual, Enclosure, EnvelopeSlab,
    EvaluationEnclosure, Evaluations, LANES, Lane, OutputSelection, Outputs, PointBatch,
    ProfileSegment, Region, Surface, Symmetry, Ternary, Tool, ToolInfo,
};
use crate::debug::debug;
use crate::id::SurfaceId;
use crate::interval::Interval;
use crate::unit::Unit;
use fearless_simd::{Level, Simd, dispatch};
use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;
use std::str::FromStr;
use touchoff_dsl::bound::lateral_extent;
use touchoff_dsl::domain::Domain;
use touchoff_dsl::interpret::{
    BLOCK_POINTS, Block, Lanes, OUTPUT_COUNT, PlanEvaluator, Tape, Value,
};
use touchoff_dsl::prove::Bounds;
use touchoff_dsl::source::Source;
use touchoff_dsl::{Accepted, CheckedTool, compile_with_arguments, diagnostic, digest, model};

/// A tool from a `.tool` file, evaluated by the interpreter.
pub struct Interpreted {
    info: ToolInfo,
    evaluations: Vec<Tape>,
    plan: PlanEvaluator,
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
            Ok(Accepted { tool, .. }) => Ok(Interpreted {
                info: info(&tool),
                evaluations: (0..tool.model.regions.len())
                    .map(|k| Tape::evaluation(&tool, k))
                    .collect(),
                plan: PlanEvaluator::new(&tool),
                warnings: diagnostics,
            }),
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

fn profile_segment(segment: model::ProfileSegment) -> ProfileSegment {
    let model::ProfileSegment { ends: [from, to], circle, surface } = segment;
    let circle = circle.map(|(centre, radius, convex)| Circle { centre, radius, convex });
    ProfileSegment { from, to, circle, surface: SurfaceId(surface) }
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
        dispatch!(level, simd => simd.vectorize(
            #[inline(always)]
            || self.evaluate_blocks(outputs, points, length, evaluations),
        ));
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
        let (point, one) = (Enclosure::of_box(sides, reference), Enclosure::constant(1.0));
        let mut enclosure = EvaluationEnclosure::empty();
        self.plan.for_each_owner(point, one, &mut scratch.enclosures, |owner, test| {
            enclosure.include(owner, test);
        });
        Some(enclosure)
    }

    fn derivatives(&self, point: [f64; 3], length: f64, scratch: &mut Evaluations) -> Derivatives {
        let mut results = [Dual::default(); OUTPUT_COUNT];
        let duals = (Dual::point(point), Dual::constant(length));
        self.plan.run(duals.0, duals.1, &mut scratch.duals, &mut results);
        let [_, _, _, _, direction @ .., gx, gy, gz] = results;
        Derivatives::of(direction, [gx, gy, gz], length)
    }

    fn reserve(&self, evaluations: &mut Evaluations) {
        self.plan.reserve(&mut evaluations.scratch);
        self.plan.reserve(&mut evaluations.duals);
        self.plan.reserve_block(&mut evaluations.lanes);
        for tape in &self.evaluations {
            tape.reserve(&mut evaluations.registers);
        }
    }
}

impl Value for Dual {
    fn constant(value: f64) -> Dual {
        Dual::constant(value)
    }
    fn sqrt(self) -> Dual {
        Lane::sqrt(self)
    }
    fn abs(self) -> Dual {
        Lane::abs(self)
    }
    fn le(a: Dual, b: Dual) -> [bool; 2] {
        Value::le(a.value, b.value)
    }
    fn lt(a: Dual, b: Dual) -> [bool; 2] {
        Value::lt(a.value, b.value)
    }
}

impl Default for Enclosure {
    fn default() -> Enclosure {
        Enclosure::constant(0.0)
    }
}

impl Value for Enclosure {
    fn constant(value: f64) -> Enclosure {
        Enclosure::constant(value)
    }
    fn sqrt(self) -> Enclosure {
        Lane::sqrt(self)
    }
    fn abs(self) -> Enclosure {
        Lane::abs(self)
    }
    fn le(a: Enclosure, b: Enclosure) -> [bool; 2] {
        let Ternary { yes, no, .. } = Lane::le(a, b);
        [yes, no]
    }
    fn lt(a: Enclosure, b: Enclosure) -> [bool; 2] {
        let Ternary { yes, no, .. } = Lane::lt(a, b);
        [yes, no]
    }
    fn hull(self, other: Enclosure) -> Enclosure {
        self.hull(other)
    }
    fn min(a: Enclosure, b: Enclosure) -> Enclosure {
        Lane::min(a, b)
    }
    fn max(a: Enclosure, b: Enclosure) -> Enclosure {
        Lane::max(a, b)
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

impl Interpreted {
    #[inline(always)]
    fn evaluate_blocks(
        &self,
        outputs: Outputs,
        points: &PointBatch,
        length: f64,
        evaluations: &mut Evaluations,
    ) {
        // Results are in this order: owner, depth, magnitude, niceness, direction, gradient.
        let result_count = match outputs {
            Outputs { gradient: true, .. } => OUTPUT_COUNT,
            Outputs { direction: true, .. } => 7,
            Outputs { niceness: true, .. } => 4,
            Outputs { magnitude: true, .. } => 3,
            Outputs { depth: true, .. } => 2,
            _ => 1,
        };
        let request = EvaluationRequest { outputs, result_count, length };
        let coordinates = points.coordinates();
        for start in (0..points.len()).step_by(BLOCK_POINTS) {
            let count = BLOCK_POINTS.min(points.len() - start);
            // Both ways give the same bits; which one is taken is a question of speed alone.
            if count <= MAX_SEPARATE_POINTS {
                self.evaluate_points(start..start + count, coordinates, request, evaluations);
            } else {
                self.evaluate_block(start..start + count, coordinates, request, evaluations);
            }
        }
    }
}

/// The requested outputs of an evaluation, the number of results that they need, and the unit of length.
#[derive(Clone, Copy)]
struct EvaluationRequest {
    outputs: Outputs,
    /// The results are in a fixed order, of which only the first ones are computed.
    result_count: usize,
    /// The tool's unit in the part's unit.
    length: f64,
}

/// Maximum number of points of a block that are evaluated one by one, because a tape computes all lanes of a block.
const MAX_SEPARATE_POINTS: usize = 8;
/// Minimum number of points of a region for which its tape is faster than an evaluation per point.
const MIN_TAPE_POINTS: usize = 8;

impl Interpreted {
    fn evaluate_points(
        &self,
        indices: Range<usize>,
        [x, y, z]: [&[f64]; 3],
        request: EvaluationRequest,
        evaluations: &mut Evaluations,
    ) {
        let EvaluationRequest { outputs, result_count, length } = request;
        let mut results = [0.0; OUTPUT_COUNT];
        for index in indices {
            let point = [x[index], y[index], z[index]];
            self.plan.run(point, length, &mut evaluations.scratch, &mut results[..result_count]);
            if results[0] < 0.0 {
                continue;
            }
            evaluations.inside[index / LANES] |= 1 << (index % LANES);
            store(evaluations, outputs, |list, result| list[index] = results[result]);
        }
    }

    #[inline(always)]
    fn evaluate_block(
        &self,
        indices: Range<usize>,
        coordinates: [&[f64]; 3],
        request: EvaluationRequest,
        evaluations: &mut Evaluations,
    ) {
        let EvaluationRequest { outputs, result_count, length } = request;
        let (start, count) = (indices.start, indices.len());
        let mut block: [Lanes; 3] = [[0.0; BLOCK_POINTS]; 3];
        let mut owners = [-1.0; BLOCK_POINTS];
        for (component, list) in block.iter_mut().zip(coordinates) {
            component[..count].copy_from_slice(&list[indices.clone()]);
        }
        let points = Block { points: block.each_ref(), count, length };
        self.plan.owners(points, &mut evaluations.lanes, &mut owners);
        for (index, _) in owners[..count].iter().enumerate().filter(|(_, owner)| **owner >= 0.0) {
            evaluations.inside[(start + index) / LANES] |= 1 << (index % LANES);
        }
        if outputs == Outputs::INSIDE {
            return;
        }
        // Fixed-size lists, since a haptic loop may not allocate.
        let (mut remaining, mut owned) = ([0; BLOCK_POINTS], [0; BLOCK_POINTS]);
        let mut remaining_count = 0;
        for index in (0..count).filter(|index| owners[*index] >= 0.0) {
            remaining[remaining_count] = index;
            remaining_count += 1;
        }
        let mut results = [[0.0; BLOCK_POINTS]; OUTPUT_COUNT];
        // Region by region: the points of one are gathered, so that its tape runs on full lanes.
        while remaining_count > 0 {
            let region = owners[remaining[0]];
            let (mut owned_count, mut other_count) = (0, 0);
            for k in 0..remaining_count {
                let index = remaining[k];
                let (list, count_in_list) = match owners[index] == region {
                    true => (&mut owned, &mut owned_count),
                    false => (&mut remaining, &mut other_count),
                };
                list[*count_in_list] = index;
                *count_in_list += 1;
            }
            let owned = &owned[..owned_count];
            let mut gathered: [Lanes; 3] = [[0.0; BLOCK_POINTS]; 3];
            for (lane, index) in owned.iter().enumerate() {
                for (component, list) in gathered.iter_mut().zip(&block) {
                    component[lane] = list[*index];
                }
            }
            // The first result is the owner, which a tape of one region does not compute.
            results[0] = [region; BLOCK_POINTS];
            if owned.len() < MIN_TAPE_POINTS {
                let mut values = [0.0; OUTPUT_COUNT];
                for lane in 0..owned.len() {
                    let point = [0, 1, 2].map(|k| gathered[k][lane]);
                    let values = &mut values[..result_count - 1];
                    self.plan.evaluate(
                        region as usize,
                        point,
                        length,
                        &mut evaluations.scratch,
                        values,
                    );
                    for (result, value) in results[1..].iter_mut().zip(values) {
                        result[lane] = *value;
                    }
                }
            } else {
                let tape = &self.evaluations[region as usize];
                let results = &mut results[1..result_count];
                let owned = Block { points: gathered.each_ref(), count: owned.len(), length };
                tape.run(owned, &mut evaluations.registers, results);
            }
            store(evaluations, outputs, |list, result| {
                for (lane, index) in owned.iter().enumerate() {
                    list[start + index] = results[result][lane];
                }
            });
            remaining_count = other_count;
        }
    }
}

/// Calls `copy` for each component of the requested outputs, with its list and the index of its result.
fn store(
    evaluations: &mut Evaluations,
    outputs: Outputs,
    mut copy: impl FnMut(&mut Vec<f64>, usize),
) {
    if outputs.depth {
        copy(&mut evaluations.depth, 1);
    }
    if outputs.magnitude {
        copy(&mut evaluations.magnitude, 2);
    }
    if outputs.niceness {
        copy(&mut evaluations.niceness, 3);
    }
    for axis in 0..3 {
        if outputs.direction {
            copy(&mut evaluations.direction[axis], 4 + axis);
        }
        if outputs.gradient {
            copy(&mut evaluations.gradient[axis], 7 + axis);
        }
    }
    if outputs.region {
        copy(&mut evaluations.region, 0);
    }
}

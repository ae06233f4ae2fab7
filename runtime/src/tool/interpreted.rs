//! Tools that are loaded at run time.

use super::{
    BatchEvaluator, Circle, DepthBounds, Derivatives, Dual, Enclosure, EnvelopeSlab,
    EvaluationEnclosure, Evaluations, LANES, Lane, OutputSelection, Outputs, PointBatch,
    ProfileSegment, Region, Surface, Symmetry, Ternary, Tool, ToolInfo,
};
use crate::debug::debug;
use crate::id::SurfaceId;
use crate::unit::Unit;
use fearless_simd::{Level, Simd, dispatch};
use std::borrow::Cow;
use std::path::Path;
use tool_dsl::bound::across;
use tool_dsl::domain::Domain;
use tool_dsl::interpret::{BLOCK, Lanes, OUTPUTS, PlanWalk, Scratch, Tape, Value};
use tool_dsl::prove::Bounds;
use tool_dsl::source::Source;
use tool_dsl::{Accepted, CheckedTool, compile_with, diagnostic, digest, model};

/// A tool from a `.tool` file, evaluated by the interpreter.
pub struct Interpreted {
    info: ToolInfo,
    evaluations: Vec<Tape>,
    walk: PlanWalk,
    outside: Tape,
    warnings: String,
}

debug!([] Interpreted, "Interpreted", |this| { name: this.info.name });

/// A `.tool` file that could not be loaded. The message is meant for people, and has the position and the remedy.
#[derive(Debug, thiserror::Error)]
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
    Wrong(String),
}

impl Interpreted {
    /// Loads a `.tool` file.
    ///
    /// # Errors
    ///
    /// [`ToolError::Unreadable`] if the file cannot be read, [`ToolError::Wrong`] if it does not compile.
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

    /// Compiles a tool's text.
    ///
    /// # Errors
    ///
    /// [`ToolError::Wrong`] with all diagnostics if the text does not compile.
    pub fn parse(source: &Source) -> Result<Interpreted, ToolError> {
        Interpreted::parse_with(source, &[])
    }

    /// Compiles a tool's text with arguments for its parameters, such as `D = 0.25inch, flute = 18`.
    ///
    /// # Errors
    ///
    /// [`ToolError::Wrong`] with all diagnostics if the text or the arguments do not compile.
    pub fn parse_with(source: &Source, given: &[Source]) -> Result<Interpreted, ToolError> {
        let compiled = compile_with(source, given);
        let said: Vec<String> =
            compiled.diagnostics().iter().map(|r| r.render(&compiled.sources, false)).collect();
        let said = said.join("\n\n");
        match compiled.outcome {
            Ok(Accepted { tool, .. }) => Ok(Interpreted {
                info: info(&tool),
                evaluations: (0..tool.model.regions.len())
                    .map(|k| Tape::evaluation(&tool, k))
                    .collect(),
                walk: PlanWalk::new(&tool),
                outside: Tape::clearance(&tool),
                warnings: said,
            }),
            Err(_) => Err(ToolError::Wrong(said)),
        }
    }

    /// Returns the compiler's warnings; empty if there are none.
    pub fn warnings(&self) -> &str {
        &self.warnings
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
            Domain::Space => Symmetry::Solid { across: across(&tool.extent) },
        },
        outline: model.outline().map(piece).collect(),
        depth: {
            let Bounds { min_slope, lipschitz, rounding } = tool.bounds();
            DepthBounds { min_slope, lipschitz, rounding }
        },
        digest: digest(tool),
    }
}

fn piece(of: model::ProfileSegment) -> ProfileSegment {
    let model::ProfileSegment { ends: [from, to], circle, surface } = of;
    let circle = circle.map(|(centre, radius, convex)| Circle { centre, radius, convex });
    ProfileSegment { from, to, circle, surface: SurfaceId(surface) }
}

impl Tool for Interpreted {
    fn info(&self) -> &ToolInfo {
        &self.info
    }

    fn clearance(&self, point: [f64; 3]) -> f64 {
        let mut owner = [0.0];
        self.walk.run(point, 1.0, &mut Scratch::default(), &mut owner);
        if owner[0] >= 0.0 {
            return 0.0;
        }
        let block = point.map(|part| [part; BLOCK]);
        let (mut registers, mut results) = (Vec::new(), [[0.0; BLOCK]]);
        self.outside.run((block.each_ref(), 1), 1.0, &mut registers, &mut results);
        results[0][0]
    }

    fn evaluate(
        &self,
        level: Level,
        ask: Outputs,
        points: &PointBatch,
        length: f64,
        evaluations: &mut Evaluations,
    ) {
        evaluations.reserve(points, ask);
        dispatch!(level, simd => simd.vectorize(
            #[inline(always)]
            || self.all(ask, points, length, evaluations),
        ));
    }

    fn enclose(
        &self,
        sides: [[f64; 2]; 3],
        at: [f64; 3],
        room: &mut Evaluations,
    ) -> Option<EvaluationEnclosure> {
        if !self.info.outline.is_empty() {
            return None;
        }
        let (point, one) = (Enclosure::of_box(sides, at), Enclosure::constant(1.0));
        let mut found = EvaluationEnclosure::nothing();
        let visit = |owner, test| found.take(owner, test);
        self.walk.each_owner(point, one, &mut room.enclosures, visit);
        Some(found)
    }

    fn derivatives(&self, point: [f64; 3], length: f64, room: &mut Evaluations) -> Derivatives {
        let mut results = [Dual::default(); OUTPUTS];
        let duals = (Dual::point(point), Dual::constant(length));
        self.walk.run(duals.0, duals.1, &mut room.duals, &mut results);
        let three = |from: usize| std::array::from_fn(|k| results[from + k]);
        Derivatives::of(three(4), three(7), length)
    }

    fn reserve(&self, evaluations: &mut Evaluations) {
        self.walk.reserve(&mut evaluations.scratch);
        self.walk.reserve(&mut evaluations.duals);
        self.walk.reserve_block(&mut evaluations.lanes);
        for tape in &self.evaluations {
            tape.reserve(&mut evaluations.registers);
        }
    }
}

impl Value for Dual {
    fn of(value: f64) -> Dual {
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
    fn of(value: f64) -> Enclosure {
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
    fn either(self, other: Enclosure) -> Enclosure {
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
    fn evaluate_outputs<W: OutputSelection>(
        &self,
        level: Level,
        points: &PointBatch,
        length: f64,
        evaluations: &mut Evaluations,
    ) {
        self.evaluate(level, W::OUTPUTS, points, length, evaluations);
    }
}

impl Interpreted {
    #[inline(always)]
    fn all(&self, ask: Outputs, points: &PointBatch, length: f64, evaluations: &mut Evaluations) {
        // Results are in this order: owner, depth, magnitude, niceness, direction, gradient.
        let wanted = match ask {
            Outputs { gradient: true, .. } => OUTPUTS,
            Outputs { direction: true, .. } => 7,
            Outputs { niceness: true, .. } => 4,
            Outputs { magnitude: true, .. } => 3,
            Outputs { depth: true, .. } => 2,
            _ => 1,
        };
        let coordinates = points.coordinates();
        for start in (0..points.len()).step_by(BLOCK) {
            let count = BLOCK.min(points.len() - start);
            if count <= FEW {
                self.one_by_one(
                    start..start + count,
                    coordinates,
                    (ask, wanted, length),
                    evaluations,
                );
            } else {
                self.block(start, coordinates, (ask, wanted, length), points.len(), evaluations);
            }
        }
    }
}

/// Blocks with at most this many points are walked point by point, because a tape computes all lanes of a block.
const FEW: usize = 8;
/// From this many points of a region on, its tape is faster than a walk per point.
const SEVERAL: usize = 8;

impl Interpreted {
    fn one_by_one(
        &self,
        places: std::ops::Range<usize>,
        [x, y, z]: [&[f64]; 3],
        (ask, wanted, length): (Outputs, usize, f64),
        evaluations: &mut Evaluations,
    ) {
        let mut results = [0.0; OUTPUTS];
        for at in places {
            let point = [x[at], y[at], z[at]];
            self.walk.run(point, length, &mut evaluations.scratch, &mut results[..wanted]);
            if results[0] < 0.0 {
                continue;
            }
            evaluations.inside[at / LANES] |= 1 << (at % LANES);
            put(evaluations, ask, |list, result| list[at] = results[result]);
        }
    }

    #[inline(always)]
    fn block(
        &self,
        start: usize,
        coordinates: [&[f64]; 3],
        (ask, wanted, length): (Outputs, usize, f64),
        total: usize,
        evaluations: &mut Evaluations,
    ) {
        let mut block: [Lanes; 3] = [[0.0; BLOCK]; 3];
        let mut owners = [-1.0; BLOCK];
        let count = BLOCK.min(total - start);
        for (part, list) in block.iter_mut().zip(coordinates) {
            part[..count].copy_from_slice(&list[start..start + count]);
        }
        let points = (block.each_ref(), count);
        self.walk.owners(points, length, &mut evaluations.lanes, &mut owners);
        for (at, _) in owners[..count].iter().enumerate().filter(|(_, owner)| **owner >= 0.0) {
            evaluations.inside[(start + at) / LANES] |= 1 << (at % LANES);
        }
        if ask == Outputs::INSIDE {
            return;
        }
        // Fixed-size lists, since a haptic loop may not allocate.
        let (mut left, mut own) = ([0; BLOCK], [0; BLOCK]);
        let mut many = 0;
        for at in (0..count).filter(|at| owners[*at] >= 0.0) {
            left[many] = at;
            many += 1;
        }
        let mut results = [[0.0; BLOCK]; OUTPUTS];
        while many > 0 {
            let region = owners[left[0]];
            let (mut ours, mut rest) = (0, 0);
            for k in 0..many {
                let at = left[k];
                let (list, place) = match owners[at] == region {
                    true => (&mut own, &mut ours),
                    false => (&mut left, &mut rest),
                };
                list[*place] = at;
                *place += 1;
            }
            let own = &own[..ours];
            let mut gathered: [Lanes; 3] = [[0.0; BLOCK]; 3];
            for (lane, at) in own.iter().enumerate() {
                for (part, list) in gathered.iter_mut().zip(&block) {
                    part[lane] = list[*at];
                }
            }
            results[0] = [region; BLOCK];
            if own.len() < SEVERAL {
                let mut one = [0.0; OUTPUTS];
                for lane in 0..own.len() {
                    let point = [0, 1, 2].map(|k| gathered[k][lane]);
                    let one = &mut one[..wanted - 1];
                    self.walk.evaluate(
                        region as usize,
                        point,
                        length,
                        &mut evaluations.scratch,
                        one,
                    );
                    for (result, value) in results[1..].iter_mut().zip(one) {
                        result[lane] = *value;
                    }
                }
            } else {
                let tape = &self.evaluations[region as usize];
                let results = &mut results[1..wanted];
                tape.run(
                    (gathered.each_ref(), own.len()),
                    length,
                    &mut evaluations.registers,
                    results,
                );
            }
            put(evaluations, ask, |list, result| {
                for (lane, at) in own.iter().enumerate() {
                    list[start + at] = results[result][lane];
                }
            });
            many = rest;
        }
    }
}

/// Calls `copy` for each component of the requested outputs, with its list and the index of its result.
fn put(evaluations: &mut Evaluations, ask: Outputs, mut copy: impl FnMut(&mut Vec<f64>, usize)) {
    if ask.depth {
        copy(&mut evaluations.depth, 1);
    }
    if ask.magnitude {
        copy(&mut evaluations.magnitude, 2);
    }
    if ask.niceness {
        copy(&mut evaluations.niceness, 3);
    }
    for part in 0..3 {
        if ask.direction {
            copy(&mut evaluations.direction[part], 4 + part);
        }
        if ask.gradient {
            copy(&mut evaluations.gradient[part], 7 + part);
        }
    }
    if ask.region {
        copy(&mut evaluations.region, 0);
    }
}

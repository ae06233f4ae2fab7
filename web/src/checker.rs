//! The check of a program, for a thread of its own beside the loop, and its findings as the page lists them.

use crate::error::EngineError;
use crate::{part, program, tool};
use nalgebra::UnitQuaternion;
use self_cell::self_cell;
use serde::Serialize;
use std::fmt;
use std::rc::Rc;
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::tool::{Interpreted, ToolInfo};
use touchoff::{Mesh, Pose, SurfaceId, Tool};
use touchoff_verify::job::{FindingDetail, Severity};
use touchoff_verify::machine::Machine;
use touchoff_verify::{
    Finding, FindingGroup, FindingKind, Job, JobReport, JobTool, Move, Program, ToolSelection,
    VerifyError,
};
use wasm_bindgen::prelude::{JsError, wasm_bindgen};

/// Tolerance of depth at a position, and of clearance, as fractions of the tool's length from its tip.
const TOLERANCES: [f64; 2] = [1e-6, 1.0 / 256.0];

#[wasm_bindgen]
extern "C" {
    /// Is called with the number of motions that were checked since the last call; the thread defines it.
    #[wasm_bindgen(js_namespace = globalThis, js_name = checkedMotions)]
    fn checked_motions(count: usize);
}

/// The part and the tool.
struct Pair {
    bvh: Rc<TriangleBvh>,
    tool: Rc<Interpreted>,
}

self_cell!(
    /// A certifier with the part and the tool that it borrows.
    struct Judge {
        owner: Pair,
        #[not_covariant]
        dependent: Certifier,
    }
);

/// A part, a tool and a program.
#[wasm_bindgen]
#[derive(Default)]
pub struct Checker {
    bvh: Option<Rc<TriangleBvh>>,
    tool: Option<Rc<Interpreted>>,
    program: Option<Program>,
    /// The number of the tool whose motions are taken.
    number: Option<u32>,
    moves: Vec<Move>,
    judge: Option<Judge>,
}

impl fmt::Debug for Checker {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Checker").field("moves", &self.moves.len()).finish_non_exhaustive()
    }
}

#[wasm_bindgen]
impl Checker {
    /// Makes a checker without part, tool and program.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Checker {
        Checker::default()
    }

    /// Lists the machines that come with the library, as JSON.
    pub fn machines() -> String {
        serde_json::json!(Machine::names().collect::<Vec<_>>()).to_string()
    }

    /// Takes a generated part; see [`Engine::generate_part`](crate::Engine::generate_part).
    ///
    /// # Errors
    /// Fails for another name.
    #[wasm_bindgen(js_name = generatePart)]
    pub fn generate_part(&mut self, name: &str) -> Result<(), JsError> {
        self.take_part(&part::generate(name)?);
        Ok(())
    }

    /// Reads a part; see [`Engine::read_part`](crate::Engine::read_part).
    ///
    /// # Errors
    /// Fails if the file cannot be read.
    #[wasm_bindgen(js_name = readPart)]
    pub fn read_part(&mut self, bytes: &[u8], name: &str, unit: &str) -> Result<(), JsError> {
        self.take_part(&part::read(bytes, name, unit)?);
        Ok(())
    }

    /// Takes a tool; see [`Engine::compile_tool`](crate::Engine::compile_tool).
    ///
    /// # Errors
    /// Fails if the text has errors.
    #[wasm_bindgen(js_name = setTool)]
    pub fn set_tool(&mut self, name: &str, text: &str, files: &str) -> Result<(), JsError> {
        let (_, tool) = tool::compiled(name, text, files)?;
        self.tool = Some(Rc::new(tool.ok_or_else(|| EngineError::ToolErrors(name.to_owned()))?));
        self.judge = None;
        Ok(())
    }

    /// Reads a program: positions, or G-code on a machine, given by its name or the text of its file. Returns the facts
    /// about it as JSON.
    ///
    /// # Errors
    /// Fails if a line is refused, the machine is unknown, or the program is too long.
    #[wasm_bindgen(js_name = readProgram)]
    pub fn read_program(
        &mut self,
        bytes: &[u8],
        name: &str,
        machine: &str,
    ) -> Result<String, JsError> {
        let program = self.program.insert(program::read(bytes, name, machine)?);
        Ok(serde_json::to_string(&program::facts(program))?)
    }

    /// Takes the motions of the tool with a number in the program. Returns the tips at the ends of motions, and 1 after each that
    /// is reached in rapid traverse, else 0: 4 values per position.
    ///
    /// # Errors
    /// Fails without part, tool and program, and if unit, poses or cutter of the program do not fit.
    #[wasm_bindgen(js_name = takeMotions)]
    pub fn take_motions(&mut self, number: Option<u32>) -> Result<Vec<f32>, JsError> {
        Ok(self.load(number)?)
    }

    /// Checks all motions with a tolerance of depth. Returns the result as JSON.
    ///
    /// # Errors
    /// Fails without motions, for an invalid tolerance, and for a tool that cannot be certified.
    pub fn check(&self, tolerance: f64) -> Result<String, JsError> {
        Ok(serde_json::to_string(&self.verified(tolerance)?)?)
    }

    /// Returns the state at a position of the program, from 0 to the number of motions less 1; the fraction is that of the
    /// motion: tip, quaternion (x, y, z, w), line, 1 in rapid traverse, lower and upper bound of depth, lower and upper bound of the
    /// distance of the surfaces that do not cut (infinite if all cut or nothing is known), and of the whole tool.
    ///
    /// # Errors
    /// Fails without motions.
    pub fn at(&mut self, position: f64) -> Result<Vec<f64>, JsError> {
        Ok(self.state_at(position)?)
    }
}

impl Checker {
    fn take_part(&mut self, mesh: &Mesh) {
        self.bvh = Some(Rc::new(TriangleBvh::new(mesh)));
        // The motions were in the frame and the unit of the old part.
        self.judge = None;
        self.moves.clear();
    }

    fn pair(&self) -> Result<(&Rc<TriangleBvh>, &Rc<Interpreted>), EngineError> {
        self.bvh.as_ref().zip(self.tool.as_ref()).ok_or(EngineError::NotLoaded)
    }

    fn load(&mut self, number: Option<u32>) -> Result<Vec<f32>, EngineError> {
        let (bvh, tool) = self.pair()?;
        let program = self.program.as_ref().ok_or(EngineError::NotLoaded)?;
        let moves = program::moves(program, number, tool.info(), bvh.unit())?;
        let pair = Pair { bvh: Rc::clone(bvh), tool: Rc::clone(tool) };
        let judge = Judge::try_new(pair, |pair| Certifier::new(&pair.bvh, &*pair.tool));
        self.judge = Some(judge.map_err(VerifyError::from)?);
        (self.number, self.moves) = (number, moves);
        let tips = self.moves.iter().flat_map(|step| {
            let tip = step.path.pose(1.0).tip();
            [tip.x, tip.y, tip.z, f64::from(u8::from(step.rapid))].map(|value| value as f32)
        });
        Ok(tips.collect())
    }

    fn verified(&self, tolerance: f64) -> Result<CheckResult, EngineError> {
        let (bvh, tool) = self.pair()?;
        let program = self.program.as_ref().filter(|_| !self.moves.is_empty());
        let mut job = Job::new(program.ok_or(EngineError::NotLoaded)?, bvh);
        let mut tool = JobTool::of_all(&**tool);
        // The page holds one tool; motions of others would be checked with the wrong one.
        tool.motions = ToolSelection::Number(self.number);
        job.tools.push(tool);
        job.tolerance = tolerance;
        Ok(CheckResult::of(&job.check(&checked_motions)?))
    }

    fn state_at(&mut self, position: f64) -> Result<Vec<f64>, EngineError> {
        let (Some(judge), Some(last)) = (&mut self.judge, self.moves.len().checked_sub(1)) else {
            return Err(EngineError::NotLoaded);
        };
        // A NaN is taken as the start: `max` returns the other number.
        let position = position.max(0.0).min(last as f64);
        // Motion `index` ends at the position of that index, so the fraction counts back from its end.
        let index = position.ceil();
        let step = &self.moves[index as usize];
        let pose = step.path.pose(1.0 - (index - position));
        let quaternion = UnitQuaternion::from(pose.to_isometry().rotation);
        let mut values: Vec<f64> = pose.tip().iter().copied().collect();
        values.extend(quaternion.coords.iter());
        values.extend([step.line as f64, f64::from(u8::from(step.rapid))]);
        values.extend(judge.with_dependent_mut(|pair, certifier| bounds(pair, certifier, &pose)));
        Ok(values)
    }
}

/// Returns the bounds of depth, of the distance of the surfaces that do not cut, and of the distance of the whole tool.
fn bounds(pair: &Pair, certifier: &mut Certifier<'_>, pose: &Pose) -> [f64; 6] {
    let info = pair.tool.info();
    let length = info.reach().high * info.unit.factor_to(pair.bvh.unit());
    let [fine, coarse] = TOLERANCES.map(|tolerance| tolerance * length);
    let depth = certifier.deepest(pose, fine).depth;
    let others = info.surfaces.iter().enumerate().filter(|(_, surface)| !surface.cutting);
    let others: Vec<SurfaceId> = others.map(|(index, _)| SurfaceId(index)).collect();
    let others = certifier.clearance_of(&others, pose, coarse).expect("surfaces of the tool");
    let whole = certifier.clearance(pose, coarse);
    let [others, whole] = [others.distance, whole.distance];
    [depth.low, depth.high, others.low, others.high, whole.low, whole.high]
}

/// The result of a check.
#[derive(Debug, Serialize)]
struct CheckResult {
    motions: usize,
    /// `true` if it is proved that nothing is deeper than allowed on the motions that were checked, in every reading of the program.
    clear: bool,
    /// `false` if the part has no inside, so that a tool wholly inside it is not found.
    inside_known: bool,
    /// Upper bound on the least distance between tool and part; 0 if they touch.
    distance: f64,
    /// `true` if the tool stays farther from the part than its diameter.
    far: bool,
    /// The factor by which all positions in feed, outside the part's box, would fit into it.
    unit_factor: Option<f64>,
    /// The findings at the part in the first reading, the worst first.
    findings: Vec<FindingRow>,
    /// Sentences about other violations: of the machine, and in other readings.
    others: Vec<String>,
    /// Sentences about what the machine does that is no violation.
    remarks: Vec<String>,
    /// Sentences about what allows no verdict.
    open: Vec<String>,
}

/// A finding on consecutive motions.
#[derive(Debug, Serialize)]
struct FindingRow {
    kind: &'static str,
    surface: Option<String>,
    /// Position of the worst in the program: the index of the cutter location before it, and the fraction of the motion.
    at: f64,
    /// Indices of the cutter locations at which the first and the last motion end.
    span: [usize; 2],
    /// Line of the worst, of the first and of the last motion.
    lines: [usize; 3],
    rapid: bool,
    /// Proved bounds of depth or distance at the worst.
    measured: Option<[f64; 2]>,
    /// The allowed depth, or the margin.
    limit: Option<f64>,
    /// The point of the part, and its triangle.
    point: Option<[f64; 3]>,
    triangle: Option<u32>,
    /// The axis of the tool at the worst.
    axis: [f64; 3],
}

impl CheckResult {
    /// Summarises the check of one tool at the part.
    fn of(report: &JobReport<'_>) -> CheckResult {
        let (mut findings, mut others, mut remarks) = (Vec::new(), Vec::new(), Vec::new());
        for finding in report.findings() {
            match &finding.detail {
                FindingDetail::Surface { pair: 0, groups, .. } => {
                    let info = report.job.tools[0].tool.info();
                    findings.extend(groups.iter().map(|group| FindingRow::of(group, info)));
                }
                _ => {
                    let is_remark = finding.severity == Severity::Remark;
                    let list = if is_remark { &mut remarks } else { &mut others };
                    list.push(format!("line {}: {}", finding.line, finding.text));
                }
            }
        }
        let open = report.gaps.iter().filter(|gap| gap.is_open());
        let first = &report.pairs[0].report;
        CheckResult {
            motions: first.motions,
            clear: report.pairs.iter().all(|pair| pair.report.is_clear()),
            inside_known: first.inside_known,
            distance: first.approach.distance,
            far: first.approach.is_far(),
            unit_factor: first.approach.unit_factor,
            findings,
            others,
            remarks,
            open: open.map(ToString::to_string).collect(),
        }
    }
}

impl FindingRow {
    fn of(group: &FindingGroup, info: &ToolInfo) -> FindingRow {
        let Finding { location, line, rapid, time, pose, kind, .. } = group.worst;
        let (label, measured, limit, witness) = match kind {
            FindingKind::Deep { allowed, depth, through, witness, .. } => {
                let label = if through { "right through" } else { "deep" };
                (label, Some([depth.low, depth.high]), Some(allowed), Some(witness))
            }
            FindingKind::Near { margin, distance, witness, .. } => {
                ("near", Some([distance.low, distance.high]), Some(margin), Some(witness))
            }
            FindingKind::Inside { .. } => ("inside", None, None, None),
            FindingKind::Undecided { .. } => ("undecided", None, None, None),
            FindingKind::Ambiguous(_) => ("ambiguous", None, None, None),
        };
        FindingRow {
            kind: label,
            surface: kind.surface().map(|surface| info.surface(surface).name.to_string()),
            at: (location as f64 - 1.0 + time).max(0.0),
            span: [group.first.location, group.last.location],
            lines: [line, group.first.line, group.last.line],
            rapid,
            measured,
            limit,
            point: witness.map(|witness| witness.point.coords.into()),
            triangle: witness.map(|witness| witness.triangle.0),
            axis: pose.axis().into(),
        }
    }
}

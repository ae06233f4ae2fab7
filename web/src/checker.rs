//! The check of a program, for a thread of its own beside the loop, and its findings as the page lists them.

use crate::error::EngineError;
use crate::stock::{Corners, PlayedStock};
use crate::{part, program, stock, tool};
use nalgebra::{Point3, UnitQuaternion};
use self_cell::self_cell;
use serde::Serialize;
use std::fmt;
use std::rc::Rc;
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::tool::{Interpreted, ToolInfo};
use touchoff::{Mesh, Pose, SurfaceId, Tool};
use touchoff_verify::job::{FindingDetail, JobFinding, PairReport, Severity};
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

/// The part and a tool.
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

/// A tool with its number in the program.
struct ProgramTool {
    number: Option<u32>,
    tool: Rc<Interpreted>,
    /// Its certifier, once motions are taken.
    judge: Option<Judge>,
}

/// A part, a program and its tools.
#[wasm_bindgen]
#[derive(Default)]
pub struct Checker {
    bvh: Option<Rc<TriangleBvh>>,
    tools: Vec<ProgramTool>,
    program: Option<Program>,
    /// The motions of all tools, in the order of the program.
    moves: Vec<Move>,
    /// The box of stock, if there is one.
    stock: Option<Corners>,
    /// The stock as it was cut last.
    played: Option<PlayedStock>,
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

    /// Takes the tool with a number in the program, in place of an earlier one; see
    /// [`Engine::compile_tool`](crate::Engine::compile_tool).
    ///
    /// # Errors
    /// Fails if the text has errors.
    #[wasm_bindgen(js_name = setTool)]
    pub fn set_tool(
        &mut self,
        number: Option<u32>,
        name: &str,
        text: &str,
        files: &str,
    ) -> Result<(), JsError> {
        let (_, tool) = tool::compiled(name, text, files)?;
        let tool = Rc::new(tool.ok_or_else(|| EngineError::ToolErrors(name.to_owned()))?);
        self.tools.retain(|known| known.number != number);
        self.tools.push(ProgramTool { number, tool, judge: None });
        // The motions are those of the old tool.
        self.moves.clear();
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
        // Numbers and motions were those of the old program.
        self.tools.clear();
        self.moves.clear();
        Ok(serde_json::to_string(&program::facts(program))?)
    }

    /// Takes the motions of all tools, in the order of the program. Returns the tips at the ends of motions, and 1 after each that
    /// is reached in rapid traverse, else 0: 4 values per position.
    ///
    /// # Errors
    /// Fails without part and program, if a number of the program has no tool, and if unit, poses or cutter of the program do not
    /// fit.
    #[wasm_bindgen(js_name = takeMotions)]
    pub fn take_motions(&mut self) -> Result<Vec<f32>, JsError> {
        Ok(self.load()?)
    }

    /// Takes a box of stock, by its lowest and its highest corner, or none if the list is empty.
    ///
    /// # Errors
    /// Fails for another number of values.
    #[wasm_bindgen(js_name = setStock)]
    pub fn set_stock(&mut self, corners: &[f64]) -> Result<(), JsError> {
        self.stock = match *corners {
            [] => None,
            [a, b, c, x, y, z] => Some([Point3::new(a, b, c), Point3::new(x, y, z)]),
            _ => return Err(EngineError::Corners(corners.len()).into()),
        };
        self.played = None;
        Ok(())
    }

    /// Cuts the stock toward a position of the program, by one motion. Before the position to which it is cut, it begins with the
    /// whole box. Returns whether it has arrived; without stock it has.
    ///
    /// # Errors
    /// Fails without motions, and if the stock cannot be made or cut.
    #[wasm_bindgen(js_name = cutStock)]
    pub fn cut_stock(&mut self, position: f64) -> Result<bool, JsError> {
        Ok(self.cut_toward(position)?)
    }

    /// Returns the number of points of the stock as it was cut last.
    #[wasm_bindgen(js_name = stockPoints)]
    pub fn stock_points(&self) -> usize {
        self.played.as_ref().map_or(0, PlayedStock::points)
    }

    /// Returns the corners of the triangles of the stock as it was cut last, 9 values per triangle.
    #[wasm_bindgen(js_name = stockPositions)]
    pub fn stock_positions(&self) -> Vec<f32> {
        self.played.as_ref().map(PlayedStock::positions).unwrap_or_default()
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
    /// distance of the surfaces that do not cut (infinite if all cut or nothing is known), and of the whole tool; and the number of
    /// the tool in the program, -1 without one.
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
        self.moves.clear();
    }

    fn load(&mut self) -> Result<Vec<f32>, EngineError> {
        let (Some(bvh), Some(program)) = (&self.bvh, &self.program) else {
            return Err(EngineError::NotLoaded);
        };
        let info =
            |number| self.tools.iter().find(|one| one.number == number).map(|one| one.tool.info());
        let moves = program::moves(program, info, bvh.unit())?;
        for one in &mut self.tools {
            let pair = Pair { bvh: Rc::clone(bvh), tool: Rc::clone(&one.tool) };
            let judge = Judge::try_new(pair, |pair| Certifier::new(&pair.bvh, &*pair.tool));
            one.judge = Some(judge.map_err(VerifyError::from)?);
        }
        self.moves = moves;
        self.played = None;
        let tips = self.moves.iter().flat_map(|step| {
            let tip = step.path.pose(1.0).tip();
            [tip.x, tip.y, tip.z, f64::from(u8::from(step.rapid))].map(|value| value as f32)
        });
        Ok(tips.collect())
    }

    fn cut_toward(&mut self, position: f64) -> Result<bool, EngineError> {
        let (Some(corners), Some(bvh)) = (self.stock, &self.bvh) else { return Ok(true) };
        let last = self.moves.len().checked_sub(1).ok_or(EngineError::NotLoaded)?;
        let position = position.max(0.0).min(last as f64);
        // Material that was cut does not come back.
        let played = match self.played.take().filter(|played| played.at() <= position) {
            Some(played) => played,
            None => PlayedStock::new(corners, bvh.unit())?,
        };
        let played = self.played.insert(played);
        if played.at() < position {
            let step = &self.moves[played.next()];
            let tool = self.tools.iter().find(|one| one.number == step.tool);
            played.cut(&*tool.ok_or(EngineError::NotLoaded)?.tool, step, position)?;
        }
        Ok(played.at() >= position)
    }

    fn verified(&self, tolerance: f64) -> Result<CheckResult, EngineError> {
        let program = self.program.as_ref().filter(|_| !self.moves.is_empty());
        let (Some(bvh), Some(program)) = (&self.bvh, program) else {
            return Err(EngineError::NotLoaded);
        };
        let mut job = Job::new(program, bvh);
        job.tools.extend(self.tools.iter().map(|one| {
            let mut tool = JobTool::of_all(&*one.tool);
            tool.motions = ToolSelection::Number(one.number);
            tool
        }));
        job.tolerance = tolerance;
        job.stock = self.stock.map(stock::of_job);
        Ok(CheckResult::of(&job.check(&checked_motions)?, &self.moves))
    }

    fn state_at(&mut self, position: f64) -> Result<Vec<f64>, EngineError> {
        let last = self.moves.len().checked_sub(1).ok_or(EngineError::NotLoaded)?;
        // A NaN is taken as the start: `max` returns the other number.
        let position = position.max(0.0).min(last as f64);
        // Motion `index` ends at the position of that index, so the fraction counts back from its end.
        let index = position.ceil();
        let step = &self.moves[index as usize];
        let tool = self.tools.iter_mut().find(|one| one.number == step.tool);
        let judge = tool.and_then(|one| one.judge.as_mut()).ok_or(EngineError::NotLoaded)?;
        let pose = step.path.pose(1.0 - (index - position));
        let quaternion = UnitQuaternion::from(pose.to_isometry().rotation);
        let mut values: Vec<f64> = pose.tip().iter().copied().collect();
        values.extend(quaternion.coords.iter());
        values.extend([step.line as f64, f64::from(u8::from(step.rapid))]);
        values.extend(judge.with_dependent_mut(|pair, certifier| bounds(pair, certifier, &pose)));
        values.push(step.tool.map_or(-1.0, f64::from));
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
    /// `true` if every tool stays farther from the part than its diameter.
    far: bool,
    /// The factor by which all positions in feed, outside the part's box, would fit into it.
    unit_factor: Option<f64>,
    /// All findings: violations, then what is undecided, then remarks; the worst of each first.
    findings: Vec<FindingRow>,
    /// Sentences about what allows no verdict.
    open: Vec<String>,
    /// A sentence about the stock, if there is one.
    stock: Option<String>,
}

/// A finding of a job.
#[derive(Clone, Debug, Serialize)]
struct FindingRow {
    severity: &'static str,
    /// The sentence.
    text: String,
    /// Number of the tool in the program, of a finding of a surface.
    number: Option<u32>,
    /// `true` if a surface goes right through the part or is inside it.
    through: bool,
    /// Line of the worst, of the first and of the last motion.
    lines: [usize; 3],
    /// Position of the worst in the program: the index of the cutter location before it, and the fraction of the motion. `None` if
    /// no motion has its line.
    at: Option<f64>,
    /// Details of a finding of a surface at the part, in the reading that is shown.
    surface: Option<SurfaceRow>,
}

/// A finding of a surface of the tool at the part, on consecutive motions.
#[derive(Clone, Debug, Serialize)]
struct SurfaceRow {
    kind: &'static str,
    name: Option<String>,
    /// Indices of the cutter locations at which the first and the last motion end.
    span: [usize; 2],
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
    /// Summarises the check of tools at the part. `moves` are their motions in the first reading, in the order of the program.
    fn of(report: &JobReport<'_>, moves: &[Move]) -> CheckResult {
        let motions_of: Vec<Vec<usize>> = report
            .job
            .tools
            .iter()
            .map(|tool| {
                let own = moves.iter().enumerate();
                let own = own.filter(|(_, step)| tool.motions.contains(step.tool));
                own.map(|(index, _)| index).collect()
            })
            .collect();
        let findings: Vec<FindingRow> = report
            .findings()
            .iter()
            .flat_map(|finding| FindingRow::all(report, finding, moves, &motions_of))
            .collect();
        let at_part = || report.tools_at_part().map(|pair| &pair.report);
        CheckResult {
            motions: at_part().map(|report| report.motions).sum(),
            clear: report.pairs.iter().all(|pair| pair.report.is_clear()),
            inside_known: at_part().all(|report| report.inside_known),
            far: at_part().all(|report| report.approach.is_far()),
            unit_factor: at_part().find_map(|report| report.approach.unit_factor),
            findings,
            open: report.gaps.iter().filter(|gap| gap.is_open()).map(ToString::to_string).collect(),
            stock: report.cut().map(|cut| {
                let (points, unit) = (&cut.stock, report.job.unit());
                format!(
                    "stock: {} of {} points remain, {} apart; {}",
                    points.len(),
                    points.initial_len(),
                    unit.format(points.spacing()),
                    cut.resolution()
                )
            }),
        }
    }
}

impl FindingRow {
    /// Returns the rows of a finding: one per group of consecutive motions. `motions_of` has the indices of each tool's motions in `moves`.
    fn all(
        report: &JobReport<'_>,
        finding: &JobFinding,
        moves: &[Move],
        motions_of: &[Vec<usize>],
    ) -> Vec<FindingRow> {
        let row = FindingRow {
            severity: match finding.severity {
                Severity::Violation => "violation",
                Severity::Undecided => "undecided",
                Severity::Remark => "note",
            },
            text: finding.text.clone(),
            number: None,
            through: false,
            lines: [finding.line, finding.lines[0], finding.lines[1]],
            at: None,
            surface: None,
        };
        let mut rows = match &finding.detail {
            FindingDetail::Surface { pair, groups, .. } => {
                let pair = &report.pairs[*pair];
                let of_group = |group| row.clone().with_surface(report, pair, group, motions_of);
                groups.iter().map(of_group).collect()
            }
            FindingDetail::Machine(_) | FindingDetail::Stock(_) => vec![row],
        };
        for row in rows.iter_mut().filter(|row| row.at.is_none()) {
            let index = moves.iter().position(|step| step.line == row.lines[0]);
            row.at = index.map(|index| index as f64);
        }
        rows
    }

    /// Adds what is known of a surface of a tool.
    fn with_surface(
        mut self,
        report: &JobReport<'_>,
        pair: &PairReport,
        group: &FindingGroup,
        motions_of: &[Vec<usize>],
    ) -> FindingRow {
        let Finding { line, location, time, kind, .. } = group.worst;
        self.lines = [line, group.first.line, group.last.line];
        let Some(index) = pair.moving.tool() else { return self };
        let tool = &report.job.tools[index];
        self.number = tool.number();
        self.through =
            matches!(kind, FindingKind::Inside { .. } | FindingKind::Deep { through: true, .. });
        // Locations count the motions of the tool in the reading, of which the first is shown.
        let locations = [location, group.first.location, group.last.location];
        let positions = locations.map(|location| motions_of[index].get(location).copied());
        if let (0, [Some(worst), Some(first), Some(last)]) = (pair.reading, positions) {
            self.at = Some((worst as f64 - 1.0 + time).max(0.0));
            self.surface = Some(SurfaceRow::of(group, tool.tool.info(), [first, last]));
        }
        self
    }
}

impl SurfaceRow {
    fn of(group: &FindingGroup, info: &ToolInfo, span: [usize; 2]) -> SurfaceRow {
        let Finding { rapid, pose, kind, .. } = group.worst;
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
        SurfaceRow {
            kind: label,
            name: kind.surface().map(|surface| info.surface(surface).name.to_string()),
            span,
            rapid,
            measured,
            limit,
            point: witness.map(|witness| witness.point.coords.into()),
            triangle: witness.map(|witness| witness.triangle.0),
            axis: pose.axis().into(),
        }
    }
}

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
use touchoff::tool::Interpreted;
use touchoff::{Mesh, Pose, SurfaceId, Tool};
use touchoff_verify::job::{FindingDetail, JobFinding};
use touchoff_verify::machine::Machine;
use touchoff_verify::{
    Finding, FindingKind, Job, JobReport, JobTool, Move, Program, ToolSelection, VerifyError,
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
        Ok(self.checked(tolerance)??)
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

    fn checked(&self, tolerance: f64) -> Result<serde_json::Result<String>, EngineError> {
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
        Ok(to_json(&job.check(&checked_motions)?, &self.moves))
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
#[derive(Serialize)]
struct CheckResult<V: Serialize, F: Serialize> {
    motions: usize,
    verdict: V,
    /// All findings: violations, then what is undecided, then remarks; the worst of each first.
    findings: Vec<PlacedFinding<F>>,
    /// A sentence about the stock, if there is one.
    stock: Option<String>,
}

/// A finding with its places in the program, in the reading that is shown.
#[derive(Serialize)]
struct PlacedFinding<F: Serialize> {
    #[serde(flatten)]
    row: F,
    /// Position of the worst in the program: the index of the cutter location before it, and the fraction of the motion. `None` if
    /// no motion has its line.
    at: Option<f64>,
    /// The consecutive motions of a surface of a tool.
    places: Vec<Place>,
}

/// Consecutive motions with a finding of a surface of a tool.
#[derive(Debug, Serialize)]
struct Place {
    line: usize,
    at: f64,
    /// Indices of the cutter locations at which the first and the last motion end.
    span: [usize; 2],
    surface: Option<String>,
    /// The point of the part, and its triangle.
    point: Option<[f64; 3]>,
    triangle: Option<u32>,
    /// The axis of the tool at the worst.
    axis: [f64; 3],
}

/// Returns a report as JSON. `moves` are the motions of its tools in the first reading, in the order of the program.
fn to_json(report: &JobReport<'_>, moves: &[Move]) -> serde_json::Result<String> {
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
    let findings = report.findings().iter().map(|finding| {
        let places = places(report, finding, &motions_of);
        let line = finding.lines[0];
        let first = || moves.iter().position(|step| step.line == line).map(|index| index as f64);
        let at = places.first().map(|place| place.at).or_else(first);
        PlacedFinding { row: report.row(finding), at, places }
    });
    serde_json::to_string(&CheckResult {
        motions: report.tools_at_part().map(|pair| pair.report.motions).sum(),
        verdict: report.verdict_row(),
        findings: findings.collect(),
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
    })
}

/// Returns the places of a finding of a surface of a tool in the first reading. `motions_of` has the indices of each tool's motions
/// among those of the program.
fn places(report: &JobReport<'_>, finding: &JobFinding, motions_of: &[Vec<usize>]) -> Vec<Place> {
    let FindingDetail::Surface { pair, groups, .. } = &finding.detail else { return Vec::new() };
    let pair = &report.pairs[*pair];
    let Some(index) = pair.moving.tool().filter(|_| pair.reading == 0) else { return Vec::new() };
    let info = report.job.tools[index].tool.info();
    // Locations count the motions of the tool.
    let position = |location: usize| motions_of[index].get(location).copied();
    let places = groups.iter().filter_map(|group| {
        let Finding { line, location, time, pose, kind, .. } = group.worst;
        let witness = match kind {
            FindingKind::Deep { witness, .. } | FindingKind::Near { witness, .. } => Some(witness),
            _ => None,
        };
        Some(Place {
            line,
            at: (position(location)? as f64 - 1.0 + time).max(0.0),
            span: [position(group.first.location)?, position(group.last.location)?],
            surface: kind.surface().map(|surface| info.surface(surface).name.to_string()),
            point: witness.map(|witness| witness.point.coords.into()),
            triangle: witness.map(|witness| witness.triangle.0),
            axis: pose.axis().into(),
        })
    });
    places.collect()
}

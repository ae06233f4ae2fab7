//! The integrator.

use super::cell::{self, Face};
use super::cell::{
    Bit, Corners, Seen, Sum, area, cut, halves, in_tool, middle, norms, push, radius, see,
};
use nalgebra::Vector3;
use touchoff::tool::{Ask, Felt, Points, Senses, Wanted};
use touchoff::{Level, Pose, Tool};

/// Longer than this a triangle that sees nothing is halved, if it is not proved to be outside. mm.
const BLIND: f64 = 0.3;
/// Of what a triangle that sees nothing may hide at most, its share of the error: on average it is less.
const HIDDEN: f64 = 0.1;
/// Of how much a cut moves the sum, its share of the error.
const MOVED: f64 = 0.05;

/// After so many evaluations it ends.
const MOST: usize = 1 << 24;

/// How an integral is made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settings {
    /// The error that is wished, relative to the force, and to the torque about the tip or the force on an arm of 1 mm.
    pub(super) tolerance: f64,
    /// How curved the tool may be beside the part, 1/mm: by it what sees nothing is taken to be outside.
    pub(super) curved: f64,
    /// The difference of both rules is the error of the worse one. The better one's is smaller by so many times the difference's
    /// share of the sum, where all is smooth.
    pub(super) smooth: f64,
}

impl Settings {
    /// For a tool of radius 1 mm.
    pub(super) fn new(tolerance: f64) -> Settings {
        Settings { tolerance, curved: 1.0, smooth: 300.0 }
    }

    /// For what is a reference: it trusts less in what it does not see, and takes the larger error.
    pub(super) fn reference() -> Settings {
        Settings { tolerance: 1e-6, curved: 8.0, smooth: f64::INFINITY }
    }
}

/// What came of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Answer {
    /// On the tool, in the world.
    pub(super) force: Vector3<f64>,
    /// The sum of the estimated errors of the force.
    pub(super) estimate: f64,
    /// At how many points the tool was evaluated.
    pub(super) evaluations: usize,
    /// How often those with too much error were halved, and once more.
    pub(super) rounds: usize,
}

struct What;

impl Wanted for What {
    const ASK: Ask =
        Ask { depth: false, niceness: false, gradient: true, region: true, ..Ask::DIRECTION };
}

#[derive(Clone, Copy)]
struct Cell {
    corners: Corners,
    face: usize,
    area: f64,
    sum: Sum,
    error: [f64; 2],
    outside: bool,
}

/// A tool beside triangles. Memory is kept between questions.
pub(super) struct Adaptive<'a, T: ?Sized> {
    tool: &'a T,
    /// The same solid, of which the distance is known.
    near: &'a dyn Tool,
    level: Level,
    points: Points,
    felt: Felt,
    normals: Vec<Vector3<f64>>,
    fresh: Vec<Cell>,
    kept: Vec<Cell>,
    bits: Vec<(usize, Bit)>,
}

impl<'a, T: Senses + ?Sized> Adaptive<'a, T> {
    /// Of a tool, and one of the same shape that has a profile. Both in mm, as the part.
    pub(super) fn new(tool: &'a T, near: &'a dyn Tool) -> Adaptive<'a, T> {
        Adaptive {
            tool,
            near,
            level: Level::new(),
            points: Points::default(),
            felt: Felt::default(),
            normals: Vec::new(),
            fresh: Vec::new(),
            kept: Vec::new(),
            bits: Vec::new(),
        }
    }

    /// The integral over the faces; those that the tool does not touch may be left out.
    pub(super) fn integrate(&mut self, faces: &[Face], pose: &Pose, settings: &Settings) -> Answer {
        self.begin(faces, pose);
        let mut answer = Answer::default();
        loop {
            answer.rounds += 1;
            self.measure(settings, &mut answer);
            self.kept.extend(self.fresh.iter().filter(|cell| !cell.outside));
            let (mut all, mut error) = (Sum::zeros(), [0.0; 2]);
            for cell in &self.kept {
                all += cell.sum;
                error = [error[0] + cell.error[0], error[1] + cell.error[1]];
            }
            let [force, torque] = norms(&all);
            let allowed = [force, torque.max(force)]
                .map(|size| (size * settings.tolerance).max(f64::MIN_POSITIVE));
            let done = error[0] <= allowed[0] && error[1] <= allowed[1];
            if done || answer.evaluations > MOST {
                answer.force = pose.rotation() * all.fixed_rows::<3>(0);
                answer.estimate = error[0];
                return answer;
            }
            // Where the sum is too large, one at least has more than its share.
            let share = allowed.map(|allowed| allowed / self.kept.len() as f64);
            self.fresh.clear();
            let fresh = &mut self.fresh;
            self.kept.retain(|cell| {
                let fine = cell.error[0] <= share[0] && cell.error[1] <= share[1];
                if !fine {
                    let half = |corners| Cell { corners, area: cell.area / 2.0, ..*cell };
                    fresh.extend(halves(&cell.corners).map(half));
                }
                fine
            });
        }
    }

    fn begin(&mut self, faces: &[Face], pose: &Pose) {
        self.fresh.clear();
        self.kept.clear();
        self.normals.clear();
        for (face, Face { corners, normal }) in faces.iter().enumerate() {
            let corners = in_tool(corners, pose);
            self.normals.push(pose.rotation().tr_mul(normal));
            self.fresh.push(Cell {
                corners,
                face,
                area: area(&corners),
                sum: Sum::zeros(),
                error: [0.0; 2],
                outside: false,
            });
        }
    }

    /// Measures those that are new.
    fn measure(&mut self, settings: &Settings, answer: &mut Answer) {
        self.points.clear();
        self.bits.clear();
        self.fresh.iter().for_each(|cell| push(&cell.corners, &mut self.points));
        answer.evaluations += self.points.len();
        self.tool.feel::<What>(self.level, &self.points, 1.0, &mut self.felt);
        for (at, cell) in self.fresh.iter_mut().enumerate() {
            let seen = see(&self.felt, &self.points, at, &self.normals[cell.face]);
            if seen.inside == 0 {
                blind(cell, self.near, settings);
                continue;
            }
            cell.sum = seen.high * cell.area;
            cell.error = difference(&seen, cell.area, settings.smooth);
            let bits = cut(&cell.corners, cell.area, &seen);
            self.bits.extend(bits.into_iter().flatten().map(|bit| (at, bit)));
        }
        if !self.bits.is_empty() {
            self.cut(answer);
        }
    }

    /// Measures what cuts left over, instead of the whole.
    fn cut(&mut self, answer: &mut Answer) {
        self.points.clear();
        self.bits.iter().for_each(|(_, (corners, _))| push(corners, &mut self.points));
        answer.evaluations += self.points.len();
        self.tool.feel::<What>(self.level, &self.points, 1.0, &mut self.felt);
        let mut next = 0;
        for bits in self.bits.chunk_by(|a, b| a.0 == b.0) {
            let cell = &mut self.fresh[bits[0].0];
            let (mut high, mut low) = (Sum::zeros(), Sum::zeros());
            for (_, (_, area)) in bits {
                let seen = see(&self.felt, &self.points, next, &self.normals[cell.face]);
                high += seen.high * *area;
                low += seen.low * *area;
                next += 1;
            }
            let (rules, moved) = (norms(&(high - low)), norms(&(high - cell.sum)));
            cell.error = [0, 1].map(|k| rules[k] + MOVED * moved[k]);
            cell.sum = high;
        }
    }
}

/// Of a cell that saw nothing: outside for certain, or as good as, or with something hidden.
fn blind(cell: &mut Cell, near: &dyn Tool, settings: &Settings) {
    let middle = middle(&cell.corners);
    let radius = radius(&cell.corners, &middle);
    let mut hidden = radius - near.clearance(middle.into());
    if hidden > 0.0 && radius <= BLIND {
        let corners = cell.corners.map(|corner| near.clearance(corner.into()));
        let least = corners.into_iter().fold(f64::INFINITY, f64::min);
        hidden = hidden.min(settings.curved * radius * radius / 2.0 - least);
    }
    cell.outside = hidden <= 0.0;
    cell.sum = Sum::zeros();
    // As much as if all of it were inside, where it is too long to tell.
    let error = if radius > BLIND { 1.0 } else { HIDDEN * hidden } * cell.area;
    cell.error = [error, error * middle.norm()];
}

/// The error of a triangle's sum.
fn difference(seen: &Seen, area: f64, factor: f64) -> [f64; 2] {
    let (rules, sums) = (norms(&(seen.high - seen.low)), norms(&seen.high));
    [0, 1].map(|k| {
        let smooth = seen.inside == cell::RULE && seen.alike && rules[k] > 0.0;
        let share = if smooth { (factor * rules[k] / sums[k]).min(1.0) } else { 1.0 };
        share * rules[k] * area
    })
}

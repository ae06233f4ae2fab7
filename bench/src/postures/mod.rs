//! A posture sweep compared with brute force, on postures drawn from those found accessible and from the others.
//!
//! Each posture is rebuilt from the tool's restatement ([`stand`]) and validated by subdividing all triangles
//! ([`free`]). Accessible postures must be free, and the others must be blocked.

pub mod free;
pub mod page;
pub mod parts;
pub mod stand;

use free::{Part, Verdict};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use stand::Stand;
use std::error::Error;
use std::num::NonZeroU16;
use std::ops::ControlFlow;
use std::time::Instant;
use touchoff::certify::TriangleBvh;
use touchoff::postures::sweep::{PostureSweep, SweepStats};
use touchoff::postures::{Directions, MapRow, Rules};
use touchoff::{Mesh, Tool, TriangleId};
use touchoff_tests::oracle::draw::Rng;

/// The settings of a comparison.
pub struct Wanted<'a> {
    /// The part.
    pub mesh: &'a Mesh,
    /// Library tools, by name.
    pub tools: Vec<&'a str>,
    /// Number of directions per hemisphere.
    pub hemisphere: usize,
    /// Allowed depth of cutting surfaces, in the part's unit.
    pub tolerance: f64,
    /// Niceness that contacts must exceed.
    pub niceness: f64,
    /// Number of postures of each kind that are validated.
    pub draws: usize,
    /// Seed for the choice of postures.
    pub seed: u64,
}

/// The reach of a tool.
#[derive(Clone, Debug, Default)]
pub struct Reach {
    /// The tool's name.
    pub tool: String,
    /// Number of triangles that the tool reaches.
    pub triangles: usize,
    /// Their area, in the square of the part's unit.
    pub area: f64,
    /// Number of postures in which it reaches them.
    pub postures: u64,
}

/// A posture on which sweep and brute force disagree or the latter is undecided.
#[derive(Clone, Debug)]
pub struct Odd {
    /// Triangle, tool and direction.
    pub at: String,
    /// The result of brute force.
    pub what: String,
}

/// The validated postures of one kind.
#[derive(Clone, Debug, Default)]
pub struct Drawn {
    /// Number of postures.
    pub judged: usize,
    /// Postures on which brute force contradicts the sweep.
    pub wrong: Vec<Odd>,
    /// Postures that brute force leaves undecided.
    pub open: Vec<Odd>,
}

/// The results of a comparison.
pub struct Found {
    /// The sweep's statistics.
    pub tally: SweepStats,
    /// Duration of the sweep, and of brute force, s.
    pub seconds: [f64; 2],
    /// Number of triangles and area of the whole part.
    pub all: (usize, f64),
    /// Number of triangles and area that any tool reaches.
    pub any: (usize, f64),
    /// The reach of each tool.
    pub reach: Vec<Reach>,
    /// The validated accessible postures.
    pub accessible: Drawn,
    /// The validated postures that face their triangle but are not accessible.
    pub refused: Drawn,
    /// The distance that counts as rounding, in the part's unit.
    pub rounding: f64,
}

/// A posture, by indices.
#[derive(Clone, Copy)]
struct Choice {
    triangle: u32,
    tool: usize,
    direction: usize,
}

/// Distances, as shares of the tolerance, at which a refused posture that is free is tested for a near collision.
const NEAR_COLLISION_SHARES: [f64; 7] = [1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2];

/// The distance that counts as rounding, as a share of the part's and the tool's size.
const ROUNDING: f64 = 1e-9;

/// Runs a sweep and validates random postures of it.
///
/// # Errors
/// If a tool is not in the library, or cannot be used in a sweep.
pub fn measure(task: &Wanted<'_>) -> Result<Found, Box<dyn Error>> {
    let mesh = task.mesh;
    let find = |name: &&str| tools_library::find(name).ok_or_else(|| format!("no tool `{name}`"));
    let tools: Vec<&dyn Tool> = task
        .tools
        .iter()
        .map(|name| find(name).map(|tool| tool as &dyn Tool))
        .collect::<Result<_, _>>()?;
    let unit_factor = |tool: &&dyn Tool| tool.info().unit.factor_to(mesh.unit());
    let stands: Vec<Stand> = tools
        .iter()
        .zip(&task.tools)
        .map(|(tool, name)| Stand::new(name, unit_factor(tool), task.tolerance))
        .collect::<Result<_, _>>()?;
    let (tolerance, niceness) = (task.tolerance, task.niceness);
    let directions = Directions::spread(task.hemisphere);
    let bvh = TriangleBvh::new(mesh);
    let rules = Rules { tolerance, niceness, allowed: Vec::new() };
    let start = Instant::now();
    let sweep = PostureSweep::new(mesh, &bvh, tools, &directions, rules, NonZeroU16::MIN)?;
    let mut rows = vec![MapRow::default(); mesh.triangles().len()];
    let mut tally = SweepStats::default();
    let batches: Vec<usize> = (0..sweep.batches()).collect();
    let outcome = sweep.run(&batches, |batch| {
        tally += batch.stats;
        batch.rows.into_iter().for_each(|(id, row)| rows[id.index()] = row);
        ControlFlow::<()>::Continue(())
    });
    debug_assert!(outcome.is_continue());
    let sweep_seconds = start.elapsed().as_secs_f64();
    let part = Part::new(mesh);
    let size = stands.iter().map(|stand| stand.extent()[0] + stand.extent()[1]);
    let validation = Validation {
        mesh,
        part: &part,
        directions: directions.list(),
        stands: &stands,
        tolerance,
        niceness,
        rounding: ROUNDING * (part.size + size.fold(0.0, f64::max)),
    };
    let mut rng = Rng::new(task.seed);
    let start = Instant::now();
    let choices = draw_accessible(&rows, task.draws, &mut rng);
    let accessible = sort_results(
        choices.into_par_iter().map(|choice| validation.check_accessible(&choice)).collect(),
    );
    let choices = validation.draw_refused(&rows, task.draws, &mut rng);
    let refused = sort_results(
        choices.into_par_iter().map(|choice| validation.check_refused(&choice)).collect(),
    );
    let (all, any, reach) = coverage(mesh, &rows, &task.tools);
    Ok(Found {
        tally,
        seconds: [sweep_seconds, start.elapsed().as_secs_f64()],
        all,
        any,
        reach,
        accessible,
        refused,
        rounding: validation.rounding,
    })
}

fn contains(set: &[u64], direction: usize) -> bool {
    set[direction / 64] >> (direction % 64) & 1 == 1
}

/// Draws from the postures that the sweep found accessible, with uniform probability.
fn draw_accessible(rows: &[MapRow], count: usize, rng: &mut Rng) -> Vec<Choice> {
    let mut cumulative = Vec::new();
    let mut sum = 0u64;
    for (triangle, row) in rows.iter().enumerate() {
        for access in &row.access {
            sum += access.directions.iter().map(|word| u64::from(word.count_ones())).sum::<u64>();
            cumulative.push((sum, triangle as u32, access));
        }
    }
    if sum == 0 {
        return Vec::new();
    }
    let choice = |_| {
        let draw = rng.bits() % sum;
        let index =
            cumulative.partition_point(|(cumulative_count, _, _)| *cumulative_count <= draw);
        let (cumulative_count, triangle, access) = cumulative[index];
        let members =
            (0..64 * access.directions.len()).filter(|k| contains(&access.directions, *k));
        let remaining = (cumulative_count - draw - 1) as usize;
        let direction = members.rev().nth(remaining)?;
        Some(Choice { triangle, tool: access.tool.into(), direction })
    };
    (0..count).filter_map(choice).collect()
}

fn sort_results(results: Vec<Result<(), (bool, Odd)>>) -> Drawn {
    let mut drawn = Drawn { judged: results.len(), ..Drawn::default() };
    for (is_open, finding) in results.into_iter().filter_map(Result::err) {
        if is_open { drawn.open.push(finding) } else { drawn.wrong.push(finding) }
    }
    drawn
}

/// The data for the validation of postures.
struct Validation<'a> {
    mesh: &'a Mesh,
    part: &'a Part<'a>,
    directions: &'a [[f64; 3]],
    stands: &'a [Stand],
    tolerance: f64,
    niceness: f64,
    rounding: f64,
}

impl Validation<'_> {
    fn postures(&self, choice: &Choice, tolerance_factor: f64) -> Vec<stand::Posture> {
        let [a, b, c] = self.mesh.triangle(TriangleId(choice.triangle));
        let centroid = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) else { return Vec::new() };
        let axis = Vector3::from(self.directions[choice.direction]);
        let mut postures =
            self.stands[choice.tool].postures(centroid, normal, axis, tolerance_factor);
        postures.retain(|posture| posture.niceness > self.niceness);
        postures
    }

    fn describe(&self, choice: &Choice) -> String {
        let [x, y, z] = self.directions[choice.direction];
        let name = touchoff_tests::oracle::Oracle::name(&self.stands[choice.tool].oracle);
        format!(
            "triangle {}, {name}, direction {} ({x:.3}, {y:.3}, {z:.3})",
            choice.triangle, choice.direction
        )
    }

    fn judge(&self, choice: &Choice, posture: &stand::Posture, allowance: f64) -> Verdict {
        self.part.judge(&self.stands[choice.tool], posture, self.tolerance, allowance)
    }

    /// Checks that one of the postures of a choice is free. The error has the finding, and whether it is undecided.
    fn check_accessible(&self, choice: &Choice) -> Result<(), (bool, Odd)> {
        let verdicts: Vec<Verdict> = self
            .postures(choice, 2.0)
            .iter()
            .map(|posture| self.judge(choice, posture, self.rounding))
            .collect();
        if verdicts.contains(&Verdict::Free) {
            return Ok(());
        }
        let is_open = verdicts.contains(&Verdict::Open);
        let finding = match &verdicts[..] {
            [] => "no contact".to_owned(),
            verdicts => format!("{verdicts:?}"),
        };
        Err((is_open, Odd { at: self.describe(choice), what: finding }))
    }

    /// Draws postures that face a triangle and that the sweep did not find accessible.
    fn draw_refused(&self, rows: &[MapRow], count: usize, rng: &mut Rng) -> Vec<Choice> {
        let mut choices = Vec::new();
        for _ in 0..100 * count {
            if choices.len() == count {
                break;
            }
            let mut random_below = |limit: usize| (rng.bits() % limit as u64) as usize;
            let (triangle, tool) = (random_below(rows.len()), random_below(self.stands.len()));
            let direction = random_below(self.directions.len());
            let tool_access =
                rows[triangle].access.iter().find(|access| usize::from(access.tool) == tool);
            let choice = Choice { triangle: triangle as u32, tool, direction };
            if tool_access.is_some_and(|access| !contains(&access.directions, direction))
                && !self.postures(&choice, -1.0).is_empty()
            {
                choices.push(choice);
            }
        }
        choices
    }

    /// Checks that all postures of a choice are blocked. The error has the finding, and whether it is undecided.
    fn check_refused(&self, choice: &Choice) -> Result<(), (bool, Odd)> {
        for posture in self.postures(choice, -1.0) {
            let verdict = self.judge(choice, &posture, 0.0);
            if matches!(verdict, Verdict::Blocked(_)) {
                continue;
            }
            let near_share = NEAR_COLLISION_SHARES.iter().find(|near_share| {
                let closer_verdict = self.judge(choice, &posture, -*near_share * self.tolerance);
                matches!(closer_verdict, Verdict::Blocked(_))
            });
            let finding = match near_share {
                Some(near_share) => {
                    format!("{verdict:?}, blocked if {near_share:e} of the tolerance nearer")
                }
                None => format!("{verdict:?}, blocked by nothing near"),
            };
            // A near collision within the certifier's rounding is undecided in the sweep, not wrong.
            let is_open = verdict == Verdict::Open
                || near_share.is_some_and(|near_share| *near_share <= 1e-6);
            return Err((is_open, Odd { at: self.describe(choice), what: finding }));
        }
        Ok(())
    }
}

type Share = (usize, f64);

/// Returns number and area of all triangles, of those that any tool reaches, and the reach of each tool.
fn coverage(mesh: &Mesh, rows: &[MapRow], tools: &[&str]) -> (Share, Share, Vec<Reach>) {
    let (mut all, mut any) = ((0, 0.0), (0, 0.0));
    let empty_reach = |tool: &&str| Reach { tool: (*tool).to_owned(), ..Reach::default() };
    let mut reach: Vec<Reach> = tools.iter().map(empty_reach).collect();
    for (id, row) in rows.iter().enumerate() {
        let area = mesh.area(TriangleId(id as u32));
        all = (all.0 + 1, all.1 + area);
        let mut is_reached = false;
        for access in &row.access {
            let count: u64 =
                access.directions.iter().map(|word| u64::from(word.count_ones())).sum();
            if count > 0 {
                let tool_reach = &mut reach[usize::from(access.tool)];
                tool_reach.triangles += 1;
                tool_reach.area += area;
                tool_reach.postures += count;
                is_reached = true;
            }
        }
        if is_reached {
            any = (any.0 + 1, any.1 + area);
        }
    }
    (all, any, reach)
}

//! A posture sweep compared with brute force, on postures drawn from those found accessible and from the others.
//!
//! Each posture is rebuilt from the tool's restatement ([`tool_model`]) and validated by subdividing all triangles
//! ([`brute_force`]). Accessible postures must be free, and the others must be blocked.

pub mod brute_force;
pub mod page;
pub mod parts;
pub mod tool_model;

use brute_force::{TrianglePart, Verdict};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use std::error::Error;
use std::num::NonZeroU16;
use std::ops::ControlFlow;
use std::time::Instant;
use tool_model::ToolModel;
use touchoff::certify::TriangleBvh;
use touchoff::{Mesh, Tool, TriangleId};
use touchoff_postures::sweep::{PostureSweep, SweepStats};
use touchoff_postures::{Directions, MapRow, Rules};
use touchoff_tests::oracle::rng::Rng;

/// The settings of a comparison.
pub struct ComparisonSettings<'a> {
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
pub struct Discrepancy {
    /// Triangle, tool and direction.
    pub posture: String,
    /// The result of brute force.
    pub result: String,
}

/// The validated postures of one kind.
#[derive(Clone, Debug, Default)]
pub struct ValidatedPostures {
    /// Number of postures.
    pub count: usize,
    /// Postures on which brute force contradicts the sweep.
    pub contradicted: Vec<Discrepancy>,
    /// Postures that brute force leaves undecided.
    pub undecided: Vec<Discrepancy>,
}

/// The results of a comparison.
pub struct ComparisonResults {
    /// The sweep's statistics.
    pub stats: SweepStats,
    /// Duration of the sweep, and of brute force, s.
    pub seconds: [f64; 2],
    /// Number of triangles and area of the whole part.
    pub total: (usize, f64),
    /// Number of triangles and area that any tool reaches.
    pub reached: (usize, f64),
    /// The reach of each tool.
    pub reach: Vec<Reach>,
    /// The validated accessible postures.
    pub accessible: ValidatedPostures,
    /// The validated postures that face their triangle but are not accessible.
    pub inaccessible: ValidatedPostures,
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
pub fn measure(settings: &ComparisonSettings<'_>) -> Result<ComparisonResults, Box<dyn Error>> {
    let mesh = settings.mesh;
    let find = |name: &&str| tools_library::find(name).ok_or_else(|| format!("no tool `{name}`"));
    let tools: Vec<&dyn Tool> = settings
        .tools
        .iter()
        .map(|name| find(name).map(|tool| tool as &dyn Tool))
        .collect::<Result<_, _>>()?;
    let unit_factor = |tool: &&dyn Tool| tool.info().unit.factor_to(mesh.unit());
    let tool_models: Vec<ToolModel> = tools
        .iter()
        .zip(&settings.tools)
        .map(|(tool, name)| ToolModel::new(name, unit_factor(tool), settings.tolerance))
        .collect::<Result<_, _>>()?;
    let (tolerance, niceness) = (settings.tolerance, settings.niceness);
    let directions = Directions::spread(settings.hemisphere);
    let bvh = TriangleBvh::new(mesh);
    let rules = Rules { tolerance, niceness, allowed: Vec::new() };
    let start = Instant::now();
    let sweep = PostureSweep::new(mesh, &bvh, tools, &directions, rules, NonZeroU16::MIN)?;
    let mut rows = vec![MapRow::default(); mesh.triangles().len()];
    let mut stats = SweepStats::default();
    let batches: Vec<usize> = (0..sweep.batches()).collect();
    let outcome = sweep.run(&batches, |batch| {
        stats += batch.stats;
        batch.rows.into_iter().for_each(|(id, row)| rows[id.index()] = row);
        ControlFlow::<()>::Continue(())
    });
    debug_assert!(outcome.is_continue());
    let sweep_seconds = start.elapsed().as_secs_f64();
    let part = TrianglePart::new(mesh);
    let size = tool_models.iter().map(|model| model.extent()[0] + model.extent()[1]);
    let validation = Validation {
        mesh,
        part: &part,
        directions: directions.list(),
        tool_models: &tool_models,
        tolerance,
        niceness,
        rounding: ROUNDING * (part.size + size.fold(0.0, f64::max)),
    };
    let mut rng = Rng::new(settings.seed);
    let start = Instant::now();
    let choices = draw_accessible(&rows, settings.draws, &mut rng);
    let accessible = sort_results(
        choices.into_par_iter().map(|choice| validation.check_accessible(&choice)).collect(),
    );
    let choices = validation.draw_inaccessible(&rows, settings.draws, &mut rng);
    let inaccessible = sort_results(
        choices.into_par_iter().map(|choice| validation.check_inaccessible(&choice)).collect(),
    );
    let (total, reached, reach) = coverage(mesh, &rows, &settings.tools);
    Ok(ComparisonResults {
        stats,
        seconds: [sweep_seconds, start.elapsed().as_secs_f64()],
        total,
        reached,
        reach,
        accessible,
        inaccessible,
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

fn sort_results(results: Vec<Result<(), (bool, Discrepancy)>>) -> ValidatedPostures {
    let mut validated = ValidatedPostures { count: results.len(), ..ValidatedPostures::default() };
    for (is_open, finding) in results.into_iter().filter_map(Result::err) {
        if is_open {
            validated.undecided.push(finding);
        } else {
            validated.contradicted.push(finding);
        }
    }
    validated
}

/// The data for the validation of postures.
struct Validation<'a> {
    mesh: &'a Mesh,
    part: &'a TrianglePart<'a>,
    directions: &'a [[f64; 3]],
    tool_models: &'a [ToolModel],
    tolerance: f64,
    niceness: f64,
    rounding: f64,
}

impl Validation<'_> {
    fn postures(&self, choice: &Choice, tolerance_factor: f64) -> Vec<tool_model::Posture> {
        let [a, b, c] = self.mesh.triangle(TriangleId(choice.triangle));
        let centroid = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) else { return Vec::new() };
        let axis = Vector3::from(self.directions[choice.direction]);
        let mut postures =
            self.tool_models[choice.tool].postures(centroid, normal, axis, tolerance_factor);
        postures.retain(|posture| posture.niceness > self.niceness);
        postures
    }

    fn describe(&self, choice: &Choice) -> String {
        let [x, y, z] = self.directions[choice.direction];
        let name = touchoff_tests::oracle::Oracle::name(&self.tool_models[choice.tool].oracle);
        format!(
            "triangle {}, {name}, direction {} ({x:.3}, {y:.3}, {z:.3})",
            choice.triangle, choice.direction
        )
    }

    fn check(&self, choice: &Choice, posture: &tool_model::Posture, allowance: f64) -> Verdict {
        self.part.check(&self.tool_models[choice.tool], posture, self.tolerance, allowance)
    }

    /// Checks that one of the postures of a choice is free. The error has the finding, and whether it is undecided.
    fn check_accessible(&self, choice: &Choice) -> Result<(), (bool, Discrepancy)> {
        let verdicts: Vec<Verdict> = self
            .postures(choice, 2.0)
            .iter()
            .map(|posture| self.check(choice, posture, self.rounding))
            .collect();
        if verdicts.contains(&Verdict::Free) {
            return Ok(());
        }
        let is_open = verdicts.contains(&Verdict::Open);
        let finding = match &verdicts[..] {
            [] => "no contact".to_owned(),
            verdicts => format!("{verdicts:?}"),
        };
        Err((is_open, Discrepancy { posture: self.describe(choice), result: finding }))
    }

    /// Draws postures that face a triangle and that the sweep did not find accessible.
    fn draw_inaccessible(&self, rows: &[MapRow], count: usize, rng: &mut Rng) -> Vec<Choice> {
        let mut choices = Vec::new();
        for _ in 0..100 * count {
            if choices.len() == count {
                break;
            }
            let mut random_below = |limit: usize| (rng.bits() % limit as u64) as usize;
            let (triangle, tool) = (random_below(rows.len()), random_below(self.tool_models.len()));
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
    fn check_inaccessible(&self, choice: &Choice) -> Result<(), (bool, Discrepancy)> {
        for posture in self.postures(choice, -1.0) {
            let verdict = self.check(choice, &posture, 0.0);
            if matches!(verdict, Verdict::Blocked(_)) {
                continue;
            }
            let near_share = NEAR_COLLISION_SHARES.iter().find(|near_share| {
                let closer_verdict = self.check(choice, &posture, -*near_share * self.tolerance);
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
            return Err((is_open, Discrepancy { posture: self.describe(choice), result: finding }));
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

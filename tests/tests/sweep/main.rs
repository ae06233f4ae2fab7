//! Posture sweeps compared with brute force, on postures drawn from those found accessible and from the others.
//!
//! Each posture is rebuilt from the tool's restatement ([`tool_model`]) and validated by subdividing all triangles
//! ([`brute_force`]). Accessible postures must be free, and the others must be blocked.
//!
//! `POSTURES=100000 cargo test --release -p touchoff-tests --test sweep -- --nocapture` draws 100,000 postures of each
//! kind, also on a real part where there is one, and prints how many were left undecided.

mod brute_force;
mod parts;
mod tool_model;

use brute_force::{TrianglePart, Verdict};
use nalgebra::{Point3, Vector3};
use parts::relief;
use rayon::prelude::*;
use std::num::NonZeroU16;
use std::ops::ControlFlow;
use std::path::Path;
use tool_model::{Posture, ToolModel};
use touchoff::certify::TriangleBvh;
use touchoff::mesh::shapes;
use touchoff::{Mesh, Tool, TriangleId, Unit};
use touchoff_postures::sweep::{PostureSweep, SweepStats};
use touchoff_postures::{Accessibility, Directions, MapRow, Rules};
use touchoff_tests::count::case_count;
use touchoff_tests::fixtures::cuboid;
use touchoff_tests::library;
use touchoff_tests::oracle::rng::Rng;
use touchoff_tests::tally::Tally;

/// Number of postures of each kind that are validated per part, unless `POSTURES` is set.
const DRAWS: usize = 300;

struct ComparisonSettings<'a> {
    mesh: &'a Mesh,
    tools: &'a [&'a str],
    hemisphere: usize,
    /// Allowed depth of cutting surfaces, in the part's unit.
    tolerance: f64,
    niceness: f64,
    /// Number of postures of each kind that are validated.
    draws: usize,
    seed: u64,
}

/// Names of counts: postures that are validated; those on which brute force contradicts the sweep; those that it leaves
/// undecided. A text has triangle, tool, direction and the verdicts of brute force.
const POSTURES: &str = "postures";
const CONTRADICTED: &str = "contradicted";
const UNDECIDED: &str = "undecided";

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

impl ComparisonSettings<'_> {
    /// Runs a sweep, validates random postures of it, and asserts that brute force contradicts none and leaves few
    /// undecided.
    fn check(&self) {
        let mesh = self.mesh;
        let tools: Vec<&dyn Tool> = self.tools.iter().map(|name| library::tool(name)).collect();
        let models = tools.iter().zip(self.tools).map(|(tool, name)| {
            let length = tool.info().unit.factor_to(mesh.unit());
            ToolModel::new(name, length, self.tolerance)
        });
        let tool_models: Vec<ToolModel> = models.collect();
        let directions = Directions::spread(self.hemisphere);
        let bvh = TriangleBvh::new(mesh);
        let rules =
            Rules { tolerance: self.tolerance, niceness: self.niceness, allowed: Vec::new() };
        let sweep = PostureSweep::new(mesh, &bvh, tools, &directions, rules, NonZeroU16::MIN);
        let sweep = sweep.expect("tools with profiles");
        let mut rows = vec![MapRow::default(); mesh.triangles().len()];
        let mut stats = SweepStats::default();
        let batches: Vec<usize> = (0..sweep.batches()).collect();
        let _: ControlFlow<()> = sweep.run(&batches, |batch| {
            stats += batch.stats;
            batch.rows.into_iter().for_each(|(id, row)| rows[id.index()] = row);
            ControlFlow::Continue(())
        });
        let part = TrianglePart::new(mesh);
        let size = tool_models.iter().map(|model| model.extent()[0] + model.extent()[1]);
        let validation = Validation {
            settings: self,
            part: &part,
            directions: directions.list(),
            tool_models: &tool_models,
            rounding: ROUNDING * (part.size + size.fold(0.0, f64::max)),
        };
        let mut rng = Rng::new(self.seed);
        let accessible = draw_accessible(&rows, self.draws, &mut rng);
        let accessible: Tally =
            accessible.into_par_iter().map(|choice| validation.check_accessible(&choice)).sum();
        let inaccessible = validation.draw_inaccessible(&rows, self.draws, &mut rng);
        let inaccessible: Tally =
            inaccessible.into_par_iter().map(|choice| validation.check_inaccessible(&choice)).sum();
        for (kind, drawn) in [("accessible", accessible), ("inaccessible", inaccessible)] {
            eprintln!("{kind} with {:?}: {drawn}", self.tools);
            assert_eq!(drawn.count(POSTURES), self.draws as u64, "{kind}");
            drawn.assert_none(CONTRADICTED);
            assert!(20 * drawn.count(UNDECIDED) <= self.draws as u64, "{kind}: {drawn:#?}");
        }
        assert_eq!(stats.postures(), stats.triangles * 2 * self.hemisphere as u64);
        assert!(stats.cached_obstruction > 0 && stats.obstructed > 0);
        assert!(stats.acceptable > 0 && stats.not_facing > 0);
        let in_map: u64 = rows.iter().flat_map(|row| &row.access).map(posture_count).sum();
        assert_eq!(in_map, stats.acceptable);
    }
}

fn outcome(finding: Option<(&'static str, String)>) -> Tally {
    let mut tally = Tally::default();
    tally.add(POSTURES, 1);
    if let Some((name, text)) = finding {
        tally.find(name, text);
    }
    tally
}

/// Returns the number of postures in which a tool reaches a triangle.
fn posture_count(access: &Accessibility) -> u64 {
    access.directions.iter().map(|word| u64::from(word.count_ones())).sum()
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
            sum += posture_count(access);
            cumulative.push((sum, triangle as u32, access));
        }
    }
    if sum == 0 {
        return Vec::new();
    }
    let choice = |_| {
        let draw = rng.bits() % sum;
        let index = cumulative.partition_point(|(count, ..)| *count <= draw);
        let (count, triangle, access) = cumulative[index];
        let members =
            (0..64 * access.directions.len()).filter(|k| contains(&access.directions, *k));
        let remaining = (count - draw - 1) as usize;
        let direction = members.rev().nth(remaining)?;
        Some(Choice { triangle, tool: access.tool.into(), direction })
    };
    (0..count).filter_map(choice).collect()
}

struct Validation<'a> {
    settings: &'a ComparisonSettings<'a>,
    part: &'a TrianglePart<'a>,
    directions: &'a [[f64; 3]],
    tool_models: &'a [ToolModel],
    rounding: f64,
}

impl Validation<'_> {
    fn postures(&self, choice: &Choice, tolerance_factor: f64) -> Vec<Posture> {
        let [a, b, c] = self.settings.mesh.triangle(TriangleId(choice.triangle));
        let centroid = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) else { return Vec::new() };
        let axis = Vector3::from(self.directions[choice.direction]);
        let mut postures =
            self.tool_models[choice.tool].postures(centroid, normal, axis, tolerance_factor);
        postures.retain(|posture| posture.niceness > self.settings.niceness);
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

    fn check(&self, choice: &Choice, posture: &Posture, allowance: f64) -> Verdict {
        self.part.check(&self.tool_models[choice.tool], posture, self.settings.tolerance, allowance)
    }

    fn check_accessible(&self, choice: &Choice) -> Tally {
        let postures = self.postures(choice, 2.0);
        let verdict = |posture| self.check(choice, posture, self.rounding);
        let verdicts: Vec<Verdict> = postures.iter().map(verdict).collect();
        if verdicts.contains(&Verdict::Free) {
            return outcome(None);
        }
        let name = if verdicts.contains(&Verdict::Open) { UNDECIDED } else { CONTRADICTED };
        outcome(Some((name, format!("{}: {verdicts:?}", self.describe(choice)))))
    }

    /// Draws postures that face a triangle and that the sweep did not find accessible.
    fn draw_inaccessible(&self, rows: &[MapRow], count: usize, rng: &mut Rng) -> Vec<Choice> {
        let mut choices = Vec::new();
        for _ in 0..100 * count {
            if choices.len() == count {
                break;
            }
            let (triangle, tool) = (rng.index(rows.len()), rng.index(self.tool_models.len()));
            let direction = rng.index(self.directions.len());
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

    fn check_inaccessible(&self, choice: &Choice) -> Tally {
        for posture in self.postures(choice, -1.0) {
            let verdict = self.check(choice, &posture, 0.0);
            if matches!(verdict, Verdict::Blocked(_)) {
                continue;
            }
            let near_share = NEAR_COLLISION_SHARES.into_iter().find(|share| {
                let closer = self.check(choice, &posture, -share * self.settings.tolerance);
                matches!(closer, Verdict::Blocked(_))
            });
            let text = self.describe(choice);
            let finding = format!("{text}: {verdict:?}, blocked if nearer by {near_share:?} of it");
            // A near collision within the certifier's rounding is undecided in the sweep, not wrong.
            let is_open = verdict == Verdict::Open || near_share.is_some_and(|share| share <= 1e-6);
            return outcome(Some((if is_open { UNDECIDED } else { CONTRADICTED }, finding)));
        }
        outcome(None)
    }
}

#[test]
fn accessible_postures_are_free_and_others_are_blocked() {
    check_relief(&["D2Ball", "BallEr16", "TaperedBall"]);
}

#[test]
fn corners_two_contacts_and_inch_tools_agree_with_brute_force() {
    check_relief(&["BullNose", "Lollipop", "TSlot", "Dovetail", "Woodruff", "HalfInchBallCat40"]);
}

/// Checks postures on a generated part.
fn check_relief(tools: &[&str]) {
    let settings = ComparisonSettings {
        mesh: &relief(20).expect("a block"),
        tools,
        hemisphere: 60,
        tolerance: 0.01,
        niceness: 0.15,
        draws: case_count("POSTURES", DRAWS),
        seed: 4,
    };
    settings.check();
}

/// A real part is swept only in full runs, since its sweep takes a minute.
#[test]
fn postures_on_a_real_part_agree_with_brute_force() {
    let draws = case_count("POSTURES", DRAWS);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/parts/impeller.stl");
    if draws <= DRAWS || !path.exists() {
        return eprintln!("skipped: {} in a full run", path.display());
    }
    let settings = ComparisonSettings {
        mesh: &Mesh::read_stl(path, Unit::Millimetre).expect("a mesh"),
        tools: &["D2Ball", "BallEr16", "TaperedBall"],
        hemisphere: 200,
        tolerance: 0.01,
        niceness: 0.5,
        draws,
        seed: 1,
    };
    settings.check();
}

/// The validation must be able to reject a posture.
#[test]
fn brute_force_rejects_blocked_postures() {
    let block = cuboid([-20.0, -20.0, -30.0], [20.0, 20.0, 0.0]);
    let part = TrianglePart::new(&block);
    let stand = ToolModel::new("D2Ball", 1.0, 0.01);
    let verdict_at = |tip: [f64; 3], allowance: f64| {
        let posture = Posture { tip: tip.into(), axis: Vector3::z(), niceness: 1.0 };
        part.check(&stand, &posture, 0.01, allowance)
    };
    assert_eq!(verdict_at([0.0, 0.0, 0.0], 0.0), Verdict::Free);
    assert_eq!(verdict_at([0.0, 0.0, -0.0099], 0.0), Verdict::Free);
    assert!(matches!(verdict_at([0.0, 0.0, -0.0101], 0.0), Verdict::Blocked(_)));
    // The flute of 5 mm may cut slightly into the wall beside it; the shank above must not.
    assert_eq!(verdict_at([20.999, 0.0, -4.9], 0.0), Verdict::Free);
    assert!(matches!(verdict_at([20.999, 0.0, -5.1], 0.0), Verdict::Blocked(_)));
    assert_eq!(verdict_at([21.0001, 0.0, -5.1], 0.0), Verdict::Free);
    assert!(matches!(verdict_at([21.0001, 0.0, -5.1], -0.001), Verdict::Blocked(_)));
    // A part far larger than the tool contains it.
    let block = cuboid([-20.0, -20.0, -30.0], [20.0, 20.0, 50.0]);
    let tip = Point3::new(0.0, 0.0, -5.0);
    let posture = Posture { tip, axis: Vector3::z(), niceness: 1.0 };
    let verdict = TrianglePart::new(&block).check(&stand, &posture, 0.01, 0.0);
    assert_eq!(verdict, Verdict::Blocked(f64::INFINITY));
}

/// Returns the rows of the map of a tool in the first batch of triangles.
fn first_rows(mesh: &Mesh, tool: &str, directions: &Directions, niceness: f64) -> Vec<MapRow> {
    let bvh = TriangleBvh::new(mesh);
    let rules = Rules { tolerance: 0.01, niceness, allowed: Vec::new() };
    let tools = vec![library::tool(tool)];
    let sweep = PostureSweep::new(mesh, &bvh, tools, directions, rules, NonZeroU16::MIN);
    let mut rows = Vec::new();
    let _: ControlFlow<()> = sweep.expect("a sweep").run(&[0], |batch| {
        rows.extend(batch.rows.into_iter().map(|(_, row)| row));
        ControlFlow::Continue(())
    });
    rows
}

/// From the centre of a plate's top a ball may lean until its flute would touch. That is the whole upper hemisphere,
/// except where the holder or a shank wider than the ball collides.
#[test]
fn a_plate_is_reached_from_the_upper_hemisphere() {
    let plate = shapes::plane(0.5, 1, Unit::Millimetre).expect("a plate");
    let directions = Directions::spread(400);
    let rows = first_rows(&plate, "D2Ball", &directions, 0.5);
    assert_eq!(rows.len(), 2);
    for row in rows {
        let angle = directions.solid_angle(&row.access[0].directions);
        assert!((angle - std::f64::consts::TAU).abs() < 0.03, "{angle}");
    }
}

/// A plate in the middle of a hollow block. The tool fits in as it is, so no larger stick-out is needed, however far
/// the holder is assumed to extend above.
#[test]
fn required_stick_out_is_at_most_that_of_the_tool() {
    let plate = cuboid([-1.0, -1.0, -2.0], [1.0, 1.0, 0.0]);
    let [outer, hollow] = [80.0, 60.0].map(|half| cuboid([-half; 3], [half; 3]));
    let vertices = [plate.vertices(), outer.vertices(), hollow.vertices()].concat();
    let offset_corners = |corners: &[u32; 3], offset: u32| corners.map(|corner| corner + offset);
    let outside = outer.triangles().iter().map(|corners| offset_corners(corners, 8));
    // The triangles of the void face inward.
    let inside = hollow.triangles().iter().map(|corners| {
        let [a, b, c] = offset_corners(corners, 16);
        [b, a, c]
    });
    let triangles = plate.triangles().iter().copied().chain(outside).chain(inside);
    let mesh = Mesh::new(vertices, triangles, Unit::Millimetre).expect("a mesh");
    let rows = first_rows(&mesh, "BallEr16", &Directions::spread(200), 0.1);
    let needed: Vec<_> = rows.iter().filter_map(|row| row.access[0].stickout).collect();
    assert!(needed.len() > 2 && needed.iter().all(|needed| *needed <= 30.0), "{needed:?}");
    assert!(needed.contains(&30.0), "nothing asks for all of it: {needed:?}");
}

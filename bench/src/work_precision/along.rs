//! Measurements on paths along a part.

use super::cutter::Cutter;
use super::lineup::{CELLS, Kind, Lineup, Truths, kinds};
use super::methods::{Budgeted, Proved};
use super::plan::Plan;
use super::reference::{Reference, in_contact};
use super::row::{Label, Row};
use super::{Facts, Failure, Sink, peers, progress};
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::{Law, LodProbe, Mesh, Part, Pose, Sampling, Unit};

/// A tool and its path along a part.
pub(super) struct Along<'t> {
    /// The scene's name.
    pub(super) name: String,
    /// The scene's description.
    pub(super) about: String,
    /// The tool.
    pub(super) cutter: Cutter<'t>,
    /// The poses of the path.
    pub(super) poses: Vec<Pose>,
    /// True if the tool touches the part.
    pub(super) touches: bool,
}

/// A scene with its reference values.
struct Known<'t> {
    scene: Along<'t>,
    /// The poses that are certainly in contact, or all poses of a scene without contact.
    poses: Vec<Pose>,
    truth: Option<Reference>,
    /// Reference values with the thesis's magnitudes, the only ones that the peers know.
    thesis: Option<Reference>,
}

/// Minimum number of timed poses.
const LEAST: usize = 2_000;

/// Measures several paths along one part with clouds of all sizes.
///
/// # Errors
/// If a path that should touch is never in contact, if nothing can be certified for a tool, or if no cloud can have the
/// number of points.
pub(super) fn measure(
    mesh: &Mesh,
    scenes: Vec<Along<'_>>,
    plan: &Plan,
    sink: Sink<'_>,
) -> Result<Vec<Facts>, Failure> {
    let bvh = TriangleBvh::new(mesh);
    let mut all = Vec::new();
    for scene in scenes {
        all.push(know(scene, mesh, &bvh, plan)?);
    }
    for (from_last, count) in plan.points.iter().rev().enumerate().rev() {
        progress(&format!("{count} points"));
        let kinds = kinds(mesh, *count, plan.seed, |cloud| cloud)?;
        let detailed = match from_last {
            0 => Some(Part::with_lods(mesh, Sampling::new(*count).with_seed(plan.seed))?),
            _ => None,
        };
        for known in &all {
            let mut lineup = Lineup::default();
            lineup.add_clouds(&kinds, known.scene.cutter);
            if let Some(detailed) = &detailed {
                add_graded(&mut lineup, known, detailed, plan);
                add_certified(&mut lineup, known, &bvh, plan)?;
            }
            if peers_fit(&known.scene, mesh) {
                add_peers(&mut lineup, mesh, &kinds, plan.has_peers(from_last), from_last == 0);
            }
            rows(&mut lineup, known, plan).into_iter().for_each(&mut *sink);
        }
    }
    Ok(all.into_iter().map(|known| facts(known, mesh)).collect())
}

fn know<'t>(
    scene: Along<'t>,
    mesh: &Mesh,
    bvh: &TriangleBvh,
    plan: &Plan,
) -> Result<Known<'t>, Failure> {
    if !scene.touches {
        let poses = scene.poses.clone();
        return Ok(Known { scene, poses, truth: None, thesis: None });
    }
    progress(&format!("the truth of {}", scene.name));
    let tool = scene.cutter.tool();
    let poses = in_contact(bvh, tool, &scene.poses)?;
    if poses.is_empty() {
        return Err(Failure::NoContact { scene: scene.name });
    }
    let truth = Reference::new(mesh, bvh, scene.cutter, &poses, plan)?;
    let thesis = match peers_fit(&scene, mesh) {
        true => of_the_thesis(mesh, &poses, plan)?,
        false => None,
    };
    Ok(Known { scene, poses, truth: Some(truth), thesis })
}

/// Returns whether the peers can handle the scene: they know one tool, in millimetres.
fn peers_fit(scene: &Along<'_>, mesh: &Mesh) -> bool {
    scene.cutter.peers_know_it() && mesh.unit() == Unit::Millimetre
}

/// Returns the reference values for the peers.
#[cfg(feature = "peers")]
fn of_the_thesis(mesh: &Mesh, poses: &[Pose], plan: &Plan) -> Result<Option<Reference>, Failure> {
    Reference::of_the_thesis(mesh, poses, plan).map(Some)
}

/// Returns no reference values: this build has no peers.
#[cfg(not(feature = "peers"))]
fn of_the_thesis(_: &Mesh, _: &[Pose], _: &Plan) -> Result<Option<Reference>, Failure> {
    Ok(None)
}

fn add_graded<'a>(lineup: &mut Lineup<'a>, known: &Known<'a>, detailed: &'a Part, plan: &Plan) {
    for budget in &plan.budgets {
        // A tool may be too large for the smallest budget.
        let graded = LodProbe::new(detailed, known.scene.cutter.tool(), *budget, Law::Thesis);
        if let Ok(graded) = graded {
            let label = Label {
                method: "graded",
                points: Some(detailed.tree().len()),
                sampling: Some("blue"),
                weights: Some(CELLS),
                budget: Some(*budget),
                tolerance: None,
            };
            lineup.add_walking(label, Box::new(Budgeted(graded)));
        }
    }
}

fn add_certified<'a>(
    lineup: &mut Lineup<'a>,
    known: &Known<'a>,
    bvh: &'a TriangleBvh,
    plan: &Plan,
) -> Result<(), Failure> {
    for tolerance in &plan.tolerances {
        let certifier = Certifier::new(bvh, known.scene.cutter.tool())?;
        let label = Label::triangles("certified");
        let label = Label { tolerance: Some(*tolerance), ..label };
        lineup.add(label, Box::new(Proved::new(certifier, *tolerance)));
    }
    Ok(())
}

fn add_peers(lineup: &mut Lineup<'_>, mesh: &Mesh, kinds: &[Kind], points: bool, triangles: bool) {
    if points && let Some(kind) = kinds.iter().find(|kind| kind.words == ["blue", CELLS]) {
        peers::add_points(lineup, kind);
    }
    if triangles {
        peers::add_triangles(lineup, mesh);
    }
}

/// Measures times, then errors.
fn rows(lineup: &mut Lineup<'_>, known: &Known<'_>, plan: &Plan) -> Vec<Row> {
    let name = &known.scene.name;
    progress(&format!("  {name}"));
    // A short path is repeated to reach the minimum number of poses, but no more often than necessary.
    let again = LEAST.min(plan.path / 2).div_ceil(known.poses.len()).max(1);
    let poses: Vec<Pose> =
        known.poses.iter().copied().cycle().take(again * known.poses.len()).collect();
    let times = lineup.race(&poses, plan.seconds);
    let Some(truth) = &known.truth else {
        let some: Vec<Pose> =
            known.poses.iter().step_by((known.poses.len() / plan.checks).max(1)).copied().collect();
        let alarms = lineup.alarms(&some);
        return lineup.rows(name, &times, alarms.into_iter().map(Err));
    };
    let thesis = known.thesis.as_ref().unwrap_or(truth);
    let tallies =
        lineup.check(&known.poses, Truths { true_depths: &truth.truths, thesis: &thesis.truths });
    let of_thesis = lineup.of_the_thesis().collect::<Vec<bool>>();
    let errors = tallies.iter().zip(of_thesis).map(|(tally, is)| {
        let by = if is { thesis } else { truth };
        Ok(tally.errors(by.known, by.depth))
    });
    lineup.rows(name, &times, errors)
}

fn facts(known: Known<'_>, mesh: &Mesh) -> Facts {
    let truth = known.truth;
    Facts {
        scene: known.scene.name,
        about: known.scene.about,
        path: true,
        typical: truth.as_ref().map_or([0.0; 3], |truth| truth.typical),
        known: truth.as_ref().map_or([0.0; 3], |truth| truth.known),
        unit: mesh.unit(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Plan, measure};
    use super::CELLS;

    #[test]
    fn along_a_path_what_is_proved_keeps_its_tolerance_and_more_points_are_nearer() {
        let plan = Plan {
            points: vec![2_000, 32_000],
            path: 200,
            checks: 10,
            tolerances: vec![1e-2, 1e-6],
            budgets: vec![300],
            ..Plan::quick(1)
        };
        let measured = measure(&["inside", "apart"], None, &plan, &mut drop).expect("a path");
        let of = |scene: &str, method: &str| {
            let all = measured.rows.iter().filter(move |row| row.scene == scene);
            all.filter(|row| row.method == method).cloned().collect::<Vec<_>>()
        };
        for row in of("inside", "certified") {
            assert!(row.worst_depth <= row.tolerance.map(|t| t + 1e-9), "{row:?}");
        }
        let clouds = of("inside", "cloud");
        let errors: Vec<f64> = clouds
            .iter()
            .filter(|row| (row.sampling, row.weights) == (Some("blue"), Some(CELLS)))
            .filter_map(|row| row.err_force)
            .collect();
        assert!(errors.len() == 2 && errors[1] < 0.3 * errors[0], "{errors:?}");
        assert!(of("inside", "graded").len() == 1 && of("inside", "cloud + bound").len() == 4);
        // Without contact nothing is evaluated, and there is no error to measure.
        for row in measured.rows.iter().filter(|row| row.scene == "apart") {
            assert!(row.missed == 0.0 && row.err_force.is_none() && row.err_depth.is_none());
        }
        assert!(measured.scenes.iter().any(|facts| facts.scene == "inside" && facts.path));
        assert!(super::super::page(&measured, &plan).is_ok());
    }
}

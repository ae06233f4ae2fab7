//! Measurements on paths along a part.

use super::cutter::Cutter;
use super::lineup::{CELLS, LabelledCloud, Lineup, Truths, labelled_clouds};
use super::methods::{BudgetedProbe, CertifiedDepth};
use super::plan::Plan;
use super::reference::{Reference, in_contact};
use super::row::{Label, Row};
use super::{Failure, SceneInfo, Sink, peers, progress};
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::{Law, LodProbe, Mesh, Part, Pose, Sampling, Unit};

/// A tool and its path along a part.
pub(super) struct PathScene<'t> {
    /// The scene's name.
    pub(super) name: String,
    /// The scene's description.
    pub(super) description: String,
    /// The tool.
    pub(super) cutter: Cutter<'t>,
    /// The poses of the path.
    pub(super) poses: Vec<Pose>,
    /// True if the tool touches the part.
    pub(super) touches: bool,
}

/// A scene with its reference values.
struct ReferencedScene<'t> {
    scene: PathScene<'t>,
    /// The poses that are certainly in contact, or all poses of a scene without contact.
    poses: Vec<Pose>,
    truth: Option<Reference>,
    /// Reference values with the thesis's magnitudes, the only ones that the peers know.
    thesis: Option<Reference>,
}

/// Minimum number of timed poses.
const MIN_TIMED_POSES: usize = 2_000;

/// Measures several paths along one part with clouds of all sizes.
///
/// # Errors
/// If a path that should touch is never in contact, if nothing can be certified for a tool, or if no cloud can have the
/// number of points.
pub(super) fn measure(
    mesh: &Mesh,
    scenes: Vec<PathScene<'_>>,
    plan: &Plan,
    sink: Sink<'_>,
) -> Result<Vec<SceneInfo>, Failure> {
    let bvh = TriangleBvh::new(mesh);
    let mut referenced_scenes = Vec::new();
    for scene in scenes {
        referenced_scenes.push(with_reference(scene, mesh, &bvh, plan)?);
    }
    for (from_last, count) in plan.points.iter().rev().enumerate().rev() {
        progress(&format!("{count} points"));
        let clouds = labelled_clouds(mesh, *count, plan.seed, |cloud| cloud)?;
        let detailed = match from_last {
            0 => Some(Part::with_lods(mesh, Sampling::new(*count).with_seed(plan.seed))?),
            _ => None,
        };
        for referenced in &referenced_scenes {
            let mut lineup = Lineup::default();
            lineup.add_clouds(&clouds, referenced.scene.cutter);
            if let Some(detailed) = &detailed {
                add_graded(&mut lineup, referenced, detailed, plan);
                add_certified(&mut lineup, referenced, &bvh, plan)?;
            }
            if peers_fit(&referenced.scene, mesh) {
                add_peers(&mut lineup, mesh, &clouds, plan.has_peers(from_last), from_last == 0);
            }
            rows(&mut lineup, referenced, plan).into_iter().for_each(&mut *sink);
        }
    }
    Ok(referenced_scenes.into_iter().map(|referenced| facts(referenced, mesh)).collect())
}

fn with_reference<'t>(
    scene: PathScene<'t>,
    mesh: &Mesh,
    bvh: &TriangleBvh,
    plan: &Plan,
) -> Result<ReferencedScene<'t>, Failure> {
    if !scene.touches {
        let poses = scene.poses.clone();
        return Ok(ReferencedScene { scene, poses, truth: None, thesis: None });
    }
    progress(&format!("the truth of {}", scene.name));
    let tool = scene.cutter.tool();
    let poses = in_contact(bvh, tool, &scene.poses)?;
    if poses.is_empty() {
        return Err(Failure::NoContact { scene: scene.name });
    }
    let truth = Reference::new(mesh, bvh, scene.cutter, &poses, plan)?;
    let thesis = match peers_fit(&scene, mesh) {
        true => thesis_reference(mesh, &poses, plan)?,
        false => None,
    };
    Ok(ReferencedScene { scene, poses, truth: Some(truth), thesis })
}

/// Returns whether the peers can handle the scene: they know one tool, in millimetres.
fn peers_fit(scene: &PathScene<'_>, mesh: &Mesh) -> bool {
    scene.cutter.is_known_to_peers() && mesh.unit() == Unit::Millimetre
}

/// Returns the reference values for the peers.
#[cfg(feature = "peers")]
fn thesis_reference(
    mesh: &Mesh,
    poses: &[Pose],
    plan: &Plan,
) -> Result<Option<Reference>, Failure> {
    Reference::with_thesis_magnitudes(mesh, poses, plan).map(Some)
}

/// Returns no reference values: this build has no peers.
#[cfg(not(feature = "peers"))]
fn thesis_reference(_: &Mesh, _: &[Pose], _: &Plan) -> Result<Option<Reference>, Failure> {
    Ok(None)
}

fn add_graded<'a>(
    lineup: &mut Lineup<'a>,
    referenced: &ReferencedScene<'a>,
    detailed: &'a Part,
    plan: &Plan,
) {
    for budget in &plan.budgets {
        // A tool may be too large for the smallest budget.
        let probe = LodProbe::new(detailed, referenced.scene.cutter.tool(), *budget, Law::Thesis);
        if let Ok(probe) = probe {
            let label = Label {
                method: "graded",
                points: Some(detailed.tree().len()),
                sampling: Some("blue"),
                weights: Some(CELLS),
                budget: Some(*budget),
                tolerance: None,
            };
            lineup.add_following_path(label, Box::new(BudgetedProbe(probe)));
        }
    }
}

fn add_certified<'a>(
    lineup: &mut Lineup<'a>,
    referenced: &ReferencedScene<'a>,
    bvh: &'a TriangleBvh,
    plan: &Plan,
) -> Result<(), Failure> {
    for tolerance in &plan.tolerances {
        let certifier = Certifier::new(bvh, referenced.scene.cutter.tool())?;
        let label = Label::triangles("certified");
        let label = Label { tolerance: Some(*tolerance), ..label };
        lineup.add(label, Box::new(CertifiedDepth::new(certifier, *tolerance)));
    }
    Ok(())
}

fn add_peers(
    lineup: &mut Lineup<'_>,
    mesh: &Mesh,
    clouds: &[LabelledCloud],
    points: bool,
    triangles: bool,
) {
    if points && let Some(cloud) = clouds.iter().find(|cloud| cloud.names == ["blue", CELLS]) {
        peers::add_points(lineup, cloud);
    }
    if triangles {
        peers::add_triangles(lineup, mesh);
    }
}

/// Measures times, then errors.
fn rows(lineup: &mut Lineup<'_>, referenced: &ReferencedScene<'_>, plan: &Plan) -> Vec<Row> {
    let name = &referenced.scene.name;
    progress(&format!("  {name}"));
    // A short path is repeated to reach the minimum number of poses, but no more often than necessary.
    let repetitions = MIN_TIMED_POSES.min(plan.path / 2).div_ceil(referenced.poses.len()).max(1);
    let poses: Vec<Pose> = referenced
        .poses
        .iter()
        .copied()
        .cycle()
        .take(repetitions * referenced.poses.len())
        .collect();
    let times = lineup.race(&poses, plan.seconds);
    let Some(truth) = &referenced.truth else {
        let sampled_poses: Vec<Pose> = referenced
            .poses
            .iter()
            .step_by((referenced.poses.len() / plan.checks).max(1))
            .copied()
            .collect();
        let shares = lineup.contact_shares(&sampled_poses);
        return lineup.rows(name, &times, shares.into_iter().map(Err));
    };
    let thesis = referenced.thesis.as_ref().unwrap_or(truth);
    let stats = lineup
        .check(&referenced.poses, Truths { true_depths: &truth.truths, thesis: &thesis.truths });
    let uses_thesis_list = lineup.uses_thesis_magnitudes().collect::<Vec<bool>>();
    let errors = stats.iter().zip(uses_thesis_list).map(|(method_stats, uses_thesis)| {
        let reference = if uses_thesis { thesis } else { truth };
        Ok(method_stats.errors(reference.reference_error, reference.depth))
    });
    lineup.rows(name, &times, errors)
}

fn facts(referenced: ReferencedScene<'_>, mesh: &Mesh) -> SceneInfo {
    let truth = referenced.truth;
    SceneInfo {
        scene: referenced.scene.name,
        description: referenced.scene.description,
        is_path: true,
        typical: truth.as_ref().map_or([0.0; 3], |truth| truth.typical),
        reference_error: truth.as_ref().map_or([0.0; 3], |truth| truth.reference_error),
        unit: mesh.unit(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Plan, measure};
    use super::CELLS;

    #[test]
    fn proved_depths_keep_their_tolerance_and_more_points_reduce_the_error() {
        let plan = Plan {
            points: vec![2_000, 32_000],
            path: 200,
            checks: 10,
            tolerances: vec![1e-2, 1e-6],
            budgets: vec![300],
            ..Plan::quick(1)
        };
        let measured = measure(&["inside", "apart"], None, &plan, &mut drop).expect("a path");
        let rows_of = |scene: &str, method: &str| {
            let scene_rows = measured.rows.iter().filter(move |row| row.scene == scene);
            scene_rows.filter(|row| row.method == method).cloned().collect::<Vec<_>>()
        };
        for row in rows_of("inside", "certified") {
            assert!(row.worst_depth <= row.tolerance.map(|t| t + 1e-9), "{row:?}");
        }
        let clouds = rows_of("inside", "cloud");
        let errors: Vec<f64> = clouds
            .iter()
            .filter(|row| (row.sampling, row.weights) == (Some("blue"), Some(CELLS)))
            .filter_map(|row| row.err_force)
            .collect();
        assert!(errors.len() == 2 && errors[1] < 0.3 * errors[0], "{errors:?}");
        assert!(
            rows_of("inside", "graded").len() == 1 && rows_of("inside", "cloud + bound").len() == 4
        );
        // Without contact nothing is evaluated, and there is no error to measure.
        for row in measured.rows.iter().filter(|row| row.scene == "apart") {
            assert!(row.missed == 0.0 && row.err_force.is_none() && row.err_depth.is_none());
        }
        assert!(measured.scenes.iter().any(|facts| facts.scene == "inside" && facts.is_path));
        assert!(super::super::page(&measured, &plan).is_ok());
    }
}

//! Run time against error of several methods.
//!
//! ```text
//! patches in closed form ──closed──┐                    ┌──▶ rows
//!                                  ├──▶ lineup ──race,──┤
//! paths along parts ───path_scenes─┘            check   └──▶ page, plots, choices
//!        └─ reference: proved depths, refined triangles
//! ```

pub mod choice;
mod closed_form;
mod contact;
mod cutter;
mod lineup;
mod methods;
pub mod orders;
mod page;
mod patch;
mod path_scenes;
mod peers;
mod plan;
mod plots;
mod reference;
mod refine;
mod row;
mod sampling;
mod table;
mod truth;

pub use page::page;
pub use plan::Plan;
pub use row::{LAW, Label, Quantity, Row};

use crate::race::clock::pin;
use cutter::Cutter;
use patch::Patch;
use path_scenes::PathScene;
use touchoff::certify::NotCertifiable;
use touchoff::scenes::{ScenePath, pose_at_gap, tube};
use touchoff::{CloudError, Mesh, Pose, Tool, Unit};

/// Receives each row when it is measured.
pub type Sink<'a> = &'a mut dyn FnMut(Row);

/// The reason why a measurement is impossible.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// A cloud could not be made.
    #[error(transparent)]
    Cloud(#[from] CloudError),
    /// Nothing can be proved about the tool, so no depth is known.
    #[error(transparent)]
    Uncertified(#[from] NotCertifiable),
    /// The path has no contact, so there are no errors to measure.
    #[error(
        "at no pose of {scene} is a triangle in the tool: errors are measured in contact, so take a path that has some"
    )]
    NoContact {
        /// The scene's name.
        scene: String,
    },
}

/// The description of a scene, and the values that its errors are relative to.
#[derive(Clone, Debug)]
pub struct SceneInfo {
    /// The scene's name.
    pub scene: String,
    /// Description of the tool and the part.
    pub description: String,
    /// True if the scene is a path along a part.
    pub is_path: bool,
    /// Root mean squares of force, torque and depth.
    pub typical: [f64; 3],
    /// Relative accuracy of the true values, as shares of `typical`.
    pub reference_error: [f64; 3],
    /// The part's unit.
    pub unit: Unit,
}

/// The results of all measurements.
#[derive(Clone, Debug, Default)]
pub struct Measurements {
    /// All rows.
    pub rows: Vec<Row>,
    /// All scenes.
    pub scenes: Vec<SceneInfo>,
    /// True if the measuring thread was pinned to one core.
    pub pinned: bool,
}

/// Distance of the ball from the wall in the scene `apart`, mm.
const GAP: f64 = 0.5;

/// Returns the names of all scenes.
pub fn scenes() -> Vec<&'static str> {
    let patches = Patch::ALL.into_iter().map(Patch::name);
    patches.chain(ScenePath::ALL.map(ScenePath::name)).chain(["apart"]).collect()
}

/// A user's part, and a tool with a path along it.
pub struct UserScene<'t> {
    /// The part.
    pub mesh: Mesh,
    /// The scene's name.
    pub name: String,
    /// The tool.
    pub tool: &'t dyn Tool,
    /// The poses of the path.
    pub poses: Vec<Pose>,
}

/// Measures the scenes with these names, and the user's own scene.
///
/// # Errors
/// See [`Failure`].
pub fn measure(
    scene_names: &[&str],
    own: Option<UserScene<'_>>,
    plan: &Plan,
    sink: Sink<'_>,
) -> Result<Measurements, Failure> {
    let mut measured = Measurements::default();
    let mut record = |row: Row| {
        sink(row.clone());
        measured.rows.push(row);
    };
    let mut scenes = Vec::new();
    // Start the worker threads before pinning this thread: they would inherit its core.
    rayon::current_num_threads();
    let pinned = pin();
    for patch in Patch::ALL.into_iter().filter(|patch| scene_names.contains(&patch.name())) {
        progress(patch.name());
        scenes.push(closed_form::measure(patch, plan, &mut record)?);
    }
    let tube_scenes = scenes_along_tube(scene_names, plan);
    if !tube_scenes.is_empty() {
        scenes.extend(path_scenes::measure(&tube(), tube_scenes, plan, &mut record)?);
    }
    if let Some(UserScene { mesh, name, tool, poses }) = own {
        let triangles = mesh.triangles().len();
        let description = format!("{} along a part of {triangles} triangles", tool.info().name);
        let scene = PathScene { name, description, cutter: Cutter(tool), poses, touches: true };
        scenes.extend(path_scenes::measure(&mesh, vec![scene], plan, &mut record)?);
    }
    Ok(Measurements { scenes, pinned, ..measured })
}

fn scenes_along_tube(scene_names: &[&str], plan: &Plan) -> Vec<PathScene<'static>> {
    let count = plan.path;
    let scene = |name: &str, description: &str, touches, pose: &dyn Fn(usize) -> Pose| PathScene {
        name: name.to_owned(),
        description: format!("`Fig73Exact` and the tube: {description}"),
        cutter: Cutter::FIG_73_EXACT,
        poses: (0..count).map(pose).collect(),
        touches,
    };
    let description_of = |path| match path {
        ScenePath::Outside => "the ball on the outer wall, the flute over the top edge",
        ScenePath::Inside => "the flute about the bore",
        ScenePath::Hold => "taper, spindle and housing driven into the rim",
    };
    let scene_of =
        |path: ScenePath| scene(path.name(), description_of(path), true, &|k| path.pose(k, count));
    let mut scenes: Vec<_> = ScenePath::ALL
        .into_iter()
        .filter(|path| scene_names.contains(&path.name()))
        .map(scene_of)
        .collect();
    if scene_names.contains(&"apart") {
        let description = "the ball 0.5 mm off the outer wall";
        scenes.push(scene("apart", description, false, &|k| pose_at_gap(GAP, k, count)));
    }
    scenes
}

/// Writes progress to standard error. A failed write is ignored.
fn progress(message: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "{message}");
}

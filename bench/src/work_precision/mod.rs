//! Run time against error: how far from the truth many ways to answer are, and how long they take.
//!
//! ```text
//! patches in closed form ──closed──┐                    ┌──▶ rows
//!                                  ├──▶ lineup ──race,──┤
//! paths along parts ──────along────┘            check   └──▶ page, plots, choices
//!        └─ reference: proved depths, refined triangles
//! ```

mod along;
pub mod choice;
mod closed;
mod contact;
mod cutter;
mod lineup;
mod methods;
pub mod orders;
mod page;
mod patch;
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
use along::Along;
use cutter::Cutter;
use patch::Patch;
use touchoff::certify::Uncertified;
use touchoff::scenes::{Path, apart, tube};
use touchoff::{CloudError, Mesh, Pose, Tool, Unit};

/// Takes each row as it is measured.
pub type Sink<'a> = &'a mut dyn FnMut(Row);

/// Why there is no measurement.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// A cloud could not be made.
    #[error(transparent)]
    Cloud(#[from] CloudError),
    /// Nothing can be proved of the tool, so no depth is known.
    #[error(transparent)]
    Uncertified(#[from] Uncertified),
    /// There is nothing to be wrong about.
    #[error(
        "at no pose of {scene} is a triangle in the tool: errors are measured in contact, so take a path that has some"
    )]
    NoContact {
        /// The scene.
        scene: String,
    },
}

/// What a scene is, and what its errors are by.
#[derive(Clone, Debug)]
pub struct Facts {
    /// Its word.
    pub scene: String,
    /// What touches what.
    pub about: String,
    /// Whether it is a path along a part.
    pub path: bool,
    /// Root mean squares of force, torque and depth.
    pub typical: [f64; 3],
    /// To what share of those they are known.
    pub known: [f64; 3],
    /// The part's unit.
    pub unit: Unit,
}

/// All that was measured.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// Row by row.
    pub rows: Vec<Row>,
    /// Scene by scene.
    pub scenes: Vec<Facts>,
    /// Whether the thread was kept on one core.
    pub pinned: bool,
}

/// How far apart the ball is from the wall in the scene of that name, mm.
const GAP: f64 = 0.5;

/// The words of all scenes.
pub fn scenes() -> Vec<&'static str> {
    let patches = Patch::ALL.into_iter().map(Patch::name);
    patches.chain(Path::ALL.map(Path::name)).chain(["apart"]).collect()
}

/// A part of one's own, and a tool on its way along it.
pub struct Own<'t> {
    /// The part.
    pub mesh: Mesh,
    /// The scene's word.
    pub name: String,
    /// The tool.
    pub tool: &'t dyn Tool,
    /// Where it goes.
    pub poses: Vec<Pose>,
}

/// Measures scenes by their words, and one of one's own.
///
/// # Errors
/// See [`Failure`].
pub fn measure(
    words: &[&str],
    own: Option<Own<'_>>,
    plan: &Plan,
    sink: Sink<'_>,
) -> Result<Measured, Failure> {
    let mut measured = Measured::default();
    let mut both = |row: Row| {
        sink(row.clone());
        measured.rows.push(row);
    };
    let mut scenes = Vec::new();
    // Workers are not kept where this thread is.
    rayon::current_num_threads();
    let pinned = pin();
    for patch in Patch::ALL.into_iter().filter(|patch| words.contains(&patch.name())) {
        progress(patch.name());
        scenes.push(closed::measure(patch, plan, &mut both)?);
    }
    let tube_scenes = along_the_tube(words, plan);
    if !tube_scenes.is_empty() {
        scenes.extend(along::measure(&tube(), tube_scenes, plan, &mut both)?);
    }
    if let Some(Own { mesh, name, tool, poses }) = own {
        let triangles = mesh.triangles().len();
        let about = format!("{} along a part of {triangles} triangles", tool.card().name);
        let scene = Along { name, about, cutter: Cutter(tool), poses, touches: true };
        scenes.extend(along::measure(&mesh, vec![scene], plan, &mut both)?);
    }
    Ok(Measured { scenes, pinned, ..measured })
}

fn along_the_tube(words: &[&str], plan: &Plan) -> Vec<Along<'static>> {
    let count = plan.path;
    let scene = |name: &str, about: &str, touches, pose: &dyn Fn(usize) -> Pose| Along {
        name: name.to_owned(),
        about: format!("`Fig73Exact` and the tube: {about}"),
        cutter: Cutter::FIG_73_EXACT,
        poses: (0..count).map(pose).collect(),
        touches,
    };
    let about = |path| match path {
        Path::Outside => "the ball on the outer wall, the flute over the top edge",
        Path::Inside => "the flute about the bore",
        Path::Hold => "taper, spindle and housing driven into the rim",
    };
    let along = |path: Path| scene(path.name(), about(path), true, &|k| path.pose(k, count));
    let mut all: Vec<_> =
        Path::ALL.into_iter().filter(|path| words.contains(&path.name())).map(along).collect();
    if words.contains(&"apart") {
        let about = "the ball 0.5 mm off the outer wall";
        all.push(scene("apart", about, false, &|k| apart(GAP, k, count)));
    }
    all
}

/// Says on standard error what is measured; where nobody reads that, nothing is lost.
fn progress(words: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "{words}");
}

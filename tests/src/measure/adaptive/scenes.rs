//! Where the integrator is measured beside clouds.

use nalgebra::{Point3, Vector3};
use tools_library::{Fig73, Fig73Exact};
use touchoff::mesh::shapes;
use touchoff::scenes::{HEIGHT, INNER, OUTER, POSES, Path, tube};
use touchoff::{Mesh, MeshError, Pose, Tool, Unit};

touchoff::tool! {
    tool Ball "a ball of 1 mm radius" {
        units mm;
        profile {
            start (0, 0);
            arc to (0, 2) center (0, 1) as ball cutting;
        }
        niceness cutting: 1;
    }
}

touchoff::tool! {
    tool Rod "a rod of 1 mm radius, so long that its ends stand out" {
        units mm;
        profile {
            start (0, 0);
            line to (1, 0), (1, 40), (0, 40) as side cutting;
        }
        niceness cutting: 1;
    }
}

/// A part, the clouds of it that are measured, and what happens beside it.
pub(super) struct Stage {
    pub(super) mesh: Mesh,
    /// No triangle is longer when the integrator begins, mm.
    pub(super) longest: f64,
    /// How many points the clouds have.
    pub(super) clouds: [usize; 4],
    pub(super) scenes: Vec<Scene>,
}

/// A tool at poses.
pub(super) struct Scene {
    pub(super) name: &'static str,
    pub(super) tool: &'static dyn Tool,
    /// Its shape with a profile.
    pub(super) near: &'static dyn Tool,
    pub(super) poses: Vec<Pose>,
}

/// How deep the ball and the rod are pressed in, mm.
const FLAT: f64 = 0.1;
const BORE: f64 = 0.2;
/// How far the rod's axis is from the bore's.
const OFFSET: f64 = INNER - 1.0 + BORE;
/// How many points clouds have: where much of them is in contact, and where little is.
const FEW: [usize; 4] = [500, 3_000, 20_000, 128_000];
const MANY: [usize; 4] = [6_000, 24_000, 96_000, 384_000];

/// Every scene, by its part.
pub(super) fn stages() -> Result<Vec<Stage>, MeshError> {
    let mm = Unit::Millimetre;
    let stage = |mesh, clouds, scenes| Stage { mesh, longest: f64::INFINITY, clouds, scenes };
    Ok(vec![
        stage(shapes::plane(1.5, 3, mm)?, FEW, vec![ball()]),
        stage(bore(1024)?, FEW, vec![rod("rod along a bore of 1024 sides", 0.0)]),
        stage(
            bore(96)?,
            FEW,
            vec![
                rod("rod along a bore of 96 sides", 0.0),
                rod("rod leaning in a bore of 96 sides", 0.01),
            ],
        ),
        Stage {
            longest: 1.0,
            ..stage(
                tube(),
                MANY,
                vec![
                    cutter("outside of the fine tube", Path::Outside, 40),
                    cutter("inside of the fine tube", Path::Inside, 40),
                ],
            )
        },
        stage(
            shapes::tube(INNER, OUTER, HEIGHT, 96, 23, mm)?,
            MANY,
            vec![
                cutter("outside of the even tube", Path::Outside, 40),
                cutter("inside of the even tube", Path::Inside, 40),
                cutter("held in the even tube", Path::Hold, 8),
            ],
        ),
    ])
}

fn pose(tip: Point3<f64>, axis: Vector3<f64>) -> Pose {
    Pose::from_axis(tip, axis).expect("a unit axis")
}

fn ball() -> Scene {
    let flat = |k: u32| {
        let step = |step: f64| (f64::from(k) * step).fract() - 0.5;
        let [x, y] = [0.754_877_666_2, 0.569_840_291_0].map(step);
        pose(Point3::new(x, y, -FLAT), Vector3::z())
    };
    Scene { name: "ball in a plane", tool: &Ball, near: &Ball, poses: (0..50).map(flat).collect() }
}

/// At each pose the rod is leant in a plane through the bore's axis, about the bore's middle.
fn rod(name: &'static str, lean: f64) -> Scene {
    let rod = |k: u32| {
        let (sin, cos) = f64::from(k).sin_cos();
        let out = Vector3::new(cos, sin, 0.0);
        let axis = (Vector3::z() + lean * out).normalize();
        pose(Point3::from(OFFSET * out + Vector3::z() * (HEIGHT / 2.0) - 20.0 * axis), axis)
    };
    Scene { name, tool: &Rod, near: &Rod, poses: (0..50).map(rod).collect() }
}

fn cutter(name: &'static str, path: Path, count: usize) -> Scene {
    let poses = (0..count).map(|k| path.pose(k * (POSES / count) + 37, POSES)).collect();
    Scene { name, tool: &Fig73, near: &Fig73Exact, poses }
}

/// The inner wall of the tube alone, of triangles as long as it is.
fn bore(segments: u32) -> Result<Mesh, MeshError> {
    let tube = shapes::tube(INNER, OUTER, HEIGHT, segments, 1, Unit::Millimetre)?;
    let near = |vertex: &u32| {
        let vertex = tube.vertices()[*vertex as usize];
        vertex.x.hypot(vertex.y) < (INNER + OUTER) / 2.0
    };
    let wall = tube.triangles().iter().filter(|corners| corners.iter().all(near));
    Mesh::new(tube.vertices().to_vec(), wall.copied().collect(), Unit::Millimetre)
}

//! Where the integrator is measured beside clouds.

use nalgebra::{Point3, Vector3};
use tools_library::{Fig73, Fig73Exact};
use touchoff::mesh::shapes;
use touchoff::scenes::{HEIGHT, INNER, OUTER, POSES, Path, tube};
use touchoff::{Mesh, MeshError, Pose, Tool, Unit};

use crate::oracle::closed_forms::{ball_in_plane, cylinder_in_bore};

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

/// A tool at poses beside a part.
pub struct Scene {
    /// Its name.
    pub name: &'static str,
    /// The tool.
    pub tool: &'static dyn Tool,
    /// Its shape with a profile.
    pub near: &'static dyn Tool,
    /// The part.
    pub mesh: Mesh,
    /// No triangle is longer when the integrator begins, mm.
    pub longest: f64,
    /// Nor when it makes the reference.
    pub finest: f64,
    /// The poses.
    pub poses: Vec<Pose>,
    /// How large the force is at each, if that is known.
    pub force: Option<f64>,
    /// The clouds that are measured beside it, points.
    pub clouds: [usize; 3],
    /// The cloud that the reference is compared with, points.
    pub check: usize,
}

/// How deep the ball and the rod are pressed in, mm.
const FLAT: f64 = 0.1;
const BORE: f64 = 0.2;

/// Every scene.
///
/// # Errors
/// None: the shapes are sound.
pub fn scenes() -> Result<Vec<Scene>, MeshError> {
    let mm = Unit::Millimetre;
    let draw = |k: u32, step: f64| (f64::from(k) * step).fract() - 0.5;
    let pose = |tip: Point3<f64>, axis| Pose::from_axis(tip, axis).expect("a unit axis");
    let flat = (0..50).map(|k| {
        let [x, y] = [0.754_877_666_2, 0.569_840_291_0].map(|step| draw(k, step));
        pose(Point3::new(x, y, -FLAT), Vector3::z())
    });
    let flat: Vec<Pose> = flat.collect();
    // At `k` the rod is leant in its own plane by so much, about the bore's middle.
    let offset = INNER - 1.0 + BORE;
    let rods = |lean: f64| -> Vec<Pose> {
        let rod = |k: u32| {
            let (sin, cos) = f64::from(k).sin_cos();
            let out = Vector3::new(cos, sin, 0.0);
            let axis = (Vector3::z() + lean * out).normalize();
            pose(Point3::from(offset * out + Vector3::z() * (HEIGHT / 2.0) - 20.0 * axis), axis)
        };
        (0..50).map(rod).collect()
    };
    let path = |path: Path, count: usize| -> Vec<Pose> {
        (0..count).map(|k| path.pose(k * (POSES / count) + 37, POSES)).collect()
    };
    let ball = Scene {
        name: "ball, plane of 0.5 mm",
        tool: &Ball,
        near: &Ball,
        mesh: shapes::plane(1.5, 6, mm)?,
        longest: f64::INFINITY,
        finest: 0.1,
        poses: flat.clone(),
        force: Some(ball_in_plane(1.0, FLAT).force),
        clouds: [500, 5_000, 50_000],
        check: 1_000_000,
    };
    let rod = |name, segments, lean| -> Result<Scene, MeshError> {
        let along = HEIGHT * cylinder_in_bore(1.0, INNER, offset).force;
        Ok(Scene {
            name,
            tool: &Rod,
            near: &Rod,
            mesh: bore(segments)?,
            poses: rods(lean),
            force: (lean == 0.0).then(|| along.abs()),
            ..ball.like()
        })
    };
    let fig = |name, of, count, mesh, longest| Scene {
        name,
        tool: &Fig73,
        near: &Fig73Exact,
        mesh,
        longest,
        finest: 0.1,
        poses: path(of, count),
        force: None,
        clouds: if of == Path::Hold {
            [500, 20_000, 500_000]
        } else {
            [20_000, 200_000, 2_000_000]
        },
        check: 10_000_000,
    };
    let coarse = shapes::tube(INNER, OUTER, HEIGHT, 96, 23, mm)?;
    let mut scenes = vec![
        Scene { name: "ball, plane of 1 mm", mesh: shapes::plane(1.5, 3, mm)?, ..ball.like() },
        rod("rod along a bore of 1024 sides", 1024, 0.0)?,
        rod("rod along a bore of 96 sides", 96, 0.0)?,
        rod("rod leaning in a bore of 96 sides", 96, 0.01)?,
        fig("outside", Path::Outside, 40, tube(), 1.0),
        fig("inside", Path::Inside, 40, tube(), 1.0),
        // Its triangles are 0.03 mm wide.
        Scene { finest: 0.4, ..fig("hold", Path::Hold, 8, tube(), f64::INFINITY) },
        fig("outside, 8832 triangles", Path::Outside, 40, coarse.clone(), f64::INFINITY),
        fig("inside, 8832 triangles", Path::Inside, 40, coarse.clone(), f64::INFINITY),
        fig("hold, 8832 triangles", Path::Hold, 8, coarse, f64::INFINITY),
    ];
    scenes.insert(0, ball);
    Ok(scenes)
}

impl Scene {
    fn like(&self) -> Scene {
        Scene { mesh: self.mesh.clone(), poses: self.poses.clone(), ..*self }
    }
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

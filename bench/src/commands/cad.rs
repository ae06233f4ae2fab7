//! Rows of `cad.md`: a part's exact points beside points of its triangles.

use clap::Args;
use nalgebra::{Point3, Unit as Direction, Vector3};
use std::error::Error;
use std::path::{Path, PathBuf};
use tools_library::Ball;
use touchoff::mesh::Shape;
use touchoff::{Cloud, Law, Mesh, Part, Pose, Probe, Unit, Wrench};
use touchoff_bench::page::Page;
use touchoff_tests::oracle::draw::Draw;

const UNIT: Unit = Unit::Millimetre;
const POSES: usize = 2_000;

/// Prints rows of the table in `cad.md`: how much more accurately exact points of a part are felt than points of its triangles.
///
/// The files are written by `scripts/cad_points.py`, in mm.
#[derive(Args)]
pub(crate) struct Cad {
    /// Name of the part in the table.
    name: String,
    /// Exact points.
    #[arg(value_name = "POINTS.ply")]
    points: PathBuf,
    /// Triangles of the same part.
    #[arg(value_name = "MESH.ply")]
    mesh: PathBuf,
    /// Many more exact points of another seed: the reference.
    #[arg(value_name = "FINE.ply")]
    fine: PathBuf,
}

impl Cad {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        let (points, fine) = (cloud(&self.points)?, cloud(&self.fine)?);
        let mesh = mesh_of(&self.mesh)?;
        let name = &self.name;
        let even = Cloud::blue(&mesh, points.len(), 1)?;
        let equal = equally(&points)?;
        let [reference, exact, unweighed, triangles] =
            [&fine, &points, &equal, &even].map(Part::from_cloud);
        println!(
            "| {name}: pressed in by | method | force, rms | depth, rms mm | depth, at most mm |"
        );
        println!("|---|---|--:|--:|--:|");
        for depth in [0.5, 0.1, 0.02] {
            let poses = poses(&fine, depth);
            let wanted = felt(&reference, &poses);
            let rows = [
                ("exact points", &exact),
                ("exact points, equal weights", &unweighed),
                ("points of its triangles", &triangles),
            ];
            for (method, part) in rows {
                let [force, typical, most] = errors(&felt(part, &poses), &wanted);
                println!("| {depth} mm | {method} | {force:.2e} | {typical:.5} | {most:.5} |");
            }
        }
        println!(
            "\n{} points, {} in the reference, {POSES} poses a row.",
            points.len(),
            fine.len()
        );
        Ok(None)
    }
}

fn cloud(file: &Path) -> Result<Cloud, Box<dyn Error>> {
    match Shape::read(file, UNIT)? {
        Shape::Points(points) => Ok(Cloud::from_points(points, UNIT)?),
        Shape::Mesh(_) => Err(format!("{} has triangles", file.display()).into()),
    }
}

fn mesh_of(file: &Path) -> Result<Mesh, Box<dyn Error>> {
    match Shape::read(file, UNIT)? {
        Shape::Mesh(mesh) => Ok(mesh),
        Shape::Points(_) => Err(format!("{} has no triangles", file.display()).into()),
    }
}

/// The same points, each for as much.
fn equally(cloud: &Cloud) -> Result<Cloud, Box<dyn Error>> {
    let share = cloud.weights().iter().sum::<f64>() / cloud.len() as f64;
    let (points, normals) = (cloud.points().to_vec(), cloud.normals().to_vec());
    Ok(Cloud::new(points, normals, cloud.triangles().to_vec(), vec![share; cloud.len()], UNIT)?)
}

/// The ball end mill pressed so deep into the surface somewhere, leaning by up to 30°.
fn poses(cloud: &Cloud, depth: f64) -> Vec<Pose> {
    let mut draw = Draw::new(11);
    (0..POSES)
        .map(|_| {
            let at = draw.bits() as usize % cloud.len();
            let (place, normal) = (cloud.points()[at], cloud.normals()[at]);
            let lean = Vector3::from_fn(|_, _| draw.between(-0.3, 0.3));
            let axis = Direction::new_normalize(normal + lean);
            let centre: Point3<f64> = place + (5.0 - depth) * normal;
            Pose::from_axis(centre - 5.0 * axis.into_inner(), axis.into_inner())
                .expect("a unit axis")
        })
        .collect()
}

fn felt(part: &Part, poses: &[Pose]) -> Vec<Wrench> {
    Probe::new(part, &Ball).law(Law::Gradient).map(poses, Probe::wrench)
}

/// Returns the errors: of forces relative to the typical one, of depths as a root mean square and at most.
fn errors(found: &[Wrench], wanted: &[Wrench]) -> [f64; 3] {
    let count = found.len() as f64;
    let rms = |squares: f64| (squares / count).sqrt();
    let typical = rms(wanted.iter().map(|wrench| wrench.force.norm_squared()).sum());
    let pairs = || found.iter().zip(wanted);
    let force = rms(pairs().map(|(a, b)| (a.force - b.force).norm_squared()).sum()) / typical;
    let off = || pairs().map(|(a, b)| (a.depth() - b.depth()).abs());
    [force, rms(off().map(|off| off * off).sum()), off().fold(0.0, f64::max)]
}

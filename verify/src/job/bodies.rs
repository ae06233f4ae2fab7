//! The bodies of a machine in a job: meshes that tools must not touch, and solids of revolution that must not touch meshes.

use super::inputs::{self, JobBody, Load};
use super::{BodyFrame, BodyRole, JobError, JobFile, NamedTool};
use crate::ToolSelection;
use crate::machine::{BodyShape, Link, Machine, MachineBody, Opponent, Side};
use nalgebra::{Point3, Vector3};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::{MeshError, shapes};
use touchoff::tool::Symmetry;
use touchoff::{Mesh, Pose, Tool, Unit};

touchoff::include_tool!("src/machine/machines/spindle-head.tool");
touchoff::include_tool!("src/machine/machines/fork-spindle.tool");
touchoff::include_tool!("src/machine/machines/fork-arm.tool");
touchoff::include_tool!("src/machine/machines/ram.tool");

/// The shapes of bodies of the machines that come with the library.
const SHAPES: [&dyn Tool; 4] = [&SpindleHead, &ForkSpindle, &ForkArm, &Ram];

/// A body of the machine that is a solid of revolution, and moves with a link of it.
#[derive(Clone)]
#[non_exhaustive]
pub struct RevolvedBody<'a> {
    /// Its name in findings.
    pub name: String,
    /// Its shape.
    pub shape: &'a dyn Tool,
    /// The link that it moves with.
    pub link: Link,
    /// The pose of its shape in machine coordinates with all axes at 0, in mm.
    pub mount: Pose,
    /// Distance that it keeps from what it is checked against, 0 or more, in the part's unit. A body with a larger one has its own.
    pub margin: f64,
    /// The indices of the bodies of the job that it is checked against.
    pub against: Vec<usize>,
}

impl std::fmt::Debug for RevolvedBody<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RevolvedBody")
            .field("name", &self.name)
            .field("shape", &self.shape.info().name)
            .field("link", &self.link)
            .field("mount", &self.mount)
            .field("margin", &self.margin)
            .field("against", &self.against)
            .finish()
    }
}

impl<'a> RevolvedBody<'a> {
    /// Creates a body of a shape at a pose in machine coordinates with all axes at 0, in mm. It is checked against no body yet.
    pub fn new(name: &str, shape: &'a dyn Tool, link: Link, mount: Pose) -> RevolvedBody<'a> {
        let (name, against) = (name.to_owned(), Vec::new());
        RevolvedBody { name, shape, link, mount, margin: 0.0, against }
    }

    /// Returns whether it is fixed to the spindle of a machine, along its axis: a longer tool lifts it by as much.
    pub(super) fn is_lifted_by_length(&self, machine: &Machine) -> bool {
        self.link == machine.last_link(Side::Tool) && self.mount.axis() == Vector3::z()
    }

    /// Checks that the shape is a solid of revolution.
    pub(super) fn check_shape(&self) -> Result<(), JobError> {
        match self.shape.info().symmetry {
            Symmetry::Revolved => Ok(()),
            Symmetry::Solid { .. } => Err(JobError::NotRevolved { name: self.name.clone() }),
        }
    }
}

/// A solid of revolution of the machine, with its shape as it was loaded.
#[derive(Debug)]
pub(super) struct LoadedBody<T> {
    name: String,
    shape: Shape<T>,
    link: Link,
    mount: Pose,
    margin: f64,
    against: Vec<usize>,
}

#[derive(Debug)]
enum Shape<T> {
    /// Index in [`SHAPES`].
    BuiltIn(usize),
    Loaded(T),
}

impl<T: AsRef<dyn Tool>> LoadedBody<T> {
    pub(super) fn body(&self) -> RevolvedBody<'_> {
        RevolvedBody {
            name: self.name.clone(),
            shape: match &self.shape {
                Shape::BuiltIn(index) => SHAPES[*index],
                Shape::Loaded(tool) => tool.as_ref(),
            },
            link: self.link,
            mount: self.mount,
            margin: self.margin,
            against: self.against.clone(),
        }
    }
}

/// Reads the bodies of a machine that are meshes, in a unit.
///
/// # Errors
/// If a file cannot be read.
pub(super) fn meshes(machine: &Machine, unit: Unit) -> Result<Vec<JobBody>, JobError> {
    let scale = Unit::Millimetre.factor_to(unit);
    let mut meshes = Vec::new();
    for body in machine.bodies() {
        let refused = |source: MeshError| JobError::MachineMesh { name: body.name.clone(), source };
        let (mesh, file) = match &body.shape {
            BodyShape::Tool { .. } => continue,
            BodyShape::Mesh { file, position } => {
                let mesh = inputs::mesh(file, Unit::Millimetre)?;
                let by = position.coords;
                (moved(&mesh, |vertex| (vertex + by) * scale, unit), Some(file.clone()))
            }
            BodyShape::Box([low, high]) => {
                let mesh = shapes::cuboid(*low, *high, Unit::Millimetre);
                (mesh.and_then(|mesh| moved(&mesh, |vertex| vertex * scale, unit)), None)
            }
            BodyShape::Cylinder { place, radius, height } => {
                let mesh = prism(place, *radius, *height);
                (mesh.and_then(|mesh| moved(&mesh, |vertex| vertex * scale, unit)), None)
            }
        };
        let mesh = mesh.map_err(refused)?;
        let meets_tools = body.against.contains(&Opponent::Tool);
        meshes.push(JobBody {
            name: body.name.clone(),
            file,
            bvh: Arc::new(TriangleBvh::new(&mesh)),
            mesh: Arc::new(mesh),
            frame: BodyFrame::Machine(body.link),
            work_offset: None,
            role: BodyRole::Machine { margin: body.margin * scale, meets_tools },
        });
    }
    Ok(meshes)
}

/// Reads the bodies of a machine that are solids of revolution. `bodies` are those of the job, among them the machine's meshes.
///
/// # Errors
/// If a tool cannot be loaded.
pub(super) fn revolved<T, E: From<JobError>>(
    machine: &Machine,
    bodies: &[JobBody],
    job: &JobFile,
    load: Load<'_, T, E>,
) -> Result<Vec<LoadedBody<T>>, E> {
    let mut revolved = Vec::new();
    for body in machine.bodies() {
        let BodyShape::Tool { name, place } = &body.shape else { continue };
        let known = SHAPES.iter().position(|shape| *shape.info().name == **name);
        let shape = match known {
            Some(index) => Shape::BuiltIn(index),
            None => Shape::Loaded(load(&mut NamedTool {
                motions: ToolSelection::All,
                name: name.clone(),
                library: None,
                params: Vec::new(),
                root: job.root.clone(),
                hand: None,
                doubts: Vec::new(),
                allow: Vec::new(),
            })?),
        };
        let against = bodies.iter().enumerate().filter(|(_, other)| meets(body, other, machine));
        revolved.push(LoadedBody {
            name: body.name.clone(),
            shape,
            link: body.link,
            mount: *place,
            margin: body.margin * Unit::Millimetre.factor_to(job.unit),
            against: against.map(|(index, _)| index).collect(),
        });
    }
    Ok(revolved)
}

/// Returns whether a body of the machine is checked against a body of the job.
fn meets(body: &MachineBody, other: &JobBody, machine: &Machine) -> bool {
    match other.role {
        BodyRole::Part => body.against.contains(&Opponent::Part),
        // A fixture that moves as one with it stands as it is set up.
        BodyRole::Fixture { .. } => {
            body.against.contains(&Opponent::Fixtures) && other.frame.link(machine) != body.link
        }
        BodyRole::Machine { .. } => {
            machine.bodies().iter().any(|known| known.name == other.name && known.meets(body))
        }
    }
}

/// Returns a mesh with other vertices, in a unit.
pub(super) fn moved(
    mesh: &Mesh,
    place: impl Fn(&Point3<f64>) -> Point3<f64>,
    unit: Unit,
) -> Result<Mesh, MeshError> {
    Mesh::new(mesh.vertices().iter().map(place), mesh.triangles().iter().copied(), unit)
}

/// Number of sides of the prism that contains a cylinder: it is up to 0.06 % wider.
const SIDES: u32 = 96;

/// Returns a prism that contains a cylinder, in mm.
fn prism(place: &Pose, radius: f64, height: f64) -> Result<Mesh, MeshError> {
    // The sides touch the cylinder; rounding moves them by far less than what is added.
    let outer = radius / (PI / f64::from(SIDES)).cos() * (1.0 + 1e-12);
    let mut vertices = Vec::new();
    for end in [0.0, height] {
        vertices.push(Point3::new(0.0, 0.0, end));
        for side in 0..SIDES {
            let (sine, cosine) = (TAU * f64::from(side) / f64::from(SIDES)).sin_cos();
            vertices.push(Point3::new(outer * cosine, outer * sine, end));
        }
    }
    let vertices = vertices
        .into_iter()
        .map(|vertex: Point3<f64>| place.tip() + place.rotation() * vertex.coords);
    let upper = SIDES + 1;
    let triangles = (0..SIDES).flat_map(|side| {
        let [from, to] = [1 + side, 1 + (side + 1) % SIDES];
        let [above_from, above_to] = [upper + from, upper + to];
        [
            [0, to, from],
            [upper, above_from, above_to],
            [from, to, above_to],
            [from, above_to, above_from],
        ]
    });
    Mesh::new(vertices, triangles, Unit::Millimetre)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The prism of a cylinder is closed, contains it, and is hardly wider.
    #[test]
    fn a_prism_contains_its_cylinder() {
        let axis = Vector3::new(0.36, -0.48, 0.8);
        let place = Pose::from_axis(Point3::new(3.0, -200.0, 70.0), axis).expect("a pose");
        let mesh = prism(&place, 160.0, 40.0).expect("a prism");
        assert!(mesh.diagnostics().is_solid(), "{:?}", mesh.diagnostics().findings());
        let bvh = TriangleBvh::new(&mesh);
        assert!(bvh.has_inside());
        let mut volume = 0.0;
        for id in mesh.ids() {
            let [a, b, c] = mesh.triangle(id).map(|corner| corner - place.tip());
            volume += a.dot(&b.cross(&c)) / 6.0;
            let normal = mesh.normal(id).expect("an area");
            let along = normal.dot(&axis);
            // The planes are at the ends of the cylinder, or touch its mantle from outside.
            let distance = a.dot(&normal);
            match along {
                _ if along > 0.5 => assert!((distance - 40.0).abs() < 1e-9, "{distance}"),
                _ if along < -0.5 => assert!(distance.abs() < 1e-9, "{distance}"),
                _ => assert!((160.0..160.0 + 1e-9).contains(&distance), "{distance}"),
            }
        }
        let exact = PI * 160.0 * 160.0 * 40.0;
        assert!((1.0..1.0006).contains(&(volume / exact)), "{}", volume / exact);
    }
}

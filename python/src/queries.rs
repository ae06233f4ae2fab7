//! Queries at many poses: on all cores, without the interpreter's lock.

use crate::error::refused;
use crate::part::{Part, rows};
use crate::pool::{in_stretches, on_all_cores};
use crate::poses::read_poses;
use crate::tool::Tool;
use nalgebra::{Point3, Vector3};
use numpy::{Element, PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use touchoff::certify::{Certifier, Clearance, Penetration, TriangleBvh, Witness};
use touchoff::{Contact, Interval, Law, Pose, Probe, Weights, Wrench};

/// The number that stands for no triangle or no surface.
const NONE: i64 = -1;

const NAN: [f64; 3] = [f64::NAN; 3];

/// Returns a position as numpy has it.
fn index(position: usize) -> i64 {
    i64::try_from(position).expect("a position in memory")
}

/// The arrays of a result, by their names.
struct Arrays<'py> {
    py: Python<'py>,
    dict: Bound<'py, PyDict>,
}

impl<'py> Arrays<'py> {
    fn new(py: Python<'py>) -> Arrays<'py> {
        Arrays { py, dict: PyDict::new(py) }
    }

    /// Adds an array of a number per pose or contact.
    fn numbers<T: Element>(
        &self,
        name: &str,
        values: impl Iterator<Item = T>,
    ) -> PyResult<&Arrays<'py>> {
        self.dict.set_item(name, PyArray1::from_vec(self.py, values.collect()))?;
        Ok(self)
    }

    /// Adds an array of vectors that are at hand.
    fn list(&self, name: &str, values: Vec<[f64; 3]>) -> PyResult<&Arrays<'py>> {
        self.dict.set_item(name, rows(self.py, values.into_flattened(), 3)?)?;
        Ok(self)
    }

    /// Adds an array of a vector per pose or contact.
    fn vectors(
        &self,
        name: &str,
        values: impl Iterator<Item = [f64; 3]>,
    ) -> PyResult<&Arrays<'py>> {
        self.dict.set_item(name, rows(self.py, values.flatten().collect(), 3)?)?;
        Ok(self)
    }
}

/// Makes the probe of a tool at the points of a part.
fn probe<'a>(
    py: Python<'_>,
    tool: &'a Tool,
    part: &'a Part,
    law: &str,
    weights: &str,
    centre: [f64; 3],
) -> PyResult<Probe<'a>> {
    let law: Law = law.parse().map_err(|error| refused(format!("law: {error}")))?;
    let weights: Weights = weights.parse().map_err(|error| refused(format!("weights: {error}")))?;
    let centre = Point3::from(centre);
    let probe: Probe<'a> = Probe::new(part.points(py)?, tool.get());
    Ok(probe.with_law(law).with_weights(weights).with_centre(centre))
}

/// Force, torque and depth of the whole contact at each pose.
#[pyfunction]
pub(crate) fn wrench<'py>(
    py: Python<'py>,
    tool: &Tool,
    part: &Part,
    poses: PyReadonlyArray2<'py, f64>,
    law: &str,
    weights: &str,
    centre: [f64; 3],
) -> PyResult<Bound<'py, PyDict>> {
    let poses = read_poses(py, tool, &poses)?;
    let is_off_axis = centre[0] != 0.0 || centre[1] != 0.0;
    if let Some(index) = poses.iter().position(|pose| is_off_axis && !pose.has_spin()) {
        return Err(refused(format!(
            "poses[{index}]: a compliance centre off the axis turns with the tool: give quaternions or matrices, or a \
             centre whose x and y are 0"
        )));
    }
    let probe = probe(py, tool, part, law, weights, centre)?;
    let mut columns = WrenchColumns::default();
    let query =
        |poses: &[Pose]| probe.par_map(poses, |probe: &mut Probe<'_>, pose| probe.wrench(pose));
    in_stretches(py, &poses, query, |found| found.iter().for_each(|wrench| columns.push(wrench)))?;
    let arrays = Arrays::new(py);
    arrays.dict.set_item("rounding_error", probe.rounding_error_bound())?;
    arrays.dict.set_item("sampling_error", probe.sampling_error_bound())?;
    arrays
        .list("force", columns.force)?
        .list("torque", columns.torque)?
        .numbers("depth", columns.depth.into_iter())?
        .numbers("niceness", columns.niceness.into_iter())?
        .numbers("colliding", columns.colliding.into_iter())?
        .numbers("energy", columns.energy.into_iter())?
        .list("point", columns.point)?
        .numbers("triangle", columns.triangle.into_iter())?
        .numbers("force_rounding", columns.force_rounding.into_iter())?
        .numbers("torque_rounding", columns.torque_rounding.into_iter())?;
    Ok(arrays.dict)
}

/// The quantities of wrenches, a list each. Wrenches themselves are several times as long.
#[derive(Default)]
struct WrenchColumns {
    force: Vec<[f64; 3]>,
    torque: Vec<[f64; 3]>,
    depth: Vec<f64>,
    niceness: Vec<f64>,
    colliding: Vec<u64>,
    energy: Vec<f64>,
    point: Vec<[f64; 3]>,
    triangle: Vec<i64>,
    force_rounding: Vec<f64>,
    torque_rounding: Vec<f64>,
}

impl WrenchColumns {
    fn push(&mut self, wrench: &Wrench) {
        self.force.push(wrench.force.into());
        self.torque.push(wrench.torque.into());
        self.depth.push(wrench.depth());
        self.niceness.push(wrench.niceness.unwrap_or(f64::NAN));
        self.colliding.push(wrench.colliding as u64);
        self.energy.push(wrench.energy);
        self.point.push(wrench.deepest.map_or(NAN, |deepest| deepest.point.into()));
        self.triangle.push(wrench.deepest.map_or(NONE, |deepest| i64::from(deepest.triangle.0)));
        self.force_rounding.push(wrench.rounding.force);
        self.torque_rounding.push(wrench.rounding.torque);
    }
}

/// Every point of the part inside the tool, at each pose.
#[pyfunction]
pub(crate) fn contacts<'py>(
    py: Python<'py>,
    tool: &Tool,
    part: &Part,
    poses: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let poses = read_poses(py, tool, &poses)?;
    let points = part.points(py)?;
    let probe: Probe<'_> = Probe::new(points, tool.get());
    let mut found: Vec<Vec<Contact>> = Vec::with_capacity(poses.len());
    let query = |poses: &[Pose]| {
        probe.par_map(poses, |probe: &mut Probe<'_>, pose| probe.contacts(pose).to_vec())
    };
    in_stretches(py, &poses, query, |stretch| found.extend(stretch))?;
    let arrays = Arrays::new(py);
    arrays.dict.set_item("rounding_error", probe.rounding_error_bound())?;
    let mut offset = 0;
    let ends = found.iter().map(|contacts| {
        offset += index(contacts.len());
        offset
    });
    arrays.numbers("offsets", [0].into_iter().chain(ends))?;
    let counted = found.iter().zip(0i64..);
    arrays
        .numbers("pose", counted.flat_map(|(contacts, pose)| contacts.iter().map(move |_| pose)))?;
    let all = || found.iter().flatten();
    arrays
        .vectors("point", all().map(|one| one.point.into()))?
        .vectors("normal", all().map(|one| one.normal.into()))?
        .vectors("direction", all().map(|one| one.direction.into()))?
        .vectors("gradient", all().map(|one| one.gradient.into()))?
        .numbers("triangle", all().map(|one| i64::from(one.triangle.0)))?
        .numbers("surface", all().map(|one| index(one.surface.0)))?
        .numbers("region", all().map(|one| index(one.region)))?
        .numbers("depth", all().map(|one| one.depth))?
        .numbers("magnitude", all().map(|one| one.magnitude))?
        .numbers("niceness", all().map(|one| one.niceness))?
        .numbers("weight", all().map(|one| one.weight))?;
    Ok(arrays.dict)
}

/// Tells whether any point of the part is inside the tool, at each pose.
#[pyfunction]
pub(crate) fn detect<'py>(
    py: Python<'py>,
    tool: &Tool,
    part: &Part,
    poses: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<bool>>> {
    let poses = read_poses(py, tool, &poses)?;
    let points = part.points(py)?;
    let probe: Probe<'_> = Probe::new(points, tool.get());
    let mut found: Vec<bool> = Vec::with_capacity(poses.len());
    let query = |poses: &[Pose]| probe.par_map(poses, Probe::detect);
    in_stretches(py, &poses, query, |stretch| found.extend(stretch))?;
    Ok(PyArray1::from_vec(py, found))
}

/// Runs a query of a certifier at each pose.
fn certified<R: Send>(
    py: Python<'_>,
    tool: &Tool,
    part: &Part,
    poses: &PyReadonlyArray2<'_, f64>,
    query: impl Fn(&mut Certifier<'_>, &Pose) -> R + Sync,
) -> PyResult<Vec<R>> {
    let poses = read_poses(py, tool, poses)?;
    let bvh: &TriangleBvh = part.triangles(py)?;
    let tool = tool.get();
    let certifier = on_all_cores(py, || Certifier::new(bvh, tool))?.map_err(refused)?;
    let mut found: Vec<R> = Vec::with_capacity(poses.len());
    let stretch =
        |poses: &[Pose]| certifier.par_map(poses, |certifier, pose| query(certifier, pose));
    in_stretches(py, &poses, stretch, |answers| found.extend(answers))?;
    Ok(found)
}

impl Arrays<'_> {
    fn interval(&self, intervals: impl Iterator<Item = Interval> + Clone) -> PyResult<&Self> {
        self.numbers("low", intervals.clone().map(|interval| interval.low))?
            .numbers("high", intervals.map(|interval| interval.high))
    }

    fn witnesses(
        &self,
        witnesses: impl Iterator<Item = Option<Witness>> + Clone,
    ) -> PyResult<&Self> {
        let of = |number: fn(Witness) -> i64| {
            witnesses.clone().map(move |witness| witness.map_or(NONE, number))
        };
        self.vectors("point", witnesses.clone().map(|one| one.map_or(NAN, |one| one.point.into())))?
            .numbers("triangle", of(|witness| i64::from(witness.triangle.0)))?
            .numbers("surface", of(|witness| index(witness.surface.0)))
    }
}

/// Proved bounds on the greatest depth of the part's triangles in the tool, at each pose.
#[pyfunction]
pub(crate) fn certified_depth<'py>(
    py: Python<'py>,
    tool: &Tool,
    part: &Part,
    poses: PyReadonlyArray2<'py, f64>,
    tolerance: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let found: Vec<Penetration> =
        certified(py, tool, part, &poses, |certifier, pose| certifier.deepest(pose, tolerance))?;
    let arrays = Arrays::new(py);
    arrays
        .interval(found.iter().map(|one| one.depth))?
        .witnesses(found.iter().map(|one| one.witness))?;
    Ok(arrays.dict)
}

/// Proved bounds on the distance between part and tool, with the nearest points of both, at each pose.
#[pyfunction]
pub(crate) fn clearance<'py>(
    py: Python<'py>,
    tool: &Tool,
    part: &Part,
    poses: PyReadonlyArray2<'py, f64>,
    tolerance: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let found: Vec<Clearance> =
        certified(py, tool, part, &poses, |certifier, pose| certifier.clearance(pose, tolerance))?;
    let arrays = Arrays::new(py);
    let on_tool = |of: fn(&touchoff::certify::ToolPoint) -> [f64; 3]| {
        found.iter().map(move |one| one.on_tool.as_ref().map_or(NAN, of))
    };
    arrays
        .interval(found.iter().map(|one| one.distance))?
        .witnesses(found.iter().map(|one| one.witness))?
        .vectors("tool_point", on_tool(|point| point.point.into()))?
        .vectors("normal", on_tool(|point| Vector3::into(point.normal)))?;
    Ok(arrays.dict)
}

/// Proved bounds on the signed distance between part and tool, at each pose.
#[pyfunction]
pub(crate) fn signed_distance<'py>(
    py: Python<'py>,
    tool: &Tool,
    part: &Part,
    poses: PyReadonlyArray2<'py, f64>,
    tolerance: f64,
    surface_only: bool,
) -> PyResult<Bound<'py, PyDict>> {
    if !surface_only {
        part.require_inside(py)?;
    }
    let found: Vec<Interval> = certified(py, tool, part, &poses, |certifier, pose| {
        certifier.signed_distance(pose, tolerance)
    })?;
    let arrays = Arrays::new(py);
    arrays.interval(found.iter().copied())?;
    Ok(arrays.dict)
}

//! Poses from arrays.

use crate::error::refused;
use crate::pool::on_all_cores;
use crate::tool::Tool;
use nalgebra::{Matrix3, Point3, Vector3};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use rayon::prelude::*;
use touchoff::tool::Symmetry;
use touchoff::{Pose, cancellation};

/// Largest deviation from `[0, 0, 0, 1]` of the last row of a matrix.
const LAST_ROW: f64 = 1e-9;

/// Reads the poses of a tool from a C-contiguous array: n × 6 of tips and axes, n × 7 of tips and quaternions `x, y, z, w`, or
/// n × 16 of matrices, row by row. The package `touchoff` makes these of what its users pass.
///
/// # Errors
/// `ValueError` for the first row that is no pose, or that lacks the spin of a solid without an axis.
pub(crate) fn read_poses(
    py: Python<'_>,
    tool: &Tool,
    rows: &PyReadonlyArray2<'_, f64>,
) -> PyResult<Vec<Pose>> {
    let (columns, rows) = (rows.as_array().ncols(), rows.as_slice()?);
    let read = match columns {
        6 => axis,
        7 => quaternion,
        16 => matrix,
        _ => {
            return Err(refused("poses: an array with rows of 6, 7 or 16 numbers is expected"));
        }
    };
    let poses = on_all_cores(py, || {
        let current = cancellation::current();
        let rows = rows.par_chunks_exact(columns).map_init(
            || current.enter(),
            |_, row| {
                cancellation::check();
                read(row).ok()
            },
        );
        rows.collect::<Option<Vec<Pose>>>()
    })?;
    if let Some(poses) = poses {
        let is_solid = matches!(tool.get().info().symmetry, Symmetry::Solid { .. });
        return match poses.iter().position(|pose| is_solid && !pose.has_spin()) {
            Some(index) => Err(refused(format!(
                "poses[{index}]: a solid without an axis needs its full rotation: give quaternions or matrices"
            ))),
            None => Ok(poses),
        };
    }
    // The first row that is no pose.
    let faults = rows.chunks_exact(columns).map(read).enumerate();
    let fault = faults.filter_map(|(index, pose)| Some((index, pose.err()?))).next();
    let (index, reason) = fault.unwrap_or_default();
    Err(refused(format!("poses[{index}]: {reason}")))
}

fn axis(row: &[f64]) -> Result<Pose, String> {
    let tip = Point3::new(row[0], row[1], row[2]);
    Pose::from_axis(tip, Vector3::new(row[3], row[4], row[5])).map_err(|error| error.to_string())
}

fn quaternion(row: &[f64]) -> Result<Pose, String> {
    let tip = Point3::new(row[0], row[1], row[2]);
    Pose::from_quaternion(tip, [row[3], row[4], row[5], row[6]]).map_err(|error| error.to_string())
}

fn matrix(row: &[f64]) -> Result<Pose, String> {
    let is_last = |(value, expected): (&f64, f64)| (value - expected).abs() <= LAST_ROW;
    if !row[12..].iter().zip([0.0, 0.0, 0.0, 1.0]).all(is_last) {
        return Err(
            "the last row of a matrix is 0, 0, 0, 1: transpose it if its translation is there"
                .to_owned(),
        );
    }
    let rotation =
        Matrix3::new(row[0], row[1], row[2], row[4], row[5], row[6], row[8], row[9], row[10]);
    let tip = Point3::new(row[3], row[7], row[11]);
    Pose::default().rotated_to(rotation, tip).map_err(|error| error.to_string())
}

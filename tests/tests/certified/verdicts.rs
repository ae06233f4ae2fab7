//! Certifiers of whole meshes, and what their verdicts and depths hold.

use crate::prelude::*;
use std::fmt::Debug;

/// Returns the certifier of a mesh and the tool of a name.
pub(crate) fn certifier(mesh: &Mesh, name: &str) -> Certifier<'static> {
    certifier_of(mesh, tool(name))
}

/// Returns the certifier of a mesh and a tool.
pub(crate) fn certifier_of<'a>(mesh: &Mesh, tool: &'a dyn Tool) -> Certifier<'a> {
    let bvh = Box::leak(Box::new(TriangleBvh::new(mesh)));
    Certifier::new(bvh, tool).expect("a tool that is proved")
}

/// Returns a certifier with the allowances of a tool's surfaces, in their order.
pub(crate) fn allowing<'a>(
    certifier: Certifier<'a>,
    tool: &dyn Tool,
    allowed: impl IntoIterator<Item = f64>,
) -> Certifier<'a> {
    let names = tool.info().surfaces.iter().map(|surface| &*surface.name);
    certifier.with_allowances(names.zip(allowed)).expect("surfaces")
}

/// Returns the time and the witness of a motion that touches.
#[track_caller]
pub(crate) fn touching(verdict: MotionVerdict) -> (f64, Witness) {
    let MotionVerdict::Touching(at, witness) = verdict else { panic!("{verdict:?}") };
    (at, witness)
}

/// Returns the time, the depth, its bound on the whole motion and the witness, where it is deeper than was asked.
#[track_caller]
pub(crate) fn deeper(found: Result<MotionDepth, impl Debug>) -> (f64, Interval, f64, Witness) {
    match found {
        Ok(MotionDepth::Deeper { at, depth, max_depth, witness }) => {
            (at, depth, max_depth, witness)
        }
        other => panic!("{other:?}"),
    }
}

/// Asserts that a verdict is the expected one, or without one that the motion touches.
#[track_caller]
pub(crate) fn assert_verdict(found: MotionVerdict, clear: Option<MotionVerdict>, case: impl Debug) {
    let is_touching = matches!(found, MotionVerdict::Touching(..));
    assert!(
        clear.map_or(is_touching, |clear| found == clear),
        "{found:?}, not {clear:?}: {case:?}"
    );
}

/// Returns a mesh with each vertex moved.
pub(crate) fn moved(mesh: &Mesh, to: impl FnMut(&Point3<f64>) -> Point3<f64>) -> Mesh {
    let vertices = mesh.vertices().iter().map(to);
    Mesh::new(vertices, mesh.triangles().to_vec(), mesh.unit()).expect("a mesh as before")
}

/// Returns the corners of each triangle.
pub(crate) fn triangles(mesh: &Mesh) -> impl Iterator<Item = [Point3<f64>; 3]> {
    (0..mesh.triangles().len() as u32).map(|id| mesh.triangle(TriangleId(id)))
}

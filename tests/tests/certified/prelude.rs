//! Imports of most modules of these tests.

pub(crate) use crate::brute::BruteForce;
pub(crate) use crate::verdicts::{
    allowing, certifier, certifier_of, deeper, moved, touching, triangles,
};
pub(crate) use crate::{UP, block, motion, plate, pose, soup, tool};
pub(crate) use nalgebra::{Point3, Vector3};
pub(crate) use touchoff::certify::{
    Certifier, MotionDepth, MotionVerdict, PoseVerdict, TriangleBvh, Witness,
};
pub(crate) use touchoff::mesh::shapes;
pub(crate) use touchoff::tool::Interpreted;
pub(crate) use touchoff::{Interval, Level, Mesh, Motion, Pose, SurfaceId, Tool, TriangleId, Unit};
pub(crate) use touchoff_tests::checks::assert_contains;
pub(crate) use touchoff_tests::count::case_count;
pub(crate) use touchoff_tests::fixtures::drawn;
pub(crate) use touchoff_tests::oracle::rng::Rng;
pub(crate) use touchoff_tests::oracle::{Nearest, Oracle};
pub(crate) use touchoff_tests::tally::Tally;

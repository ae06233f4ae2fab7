//! Imports of most modules of these tests.

pub(crate) use crate::scene::{PointSet, Scene, format_pose, pose, random_pose};
pub(crate) use crate::truth::Subject;
pub(crate) use crate::validator::Validator;
pub(crate) use crate::{check_tools, extent};
pub(crate) use nalgebra::{Point3, Vector3};
pub(crate) use touchoff::Pose;
pub(crate) use touchoff_tests::checks::{Checks, assert_no_misses, print_worst};
pub(crate) use touchoff_tests::oracle::big::Big;
pub(crate) use touchoff_tests::oracle::rng::Rng;
pub(crate) use touchoff_tests::oracle::{Nearest, Oracle};

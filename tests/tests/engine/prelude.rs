//! Imports of most modules of these tests.

pub(crate) use nalgebra::{Point3, UnitQuaternion, Vector3};
pub(crate) use touchoff::tool::Interpreted;
pub(crate) use touchoff::{Law, Level, Part, Pose, Probe, Tool, Unit};
pub(crate) use touchoff_tests::checks::assert_near;
pub(crate) use touchoff_tests::library;
pub(crate) use touchoff_tests::oracle::Oracle;
pub(crate) use touchoff_tests::oracle::rng::Rng;

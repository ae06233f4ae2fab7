//! Other methods for the queries of a probe: the tool of fig. 7.3 at the points of a cloud, or at the part's triangles.
//! `work_precision` times them against this project.

pub mod brute;
pub mod deepest;
pub mod fidget;
pub mod formula;
pub mod parry_bvh;
pub mod parry_contact;
pub mod points;
pub mod thesis;

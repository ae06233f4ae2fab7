//! Other ways to answer what a probe answers: the tool of fig. 7.3 at the points of a cloud, or at the
//! part's triangles. Benches and measurements race them against this project.

pub mod brute;
pub mod deepest;
pub mod fidget;
pub mod formula;
pub mod grid;
pub mod grid_dz;
pub mod parry_bvh;
pub mod parry_contact;
pub mod points;
pub mod shell;
pub mod thesis;

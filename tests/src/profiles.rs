//! The library's profiles with their restatements, and how their regions correspond.

use crate::oracle::restated::{self, Restated};
use crate::oracle::{Nearest, Oracle};
use touchoff::Tool;

/// Returns the tools of the library that are profiles, with their restatements.
pub fn tools() -> Vec<(&'static dyn Tool, Restated)> {
    let restated = restated::all().into_iter();
    restated.filter_map(|tool| Some((touchoff_tools::find(tool.name)?, tool))).collect()
}

/// Returns the oracle's owners for each region of a tool: those of its name, or else all of the surface of that
/// name.
pub fn owners(tool: &dyn Tool, oracle: &Nearest) -> Vec<Vec<usize>> {
    let (names, surfaces) = (oracle.regions(), oracle.surfaces());
    let surfaces: Vec<&str> = surfaces.map(|(surface, _)| surface).collect();
    let indices = |list: &[&str], name: &str| -> Vec<usize> {
        (0..list.len()).filter(|k| list[*k] == name).collect()
    };
    let of = |name: &str| match indices(&names, name) {
        none if none.is_empty() => indices(&surfaces, name),
        some => some,
    };
    tool.info().regions.iter().map(|region| of(&region.name)).collect()
}

//! Parts and tools to compare, each part with each tool.

use crate::motions::bumpy;
use crate::prelude::*;
use rayon::prelude::*;
use std::env;
use std::fmt::{Display, Formatter};
use std::path::Path;
use touchoff::scenes;

/// Files of real parts, and their units.
const FILES: [(&str, Unit); 4] = [
    ("impeller.stl", Unit::Millimetre),
    ("featuretype_inch.stl", Unit::Inch),
    ("octagonal_pocket_metre.stl", Unit::Metre),
    ("kiri_pocket_test.stl", Unit::Millimetre),
];

/// Names of counts: what is queried, a sample inside the tool, samples near the lower bound, an interval wider than tolerance
/// and rounding together, kinds of verdicts, a wrong answer.
pub(crate) const QUERIED: &str = "queried";
pub(crate) const IN_CONTACT: &str = "in contact";
pub(crate) const REACHED: &str = "reached";
pub(crate) const WIDER: &str = "wider";
pub(crate) const CLEAR: &str = "clear";
pub(crate) const NEAR: &str = "near";
pub(crate) const TOUCHING: &str = "touching";
pub(crate) const INSIDE: &str = "inside";
pub(crate) const UNDECIDED: &str = "undecided";
pub(crate) const VIOLATIONS: &str = "violations";

pub(crate) struct Part {
    pub(crate) name: &'static str,
    pub(crate) mesh: Mesh,
    pub(crate) bvh: TriangleBvh,
    /// True for a part read from a file.
    pub(crate) is_real: bool,
}

/// Returns the generated parts, in mm.
pub(crate) fn generated_parts() -> Vec<Part> {
    let sphere = shapes::sphere(8.0, 4, Unit::Millimetre).expect("a sphere");
    let meshes = [
        ("tube", scenes::tube()),
        ("sphere", sphere),
        ("cuboid", plate()),
        ("bumpy", bumpy(20.0, 32)),
    ];
    let part = |(name, mesh)| Part { name, bvh: TriangleBvh::new(&mesh), mesh, is_real: false };
    meshes.map(part).into()
}

/// Returns whether a suite runs in full: if the variable with its number of cases is set.
pub(crate) fn is_full_run(variable: &str) -> bool {
    env::var_os(variable).is_some()
}

/// Returns the generated parts, and in a full run the real ones that are there.
pub(crate) fn parts(variable: &str) -> Vec<Part> {
    let mut parts = generated_parts();
    if is_full_run(variable) {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/parts");
        for (name, unit) in FILES {
            let path = folder.join(name);
            if path.exists() {
                let mesh = Mesh::read_stl(path, unit).expect("a mesh");
                parts.push(Part { name, bvh: TriangleBvh::new(&mesh), mesh, is_real: true });
            } else {
                eprintln!("{name} is skipped: there is no {}", path.display());
            }
        }
    }
    parts
}

/// A part, and a tool with its oracle.
pub(crate) struct Pair<'a, Oracle = Nearest> {
    pub(crate) part: &'a Part,
    pub(crate) tool: &'static dyn Tool,
    pub(crate) oracle: Oracle,
    /// Seed of the pair's random numbers.
    pub(crate) seed: u64,
}

impl<Oracle> Pair<'_, Oracle> {
    /// Returns the tool's unit of length, in the part's unit.
    pub(crate) fn length(&self) -> f64 {
        self.tool.info().unit.factor_to(self.part.mesh.unit())
    }
}

impl<Oracle> Display for Pair<'_, Oracle> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} in {}", self.tool.info().name, self.part.name)
    }
}

/// Parts and tools to compare, and the seed of the first tool.
pub(crate) struct Pairs<'a> {
    pub(crate) parts: &'a [Part],
    /// Names of tools of the library or of [`crate::overhang`].
    pub(crate) tools: &'a [&'a str],
    pub(crate) seed: u64,
}

impl Pairs<'_> {
    /// Returns the results of a comparison of each part with each tool, computed in parallel. `oracle_of` returns the
    /// oracle of a tool, given its name.
    pub(crate) fn compare<Oracle: Sync, Results: Send>(
        &self,
        oracle_of: impl Fn(&str) -> Oracle + Sync,
        compare: impl Fn(&Pair<'_, Oracle>) -> Results + Sync,
    ) -> Vec<Results> {
        let compare_number = |number: usize| {
            let index = number % self.tools.len();
            let name = self.tools[index];
            compare(&Pair {
                part: &self.parts[number / self.tools.len()],
                tool: tool(name),
                oracle: oracle_of(name),
                seed: self.seed + index as u64,
            })
        };
        // A thread takes one pair at a time, because pairs differ much in their time.
        let numbers = (0..self.parts.len() * self.tools.len()).into_par_iter().with_max_len(1);
        numbers.map(compare_number).collect()
    }
}

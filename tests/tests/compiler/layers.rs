//! Modules stand one above the other: none uses one that comes later in the order of its crate.

use std::path::Path;

const COMPILER: &[&str] = &[
    "number",
    "source",
    "dimension",
    "diagnostic",
    "expr",
    "domain",
    "formula",
    "geometry",
    "syntax",
    "format",
    "regionalise",
    "model",
    "resolve",
    "elimination",
    "bound",
    "lint",
    "plan",
    "prove",
    "checked",
    "interpret",
    "digest",
    "draw",
    "emit",
    "compile",
    "lib",
];

const RUNTIME: &[&str] = &[
    "debug",
    "atomic_file",
    "parallel",
    "escape",
    "input",
    "unit",
    "interval",
    "id",
    "keywords",
    "mesh",
    "pose",
    "motion",
    "tool",
    "bvh",
    "cloud",
    "point_bvh",
    "probe",
    "part",
    "storage",
    "scenes",
    "scene",
    "certify",
    "lib",
];

/// An order of modules, and the number of uses that were checked.
struct Layers {
    order: &'static [&'static str],
    uses: usize,
}

impl Layers {
    fn rank(&self, module: &str) -> usize {
        let rank = self.order.iter().position(|known| *known == module);
        rank.unwrap_or_else(|| panic!("`{module}` has no place in the order: give it one"))
    }

    /// Checks each file of a folder, whose module is named unless it is the root's.
    fn check(&mut self, folder: &Path, module: Option<&str>) {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let stem = path.file_stem().expect("a name").to_string_lossy().into_owned();
            let module = module.unwrap_or(&stem);
            // Unit tests may use modules that come later.
            if path.is_dir() && stem != "tests" {
                self.check(&path, Some(module));
            } else if path.is_file() && stem != "tests" {
                let text = std::fs::read_to_string(&path).expect("a source file");
                self.check_text(text.split("#[cfg(test)]").next().unwrap_or_default(), module);
            }
        }
    }

    fn check_text(&mut self, text: &str, module: &str) {
        for line in text.lines().filter(|line| !line.trim_start().starts_with("//")) {
            // Macros name the root for other crates.
            for used in line.replace("$crate::", "").split("crate::").skip(1) {
                let word = |c: &char| c.is_alphanumeric() || *c == '_';
                let name: String = used.chars().take_while(word).collect();
                assert!(
                    name == module || self.rank(&name) < self.rank(module),
                    "`{module}` uses `{name}`, which comes later: {line}"
                );
                self.uses += 1;
            }
        }
    }
}

#[test]
fn no_module_uses_a_later_one() {
    for (folder, order) in [("../tool-dsl/src", COMPILER), ("../runtime/src", RUNTIME)] {
        let mut layers = Layers { order, uses: 0 };
        layers.check(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), None);
        assert!(layers.uses > 200, "{folder}: {} uses", layers.uses);
    }
}

//! The passes of the compiler stand one behind the other: no module uses one that comes later.

use std::path::Path;

/// The modules of `src/`, each of which uses earlier ones only.
const ORDER: [&str; 24] = [
    "number",
    "source",
    "report",
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
    "look",
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

fn rank(module: &str) -> usize {
    let rank = ORDER.iter().position(|known| *known == module);
    rank.unwrap_or_else(|| panic!("`{module}` has no place in the order: give it one"))
}

/// Checks each file of a folder, whose module is named unless it is the root's.
fn check(folder: &Path, module: Option<&str>, seen: &mut usize) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let stem = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let module = module.unwrap_or(&stem);
        if path.is_dir() {
            check(&path, Some(module), seen);
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("a source file");
        // Unit tests of a pass may compile a whole text.
        let text = text.split("#[cfg(test)]").next().unwrap_or_default();
        let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
        for line in code {
            for used in line.split("crate::").skip(1) {
                let names = used.strip_prefix('{').unwrap_or(used);
                let name: String =
                    names.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                assert!(
                    name == module || rank(&name) < rank(module),
                    "{}: `{module}` uses `{name}`, which comes later",
                    path.display()
                );
                *seen += 1;
            }
        }
    }
}

#[test]
fn no_pass_uses_a_later_one() {
    let mut seen = 0;
    check(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), None, &mut seen);
    assert!(seen > 300, "{seen} uses: is `crate::` written differently now?");
}

//! `web/dist`, which the program contains, is built from the sources as they are.

use sha2::{Digest, Sha256};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

const REMEDY: &str = "web/dist is older than its sources: run `web/build` and commit web/dist";

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

fn list() -> String {
    fs::read_to_string(root().join("web/dist/sources.txt")).expect("a list of sources")
}

/// Collects the paths of all files below a folder, relative to the root.
fn files_below(folder: &str, found: &mut BTreeSet<String>) {
    for entry in fs::read_dir(root().join(folder)).expect("a folder") {
        let entry = entry.expect("an entry");
        let path = format!("{folder}/{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            files_below(&path, found);
        } else {
            found.insert(path);
        }
    }
}

#[test]
fn the_page_is_as_new_as_its_sources() {
    let list = list();
    let mut listed = BTreeSet::new();
    for line in list.lines().filter(|line| !line.starts_with("package ")) {
        let (digest, path) = line.split_once("  ").expect("a digest and a path");
        let bytes =
            fs::read(root().join(path)).unwrap_or_else(|_| panic!("{path} is gone: {REMEDY}"));
        let found: String =
            Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(found, digest, "{path} has changed: {REMEDY}");
        listed.insert(path.to_owned());
    }
    let mut sources = BTreeSet::new();
    for folder in ["tools-library/tools", "web/src", "web/page"] {
        files_below(folder, &mut sources);
    }
    let new: Vec<&String> = sources.difference(&listed).collect();
    assert!(new.is_empty(), "{new:?} are new: {REMEDY}");
    assert!(listed.len() > 200, "{} sources", listed.len());
}

#[test]
fn the_page_has_the_locked_versions() {
    let lock = fs::read_to_string(root().join("Cargo.lock")).expect("the lock");
    let list = list();
    let packages: Vec<&str> =
        list.lines().filter_map(|line| line.strip_prefix("package ")).collect();
    for package in &packages {
        let (name, version) = package.split_once(' ').expect("a name and a version");
        let entry = format!("name = \"{name}\"\nversion = \"{version}\"\n");
        assert!(lock.contains(&entry), "{package} is another version now: {REMEDY}");
    }
    assert!(packages.len() > 30, "{} packages", packages.len());
}

//! `touchoff fmt` from the user's side.

use super::bench::{stderr, stdout};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

const LOOSE: &str =
    "tool T{units mm; // in mm\n\n\n  region r where hypot(d,z-1)<=1{depth:1-hypot( d,z - 1 );}}";
const LAID: &str = "tool T {
    units mm; // in mm

    region r where hypot(d, z - 1) <= 1 { depth: 1 - hypot(d, z - 1); }
}
";
const BROKEN: &str = "tool T { units mm }";

fn touchoff(arguments: &[&str], input: &str) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_touchoff"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program runs");
    let mut stdin = program.stdin.take().expect("a pipe");
    stdin.write_all(input.as_bytes()).expect("the program reads");
    drop(stdin);
    program.wait_with_output().expect("the program ends")
}

fn write(folder: &Path, name: &str, content: &str) -> (PathBuf, String) {
    let path = folder.join(name);
    std::fs::write(&path, content).expect("a writable folder");
    let shown = path.display().to_string();
    (path, shown)
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).expect("a readable file")
}

#[test]
fn files_are_laid_out_in_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let (loose, loose_name) = write(folder.path(), "loose.tool", LOOSE);
    let (laid, laid_name) = write(folder.path(), "laid.tool", LAID);
    let before = laid.metadata().and_then(|m| m.modified()).expect("a time");
    let output = touchoff(&["fmt", &loose_name, &laid_name], "");
    assert!(output.status.success() && output.stdout.is_empty(), "{}", stderr(&output));
    assert_eq!(stderr(&output), format!("rewritten: {loose_name}\n1 of 2 files rewritten\n"));
    let again = touchoff(&["fmt", &loose_name, &laid_name], "");
    assert!(again.status.success() && again.stderr.is_empty(), "{}", stderr(&again));
    assert_eq!((read(&loose).as_str(), read(&laid).as_str()), (LAID, LAID));
    let after = laid.metadata().and_then(|m| m.modified()).expect("a time");
    assert_eq!(before, after, "a file that stays the same is not written");
    assert_eq!(folder.path().read_dir().expect("a folder").count(), 2, "something is left behind");
}

#[test]
fn check_names_what_would_change() {
    let folder = tempfile::tempdir().expect("a folder");
    let (loose, loose_name) = write(folder.path(), "loose.tool", LOOSE);
    let (_, laid_name) = write(folder.path(), "laid.tool", LAID);
    let output = touchoff(&["fmt", "--check", &loose_name, &laid_name], "");
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(stdout(&output), format!("{loose_name}\n"));
    assert!(stderr(&output).contains("1 of 2 files would be rewritten"), "{}", stderr(&output));
    assert_eq!(read(&loose), LOOSE);
    let output = touchoff(&["fmt", "--check", &laid_name], "");
    assert!(output.status.success() && output.stdout.is_empty() && output.stderr.is_empty());
}

#[test]
fn json_has_an_object_per_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let (_, loose) = write(folder.path(), "loose.tool", LOOSE);
    let (_, laid) = write(folder.path(), "laid.tool", LAID);
    let (_, broken) = write(folder.path(), "broken.tool", BROKEN);
    let output = touchoff(&["fmt", "--check", "--json", &loose, &laid, &broken], "");
    assert_eq!(output.status.code(), Some(1));
    let rows: Vec<serde_json::Value> = stdout(&output)
        .lines()
        .map(|line| serde_json::from_str(line).expect("an object per line"))
        .collect();
    for (row, (file, outcome)) in
        rows.iter().zip([(&loose, "changed"), (&laid, "unchanged"), (&broken, "failed")])
    {
        assert_eq!((&row["file"], &row["outcome"]), (&file.as_str().into(), &outcome.into()));
    }
    assert_eq!(rows.len(), 3);
}

#[cfg(unix)]
#[test]
fn names_need_not_be_utf8() {
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join(std::ffi::OsStr::from_bytes(b"fr\xe4ser.tool"));
    std::fs::write(&file, LAID).expect("a writable folder");
    for command in ["check", "tools list", "expand", "draw", "fmt"] {
        let mut touchoff = Command::new(env!("CARGO_BIN_EXE_touchoff"));
        let output = touchoff.args(command.split(' ')).arg(&file).output();
        let output = output.expect("the program runs");
        assert!(output.status.success(), "{command}: {}", stderr(&output));
    }
    // The tool is found; only the part is missing.
    let output = Command::new(env!("CARGO_BIN_EXE_touchoff"))
        .args(["verify", "--part", "none.stl", "--unit", "mm", "--program", "none.apt", "--tool"])
        .arg(&file)
        .output()
        .expect("the program runs");
    assert!(!stderr(&output).contains("UTF-8"), "{}", stderr(&output));
}

#[test]
fn standard_input_goes_to_standard_output() {
    let output = touchoff(&["fmt", "-"], LOOSE);
    assert!(output.status.success());
    assert_eq!(stdout(&output), LAID);
    let output = touchoff(&["fmt", "--check", "-"], LOOSE);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(stdout(&output), "<stdin>\n");
    let output = touchoff(&["fmt", "-"], BROKEN);
    assert!(output.status.code() == Some(1) && output.stdout.is_empty());
}

#[test]
fn files_with_errors_are_left_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let (broken, broken_name) = write(folder.path(), "broken.tool", BROKEN);
    let (loose, loose_name) = write(folder.path(), "loose.tool", LOOSE);
    let missing = folder.path().join("missing.tool").display().to_string();
    let output = touchoff(&["fmt", &broken_name, &missing, &loose_name], "");
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(1));
    assert!(said.contains("broken.tool:1:") && said.contains("`;`"), "{said}");
    assert!(said.contains("missing.tool") && said.contains("2 of 3 files have errors"), "{said}");
    assert_eq!((read(&broken).as_str(), read(&loose).as_str()), (BROKEN, LAID));
}

#[cfg(unix)]
#[test]
fn links_and_permissions_stay() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().expect("a folder");
    let (file, _) = write(folder.path(), "file.tool", LOOSE);
    let wanted = std::fs::Permissions::from_mode(0o640);
    std::fs::set_permissions(&file, wanted).expect("a file of one's own");
    let link = folder.path().join("link.tool");
    std::os::unix::fs::symlink(&file, &link).expect("a link");
    assert!(touchoff(&["fmt", &link.display().to_string()], "").status.success());
    assert!(link.symlink_metadata().expect("a link").file_type().is_symlink());
    assert_eq!(read(&file), LAID);
    assert_eq!(file.metadata().expect("a file").permissions().mode() & 0o777, 0o640);
}

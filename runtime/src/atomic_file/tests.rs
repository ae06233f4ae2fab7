use super::*;

fn names(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).expect("a folder").flatten();
    let mut names: Vec<String> =
        names.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn replaces_files_completely_or_not_at_all() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a");
    AtomicFile::write(&path, "old").expect("written");
    let mut file = AtomicFile::create(&path).expect("begun");
    file.write_all(&[b'x'; 100_000]).expect("written");
    assert_eq!(fs::read(&path).expect("read"), b"old");
    drop(file);
    assert_eq!(fs::read(&path).expect("read"), b"old");
    assert_eq!(names(folder.path()), ["a"]);
    AtomicFile::write(&path, "new").expect("written");
    assert_eq!(fs::read(&path).expect("read"), b"new");
    let again = AtomicFile::create(&path).expect("begun").commit_new().expect_err("it is there");
    assert_eq!(again.kind(), io::ErrorKind::AlreadyExists);
    assert_eq!((fs::read(&path).expect("read"), names(folder.path()).len()), (b"new".into(), 1));
    let nowhere = AtomicFile::create(folder.path().join("no/a")).expect_err("no folder");
    assert_eq!(nowhere.kind(), io::ErrorKind::NotFound);
    AtomicFile::create(folder.path()).expect_err("a folder");
}

#[test]
fn removes_only_abandoned_temporary_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let path_of = |name: &str| folder.path().join(name);
    let live = AtomicFile::create(path_of("b")).expect("begun");
    let unrelated = [".touchoff-notes", ".touchoff-notes.tmp", "touchoff.tmp", ".other.tmp"];
    for name in unrelated.iter().chain(&[".touchoff-0123456789abcdef.tmp"]) {
        fs::write(path_of(name), "x").expect("written");
    }
    AtomicFile::write(path_of("a"), "a").expect("written");
    let found = names(folder.path());
    assert_eq!(found.len(), 6, "{found:?}");
    assert!(unrelated.iter().all(|name| found.contains(&(*name).to_owned())), "{found:?}");
    // The file being written is not treated as abandoned.
    live.commit().expect("written");
    assert!(path_of("b").exists());
}

#[cfg(unix)]
#[test]
fn permissions_come_from_the_old_file_or_the_umask() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().expect("a folder");
    let [new, plain] = ["new", "plain"].map(|name| folder.path().join(name));
    let mode = |path: &Path| fs::metadata(path).expect("there").permissions().mode() & 0o7777;
    AtomicFile::write(&new, "").expect("written");
    File::create(&plain).expect("created");
    assert_eq!(mode(&new), mode(&plain));
    fs::set_permissions(&new, fs::Permissions::from_mode(0o604)).expect("set");
    AtomicFile::write(&new, "x").expect("written");
    assert_eq!(mode(&new), 0o604);
    fs::set_permissions(&new, fs::Permissions::from_mode(0o400)).expect("set");
    // Some users, such as root, may write every file.
    if OpenOptions::new().write(true).open(&new).is_err() {
        let refused = AtomicFile::create(&new).expect_err("not to be written");
        assert_eq!(refused.kind(), io::ErrorKind::PermissionDenied);
    }
}

#[cfg(unix)]
#[test]
fn follows_links_and_writes_devices_directly() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().expect("a folder");
    let path_of = |name: &str| folder.path().join(name);
    fs::create_dir(path_of("in")).expect("a folder");
    // Links to an existing file, over two links, and to a file that does not exist yet.
    for (link, to) in [("one", "in/two"), ("in/two", "file"), ("open", "in/later")] {
        symlink(to, path_of(link)).expect("a link");
    }
    fs::write(path_of("in/file"), "old").expect("written");
    for (link, file) in [("one", "in/file"), ("open", "in/later")] {
        AtomicFile::write(path_of(link), "new").expect("written");
        assert!(fs::symlink_metadata(path_of(link)).expect("there").is_symlink());
        assert_eq!(fs::read(path_of(file)).expect("read"), b"new");
    }
    symlink("round", path_of("round")).expect("a link");
    AtomicFile::create(path_of("round")).expect_err("it leads nowhere");
    AtomicFile::write("/dev/null", "x").expect("taken");
    if Path::new("/dev/full").exists() {
        symlink("/dev/full", path_of("full")).expect("a link");
        for path in [Path::new("/dev/full"), &path_of("full")] {
            let error = AtomicFile::write(path, "x").expect_err("no room");
            assert_eq!(error.kind(), io::ErrorKind::StorageFull);
        }
    }
}

#[cfg(unix)]
#[test]
fn writes_pipes_directly() {
    use std::io::Read;
    let (mut reader, writer) = io::pipe().expect("a pipe");
    let path = format!("/dev/fd/{}", std::os::fd::AsRawFd::as_raw_fd(&writer));
    AtomicFile::write(path, "through").expect("written");
    drop(writer);
    let mut text = String::new();
    reader.read_to_string(&mut text).expect("read");
    assert_eq!(text, "through");
}

#[cfg(target_os = "linux")]
#[test]
fn errors_do_not_name_the_temporary_file() {
    let error = AtomicFile::create("/proc/report.txt").expect_err("no file can be made there");
    assert!(
        error.kind() == io::ErrorKind::NotFound && !error.to_string().contains(SUFFIX),
        "{error}"
    );
}

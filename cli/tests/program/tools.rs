//! `touchoff tools show`: the text of built-in tools.

use crate::bench::{rows, stderr, stdout, touchoff};
use std::fs;
use touchoff::Tool;
use touchoff::tool::Interpreted;
use touchoff_tools::{SOURCES, TOOLS};

/// Every built-in tool, written to a file, has the same digest as the one that is compiled into the program.
#[test]
fn built_in_tools_are_written_as_they_were_compiled() {
    let folder = tempfile::tempdir().expect("a folder");
    for tool in TOOLS {
        let info = tool.info();
        // The command makes this folder.
        let file = folder.path().join(&*info.name).join("own.tool");
        let shown = file.display().to_string();
        let output = touchoff(&["tools", "show", &info.name, "-o", &shown]);
        assert!(output.status.success() && output.stdout.is_empty(), "{}", stderr(&output));
        let loaded = Interpreted::load(&file).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((&loaded.info().name, loaded.info().digest), (&info.name, info.digest));
    }
}

#[test]
fn the_text_of_a_tool_is_printed() {
    let output = touchoff(&["tools", "show", "D2Ball"]);
    assert!(output.stderr.is_empty() && stdout(&output).contains("tool D2Ball"), "{output:?}");
    let output = touchoff(&["tools", "show", "BallEr16"]);
    assert!(stderr(&output).contains("mounts `ball.tool`, `holders/er16.tool`"), "{output:?}");
    let row = &rows(&touchoff(&["tools", "show", "BallEr16", "--json"]))[0];
    let index = TOOLS.iter().position(|tool| tool.info().name == "BallEr16").expect("a tool");
    let files = row["files"].as_array().expect("a list");
    for (file, (name, text)) in files.iter().zip(SOURCES[index]) {
        assert_eq!((&file["file"], &file["text"]), (&(*name).into(), &(*text).into()));
    }
    assert_eq!(files.len(), 3);
}

#[test]
fn mounted_files_replace_no_others() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = |name: &str| folder.path().join(name).display().to_string();
    // The second is not UTF-8.
    for present in [&b"another"[..], b"\xff\xfe"] {
        fs::write(place("ball.tool"), present).expect("a writable folder");
        for output in ["own.tool", "ball.tool"] {
            let output = touchoff(&["tools", "show", "BallEr16", "-o", &place(output)]);
            assert_eq!(output.status.code(), Some(1));
            assert!(stderr(&output).contains("would replace `"), "{}", stderr(&output));
        }
        assert_eq!(fs::read(place("ball.tool")).expect("a file"), present);
    }
    assert_eq!(folder.path().read_dir().expect("a folder").count(), 1);
    let output = touchoff(&["tools", "show", "D2Ball", "-o", &place("own.txt")]);
    assert!(stderr(&output).contains("own.tool` instead of"), "{}", stderr(&output));
}

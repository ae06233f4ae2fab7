//! Outputs that cannot be written, or must not be.

use crate::bench::{Bench, stderr, touchoff};
use std::fs;
use std::io;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// A program that cuts 0.5 deep through the block, and one that stays clear of it.
const GOUGES: &str =
    "UNITS/MM\nGOTO/-9,0,3,0,0,1\nGOTO/-9,0,-0.5,0,0,1\nGOTO/9,0,-0.5,0,0,1\nFINI\n";
const CLEAR: &str = "UNITS/MM\nGOTO/-9,0,1,0,0,1\nGOTO/9,0,1,0,0,1\nFINI\n";
const GOOD: &str = "tool Good {
    units mm;
    profile { start (0, 0); line to (2, 0), (2, 9), (0, 9) as body cutting; }
}
";

/// Runs the program with its standard output going to `out`, and returns its exit status and messages.
fn into(out: impl Into<Stdio>, arguments: &[&str]) -> (Option<i32>, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_touchoff"))
        .args(arguments)
        .stdout(out)
        .stderr(Stdio::piped())
        .output()
        .expect("the program runs");
    (output.status.code(), stderr(&output))
}

/// Returns a pipe whose reader is closed.
fn closed() -> io::PipeWriter {
    let (reader, writer) = io::pipe().expect("a pipe");
    drop(reader);
    writer
}

/// Returns commands that write to standard output, and their exit statuses.
fn commands(bench: &Bench) -> Vec<(Vec<String>, i32)> {
    bench.write("gouges.apt", GOUGES);
    bench.write("clear.apt", CLEAR);
    bench.write("good.tool", GOOD);
    bench.write("loose.tool", GOOD.replace("    ", " "));
    bench.write("warned.tool", GOOD.replace("profile", "param unused = 3; profile"));
    bench.write("bad.tool", "tool Bad { units mm; region r where d < 1 { depth: 1 - d; } }");
    let block = bench.place("block.stl");
    let words = |words: &str| -> Vec<String> {
        words
            .split(' ')
            .map(|word| match word {
                "PART" => block.clone(),
                word if word.contains('.') && word.parse::<f64>().is_err() => bench.place(word),
                word => word.to_owned(),
            })
            .collect()
    };
    [
        ("verify --part PART --unit mm --tool D2Ball --program gouges.apt", 1),
        ("verify --part PART --unit mm --tool D2Ball --program gouges.apt --json", 1),
        ("run --part PART --unit mm --tool D2Ball --program gouges.apt", 0),
        ("run --part PART --unit mm --tool D2Ball --program gouges.apt --json", 0),
        ("check good.tool bad.tool", 1),
        ("check good.tool", 0),
        ("check --json good.tool", 0),
        ("fmt --check loose.tool", 1),
        ("tools", 0),
        ("tools list --json good.tool", 0),
        ("expand good.tool", 0),
        ("expand --stage plan good.tool", 0),
        ("draw good.tool", 0),
        ("sweep --part PART --unit mm --tool D2Ball --directions 4", 0),
        ("haptic --part PART --unit mm --tool D2Ball --duration 0.01", 0),
        ("haptic --part PART --unit mm --tool D2Ball --duration 0.01 --json", 0),
    ]
    .map(|(line, status)| (words(line), status))
    .into()
}

#[test]
fn the_status_does_not_depend_on_the_reader() {
    let bench = Bench::new();
    for (words, status) in commands(&bench) {
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let (code, said) = into(closed(), &words);
        assert_eq!(code, Some(status), "{words:?}: {said}");
        assert!(!said.contains("panicked") && !said.contains("could not be written"), "{said}");
    }
    let verify = |program: &str| {
        let (block, program) = (bench.place("block.stl"), bench.place(program));
        let words = ["verify", "--part", &block, "--unit", "mm", "--tool", "D2Ball", "--program"];
        into(closed(), &[&words[..], &[&program]].concat()).0
    };
    assert_eq!((verify("clear.apt"), verify("nowhere.apt")), (Some(0), Some(2)));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_under_standard_output_is_an_error() {
    let bench = Bench::new();
    let full = || fs::OpenOptions::new().write(true).open("/dev/full").expect("a device");
    for (words, _) in commands(&bench) {
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let (code, said) = into(full(), &words);
        let status = if words[0] == "verify" { 2 } else { 1 };
        assert_eq!(code, Some(status), "{words:?}: {said}");
        let bad_tool = words.contains(&"check") && words.len() == 3;
        assert!(
            bad_tool || said.contains("standard output could not be written"),
            "{words:?}: {said}"
        );
    }
}

/// Runs the program with room for `blocks` blocks of 512 bytes in each file.
#[cfg(target_os = "linux")]
fn with_room(blocks: u32, arguments: &[&str]) -> Output {
    // The signal that would end the program is ignored, so that writing fails as on a full disk.
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$@\"");
    let program = env!("CARGO_BIN_EXE_touchoff");
    let shell = ["-c", &script, "sh", program];
    Command::new("sh").args(shell).args(arguments).output().expect("a shell")
}

/// Returns the names of the files in a folder, and their contents.
fn content(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder).expect("a folder").flatten();
    let mut all: Vec<(String, Vec<u8>)> = entries
        .filter(|entry| entry.path().is_file())
        .map(|entry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            (name, fs::read(entry.path()).expect("a file"))
        })
        .collect();
    all.sort();
    all
}

/// Sweeps the block into the map `block.postures`, and returns its path.
fn swept(bench: &Bench) -> String {
    let (part, map) = (bench.place("block.stl"), bench.place("block.postures"));
    let words = ["sweep", "--part", &part, "--unit", "mm", "--tool", "D2Ball"];
    let more = ["--directions", "30", "--tolerance", "0.05", "--output", &map];
    let output = touchoff(&[&words[..], &more].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    map
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_old_files_and_no_others() {
    let bench = Bench::new();
    let (part, map) = (bench.place("block.stl"), swept(&bench));
    let tool = bench.write("good.tool", GOOD);
    let loose = GOOD.replace("    ", " ") + &"// a comment\n".repeat(400);
    let loose = bench.write("loose.tool", loose);
    let outputs = ["o.csv", "o.json", "o.ply", "o.png", "o.svg", "o.touchoff", "o.apt"];
    for name in outputs {
        bench.write(name, "old");
    }
    let before = || content(bench.folder.path());
    let kept = before();
    let [csv, json, ply, png, svg, saved, apt] =
        ["o.csv", "o.json", "o.ply", "o.png", "o.svg", "o.touchoff", "o.apt"]
            .map(|name| bench.place(name));
    let path = |to: &str| format!("path {map} --part {part} --tool D2Ball --stepover 0.3 -o {to}");
    let commands = [
        format!("map {map} -o {csv}"),
        format!("map {map} -o {json}"),
        format!("map {map} --part {part} -o {ply}"),
        format!("map {map} --part {part} -o {png}"),
        path(&apt),
        path(&csv),
        format!("draw {tool} -o {svg}"),
        format!("draw {tool} -o {png}"),
        format!("sample --part {part} --unit mm -o {saved}"),
        format!("fmt {loose}"),
        format!("haptic --part {part} --unit mm --tool D2Ball --duration 0.2 --record {csv}"),
    ];
    for command in &commands {
        let output = with_room(0, &command.split(' ').collect::<Vec<_>>());
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{command:?}: {said}");
        assert!(said.contains("File too large") && said.contains("error: "), "{command:?}: {said}");
        assert!(before() == kept, "{command:?}: something is changed or left");
    }
    // A link to a device is followed, and the device written to.
    #[cfg(unix)]
    {
        let link = bench.folder.path().join("full.svg");
        std::os::unix::fs::symlink("/dev/full", &link).expect("a link");
        let output = touchoff(&["draw", &tool, "-o", &link.display().to_string()]);
        assert_eq!(output.status.code(), Some(1));
        assert!(stderr(&output).contains("No space left"), "{}", stderr(&output));
    }
}

#[test]
fn an_output_that_is_an_input_is_refused() {
    let bench = Bench::new();
    let map = swept(&bench);
    let (part, path) = (bench.place("block.stl"), bench.place("path.csv"));
    let tool = bench.write("good.tool", GOOD);
    let drawn = bench.write("tool.svg", GOOD);
    let [to_map, to_part, to_tool, to_saved] =
        ["y.csv", "part.csv", "tool.csv", "s.touchoff"].map(|name| bench.place(name));
    fs::hard_link(&map, &to_map).expect("a link");
    fs::hard_link(&part, &to_part).expect("a link");
    fs::hard_link(&tool, &to_tool).expect("a link");
    fs::hard_link(&part, &to_saved).expect("a link");
    let mounting =
        bench.write("mounting.tool", "tool Mounting { units mm; mount \"tool.svg\" as c; }");
    let kept = content(bench.folder.path());
    let haptic =
        ["haptic", "--part", &part, "--unit", "mm", "--tool", "D2Ball", "--duration", "0.1"];
    let leads = ["path", &map, "--part", &part, "--tool"];
    let commands: [&[&str]; 11] = [
        &["draw", &mounting, "-o", &drawn],
        &["map", &map, "-o", &to_map],
        &["map", &map, "--part", &part, "-o", &to_part],
        &[&leads[..], &["D2Ball", "--stepover", "1", "-o", &to_map]].concat(),
        &[&leads[..], &["D2Ball", "--stepover", "1", "-o", &to_part]].concat(),
        &[&leads[..], &[&tool, "--stepover", "1", "-o", &to_tool]].concat(),
        &["draw", &drawn, "-o", &drawn],
        &["sample", "--part", &part, "--unit", "mm", "-o", &to_saved],
        &["sweep", "--part", &part, "--unit", "mm", "--tool", "D2Ball", "--output", &part],
        &[&haptic[..], &["--device", "playback", "--program", &path, "--record", &path]].concat(),
        &[&haptic[..], &["--postures", &map, "--record", &to_map]].concat(),
    ];
    for command in commands {
        let output = touchoff(command);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{command:?}: {said}");
        assert!(said.contains("is also an input"), "{command:?}: {said}");
        assert!(output.stdout.is_empty() && content(bench.folder.path()) == kept, "{command:?}");
    }
}

#[test]
fn a_program_that_is_cut_short_is_refused() {
    let bench = Bench::new();
    let (map, part, to) = (swept(&bench), bench.place("block.stl"), bench.place("led.csv"));
    let words = ["path", &map, "--part", &part, "--tool", "D2Ball", "--stepover", "1", "-o", &to];
    assert!(touchoff(&words).status.success());
    let run = |name: &str| bench.run("block.stl", name, "D2Ball", &[]);
    assert!(run("led.csv").status.success());
    let whole = fs::read_to_string(&to).expect("a program");
    let half = whole.lines().take(whole.lines().count() / 2).collect::<Vec<_>>().join("\n");
    bench.write("cut.csv", &half);
    let line = half.lines().count();
    bench.refused_program("cut.csv", &[&format!("cut.csv:{line}: the table stops here")]);
}

#[test]
fn control_characters_of_names_are_escaped() {
    let bench = Bench::new();
    let evil = "\u{1b}[2J\u{9b}0m\r\u{202e}";
    let title = GOOD.replacen("Good", &format!("Good \"{evil}\""), 1);
    let tool = bench.write(&format!("a{evil}.tool"), &title);
    bench.write(&format!("{evil}.apt"), "UNITS/MM\nGOTO/0,0,9,0,0,1\nGOTO/1,0,9\nFINI\n");
    let program = format!("{evil}.apt");
    let outputs = [
        touchoff(&["tools", "list", &tool]),
        touchoff(&["tools", "list", "--json", &tool]),
        touchoff(&["check", &tool]),
        touchoff(&["check", &format!("{tool}.nowhere")]),
        touchoff(&["expand", &tool]),
        touchoff(&["draw", &tool]),
        touchoff(&["fmt", "--check", &tool]),
        bench.run("block.stl", &program, "D2Ball", &[]),
        bench.run("block.stl", &format!("no{program}"), "D2Ball", &[]),
        bench.run(&program, "path.csv", "D2Ball", &[]),
    ];
    for output in outputs {
        for text in [output.stdout, output.stderr] {
            let text = String::from_utf8(text).expect("UTF-8");
            let is_bad = |c: &char| (c.is_control() && !"\n\t".contains(*c)) || *c == '\u{202e}';
            assert_eq!(text.chars().find(is_bad), None, "{text:?}");
        }
    }
}

#[test]
fn negative_numbers_are_read_and_judged() {
    let bench = Bench::new();
    let (part, apt) = (bench.place("block.stl"), bench.write("clear.apt", CLEAR));
    let refused = |words: &[&str], more: &[&str]| {
        for (option, remedy) in more.iter().zip(more.iter().skip(1)).step_by(2) {
            for value in ["-0.01", "-5", "-.5", "-1e-3"] {
                let output = touchoff(&[words, &[option, value]].concat());
                let said = stderr(&output);
                assert_eq!(output.status.code(), Some(2), "{option} {value}: {said}");
                assert!(said.contains(&format!("invalid value '{value}'")), "{option}: {said}");
                assert!(said.contains(remedy), "{option} {value}: {said}");
            }
        }
    };
    let (length, length_above) = ("finite length of 0 or more", "finite length above 0");
    let above = "finite number above 0";
    refused(
        &["verify", "--part", &part, "--unit", "mm", "--tool", "D2Ball", "--program", &apt],
        &["--tolerance", length, "--resolution", length],
    );
    refused(
        &["run", "--part", &part, "--unit", "mm", "--tool", "D2Ball", "--program", &apt],
        &["--sampling-error", length_above, "--certify", length, "--points", "", "--seed", ""],
    );
    refused(
        &["haptic", "--part", &part, "--unit", "mm", "--tool", "D2Ball"],
        &[
            "--rate",
            "a rate of 1 to 100000",
            "--duration",
            above,
            "--stiffness",
            above,
            "--device-stiffness",
            above,
            "--max-force",
            above,
            "--core",
            "",
            "--spin",
            "",
        ],
    );
    refused(
        &["sweep", "--part", &part, "--unit", "mm", "--tool", "D2Ball"],
        &["--tolerance", length_above, "--directions", "", "--keep", ""],
    );
    refused(
        &["path", "map", "--part", &part, "--tool", "D2Ball", "-o", "a.csv"],
        &["--tolerance", length_above, "--stepover", length_above, "--forward-step", length_above],
    );
    let verify = ["verify", "--part", &part, "--unit", "mm", "--tool", "D2Ball", "--program", &apt];
    let allowed = touchoff(&[&verify[..], &["--allow", "shank=-0.5"]].concat());
    assert_eq!(allowed.status.code(), Some(0), "{}", stderr(&allowed));
}

#[test]
fn an_option_is_no_value() {
    for (command, option) in [("verify", "--tolerance"), ("run", "--center"), ("sweep", "--tool")] {
        let output = touchoff(&[command, option, "--json"]);
        assert_eq!(output.status.code(), Some(2));
        let said = stderr(&output);
        assert!(said.contains("a value is required for") && said.contains(option), "{said}");
    }
}

/// clap's own suggestion names the new option where it is similar; no old name is an alias.
#[test]
fn old_options_are_refused() {
    for line in [
        "run --path a",
        "run --tolerance 1",
        "haptic --most-force 1",
        "haptic --awake 1",
        "haptic --seconds 1",
        "sweep --out a",
        "sweep --niceness 1",
        "map --to a",
        "map --by niceness",
        "path --to a",
        "path --planes 1,0,0",
        "path --step 1",
        "verify --allow-distant",
        "sample --tolerance 1",
    ] {
        let output = touchoff(&line.split(' ').collect::<Vec<_>>());
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("unexpected argument '--"), "{line}: {said}");
    }
}

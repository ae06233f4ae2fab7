//! Outputs that cannot be written, or must not be.

use crate::bench::{Bench, TOOL, stderr, touchoff};
use std::fs;
use std::io;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Instant;

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
fn into(out: impl Into<Stdio>, bench: &Bench, line: &str) -> (Option<i32>, String) {
    let mut command = bench.command(line);
    let output = command.stdout(out).stderr(Stdio::piped()).output().expect("the program runs");
    (output.status.code(), stderr(&output))
}

/// Returns a pipe whose reader is closed.
fn closed() -> io::PipeWriter {
    let (reader, writer) = io::pipe().expect("a pipe");
    drop(reader);
    writer
}

/// Returns commands that write to standard output, and their exit statuses.
fn commands(bench: &Bench) -> [(&'static str, i32); 18] {
    bench.write("gouges.apt", GOUGES);
    bench.write("clear.apt", CLEAR);
    bench.write("good.tool", GOOD);
    bench.write("loose.tool", GOOD.replace("    ", " "));
    bench.write("warned.tool", GOOD.replace("profile", "param unused = 3; profile"));
    bench.write("bad.tool", "tool Bad { units mm; region r where d < 1 { depth: 1 - d; } }");
    [
        ("verify --part block.stl --unit mm --tool D2Ball --program gouges.apt", 1),
        ("verify --part block.stl --unit mm --tool D2Ball --program gouges.apt --json", 1),
        ("run --part block.stl --unit mm --tool D2Ball --program gouges.apt", 0),
        ("run --part block.stl --unit mm --tool D2Ball --program gouges.apt --json", 0),
        ("check good.tool bad.tool", 1),
        ("check good.tool", 0),
        ("check --json good.tool", 0),
        ("fmt --check loose.tool", 1),
        ("tools", 0),
        ("--help", 0),
        ("--version", 0),
        ("tools list --json good.tool", 0),
        ("expand good.tool", 0),
        ("expand --stage plan good.tool", 0),
        ("draw good.tool", 0),
        ("sweep --part block.stl --unit mm --tool D2Ball --directions 4", 0),
        ("haptic --part block.stl --unit mm --tool D2Ball --duration 0.01", 0),
        ("haptic --part block.stl --unit mm --tool D2Ball --duration 0.01 --json", 0),
    ]
}

#[test]
fn the_status_does_not_depend_on_the_reader() {
    let bench = Bench::new();
    for (line, status) in commands(&bench) {
        let (code, said) = into(closed(), &bench, line);
        assert_eq!(code, Some(status), "{line}: {said}");
        assert!(!said.contains("panicked") && !said.contains("could not be written"), "{said}");
    }
    let verify = |program: &str| {
        let inputs = format!("--part block.stl --unit mm --tool D2Ball --program {program}");
        into(closed(), &bench, &format!("verify {inputs}")).0
    };
    assert_eq!((verify("clear.apt"), verify("nowhere.apt")), (Some(0), Some(2)));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_under_standard_output_is_an_error() {
    let bench = Bench::new();
    let full = || fs::OpenOptions::new().write(true).open("/dev/full").expect("a device");
    for (line, _) in commands(&bench) {
        let (code, said) = into(full(), &bench, line);
        let status = if line.starts_with("verify") { 2 } else { 1 };
        assert_eq!(code, Some(status), "{line}: {said}");
        let bad_tool = line == "check good.tool bad.tool";
        assert!(
            bad_tool || said.contains("standard output could not be written"),
            "{line}: {said}"
        );
    }
}

/// Runs the program with room for no byte in any file.
#[cfg(target_os = "linux")]
fn without_room(bench: &Bench, line: &str) -> Output {
    // The signal that would end the program is ignored, so that writing fails as on a full disk.
    let script = "trap '' XFSZ; ulimit -f 0; exec \"$@\"";
    let mut shell = Command::new("sh");
    shell.args(["-c", script, "sh", env!("CARGO_BIN_EXE_touchoff")]).args(line.split(' '));
    shell.current_dir(&bench.folder).output().expect("a shell")
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

/// Sweeps the block into the map `block.postures`.
fn swept(bench: &Bench) {
    let inputs = "--part block.stl --unit mm --tool D2Ball --directions 30 --tolerance 0.05";
    let output = bench.touchoff(&format!("sweep {inputs} --output block.postures"));
    assert!(output.status.success(), "{}", stderr(&output));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_old_files_and_no_others() {
    let bench = Bench::new();
    swept(&bench);
    bench.write("good.tool", GOOD);
    bench.write("loose.tool", GOOD.replace("    ", " ") + &"// a comment\n".repeat(400));
    for name in ["o.csv", "o.json", "o.ply", "o.png", "o.svg", "o.touchoff", "o.apt"] {
        bench.write(name, "old");
    }
    let before = || content(bench.folder.path());
    let kept = before();
    for line in [
        "map block.postures -o o.csv",
        "map block.postures -o o.json",
        "map block.postures --part block.stl -o o.ply",
        "map block.postures --part block.stl -o o.png",
        "path block.postures --part block.stl --tool D2Ball --stepover 0.3 -o o.apt",
        "path block.postures --part block.stl --tool D2Ball --stepover 0.3 -o o.csv",
        "draw good.tool -o o.svg",
        "draw good.tool -o o.png",
        "sample --part block.stl --unit mm -o o.touchoff",
        "fmt loose.tool",
        "haptic --part block.stl --unit mm --tool D2Ball --duration 0.2 --record o.csv",
    ] {
        let output = without_room(&bench, line);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{line}: {said}");
        assert!(said.contains("File too large") && said.contains("error: "), "{line}: {said}");
        // The recorded part is kept.
        if line.contains("--record") {
            fs::remove_file(bench.place("o.csv.part")).expect("a part");
        }
        assert!(before() == kept, "{line}: something is changed or left");
    }
    // A link to a device is followed, and the device written to.
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("/dev/full", bench.place("full.svg")).expect("a link");
        let output = bench.touchoff("draw good.tool -o full.svg");
        assert_eq!(output.status.code(), Some(1));
        assert!(stderr(&output).contains("No space left"), "{}", stderr(&output));
    }
}

#[test]
fn an_output_that_is_an_input_is_refused() {
    let bench = Bench::new();
    swept(&bench);
    bench.write("good.tool", GOOD);
    bench.write("tool.svg", GOOD);
    for (file, link) in [
        ("block.postures", "y.csv"),
        ("block.stl", "part.csv"),
        ("good.tool", "tool.csv"),
        ("block.stl", "s.touchoff"),
    ] {
        fs::hard_link(bench.place(file), bench.place(link)).expect("a link");
    }
    let mounting = "tool Mounting { units mm; mount \"tool.svg\" as c; }";
    bench.write("mounting.tool", mounting);
    bench.write("mounting", mounting);
    let kept = content(bench.folder.path());
    for line in [
        "draw mounting.tool -o tool.svg",
        "draw mounting -o tool.svg",
        "expand good.tool mounting -o tool.svg",
        "map block.postures -o y.csv",
        "map block.postures --part block.stl -o part.csv",
        "path block.postures --part block.stl --tool D2Ball --stepover 1 -o y.csv",
        "path block.postures --part block.stl --tool D2Ball --stepover 1 -o part.csv",
        "path block.postures --part block.stl --tool good.tool --stepover 1 -o tool.csv",
        "draw tool.svg -o tool.svg",
        "sample --part block.stl --unit mm -o s.touchoff",
        "sweep --part block.stl --unit mm --tool D2Ball --output block.stl",
        "haptic --part block.stl --unit mm --tool D2Ball --device playback --program path.csv --record path.csv",
        "haptic --part block.stl --unit mm --tool D2Ball --postures block.postures --record y.csv",
    ] {
        let output = bench.touchoff(line);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{line}: {said}");
        let is_said = said.contains("is also an input") || said.contains("for two outputs");
        assert!(is_said, "{line}: {said}");
        assert!(output.stdout.is_empty() && content(bench.folder.path()) == kept, "{line}");
    }
}

/// Neither what options name nor what a job names may be an input, or another output: not through links, and not what an input
/// lists.
#[test]
fn outputs_of_a_job_are_no_inputs() {
    let bench = Bench::new();
    for folder in ["tools", "Bit"] {
        fs::create_dir(bench.place(folder)).expect("a folder");
    }
    bench.write("tools/T1.tool", TOOL);
    let holder = "tool Holder { units mm; profile { start (0, 0); line to (9, 0), (9, 20), (0, 20) as holder; } }";
    bench.write("holder.tool", holder);
    bench.write("cutter.tool", TOOL);
    let mounting = "tool Mounted { units mm; mount \"cutter.tool\" as cutter; mount \"holder.tool\" as holder at z = 15; }";
    bench.write("mounting.tool", mounting);
    bench.write("library.fctl", r#"{"tools": [{"nr": 1, "path": "Ball.fctb"}]}"#);
    let bit = r#"{"shape": "ballend.fcstd", "name": "Ball", "parameter": {"Diameter": "4 mm", "Length": "20 mm",
        "CuttingEdgeHeight": "10 mm", "ShankDiameter": "4 mm"}}"#;
    bench.write("Bit/Ball.fctb", bit);
    bench.write("a.csv", "UNITS/MM\nLOADTL/1\nGOTO/0,0,3,0,0,1\nGOTO/1,0,3,0,0,1\nFINI\n");
    let job = |tools: &str, more: &str| {
        let text = format!(
            "part = \"block.stl\"\nunit = \"mm\"\nprogram = \"a.csv\"\n{tools}\n[stock]\nbox = [[-3, -3, -2], [3, 3, 1]]\n\
             spacing = 1\n{more}\n"
        );
        bench.write("job.toml", text);
    };
    let [built_in, mounting, folder, library] = [
        "[tool.1]\ntool = \"D2Ball\"",
        "[tool.1]\ntool = \"mounting.tool\"",
        "tools = \"tools\"",
        "tools = \"library.fctl\"",
    ];
    #[cfg(unix)]
    std::os::unix::fs::symlink("a.csv", bench.place("link.sarif")).expect("a link");
    fs::hard_link(bench.place("block.stl"), bench.place("same.stl")).expect("a link");
    let (plain, said) = ("verify job.toml", "is also an input");
    for (tools, more, line, said) in [
        (built_in, "", "verify job.toml --sarif a.csv", said),
        (built_in, "", "verify job.toml --sarif block.stl", said),
        (built_in, "", "verify job.toml --sarif ./job.toml", said),
        #[cfg(unix)]
        (built_in, "", "verify job.toml --sarif link.sarif", said),
        (built_in, "output = \"block.stl\"", plain, said),
        (built_in, "output = \"same.stl\"", plain, said),
        (built_in, "map = \"a.csv\"", plain, said),
        (built_in, "map = \"a.csv\"", "report job.toml -o report.html", said),
        (built_in, "map = \"rest.csv\"", "verify job.toml --sarif rest.csv", "two outputs"),
        (
            built_in,
            "map = \"rest.csv\"",
            "verify job.toml --sarif tools/../rest.csv",
            "two outputs",
        ),
        (built_in, "", "export T1 --tools library.fctl -o Bit/Ball.fctb", said),
        (
            built_in,
            "",
            "haptic --part block.stl --unit mm --tool D2Ball --record r --postures ./r",
            "two outputs",
        ),
        (mounting, "", "verify job.toml --sarif holder.tool", said),
        (folder, "", "verify job.toml --sarif tools/T1.tool", said),
        (library, "", "verify job.toml --sarif Bit/Ball.fctb", said),
    ] {
        job(tools, more);
        let kept = content(bench.folder.path());
        let output = bench.touchoff(line);
        assert_eq!(output.status.code(), Some(2), "{line}, {more}: {}", stderr(&output));
        assert!(stderr(&output).contains(said), "{line}, {more}: {}", stderr(&output));
        assert!(content(bench.folder.path()) == kept, "{line}, {more}");
    }
    // Without such outputs all that was read is in the report.
    job(folder, "");
    bench.write("tools/notes.txt", "no tool");
    let output = bench.touchoff("report job.toml -o report.html");
    let page = fs::read_to_string(bench.place("report.html"))
        .unwrap_or_else(|_| panic!("{}", stderr(&output)));
    assert!(page.contains("tools/T1.tool") && !page.contains("notes.txt"));
    // The rest of the stock after a program that was not verified is not written.
    job(built_in, "output = \"rest.stl\"");
    let output = bench.touchoff(plain);
    assert!(stderr(&output).contains("not verified: "), "{}", stderr(&output));
    assert!(stderr(&output).contains("not written: rest.stl"), "{}", stderr(&output));
    assert!(!Path::new(&bench.place("rest.stl")).exists(), "{}", stderr(&output));
}

/// Tools of a folder end in `.tool`, so that what they mount is known before anything is written.
#[test]
fn outputs_are_no_inputs_of_a_folder_of_tools() {
    let bench = Bench::new();
    for folder in ["tools", "tools/sub"] {
        fs::create_dir(bench.place(folder)).expect("a folder");
    }
    bench.write("holder.stl", TOOL);
    let mounting = "tool Mounting { units mm; mount \"../holder.stl\" as c; }";
    for file in ["tools/T1", "tools/holder.txt", "tools/sub/x.tool"] {
        bench.write(file, mounting);
    }
    bench.write("a.csv", "UNITS/MM\nLOADTL/1\nGOTO/0,0,3,0,0,1\nGOTO/1,0,3,0,0,1\nFINI\n");
    bench.write(
        "job.toml",
        "part = \"block.stl\"\nunit = \"mm\"\nprogram = \"a.csv\"\ntools = \"tools\"\n[stock]\n\
         box = [[-3, -3, -2], [3, 3, 1]]\nspacing = 1\noutput = \"holder.stl\"\n",
    );
    let inputs = "verify --part block.stl --unit mm --program a.csv --tools tools";
    for (line, written) in [
        ("verify job.toml", "holder.stl"),
        (&*format!("{inputs} --tool T1 --sarif tools/T1"), "tools/T1"),
        (&format!("{inputs} --tool holder.txt --sarif tools/holder.txt"), "tools/holder.txt"),
        (&format!("{inputs} --tool sub/x.tool --sarif tools/sub/x.tool"), "tools/sub/x.tool"),
    ] {
        let kept = fs::read(bench.place(written)).expect("a file");
        let output = bench.touchoff(line);
        assert!(!output.status.success(), "{line}: {}", stderr(&output));
        assert!(fs::read(bench.place(written)).expect("a file") == kept, "{line}");
    }
}

/// A command ends in time, and when there is no memory, with a status of its own.
#[test]
fn a_command_ends_when_time_or_memory_is_used_up() {
    let bench = Bench::new();
    let line =
        "sample --part block.stl --unit mm --sampling random --points 100000000 -o points.touchoff";
    let output = bench.touchoff(&format!("{line} --max-time 0.2"));
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("--max-time"), "{}", stderr(&output));
    assert!(!Path::new(&bench.place("points.touchoff")).exists());
    // A command that is done when its time is up ends in one way or the other.
    let begin = Instant::now();
    let line_of_run = "run --part block.stl --unit mm --tool D2Ball --program path.csv";
    assert!(bench.touchoff(line_of_run).status.success());
    let all = begin.elapsed();
    for fortieth in 30..50 {
        let time = (all * fortieth / 40).as_secs_f64();
        let output = bench.touchoff(&format!("{line_of_run} --max-time {time}"));
        let is_late = stderr(&output).contains("--max-time");
        let status = if is_late { 2 } else { 0 };
        assert_eq!(output.status.code(), Some(status), "{}", stderr(&output));
    }
    #[cfg(target_os = "linux")]
    {
        // No memory holds such a stack.
        let mut refused = bench.command("tools list --max-time 9");
        let output = refused.env("RUST_MIN_STACK", (1u64 << 50).to_string()).output();
        let output = output.expect("the program runs");
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert!(stderr(&output).contains("refuses a thread"), "{}", stderr(&output));
        let limited = format!("ulimit -v 1000000; exec \"$0\" {line}");
        let mut shell = std::process::Command::new("bash");
        shell.args(["-c", &limited, env!("CARGO_BIN_EXE_touchoff")]).current_dir(&bench.folder);
        let output = shell.output().expect("bash");
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert!(stderr(&output).contains("no more memory"), "{}", stderr(&output));
        // The backtrace of a thread that is refused needs memory itself.
        let limited = "ulimit -d 3500; exec \"$0\" verify --part block.stl --unit mm --tool D2Ball --program path.csv";
        let mut shell = std::process::Command::new("bash");
        shell.args(["-c", limited, env!("CARGO_BIN_EXE_touchoff")]).current_dir(&bench.folder);
        let output = shell.env("RUST_BACKTRACE", "1").output().expect("bash");
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    }
}

#[test]
fn a_program_that_is_cut_short_is_refused() {
    let bench = Bench::new();
    swept(&bench);
    let line = "path block.postures --part block.stl --tool D2Ball --stepover 1 -o led.csv";
    assert!(bench.touchoff(line).status.success());
    let run = |name: &str| bench.run("block.stl", name, "D2Ball", &[]);
    assert!(run("led.csv").status.success());
    let whole = fs::read_to_string(bench.place("led.csv")).expect("a program");
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
    bench.write("clear.apt", CLEAR);
    let block = "--part block.stl --unit mm --tool D2Ball";
    let [length, length_above, above] =
        ["finite length of 0 or more", "finite length above 0", "finite number above 0"];
    for (command, option, remedy) in [
        ("verify --program clear.apt", "--tolerance", length),
        ("verify --program clear.apt", "--resolution", length),
        ("run --program clear.apt", "--sampling-error", length_above),
        ("run --program clear.apt", "--certify", length),
        ("run --program clear.apt", "--points", ""),
        ("run --program clear.apt", "--seed", ""),
        ("haptic", "--rate", "a rate of 1 to 100000"),
        ("haptic", "--duration", above),
        ("haptic", "--stiffness", above),
        ("haptic", "--device-stiffness", above),
        ("haptic", "--max-force", above),
        ("haptic", "--core", ""),
        ("haptic", "--spin", ""),
        ("sweep", "--tolerance", length_above),
        ("sweep", "--directions", ""),
        ("sweep", "--keep", ""),
        ("path block.postures -o a.csv", "--tolerance", length_above),
        ("path block.postures -o a.csv", "--stepover", length_above),
        ("path block.postures -o a.csv", "--forward-step", length_above),
    ] {
        let inputs =
            if command.starts_with("path") { "--part block.stl --tool D2Ball" } else { block };
        for value in ["-0.01", "-5", "-.5", "-1e-3"] {
            let output = bench.touchoff(&format!("{command} {inputs} {option} {value}"));
            let said = stderr(&output);
            assert_eq!(output.status.code(), Some(2), "{option} {value}: {said}");
            assert!(said.contains(&format!("invalid value '{value}'")), "{option}: {said}");
            assert!(said.contains(remedy), "{option} {value}: {said}");
        }
    }
    let allowed = bench.touchoff(&format!("verify --program clear.apt {block} --allow shank=-0.5"));
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

//! `touchoff haptic` from the user's side.

use crate::bench::{Bench, cuboid, rows, stderr, stdout};
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};

fn haptic(bench: &Bench, more: &str) -> Output {
    let inputs = "--part block.stl --unit mm --tool D2Ball --points 5000";
    bench.touchoff(&format!("haptic {inputs} --duration 0.5 {more}"))
}

#[test]
fn a_program_is_played_and_recorded() {
    let bench = Bench::new();
    let played = || {
        let arguments = "--device playback --program path.csv --record record.csv --json";
        rows(&haptic(&bench, arguments)).swap_remove(0)
    };
    let skipped = |said: &serde_json::Value| said["skipped_cycles"].as_u64().expect("a number");
    // A machine with other work may stop the loop for so long that most of the program is not played.
    let mut said = played();
    for _ in 0..10 {
        if skipped(&said) < 100 {
            break;
        }
        said = played();
    }
    let count = |key: &str| said[key].as_u64().unwrap_or_else(|| panic!("{key} in {said}"));
    assert!(count("cycles") + count("skipped_cycles") >= 500 && count("cycles") > 100, "{said}");
    assert_eq!((count("dropped_states"), count("stalls")), (0, 0));
    assert!(said["peak_force"].as_f64().is_some_and(|force| force > 0.01), "{said}");
    assert!(count("cycles") >= 1 && said["cycle_time_ns"]["p50"].as_u64().is_some_and(|ns| ns > 0));

    let record = std::fs::read_to_string(bench.place("record.csv")).expect("a record");
    let mut lines = record.lines();
    let columns = lines.next().expect("a head").split(',').count();
    assert_eq!(columns, 24);
    let mut states = 0;
    for line in lines {
        let numbers = line.split(',').map(|cell| cell.parse::<f64>().expect("a number"));
        assert_eq!(numbers.filter(|number| number.is_finite()).count(), columns);
        states += 1;
    }
    assert_eq!(states, count("cycles"));
}

#[test]
fn a_session_of_the_hand_is_summarised() {
    let bench = Bench::new();
    let output = haptic(&bench, "--rate 500");
    assert!(output.status.success(), "{}", stderr(&output));
    for word in ["cycles at 500 Hz", "cycle time, µs", "energy", "law gradient"] {
        assert!(stdout(&output).contains(word), "{}", stdout(&output));
    }
}

/// Returns the lowest height of the tip, and the place of the tip at the last state, from a record.
fn recorded(bench: &Bench) -> (f64, [f64; 3]) {
    let record = std::fs::read_to_string(bench.place("record.csv")).expect("a record");
    let mut lines = record.lines();
    let names: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let columns = ["tool_x", "tool_y", "tool_z"]
        .map(|name| names.iter().position(|known| *known == name).expect(&record[..200]));
    let tips: Vec<[f64; 3]> = lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            columns.map(|column| cells[column].parse().expect("a number"))
        })
        .collect();
    (tips.iter().map(|tip| tip[2]).fold(f64::INFINITY, f64::min), *tips.last().expect("states"))
}

/// A sheet has its highest points at its edges, too: the hand presses its middle and stays on it.
#[test]
fn the_hand_stays_on_a_flat_part() {
    let bench = Bench::new();
    bench.part("sheet.stl", &cuboid([-15.0, -15.0, -0.3], [15.0, 15.0, 0.0]));
    let line = "haptic --part sheet.stl --unit mm --tool D2Ball --points 60000 --duration 4 --record record.csv --json";
    let said = rows(&bench.touchoff(line)).swap_remove(0);
    let (lowest, [x, y, _]) = recorded(&bench);
    assert!(lowest > -0.15 && x.hypot(y) < 3.0, "{lowest} {x} {y}");
    // The largest force is that of `--press`, but for the tremor and the damper.
    let peak = said["peak_force"].as_f64().expect("a force");
    assert!((0.3..0.9).contains(&peak), "{said}");
    assert!(said["stiffness"].as_f64().is_some_and(|stiffness| stiffness > 100.0), "{said}");
    let reason = said["stiffness_reason"].as_str().expect("a sentence");
    assert!(reason.contains("a quarter of the part's thickness of 0.3000 mm at ("), "{reason}");
}

#[test]
fn place_path_and_force_of_the_hand_are_options() {
    let bench = Bench::new();
    let output = haptic(&bench, "--at 1,2,0 --circle 0 --press 2 --rate 500 --record record.csv");
    assert!(output.status.success(), "{}", stderr(&output));
    let (_, [x, y, z]) = recorded(&bench);
    assert!((x - 1.0).abs() < 0.2 && (y - 2.0).abs() < 0.2 && z < 2.0, "{x} {y} {z}");
    // Along a path on the block's top, pressed into it.
    bench.write("along.csv", "-2,0,0,0,0,1\n2,0,0,0,0,1\n");
    let line = "haptic --part block.stl --unit mm --tool D2Ball --points 20000 --duration 2 --program along.csv --press 1";
    let output = bench.touchoff(&format!("{line} --record record.csv --json"));
    let said = rows(&output).swap_remove(0);
    assert!(said["peak_force"].as_f64().is_some_and(|force| force > 0.5), "{said}");
    let (lowest, [x, ..]) = recorded(&bench);
    assert!(x > 1.0 && lowest > -0.5, "{x} {lowest}");
}

/// The report and the messages say which stiffness is in use, and what may happen with it.
#[test]
fn the_stiffness_is_stated_with_its_reason() {
    let bench = Bench::new();
    let derived = haptic(&bench, "--rate 500");
    assert!(
        stdout(&derived)
            .contains("N/mm³, derived from tool and part: the device's 8 N press the tool")
    );
    let given = haptic(&bench, "--rate 500 --stiffness 1");
    assert!(stdout(&given).contains("1.00 N/mm³, as given"), "{}", stdout(&given));
    bench.part("sheet.stl", &cuboid([-3.0, -3.0, -0.3], [3.0, 3.0, 0.0]));
    let line = "haptic --part sheet.stl --unit mm --tool D2Ball --points 5000 --duration 0.1 --stiffness 1";
    let soft = stderr(&bench.touchoff(line));
    assert!(
        soft.contains("the part is 0.3000 mm thin at (") && soft.contains("may break through"),
        "{soft}"
    );
}

/// A limit on the size of files stands for a full disk.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported_at_once() {
    use std::io::{BufRead, BufReader};
    use std::process::Command;
    let bench = Bench::new();
    let table = bench.write("record.csv", "old");
    let script = "trap '' XFSZ; ulimit -f 40; exec \"$@\"";
    let mut child = Command::new("sh")
        .args(["-c", script, "sh", env!("CARGO_BIN_EXE_touchoff")])
        .args(["haptic", "--part", &bench.place("block.stl"), "--unit", "mm", "--tool", "D2Ball"])
        .args(["--points", "2000", "--duration", "3", "--record", &table])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("a shell");
    let lines = BufReader::new(child.stderr.take().expect("a pipe")).lines();
    let lines: Vec<String> = lines.map_while(Result::ok).collect();
    let told = lines.iter().position(|line| line.contains("the recording of states stops here"));
    let told = told.unwrap_or_else(|| panic!("{lines:?}"));
    assert!(lines[told].contains("record.csv") && lines[told].contains("File too large"));
    // The loop goes on, and still shows its state.
    assert!(lines[told..].iter().any(|line| line.contains("  tip ")), "{lines:?}");
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(1), "{lines:?}");
    assert!(stdout(&output).contains("cycles at 1000 Hz"), "{}", stdout(&output));
    assert!(lines.last().is_some_and(|line| line.contains("the recording is incomplete")));
    assert_eq!(std::fs::read_to_string(&table).expect("a file"), "old");
    let names = std::fs::read_dir(bench.folder.path()).expect("a folder").count();
    assert_eq!(names, 4, "something is left behind");
    // The recorded part is kept.
    let part = std::fs::read_to_string(table + ".part").expect("a part");
    assert!(part.starts_with("cycle,time_s") && part.lines().count() > 10);
}

/// Records of a killed session stay, whatever is written beside them later.
#[cfg(target_os = "linux")]
#[test]
fn a_killed_recording_is_kept() {
    let bench = Bench::new();
    let line = "haptic --part block.stl --unit mm --tool D2Ball --points 2000 --duration 60 --record r.csv";
    let mut child =
        bench.command(line).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it runs");
    let part = bench.place("r.csv.part");
    let lines = || std::fs::read_to_string(&part).map_or(0, |text| text.lines().count());
    let deadline = Instant::now() + Duration::from_secs(60);
    while lines() < 100 {
        assert!(Instant::now() < deadline, "nothing is recorded");
        std::thread::sleep(Duration::from_millis(20));
    }
    child.kill().expect("killed");
    child.wait().expect("it ended");
    let kept = std::fs::read_to_string(&part).expect("the part");
    let again = haptic(&bench, "--record r.csv");
    assert_eq!(again.status.code(), Some(1), "{}", stderr(&again));
    assert!(stderr(&again).contains("r.csv.part is there already"), "{}", stderr(&again));
    assert!(haptic(&bench, "--record other.csv").status.success());
    assert!(bench.touchoff("tools show D2Ball -o d2.tool").status.success());
    assert_eq!(std::fs::read_to_string(&part).expect("the part"), kept);
}

#[test]
fn missing_cores_are_refused_with_a_list_of_others() {
    let bench = Bench::new();
    for core in ["1024", "18446744073709551615"] {
        let output = haptic(&bench, &format!("--core {core}"));
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        let words = format!("not kept on core {core}: this process may run on core ");
        assert!(stderr(&output).contains(&words), "{}", stderr(&output));
    }
}

#[test]
fn invalid_devices_are_refused() {
    let bench = Bench::new();
    for (more, status, words) in [
        ("--device glove", 2, "[possible values: hand, playback, spacenav]"),
        ("--device playback", 2, "--program <FILE>"),
        ("--device spacenav --program path.csv", 2, "`--device playback`"),
        ("--program path.csv --at 0,0,0", 2, "--at"),
        ("--press 9", 2, "`--max-force`"),
        ("--at 0,0", 2, "three numbers"),
        ("--device playback --program nowhere.csv", 2, "nowhere.csv"),
        ("--record no/record.csv", 1, "record.csv"),
    ] {
        let output = haptic(&bench, more);
        assert_eq!(output.status.code(), Some(status), "{more}");
        assert!(stderr(&output).contains(words), "{}", stderr(&output));
    }
    for wrong in
        ["--rate 0", "--rate 1e9", "--stiffness -1", "--duration NaN", "--press 0", "--circle -1"]
    {
        assert_eq!(haptic(&bench, wrong).status.code(), Some(2), "{wrong}");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_session_keeps_its_recording() {
    use std::io::{BufRead, BufReader};
    use std::process::Command;
    let bench = Bench::new();
    let inputs = "--part block.stl --unit mm --tool D2Ball --points 2000";
    let line = format!("haptic {inputs} --duration 600 --record record.csv");
    let table = bench.place("record.csv");
    for signal in ["INT", "TERM"] {
        let mut child = bench
            .command(&line)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program runs");
        let mut lines = BufReader::new(child.stderr.take().expect("a pipe")).lines();
        // The session runs once it shows its state.
        let shown = lines.by_ref().map_while(Result::ok).find(|line| line.contains("  tip "));
        assert!(shown.is_some());
        let sent =
            Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status();
        assert!(sent.expect("a shell's kill").success());
        let last = lines.map_while(Result::ok).last().expect("a line");
        assert!(last.contains("interrupted"), "{last}");
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(130));
        assert!(stdout(&output).contains("cycles at 1000 Hz"), "{}", stdout(&output));
        let record = std::fs::read_to_string(&table).expect("a record");
        assert!(record.lines().count() > 1 && record.ends_with('\n'), "{signal}: {record}");
        std::fs::remove_file(&table).expect("a record");
    }
}

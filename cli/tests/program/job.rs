//! Job files: G-code on a machine, with several tools, fixtures and stock.

use crate::bench::{Bench, cuboid, findings, objects, stderr, stdout, touchoff};
use crate::help::page_commands;
use std::process::Output;
use touchoff::Mesh;
use touchoff::Unit;
use touchoff_verify::gcode::{Choice, ControlRules, Rule};

/// A posted program: it faces the bracket, mills its ends, and runs a ball along an edge, tilted by 80 degrees.
const PROGRAM: &str = "%
O1000 (BRACKET)
N10 G21 G90 G17 G40 G49 G80
N20 G54
(FACE)
N30 T1 M6
N40 S3000 M3
N50 G0 A0. C0.
N60 X-55. Y-10.
N70 G43 H1 Z50. M8
N80 Z5.
N90 G1 Z0. F800.
N100 X55.
N110 G0 Z5.
N120 X-55. Y10.
N130 G1 Z0.
N140 X55.
N150 G0 Z50.
N160 G91 G28 Z0.
N170 G90
(ENDS)
N200 T3 M6
N210 S6000 M3
N220 G0 X35. Y-30.
N230 G43 H3 Z50.
N240 G0 Z2.
N250 G1 Z-9. F600.
N260 Y15.
N270 G0 Z50.
N280 X-35. Y-30.
N290 Z2.
N300 G1 Z-9.
N310 Y15.
N320 G0 Z50.
N330 G91 G28 Z0.
N340 G90
(EDGE)
N400 T2 M6
N410 S9000 M3
N420 G43 H2 G0 X-30. Y40. A-80. C0.
N430 M428
N440 X-40. Y40. Z60.
N450 G0 Z30.
N460 Y19.2 Z1.62
N470 G1 X40. F1000.
N480 G0 Y40. Z40.
N490 M429
N500 G91 G28 Z0.
N510 G90
N520 M30
%
";

/// A ball end mill in a nut, whose stick-out is a param.
const BALL: &str = "tool Ball6 \"6 mm ball end mill in a nut\" { units mm; param stickout = 35; profile { start (0, 0); \
                    arc to (3, 3) center (0, 3) as ball cutting; line to (3, 12) as flute cutting; line to (3, \
                    stickout) as shank; line to (16, stickout), (16, stickout + 30), (0, stickout + 30) as nut; } \
                    niceness cutting: 1; }";

/// Returns an end mill of a diameter.
fn end_mill(name: &str, diameter: f64) -> String {
    let radius = diameter / 2.0;
    format!(
        "tool {name} \"{diameter} mm end mill\" {{ units mm; profile {{ start (0, 0); line to ({radius}, 0) as face cutting; \
         line to ({radius}, 22) as flute cutting; line to ({radius}, 60), (0, 60) as shank; }} niceness cutting: 1; }}"
    )
}

/// Returns meshes as one.
fn joined(meshes: &[Mesh]) -> Mesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for mesh in meshes {
        let first = u32::try_from(vertices.len()).expect("few vertices");
        vertices.extend_from_slice(mesh.vertices());
        triangles.extend(mesh.triangles().iter().map(|triangle| triangle.map(|k| first + k)));
    }
    Mesh::new(vertices, triangles, Unit::Millimetre).expect("a mesh")
}

/// Returns the file of LinuxCNC with rotary axes that turn as ISO 841 states.
pub(super) fn linuxcnc() -> String {
    let rules = ControlRules::named("linuxcnc").expect("a control");
    let rules = rules.with(Rule::RotaryDirection, Choice::Iso841);
    rules.with(Rule::HeadLength, Choice::Compensated).to_toml()
}

/// Returns the job of docs/verify.md, and a folder with its files.
pub(super) fn bracket() -> (Bench, String) {
    let bench = Bench::new();
    bench.part("bracket.stl", &cuboid([-30.0, -20.0, -30.0], [30.0, 20.0, 0.0]));
    let jaws = [
        cuboid([-40.0, 20.0, -40.0], [40.0, 50.0, -10.0]),
        cuboid([-40.0, -50.0, -40.0], [40.0, -20.0, -10.0]),
    ];
    bench.part("vise.stl", &joined(&jaws));
    bench.write("bracket.nc", PROGRAM);
    bench.write("mill.toml", linuxcnc());
    bench.write("face40.tool", end_mill("Face40", 40.0));
    bench.write("ball6.tool", BALL);
    bench.write("mill10.tool", end_mill("Mill10", 10.0));
    let page = include_str!("../../../docs/verify.md");
    let (_, job) = page.split_once("```toml\n# bracket.toml\n").expect("the job of the page");
    let (job, _) = job.split_once("```").expect("its end");
    (bench, job.to_owned())
}

fn job(bench: &Bench, text: &str, more: &[&str]) -> Output {
    let file = bench.write("bracket.toml", text);
    touchoff(&[&["verify", &file][..], more].concat())
}

/// The walk of docs/verify.md: a nut that touches the vise, then a longer stick-out.
#[test]
fn the_job_of_the_page_becomes_clean() {
    let (bench, text) = bracket();
    bench.write("bracket.toml", &text);
    let outputs = page_commands(&bench, include_str!("../../../docs/verify.md"));
    for (command, output) in &outputs {
        assert_eq!(output.status.code(), Some(1), "{command}: {}", stderr(output));
    }
    let count = outputs.len();
    assert!(count >= 3, "{count} commands");
    let printed = stdout(&outputs[0].1);
    assert!(
        include_str!("../../../docs/verify.md").contains(&format!("```text\n{printed}```")),
        "the page has other findings than\n{printed}"
    );
    let found = findings(&job(&bench, &text, &["--json"]));
    assert!(found.iter().any(|row| {
        row["tool_number"] == 2 && row["surface"] == "nut" && row["body"] == "the vise"
    }));
    assert!(found.iter().all(|row| row["tool_number"] == 2), "{found:?}");
    let sarif = std::fs::read(bench.folder.path().join("bracket.sarif")).expect("the log");
    let sarif: serde_json::Value = serde_json::from_slice(&sarif).expect("JSON");
    assert_eq!(sarif["version"], "2.1.0");
    let results = sarif["runs"][0]["results"].as_array().expect("results");
    assert_eq!(results.len(), found.len());
    let clean = job(&bench, &text.replace("stickout = 20", "stickout = 35"), &["-v"]);
    assert_eq!(clean.status.code(), Some(0), "{}{}", stdout(&clean), stderr(&clean));
    assert!(stderr(&clean).contains("T2 at the vise: no findings"), "{}", stderr(&clean));
}

/// Hands, holders and origins that a library states are those of a job; JSON and SARIF say why there is no verdict, and of which job.
#[test]
fn a_job_knows_what_its_library_states() {
    let bench = Bench::new();
    bench.part("part.stl", &cuboid([-30.0, -20.0, -30.0], [30.0, 20.0, 0.0]));
    let program = "G21 G90 G17 G94 G61 G54\nT1 M6\nS3000 M3\nG0 X-50 Y0\nG43 H1 Z5\nG1 X50 F600\nG0 Z50\nM5\nM2\n";
    bench.write("m3.nc", program);
    bench.write("m4.nc", program.replace("M3\n", "M4\n"));
    let tapped = program.replace("G1 X50 F600", "X0\nG84 Z2 R5 F300\nG80");
    bench.write("g84.nc", &tapped);
    bench.write("g74.nc", tapped.replace("M3\n", "M4\n").replace("G84", "G74"));
    let tool = |more: &str| {
        format!(
            "{{\"data\": [{{\"type\": \"flat end mill\", \"unit\": \"millimeters\", \"description\": \"mill\", \"geometry\": {{\"DC\": 10, \
             \"LCF\": 20, \"LB\": 40, \"OAL\": 70, \"SFDM\": 10{more}, \"post-process\": {{\"number\": 1}}}}], \"version\": 2}}"
        )
    };
    bench.write("right.json", tool("}"));
    bench.write("left.json", tool(", \"HAND\": false}"));
    bench.write(
        "holder.json",
        tool("}, \"holder\": {\"description\": \"ER32\", \"unit\": \"millimeters\"}"),
    );
    let job = |program: &str, library: &str, tool: &str, more: &[&str]| {
        let control = if program.starts_with('g') { "fanuc" } else { "linuxcnc" };
        let text = format!(
            "part = \"part.stl\"\nunit = \"mm\"\nprogram = \"{program}\"\ncontrol = \"{control}\"\ntools = \"{library}\"\n{tool}"
        );
        let file = bench.write("job.toml", text);
        touchoff(&[&["verify", &file, "--anyway"][..], more].concat())
    };
    for (program, library, stated, status) in [
        ("m3.nc", "right.json", "", 0),
        ("m4.nc", "right.json", "", 1),
        ("m3.nc", "left.json", "", 1),
        ("m4.nc", "left.json", "", 0),
        // The job knows better than the library.
        ("m3.nc", "left.json", "[tool.1]\nhand = \"right\"", 0),
        ("g84.nc", "right.json", "", 0),
        ("g84.nc", "left.json", "", 1),
        ("g74.nc", "left.json", "", 0),
        // Without a statement a tap has the hand of its thread.
        ("g74.nc", "right.json", "", 0),
        ("g74.nc", "right.json", "[tool.1]\nhand = \"right\"", 1),
    ] {
        let output = job(program, library, stated, &[]);
        let said = format!("{program} {library} {stated}: {}{}", stdout(&output), stderr(&output));
        assert_eq!(output.status.code(), Some(status), "{said}");
        assert!(status == 0 || said.contains("V0106"), "{said}");
    }
    let file = bench.place("job.toml");
    job("m3.nc", "holder.json", "", &[]);
    let sarif = bench.place("job.sarif");
    let output = touchoff(&["verify", &file, "--json", "--sarif", &sarif]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    let open = |output: &Output| {
        let rows = objects(output).into_iter().filter(|row| row["open"] == true);
        rows.map(|row| row["code"].as_str().expect("a code").to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(open(&output), ["V0613"]);
    let log: serde_json::Value =
        serde_json::from_slice(&std::fs::read(&sarif).expect("the log")).expect("JSON");
    let run = &log["runs"][0];
    assert_eq!(run["automationDetails"]["id"], format!("touchoff/{file}/"));
    let notice = &run["invocations"][0]["toolExecutionNotifications"][0];
    assert_eq!(notice["descriptor"]["id"], "V0613");
    // A program that stays far from the part has a reason of the verdict alone.
    bench.write("far.nc", program.replace("Z5", "Z900").replace("Z50", "Z950"));
    job("far.nc", "right.json", "", &[]);
    let output = touchoff(&["verify", &file, "--json"]);
    assert_eq!((output.status.code(), open(&output)), (Some(2), vec!["V0203".to_owned()]));
}

/// Neither of the two commands that check a job writes what a stranger's asks for, if they are told so.
#[test]
fn a_job_that_is_only_read_writes_nothing() {
    let (bench, text) = bracket();
    bench.write("bracket.toml", text);
    let outputs = ["rest.stl", "rest.csv"].map(|file| bench.folder.path().join(file));
    for command in ["verify bracket.toml", "report bracket.toml -o report.html"] {
        let read_only = bench.touchoff(&format!("{command} --read-only"));
        assert_eq!(read_only.status.code(), Some(1), "{command}: {}", stderr(&read_only));
        assert!(!outputs.iter().any(|output| output.exists()), "{command}");
        assert_eq!(bench.touchoff(command).status.code(), Some(1), "{command}");
        for output in &outputs {
            std::fs::remove_file(output).expect("what the job asks for");
        }
    }
    // Without a job there is nothing to leave out.
    let options = "--unit mm --tool ball6.tool --program bracket.nc --read-only";
    for command in ["verify --part bracket.stl", "report bracket.stl -o report.html"] {
        let refused = bench.touchoff(&format!("{command} {options}"));
        assert_eq!(refused.status.code(), Some(2), "{command}: {}", stderr(&refused));
    }
}

/// Cutter locations of two tools: each tool is checked on its own positions, against its own cutter.
#[test]
fn cutter_locations_change_tools() {
    let (bench, _) = bracket();
    let program = |depth: f64| {
        format!(
            "UNITS/MM\nLOADTL/1\nCUTTER/40\nGOTO/-60,0,0\nGOTO/60,0,0\nCUTTER/10\nLOADTL/3\nGOTO/60,-35,-5\n\
             GOTO/-60,-35,{depth}\nLOADTL/1\nCUTTER/40\nGOTO/-60,0,1\nGOTO/60,0,1\nFINI\n"
        )
    };
    let text = "part = \"bracket.stl\"\nunit = \"mm\"\nprogram = \"two.apt\"\n[tool.1]\ntool = \"face40.tool\"\n\
                [tool.3]\ntool = \"mill10.tool\"\n[[fixture]]\nname = \"the vise\"\nmesh = \"vise.stl\"\n";
    bench.write("two.apt", program(-5.0));
    let clean = job(&bench, text, &[]);
    assert_eq!(clean.status.code(), Some(0), "{}{}", stdout(&clean), stderr(&clean));
    let said = stderr(&clean);
    assert!(said.contains(
        "2 motions to the first position after a tool change not checked, first to line 8"
    ));
    bench.write("two.apt", program(-12.0));
    let found = objects(&job(&bench, text, &["--json"]));
    let (gaps, found): (Vec<_>, Vec<_>) =
        found.iter().partition(|row| row["kind"] == "not-checked");
    assert!(!found.is_empty() && gaps.len() == 1 && gaps[0]["open"] == false, "{gaps:?}");
    for row in found {
        assert_eq!(
            (&row["tool_number"], &row["body"], &row["line"]),
            (&3.into(), &"the vise".into(), &9.into())
        );
    }
    let program = bench.write("two.apt", program(-12.0));
    let part = bench.place("bracket.stl");
    let options = ["--part", &part, "--unit", "mm", "--tool", "D2Ball", "--program", &program];
    for (command, expected) in [
        ("verify", "the program uses T1 and T3: give its tools by number in a job file"),
        ("run", "two.apt:6: another tool than that of line 3: give one program per tool"),
    ] {
        let one = touchoff(&[&[command][..], &options].concat());
        assert_eq!(one.status.code(), Some(2));
        assert!(stderr(&one).contains(expected), "{}", stderr(&one));
    }
    let other = job(&bench, &text.replace("mill10", "face40"), &[]);
    assert_eq!(other.status.code(), Some(2));
    assert!(stderr(&other).contains("two.apt:6: CUTTER/10 is not `Face40`"), "{}", stderr(&other));
}

/// An error names the entry of a job that is missing or wrong, or the file that cannot be read.
#[test]
fn a_wrong_job_is_refused() {
    let (bench, text) = bracket();
    for (from, to, start, word) in [
        (
            "tolerance = 0.02",
            "tolerances = 0.02",
            "error[J0201]: ",
            "line 6: unknown field `tolerances`",
        ),
        ("bracket.nc", "none.nc", "error[P0601]: ", "none.nc: cannot be read"),
        ("ball6.tool", "ball7.tool", "error: ", "ball7.tool"),
    ] {
        assert!(text.contains(from), "{from}");
        let output = job(&bench, &text.replace(from, to), &[]);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{to}: {said}");
        assert!(said.starts_with(start) && said.contains(word), "{to}: {said}");
    }
    let absent = touchoff(&["verify", "absent.toml"]);
    assert_eq!(absent.status.code(), Some(2), "{}", stderr(&absent));
}

/// G-code of one tool needs no job.
#[test]
fn g_code_runs_without_a_job() {
    let bench = Bench::new();
    bench.part("block.stl", &cuboid([-3.0, -3.0, -2.0], [3.0, 3.0, 0.0]));
    let part = bench.place("block.stl");
    let program = bench.write(
        "slot.nc",
        "G21 G90 G54 S9000 M3 G0 X-4 Y0 Z3\nG1 Z-0.5 F100\nX4\nG1 Y1\nX-4\nG0 Z3\nM30\n",
    );
    let all = ["--part", &part, "--unit", "mm", "--tool", "D2Ball", "--program", &program];
    let all = [&all[..], &["--control", "linuxcnc"]].concat();
    let verify = |more: &[&str]| touchoff(&[&["verify"][..], &all, more].concat());
    let output = verify(&["--json"]);
    let found = objects(&output);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let ball = found.iter().find(|row| row["surface"] == "ball").expect("a finding");
    assert_eq!((&ball["line"], &ball["kind"]), (&3.into(), &"deep".into()));
    let depth = ball["depth"][0].as_f64().expect("a number");
    assert!((depth - 0.5).abs() < 2e-3, "{depth}");
    assert_eq!(verify(&["--tolerance", "0.51"]).status.code(), Some(0));
    // The same program in inches belongs to another part.
    let inch = std::fs::read_to_string(&program).expect("the program");
    bench.write("slot.nc", inch.replace("G21", "G20").replace("-0.5", "-0.001"));
    let output = verify(&["--tolerance", "1"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("units of part and program"), "{}", stderr(&output));
}

/// The report names the other parts of a job and their files.
#[test]
fn a_report_names_other_parts() {
    let bench = Bench::new();
    bench.part("plate.stl", &cuboid([-20.0, -20.0, -10.0], [20.0, 20.0, 0.0]));
    bench.part("bar.stl", &cuboid([-20.0, -5.0, -10.0], [20.0, 5.0, 4.0]));
    bench.write("mill10.tool", end_mill("Mill10", 10.0));
    let text = "G21 G90 G54 G94 F300.\nT1 M6\nS900 M3\nG0 X-30. Y0.\nG43 H1 Z20.\nZ0.\nG1 X30.\nG0 Z20.\n\
                G55 X-30. Y0.\nZ3.5\nG1 X30.\nG0 Z20.\nM30\n";
    bench.write("two.nc", text);
    let text = "part = \"plate.stl\"\nunit = \"mm\"\nprogram = \"two.nc\"\ncontrol = \"linuxcnc\"\n\
                [work_offsets]\nG54 = [0, 0, -300]\nG55 = [100, 0, -300]\n[tool.1]\ntool = \"mill10.tool\"\nlength = 60\n\
                [[other_part]]\nwork_offset = \"G55\"\nmesh = \"bar.stl\"\nname = \"the bar\"\n";
    let found = objects(&job(&bench, text, &["--json"]));
    assert!(found.iter().any(|row| row["body"] == "the bar" && row["line"] == 11), "{found:?}");
    let report = bench.touchoff("report bracket.toml -o two.html");
    assert_eq!(report.status.code(), Some(1), "{}", stderr(&report));
    let html = std::fs::read_to_string(bench.place("two.html")).expect("the report");
    assert!(html.contains("Other parts") && html.contains("the bar") && html.contains("bar.stl"));
}

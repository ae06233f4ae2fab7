//! Bodies of a machine: a job is followed from its text to the finding that a spindle head touches the table.

use crate::bench::{Bench, cuboid, findings, objects, stderr, stdout, touchoff};
use std::process::Output;

/// A slot in the side of a block, milled with the table tilted by 90 degrees.
const SLOT: &str = "%
(SLOT IN THE SIDE)
N10 G21 G90 G17 G40 G49 G80 G94
N20 G54
N30 T1 M6
N40 S6000 M3
N50 G0 A0. C0.
N60 G43 H1 X0. Y0. Z150.
N70 G0 A-90.
N80 M428
N90 G0 X-80. Y100. Z-45.
N100 Y58.
N110 G1 X80. F800.
N120 G0 Y100.
N130 M429
N140 M30
%
";

const MILL: &str = "tool Mill10 \"10 mm end mill in a holder\" { units mm; profile { start (0, 0); line to (5, 0) as face cutting; \
                    line to (5, 30) as flute cutting; line to (5, 60) as shank; line to (14, 60), (14, 90), (0, 90) as holder; } \
                    niceness cutting: 1; }";

/// Returns the job of docs/verify.md, and a folder with its files.
fn slot() -> (Bench, String) {
    let bench = Bench::new();
    bench.part("block.stl", &cuboid([-60.0, -60.0, -60.0], [60.0, 60.0, 0.0]));
    bench.write("slot.nc", SLOT);
    bench.write("mill10.tool", MILL);
    let page = include_str!("../../../docs/verify.md");
    let (_, job) = page.split_once("```toml\n# slot.toml\n").expect("the job of the page");
    let (job, _) = job.split_once("```").expect("its end");
    (bench, job.to_owned())
}

fn verify(bench: &Bench, text: &str, more: &[&str]) -> Output {
    let file = bench.write("slot.toml", text);
    touchoff(&[&["verify", &file][..], more].concat())
}

/// The gauge point is at y = 58 + 95 of the tilted block, and the disc of the table reaches to 160: its prism to 160 / cos(π / 96).
#[test]
fn a_spindle_head_touches_the_table_at_a_steep_angle() {
    let (bench, text) = slot();
    let sarif = bench.place("slot.sarif");
    let output = verify(&bench, &text, &["--json", "--sarif", &sarif]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let found = findings(&output);
    let [row] = &found[..] else { panic!("{found:?}") };
    for (key, value) in
        [("tool", "the spindle head"), ("body", "the table"), ("kind", "deep"), ("surface", "nose")]
    {
        assert_eq!(row[key], value, "{row}");
    }
    assert!(row["tool_number"].is_null() && row["line"] == 13, "{row}");
    let exact = 160.0 / (std::f64::consts::PI / 96.0).cos() - (58.0 + 95.0);
    let depth = row["depth"][1].as_f64().expect("a number");
    assert!((depth - exact).abs() < 1e-3, "{depth} {exact}");
    // The margin of the head is 1 mm.
    let lift = row["lift"].as_f64().expect("a number");
    assert!((lift - exact - 1.0).abs() < 0.02, "{lift}");
    let log = std::fs::read(&sarif).expect("the log");
    let log: serde_json::Value = serde_json::from_slice(&log).expect("JSON");
    let message = log["runs"][0]["results"][0]["message"]["text"].as_str().expect("a text");
    assert!(message.starts_with("the spindle head: nose is 7.0857"), "{message}");
    assert!(
        message.contains("deep in the table") && message.contains("with a tool that is"),
        "{message}"
    );
    // The finding stands in the page as it is printed.
    let page = include_str!("../../../docs/verify.md");
    let printed = stdout(&verify(&bench, &text, &[]));
    let (_, printed) = printed.trim_end().split_once("slot.nc").expect("the file");
    assert!(page.contains(&format!("slot.nc{printed}")), "{printed}");

    let longer = verify(&bench, &text.replace("length = 95", "length = 104"), &[]);
    assert_eq!(longer.status.code(), Some(0), "{}{}", stdout(&longer), stderr(&longer));
    assert!(stderr(&longer).contains("the spindle head at the table: no findings in 5 motions"));
    // The same machine without bodies has nothing to find.
    let plain = verify(&bench, &text.replace(" with bodies", ""), &[]);
    assert_eq!(plain.status.code(), Some(0), "{}{}", stdout(&plain), stderr(&plain));

    // In inches the bodies are as large.
    let side = 60.0 / 25.4;
    bench.part("inch.stl", &cuboid([-side, -side, -side], [side, side, 0.0]));
    let inch = text.replace("\"mm\"", "\"inch\"").replace("block.stl", "inch.stl");
    let inch = verify(&bench, &inch.replace("tolerance = 2.1", "tolerance = 0.09"), &["--json"]);
    let rows = objects(&inch);
    let row = rows.iter().find(|row| row["kind"] == "deep").expect("a finding");
    let depth = row["depth"][1].as_f64().expect("a number");
    assert!((25.4 * depth - exact).abs() < 2e-3 && row["body"] == "the table", "{row}");

    verify(&bench, &text, &[]);
    let report = bench.touchoff("report slot.toml -o slot.html");
    assert_eq!(report.status.code(), Some(1), "{}", stderr(&report));
    let html = std::fs::read_to_string(bench.place("slot.html")).expect("the report");
    for words in [
        "Bodies of the machine",
        "the spindle head",
        "the spindle head: nose is 7.0857",
        "1 violation<",
    ] {
        assert!(html.contains(words), "{words}");
    }
}

/// An own machine has meshes and tools in files beside its own, and its report names them.
#[test]
fn an_own_machine_has_its_bodies_in_files() {
    let (bench, text) = slot();
    std::fs::create_dir(bench.folder.path().join("shop")).expect("a folder");
    let machine = stdout(&touchoff(&["machines", "A-C trunnion with bodies"]));
    let machine = machine.replace("name = \"A-C trunnion with bodies\"", "name = \"ours\"");
    let machine = machine.replace("tool = \"SpindleHead\"", "tool = \"head.tool\"");
    let disc = "cylinder = { radius = 160, height = 40 }\nposition = [0, 0, -540]\n";
    assert!(machine.contains(disc));
    let machine = machine.replace(disc, "mesh = \"table.stl\"\nposition = [0, 0, -500]\n");
    bench.write("shop/ours.toml", &machine);
    let head = "tool Head \"a head\" { units mm; profile { start (0, 0); line to (80, 0), (80, 300), (0, 300) as cover; } }";
    bench.write("shop/head.tool", head);
    bench.part("shop/table.stl", &cuboid([-155.0, -155.0, -40.0], [155.0, 155.0, 0.0]));
    let text = text.replace("A-C trunnion with bodies", "shop/ours.toml");
    let output = verify(&bench, &text, &[]);
    let printed = stdout(&output);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(
        printed.contains("the spindle head: cover is 2.0000 mm deep in the table"),
        "{printed}"
    );
    let report = bench.touchoff("report slot.toml -o slot.html");
    assert_eq!(report.status.code(), Some(1), "{}", stderr(&report));
    let html = std::fs::read_to_string(bench.place("slot.html")).expect("the report");
    assert!(html.contains("table.stl") && html.contains("head.tool"));

    for (from, to, words) in [
        ("table.stl", "none.stl", "none.stl"),
        ("head.tool", "none.tool", "none.tool"),
        ("head.tool", "Head", "no built-in tool is called `Head`"),
        (
            "\"the table\", \"the cradle\"",
            "\"the tables\", \"the cradle\"",
            "`the tables`: name another body",
        ),
        (
            "[220, 180, -560]]\nagainst = [\"tool\"]",
            "[220, 180, -560]]\nagainst = [\"part\"]",
            "of which no pair is proved: give one of both as a `tool`",
        ),
    ] {
        assert!(machine.contains(from), "{from}");
        bench.write("shop/ours.toml", machine.replacen(from, to, 1));
        let refused = verify(&bench, &text, &[]);
        let said = stderr(&refused);
        assert_eq!(refused.status.code(), Some(2), "{to}: {said}");
        assert!(said.contains(words), "{to}: {said}");
    }
}

/// Bodies have no place without the origin of G54 and the lengths of the tools.
#[test]
fn bodies_need_the_place_of_the_part_and_the_lengths_of_tools() {
    let (bench, text) = slot();
    let offsets = "[work_offsets]\nG54 = [0, 0, -440]\n";
    assert!(text.contains(offsets) && text.contains("length = 95\n"));
    for (from, words) in [
        (offsets, "the origin of G54"),
        ("length = 95\n", "that of T1 is not stated: state `length` in `[tool.1]`"),
    ] {
        let refused = verify(&bench, &text.replace(from, ""), &["--anyway"]);
        let said = stderr(&refused);
        assert_eq!(refused.status.code(), Some(2), "{said}");
        assert!(said.contains(words), "{said}");
    }
}

/// A fork head beside walls: its arms are beside the spindle, and reach lower than the pivot by their radius.
#[test]
fn an_arm_of_a_fork_head_touches_a_wall() {
    let bench = Bench::new();
    bench.part("block.stl", &cuboid([-60.0, -60.0, -60.0], [60.0, 60.0, 0.0]));
    let walls = cuboid([-170.0, -330.0, -60.0], [-110.0, 330.0, 53.0]);
    bench.part("walls.stl", &walls);
    bench.write("mill10.tool", MILL);
    let job = "part = \"block.stl\"\nunit = \"mm\"\nprogram = \"slot.nc\"\nmachine = \"A-C fork head with bodies\"\n\
               control = \"linuxcnc\"\ntolerance = 2.1\n[work_offsets]\nG54 = [0, 0, -700]\n[tool.1]\ntool = \"mill10.tool\"\n\
               length = 95\n[[fixture]]\nname = \"the wall\"\nmesh = \"walls.stl\"\n";
    // The pivot is 95 + 220 mm from the tip, and at the cosine of the tilt above it: the arm's radius is 110.
    let program = |tilt: f64| {
        bench.write(
            "slot.nc",
            format!(
                "G21 G90 G54 G94 F800.\nT1 M6\nS6000 M3\nG0 A0. C0.\nG43 H1 X0. Y0. Z100.\nM428\nG0 X0. Y0. Z3.\n\
                 G1 A{tilt}\nM429\nM30\n"
            ),
        );
    };
    let clear = |angle: f64| 3.0 + 315.0 * f64::cos(angle.to_radians()) - 110.0 - 53.0 - 1.0;
    assert!(clear(59.0) > 0.1 && clear(61.0) < -4.0, "{} {}", clear(59.0), clear(61.0));
    for (tilt, status) in [(59.0, 0), (-59.0, 0), (61.0, 1), (-61.0, 1)] {
        program(tilt);
        let output = verify(&bench, job, &[]);
        let printed = stdout(&output);
        assert_eq!(output.status.code(), Some(status), "{tilt}: {printed}{}", stderr(&output));
        assert_eq!(printed.contains("the left arm of the fork: arm is"), status == 1, "{printed}");
        assert!(!printed.contains("the right arm") && !printed.contains("T1"), "{printed}");
    }
}

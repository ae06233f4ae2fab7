//! Bodies of a machine: a job is followed from its text to the finding that a spindle head touches the table.

use crate::bench::{Bench, cuboid, findings, stderr, stdout, touchoff};
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
    bench.write("mill.toml", crate::job::linuxcnc());
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

/// The finding in JSON, SARIF, as text and in the report.
#[test]
fn a_spindle_head_touches_the_table() {
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
    let log = std::fs::read(&sarif).expect("the log");
    let log: serde_json::Value = serde_json::from_slice(&log).expect("JSON");
    let message = log["runs"][0]["results"][0]["message"]["text"].as_str().expect("a text");
    assert!(message.starts_with("the spindle head: nose is 7.0857"), "{message}");
    assert!(
        message.contains("deep in the table") && message.contains("with a tool that is"),
        "{message}"
    );
    assert_eq!(log["runs"][0]["results"][0]["ruleId"], "V0101");
    let rules = log["runs"][0]["tool"]["driver"]["rules"].as_array().expect("rules");
    let rule = rules.iter().find(|rule| rule["id"] == "V0101").expect("its rule");
    assert_eq!(rule["name"], "deep");
    let said = |key: &str| rule[key]["text"].as_str().expect("a text").to_owned();
    assert_eq!(said("shortDescription"), "a surface that is deeper in a body than allowed");
    assert!(said("help").contains("lift or tilt the tool there"), "{}", said("help"));
    // The finding stands in the page as it is printed.
    let page = include_str!("../../../docs/verify.md");
    let printed = stdout(&verify(&bench, &text, &[]));
    let (_, printed) = printed.trim_end().split_once("slot.nc").expect("the file");
    assert!(page.contains(&format!("slot.nc{printed}")), "{printed}");

    let longer = verify(&bench, &text.replace("length = 95", "length = 104"), &["-v"]);
    assert_eq!(longer.status.code(), Some(0), "{}{}", stdout(&longer), stderr(&longer));
    assert!(stderr(&longer).contains("the spindle head at the table: no findings in 5 motions"));

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
    bench.write("shop/ours.toml", machine.replace("head.tool", "Head"));
    let refused = verify(&bench, &text, &[]);
    assert_eq!(refused.status.code(), Some(2));
    let said = stderr(&refused);
    assert!(said.contains("no built-in tool is called `Head`"), "{said}");
}

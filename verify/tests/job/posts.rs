//! One job, posted for each control in its own language, from the text to the findings.
//!
//! A ball end mill with a radius of 1 mm passes over the block at z = 0.2, and back 0.3 mm deep in its top. Another one with a radius of
//! 2 mm drills 0.5 mm deep. The depth of a tip in a plane is its distance from it.

use crate::scene::{FINDINGS, Scene, rules};
use touchoff_verify::FindingKind;
use touchoff_verify::job::{FindingDetail, FindingRule};

/// A program as a postprocessor writes it, and the beginning of its blocks that cut into the block.
struct Post<'a> {
    control: &'a str,
    file: &'a str,
    text: &'a str,
    gouges: [&'a str; 2],
}

const FANUC: &str = "%\nO1000 (PLATE)\nN10 G17 G21 G40 G49 G80 G90 G94\nN20 G91 G28 Z0.\nN30 G90\nN40 T1 M6 (BALL 2)\n\
    N50 G54\nN60 S9000 M3\nN70 G0 X-6. Y0.\nN80 G43 H1 Z20.\nN90 Z5.\nN100 G1 Z0.2 F500.\nN110 X6. F200.\nN120 Z-0.3\nN130 X-6.\n\
    N140 G0 Z20.\nN150 G91 G28 Z0.\nN160 G90\nN170 T2 M6 (BALL 4)\nN180 S3000 M3\nN190 G54 G0 X1. Y1.\nN200 G43 H2 Z20.\n\
    N210 G98 G81 X1. Y1. Z-0.5 R2. F100.\nN220 G80\nN230 G91 G28 Z0.\nN240 G90\nN250 M5\nN260 M30\n%\n";

const HAAS: &str = "%\nO01000 (PLATE)\n(T1 BALL 2)\n(T2 BALL 4)\nG20\nG21\nG00 G17 G40 G49 G80 G90 G94\nG53 G00 Z0.\nT1 M06\nS9000 M03\n\
    G54\nM08\nG00 X-6. Y0.\nG43 Z20. H01\nZ5.\nG01 Z0.2 F500.\nX6. F200.\nZ-0.3\nX-6.\nG00 Z20.\nM09\nG53 G00 Z0.\nM01\n\
    T2 M06\nS3000 M03\nG54\nG00 X1. Y1.\nG43 Z20. H02\nG98 G81 X1. Y1. Z-0.5 R2. F100.\nG80\nG53 G00 Z0.\nM05\nM30\n%\n";

const LINUXCNC: &str = "(PLATE)\nG21 G90 G17 G40 G49 G80 G94 G61\nG54\nG53 G0 Z0\n; ball 2\nT1 M6\nS9000 M3\nG0 X-6 Y0\nG43 H1\nG0 Z20\nG0 Z5\n\
    G1 Z0.2 F500\nG1 X6 F200\nG1 Z-0.3\nG1 X-6\nG0 Z20\nG53 G0 Z0\n; ball 4\nT2 M6\nS3000 M3\nG0 X1 Y1\nG43 H2\nG0 Z20\n\
    G98 G81 X1 Y1 Z-0.5 R2 F100\nG80\nG53 G0 Z0\nM5\nM2\n";

const SIEMENS: &str = "; PLATE\nN10 G17 G40 G71 G90 G94 G60\nN20 SUPA G0 Z0 D0\nN30 T=\"BALL 2\"\nN40 M6\nN50 MSG(\"FACE\")\nN60 G54\nN70 S9000 M3 D1\n\
    N80 G0 X-6 Y0\nN90 G0 Z20\nN100 G0 Z5\nN110 G1 Z0.2 F500\nN120 G1 X6 F200\nN130 G1 Z-0.3\nN140 G1 X-6\nN150 G0 Z20\n\
    N160 SUPA G0 Z0 D0\nN170 T=\"BALL 4\"\nN180 M6\nN190 G54\nN200 S3000 M3 D1\nN210 G0 X1 Y1\nN220 G0 Z20\nN230 F100\n\
    N240 MCALL CYCLE81(20,0,2,-0.5)\nN250 X1 Y1\nN260 MCALL\nN270 SUPA G0 Z0 D0\nN280 M5\nN290 M30\n";

const HEIDENHAIN: &str = "0 BEGIN PGM PLATE MM\n1 BLK FORM 0.1 Z X-3 Y-3 Z-2\n2 BLK FORM 0.2 X+3 Y+3 Z+0\n3 L Z+0 R0 FMAX M91\n\
    4 TOOL CALL 1 Z S9000\n5 L X-6 Y+0 R0 FMAX M3\n6 L Z+20 R0 FMAX\n7 L Z+5 FMAX\n8 L Z+0.2 F500\n9 L X+6 F200\n10 L Z-0.3\n11 L X-6\n\
    12 L Z+20 FMAX\n13 L Z+0 R0 FMAX M91\n14 TOOL CALL 2 Z S3000\n15 L X+1 Y+1 R0 FMAX M3\n16 L Z+20 R0 FMAX\n\
    17 CYCL DEF 200 DRILLING ~\n Q200=+2 ;SET-UP CLEARANCE ~\n Q201=-0.5 ;DEPTH ~\n Q206=+100 ;FEED RATE FOR PLNGNG ~\n\
    Q202=+0.5 ;PLUNGING DEPTH ~\n Q210=+0 ;DWELL TIME AT TOP ~\n Q203=+0 ;SURFACE COORDINATE ~\n Q204=+20 ;2ND SET-UP CLEARANCE ~\n\
    Q211=+0 ;DWELL TIME AT DEPTH\n18 CYCL CALL M3\n19 L Z+0 R0 FMAX M91\n20 M30\n21 END PGM PLATE MM\n";

const POSTS: [Post<'static>; 5] = [
    Post { control: "fanuc", file: "plate.nc", text: FANUC, gouges: ["N130", "N210"] },
    Post { control: "haas", file: "plate.nc", text: HAAS, gouges: ["X-6.", "G98 G81"] },
    Post { control: "linuxcnc", file: "plate.ngc", text: LINUXCNC, gouges: ["G1 X-6", "G98 G81"] },
    Post { control: "siemens", file: "plate.mpf", text: SIEMENS, gouges: ["N140", "N250"] },
    Post { control: "heidenhain", file: "plate.h", text: HEIDENHAIN, gouges: ["11 L", "18 CYCL"] },
];

const BALL_4: &str = "tool My {
    units mm;
    profile { start (0, 0); arc to (2, 2) center (0, 2) as ball cutting; line to (2, 20), (0, 20) as shank; }
    niceness cutting: 1;
}";

#[test]
fn a_job_posted_for_each_control_has_the_same_findings() {
    for Post { control, file, text, gouges } in POSTS {
        let mut scene = Scene::of(text).with_file("ball4.tool", BALL_4);
        scene.file = file;
        scene.job = scene.job.replace("LENGTH", "name = \"BALL 2\"\nlength = 50")
            + "[tool.2]\ntool = \"ball4.tool\"\nname = \"BALL 4\"\nlength = 60\n[work_offsets]\nG54 = [0, 0, -400]\n";
        let scene = scene.on("3-axis", "name = ", "tool_change = { Z = 0 }\nname = ");
        let line_of = |begin: &str| {
            let line = text.lines().position(|line| line.starts_with(begin));
            1 + line.expect("a block")
        };
        let compared = scene.with_report(rules(control), |report| {
            // Nothing is left open but what is said.
            assert_eq!((report.verdict(), report.refusals()), (FINDINGS, Vec::new()), "{control}");
            // The deeper one comes first.
            let expected = [(2, 0.5, gouges[1]), (1, 0.3, gouges[0])];
            assert_eq!(report.findings().len(), expected.len(), "{control}");
            for (finding, (number, depth, begin)) in report.findings().iter().zip(expected) {
                assert_eq!(
                    (finding.rule, finding.line),
                    (FindingRule::Deep, line_of(begin)),
                    "{control}: {finding}"
                );
                let FindingDetail::Surface { pair, groups, .. } = &finding.detail else {
                    panic!("{control}: {finding}");
                };
                let pair = &report.pairs[*pair];
                let FindingKind::Deep { surface, depth: found, .. } = groups[0].worst.kind else {
                    panic!("{control}: {finding}");
                };
                assert_eq!(report.tool(pair).and_then(|tool| tool.number()), Some(number));
                assert_eq!(&*report.shape(pair).info().surface(surface).name, "ball");
                assert!(
                    found.low <= depth + 1e-6 && depth <= found.high + 1e-3,
                    "{control}: {finding}"
                );
                assert!(found.high - found.low < 1e-3, "{control}: {finding}");
            }
        });
        compared.expect(control);
    }
}

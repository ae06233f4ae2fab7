//! Jobs built in code: the one pass of a job gives what each check gives by itself.

use nalgebra::Point3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::path::Path;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::shapes;
use touchoff::tool::Interpreted;
use touchoff::{Tool, Unit};
use touchoff_verify::gcode::{ControlRules, ControlSetup, WorkOffset};
use touchoff_verify::job::{
    Body, BodyRole, FindingDetail, FindingRule, JobFinding, JobStock, Moving, NoVerdict,
    PairReport, StockShape, read_control,
};
use touchoff_verify::machine::Machine;
use touchoff_verify::{
    FindingGroup, FindingKind, Job, JobError, JobFile, JobTool, Move, Program, ToolSelection,
    Verdict, Verifier,
};

const MILL: &str = "tool Mill \"8 mm end mill in a nut\" {
    units mm;
    profile {
        start (0, 0); line to (4, 0) as face cutting; line to (4, 12) as flute cutting;
        line to (4, 30) as shank; line to (12, 30), (12, 60), (0, 60) as nut;
    }
    niceness cutting: 1;
}";

const BALL: &str = "tool Ball \"6 mm ball\" {
    units mm;
    profile { start (0, 0); arc to (3, 3) center (0, 3) as ball cutting; line to (3, 40), (0, 40) as shank; }
    niceness cutting: 1;
}";

/// Returns the end mill and the ball.
fn tools() -> [Interpreted; 2] {
    [("mill.tool", MILL), ("ball.tool", BALL)]
        .map(|(name, text)| Interpreted::from_text(name, text).expect("a tool"))
}

fn cuboid(low: [f64; 3], high: [f64; 3]) -> TriangleBvh {
    let mesh = shapes::cuboid(Point3::from(low), Point3::from(high), Unit::Millimetre);
    TriangleBvh::new(&mesh.expect("a cuboid"))
}

/// Writes a program of two tools and two work offsets, with some gouges.
fn program(random: &mut Pcg64Mcg) -> String {
    let mut uniform = |low: f64, high: f64| {
        low + (high - low) * ((random.next_u64() >> 11) as f64 / 2f64.powi(53))
    };
    let mut text = "G21 G90 G54\n".to_owned();
    for (tool, offset) in [(1, "G54"), (2, "G54"), (1, "G55"), (2, "G55"), (1, "G54")] {
        text += &format!("T{tool} M6\nS900 M3\n{offset} G0 X0. Y0.\nG43 H{tool} Z40.\nG1 F500.\n");
        for _ in 0..20 {
            let [x, y] = [uniform(-25.0, 25.0), uniform(-25.0, 25.0)];
            text += &format!(
                "{} X{x:.3} Y{y:.3} Z{:.3}\n",
                ["G0", "G1"][usize::from(uniform(0.0, 1.0) > 0.3)],
                uniform(-1.0, 12.0)
            );
        }
        // Without a point, 0.04 mm on some controls.
        text += "G0 Z40\nZ40.\n";
    }
    text + "G54 G0 X0. Y0.\nM30\n"
}

/// Returns the set-up for these programs.
fn setup() -> ControlSetup {
    ControlSetup {
        work_offsets: std::array::from_fn(|k| {
            (k < 2).then_some([5.0 * k as f64, 0.0, -300.0, 0.0, 0.0, 0.0])
        }),
        lengths: [(1, 80.0), (2, 60.0)].into(),
        ..ControlSetup::default()
    }
}

#[test]
fn one_pass_gives_what_each_check_gives_by_itself() {
    let [mill, ball] = tools();
    let part = cuboid([-20.0, -20.0, -10.0], [20.0, 20.0, 0.0]);
    let clamp = cuboid([10.0, 10.0, 0.0], [30.0, 30.0, 6.0]);
    let setup = setup();
    let mut random = Pcg64Mcg::seed_from_u64(49);
    let (mut pairs, mut found, mut most_readings) = (0, 0, 0);
    for _ in 0..3 {
        let text = program(&mut random);
        let machine = Machine::named("3-axis").expect("a machine");
        let program = Program::parse(&text, "random.nc", machine, &setup).expect("a program");
        let mut job = Job::new(&program, &part);
        job.tools.extend([JobTool::numbered(1, &mill), JobTool::numbered(2, &ball)]);
        job.tolerance = 0.5;
        let mut fixture = Body::fixture("the clamp", &clamp);
        fixture.role = BodyRole::Fixture { margin: 0.25 };
        job.bodies.push(fixture);
        let corners = [[-22.0, -22.0, -10.0], [22.0, 22.0, 2.0]].map(Point3::from);
        job.stock =
            Some(JobStock { shape: StockShape::Box(corners), spacing: 2.0, tolerance: None });
        let report = job.check(&|_| ()).expect("a result");
        most_readings = program.reading_count().max(most_readings);
        assert_eq!(report.pairs.len(), 4 * program.reading_count());
        assert_eq!(report.cuts.len(), program.reading_count());
        for pair in &report.pairs {
            let index = pair.moving.tool().expect("a tool");
            let (tool, body): (&dyn Tool, _) = (job.tools[index].tool, &job.bodies[pair.body]);
            let mut verifier = Verifier::new(body.bvh, tool).expect("a verifier");
            if pair.body == 0 {
                verifier = verifier.with_tolerance(0.5).expect("a tolerance");
            } else {
                for surface in tool.info().surfaces.iter() {
                    verifier = verifier.with_allowance(&surface.name, -0.25).expect("a margin");
                }
            }
            let selection = ToolSelection::Number(Some(index as u32 + 1));
            let symmetry = tool.info().symmetry;
            let moves = program.moves(pair.reading, selection, symmetry, None, Unit::Millimetre);
            let alone = verifier.check_moves(moves.expect("moves"), &|_| ()).expect("a result");
            assert_eq!(pair.report, alone);
            assert_eq!(pair.groups, FindingGroup::join(&alone.findings));
            pairs += 1;
            found += alone.findings.len();
        }
        assert_eq!(report.verdict(), Verdict::Findings);
        let is_surface = |detail: &FindingDetail| matches!(detail, FindingDetail::Surface { .. });
        let surfaces = report.findings().iter().filter(|finding| is_surface(&finding.detail));
        assert!(surfaces.count() > 0);
    }
    println!("{pairs} pairs in up to {most_readings} readings, {found} findings");
    assert!(found > 200 && most_readings > 1);
}

/// Each pair takes memory, and a small file states very many.
#[test]
fn too_many_pairs_are_refused() {
    let [mill, _] = tools();
    let part = cuboid([-20.0, -20.0, -10.0], [20.0, 20.0, 0.0]);
    let program = Program::parse(
        "G21 G90 G54\nT1 M6\nG0 X0 Y0\nG0 Z20\nM30\n",
        "short.nc",
        Machine::named("3-axis").expect("a machine"),
        &setup(),
    );
    let program = program.expect("a program");
    let mut job = Job::new(&program, &part);
    job.tools.extend((1..=101).map(|number| JobTool::numbered(number, &mill)));
    job.bodies.extend((1..100).map(|_| Body::fixture("the clamp", &part)));
    let error = job.check(&|_| ()).expect_err("too many pairs");
    let start = "101 tools and bodies of the machine are checked against 100 bodies, in 10100 pairs of at most 10000: ";
    assert!(error.to_string().starts_with(start), "{error}");
    assert_eq!(error.code(), "J0133");
}

/// One order over surfaces, stock and machine: by what a finding means, then by depth. What goes right through the part is one
/// finding.
#[test]
fn the_worst_finding_comes_first() {
    let [mill, _] = tools();
    let part = cuboid([-20.0, -20.0, -10.0], [20.0, 20.0, 0.0]);
    let clamp = cuboid([40.0, -5.0, 0.0], [50.0, 5.0, 20.0]);
    let text = "G21 G90 G54\nT1 M6\nS900 M3\nG0 X-30. Y0.\nG43 H1 Z5.\nG1 Z-5. F100.\nX30.\nG0 Z5.\nX10. Y10.\nG1 Z-0.5\nG0 Z5.\n\
                X30.\nG1 Z-5.\nX-30.\nY14.\nX30.\nG0 Z5.\nX0. Y-12.\nZ-0.25\nZ5.\nM5\nG1 X-30.\nM30\n";
    let setup = ControlSetup {
        rules: ControlRules::named("linuxcnc").expect("a control"),
        work_offsets: std::array::from_fn(|k| {
            (k == 0).then_some([0.0, 0.0, -300.0, 0.0, 0.0, 0.0])
        }),
        lengths: [(1, 80.0)].into(),
        ..ControlSetup::default()
    };
    let machine = Machine::named("3-axis").expect("a machine");
    let program = Program::parse(text, "worst.nc", machine, &setup).expect("a program");
    let mut job = Job::new(&program, &part);
    job.tools.push(JobTool::numbered(1, &mill));
    let mut fixture = Body::fixture("the clamp", &clamp);
    fixture.role = BodyRole::Fixture { margin: 7.0 };
    job.bodies.push(fixture);
    let corners = [[-20.0, -20.0, -10.0], [20.0, 20.0, 2.0]].map(Point3::from);
    let stock = JobStock { shape: StockShape::Box(corners), spacing: 1.0, tolerance: Some(0.5) };
    job.stock = Some(stock);
    let report = job.check(&|_| ()).expect("a result");
    let findings = report.findings();

    // Face and flute pass through on line 7, and beside it on lines 14 and 16.
    let FindingDetail::Surface { groups, motions, .. } = &findings[0].detail else {
        panic!("{}", findings[0]);
    };
    assert_eq!(
        (findings[0].rule, findings[0].line, findings[0].lines),
        (FindingRule::Deep, 7, [7, 16])
    );
    assert_eq!((groups.len(), *motions), (6, 3), "{}", findings[0]);
    let start = "T1 face and flute pass right through the part on 3 motions, lines 7, 14, 16; first, face passes right \
                 through the part at ";
    assert!(findings[0].text.starts_with(start), "{}", findings[0]);

    let at_part = |finding: &&JobFinding| matches!(finding.detail, FindingDetail::Surface { pair, .. } if report.pairs[pair].body == 0);
    let count = findings.iter().filter(at_part).count();
    let start = format!("T1 at the part: {count} findings in ");
    assert!(report.summaries()[0].starts_with(&start), "{:?}", report.summaries());

    // The depth beyond its limit, over surfaces and the stock; then what has none.
    let excess = |detail: &FindingDetail| match detail {
        FindingDetail::Surface { groups, .. } => match groups[0].worst.kind {
            FindingKind::Deep { through: true, .. } => Some(f64::INFINITY),
            FindingKind::Deep { depth, allowed, .. } => Some(depth.low - allowed),
            _ => None,
        },
        FindingDetail::Stock(stock) => Some(stock.depth - 0.5),
        FindingDetail::Machine(_) => None,
    };
    let excesses: Vec<_> = findings.iter().map(|finding| excess(&finding.detail)).collect();
    let deep: Vec<f64> = excesses.iter().map_while(|excess| *excess).collect();
    assert!(deep.is_sorted_by(|one, other| one >= other), "{deep:?}");
    let rules: Vec<_> = findings.iter().map(|finding| finding.rule).collect();
    let stock = rules.iter().position(|rule| *rule == FindingRule::Stock).expect("stock");
    assert!(
        rules[..stock].contains(&FindingRule::Deep)
            && rules[stock..deep.len()].contains(&FindingRule::Deep)
    );
    let (last, near) = rules[deep.len()..].split_last().expect("findings without a depth");
    assert!(*last == FindingRule::Spindle && near.contains(&FindingRule::Near), "{rules:?}");
    assert!(near.iter().all(|rule| *rule == FindingRule::Near), "{rules:?}");
}

/// The moves of all tools in the order of the program hold those of each tool, with a rest after each change.
#[test]
fn moves_in_order_hold_those_of_each_tool() {
    let [_, ball] = tools();
    let text = program(&mut Pcg64Mcg::seed_from_u64(50));
    let machine = Machine::named("3-axis").expect("a machine");
    let program = Program::parse(&text, "random.nc", machine, &setup()).expect("a program");
    let unit = Unit::Millimetre;
    for (index, reading) in program.readings().iter().enumerate() {
        let all: Vec<_> = reading.moves_in_order(unit).collect();
        assert_eq!(all.chunk_by(|one, other| one.tool == other.tool).count(), 5);
        for number in [1, 2].map(Some) {
            let selection = ToolSelection::Number(number);
            let alone = program.moves(index, selection, ball.info().symmetry, None, unit);
            let key = |step: Move| (step.line, step.from, step.rapid, step.path.pose(0.5));
            let alone: Vec<_> = alone.expect("moves").map(key).collect();
            let own = all.iter().filter(|step| step.tool == number).cloned();
            assert_eq!(own.map(key).collect::<Vec<_>>(), alone);
            assert!(alone.len() > 40);
        }
    }
}

/// Names by which programs of Sinumerik select tools are given once.
#[test]
fn a_tool_name_stands_for_one_tool() {
    let text = |second: &str| {
        format!(
            "part = \"a.stl\"\nunit = \"mm\"\nprogram = \"a.mpf\"\n[tool.1]\nname = \"FACEMILL 63\"\n[tool.2]\nname = \"{second}\"\n"
        )
    };
    let parse = |second: &str| JobFile::parse(&text(second), Path::new("job.toml"));
    assert!(parse("CUTTER 16").is_ok());
    let error = parse("FACEMILL 63").expect_err("two tools of one name");
    assert_eq!(error.code(), "J0207", "{error}");
}

/// A program that moves far away under one of two work offsets seems to be meant for another part.
#[test]
fn a_work_offset_far_from_the_part_is_open() {
    let [mill, _] = tools();
    let part = cuboid([-20.0, -20.0, -10.0], [20.0, 20.0, 0.0]);
    let text = "G21 G90 G54\nT1 M6\nS900 M3\nG0 X0. Y0.\nG43 H1 Z20.\nG1 Z1. F100.\nG0 Z20.\n\
                G55 X0. Y0.\nG1 Z1.\nG0 Z20.\nG54 X0.\nM30\n";
    for (x, is_far) in [(300.0, true), (10.0, false)] {
        let setup = ControlSetup {
            rules: ControlRules::named("linuxcnc").expect("a control"),
            work_offsets: std::array::from_fn(|k| {
                (k < 2).then_some([x * k as f64, 0.0, -300.0, 0.0, 0.0, 0.0])
            }),
            lengths: [(1, 80.0)].into(),
            ..ControlSetup::default()
        };
        let machine = Machine::named("3-axis").expect("a machine");
        let program = Program::parse(text, "two.nc", machine, &setup).expect("a program");
        let mut job = Job::new(&program, &part);
        job.tools.push(JobTool::numbered(1, &mill));
        let report = job.check(&|_| ()).expect("a result");
        let refusals = report.refusals();
        let codes: Vec<_> = refusals.iter().map(NoVerdict::code).collect();
        assert_eq!(codes.contains(&"V0603"), is_far, "{refusals:?}");
        let verdict = if is_far { Verdict::None } else { Verdict::Clean };
        assert_eq!(report.verdict(), verdict, "{refusals:?}");
    }
}

/// The line of a finding, and the reading for which it holds.
type FindingPlace = (usize, Option<String>);

/// Checks a program with the mill at a plate whose top is at 0, and returns the verdict, the places of its findings, and the reasons
/// against a verdict.
fn checked(text: &str, setup: &ControlSetup) -> (Verdict, Vec<FindingPlace>, Vec<NoVerdict>) {
    let [mill, _] = tools();
    let part = cuboid([-20.0, -20.0, -10.0], [20.0, 20.0, 0.0]);
    let machine = Machine::named("3-axis").expect("a machine");
    let program = Program::parse(text, "a.nc", machine, setup).expect("a program");
    let mut job = Job::new(&program, &part);
    job.tools.push(JobTool::of_all(&mill));
    job.anyway = true;
    let report = job.check(&|_| ()).expect("a result");
    let findings = report.findings().iter();
    let lines = findings.map(|finding| (finding.line, finding.under.clone())).collect();
    (report.verdict(), lines, report.refusals())
}

#[test]
fn a_program_is_checked_up_to_the_line_that_is_not_read() {
    let setup = ControlSetup {
        rules: ControlRules::named("linuxcnc").expect("a control"),
        ..ControlSetup::default()
    };
    let head = "G21 G90 G54\nT1 M6\nS900 M3\nG0 X0. Y0.\nG43 H1 Z20.\n";
    let text = format!("{head}G1 Z1. F100.\nG888 P3\nG1 Z-5.\nM777\nDRAW(1)\nG888\nM98 P44\nM30\n");
    let (verdict, findings, refusals) = checked(&text, &setup);
    // The gouge is behind the line that is not read.
    assert_eq!((verdict, findings.len()), (Verdict::None, 0), "{refusals:?}");
    let places: Vec<_> = refusals.iter().map(|refusal| (refusal.code(), refusal.line())).collect();
    assert_eq!(places, [("P0114", 7), ("P0114", 9), ("P0107", 10), ("P0126", 12)], "{refusals:?}");
    assert!(refusals[0].to_string().contains("; the program is checked up to here"));
    // One before it is found.
    let gouge = text.replace("Z1.", "Z-1.");
    let (verdict, findings, _) = checked(&gouge, &setup);
    assert_eq!(verdict, Verdict::Findings);
    assert!(!findings.is_empty() && findings.iter().all(|(line, _)| *line == 6), "{findings:?}");
    // Words that are ignored with a reason stand in the way no more.
    let mut rules = setup.rules.clone();
    for word in ["G888", "M777", "DRAW"] {
        rules = rules.ignoring(word, "draws on the screen").expect("a word");
    }
    let ignoring = ControlSetup { rules, ..setup };
    let (verdict, findings, refusals) = checked(&text.replace("M98 P44\n", ""), &ignoring);
    assert_eq!((verdict, findings[0].0), (Verdict::Findings, 8), "{refusals:?}");
}

/// A variable that can have several values: each is checked, and those that fail are named.
#[test]
fn every_value_of_a_variable_is_checked() {
    let text =
        "G21 G90 G54\nT1 M6\nS900 M3\nG0 X0. Y0.\nG43 H1 Z20.\nG1 Z[1.-#500] F100.\nG0 Z20.\nM30\n";
    let setup = |values: &[f64]| ControlSetup {
        rules: ControlRules::named("linuxcnc").expect("a control"),
        variables: [("#500".to_owned(), values.to_vec())].into(),
        ..ControlSetup::default()
    };
    let (verdict, ..) = checked(text, &setup(&[0.0, 0.5, 1.0]));
    assert_eq!(verdict, Verdict::Clean);
    let (verdict, findings, _) = checked(text, &setup(&[0.0, 0.5, 1.0, 1.5]));
    assert_eq!(verdict, Verdict::Findings);
    let named = (6, Some("under #500 = 1.5".to_owned()));
    assert!(!findings.is_empty() && findings.iter().all(|found| *found == named), "{findings:?}");
    // Nobody knows it otherwise.
    let (verdict, _, refusals) =
        checked(text, &ControlSetup { variables: [].into(), ..setup(&[0.0]) });
    assert_eq!(verdict, Verdict::None);
    assert_eq!((refusals[0].code(), refusals[0].line()), ("P0210", 6), "{refusals:?}");
    let many = (0..101).map(f64::from).collect::<Vec<_>>();
    let machine = Machine::named("3-axis").expect("a machine");
    let error = Program::parse(text, "a.nc", machine, &setup(&many)).expect_err("too many");
    assert_eq!(error.code(), "K0902", "{error}");
}

#[test]
fn job_files_are_read_with_their_paths_beside_them() {
    let text = "part = \"a.stl\"\nunit = \"mm\"\nprogram = \"a.nc\"\ncontrol = \"haas\"\n[tool.3]\ntool = \"m.tool\"\n\
                set = { D = 6 }\nlength = 40\n[work_offsets]\nG55 = [1, 2, 3]\n[[fixture]]\nname = \"vise\"\nmesh = \"v.stl\"\n";
    let job = JobFile::parse(text, Path::new("jobs/a.toml")).expect("a job");
    let files: Vec<String> =
        job.files().iter().map(|(role, file)| format!("{role}: {}", file.display())).collect();
    let expected =
        ["part: jobs/a.stl", "program: jobs/a.nc", "tool T3: jobs/m.tool", "vise: jobs/v.stl"];
    assert_eq!(files, expected);
    let shouted = text.replace("haas", "H.TOML");
    let shouted = JobFile::parse(&shouted, Path::new("jobs/a.toml")).expect("a job");
    assert_eq!(shouted.control, Some("jobs/H.TOML".into()));
    let unreadable = read_control("none.TOML".as_ref()).expect_err("no file");
    assert!(matches!(unreadable, JobError::Unreadable { .. }), "{unreadable}");
    assert_eq!(job.work_offsets[1], Some([1.0, 2.0, 3.0, 0.0, 0.0, 0.0]));

    let tables = format!(
        "{text}\n[ignore]\nG888 = \"draws\"\n[variables]\n\"#500\" = 2.5\n\"#<_d>\" = [1, 2]\n"
    );
    let stated = JobFile::parse(&tables, Path::new("jobs/a.toml")).expect("a job");
    assert_eq!(stated.ignore["G888"], "draws");
    assert_eq!(stated.variables["#500"], [2.5]);
    assert_eq!(stated.variables["#<_d>"], [1.0, 2.0]);
    for wrong in ["\"500x\" = 1", "\"#500\" = []", "\"#500\" = nan"] {
        let tables = format!("{text}\n[variables]\n{wrong}\n");
        let error = JobFile::parse(&tables, Path::new("a.toml")).expect_err(wrong);
        assert_eq!(error.code(), "J0205", "{error}");
    }

    let setup = ControlSetup::default();
    let machine = || Machine::named("3-axis").expect("a machine");
    let of = |text: &str| Program::parse(text, "a.nc", machine(), &setup).expect("a program");
    let used = job.used_tools(&of("G21 T3 M6\nG0 X1.\nX2.\nM30\n")).expect("its tool");
    assert_eq!(used[0].motions, ToolSelection::Number(Some(3)));
    assert_eq!(used[0].params, ["D=6"]);
    let low = JobFile::parse(&text.replace("= 40", "= -40"), Path::new("a.toml")).expect("a job");
    let low = low.used_tools(&of("G21 T3 M6\nG0 X1.\nX2.\nM30\n")).expect_err("a tip above");
    assert_eq!(low.code(), "J0134", "{low}");
    let missing = job.used_tools(&of("G21 T4 M6\nG0 X1.\nX2.\nM30\n")).err();
    assert!(matches!(missing, Some(JobError::NoTool { number: 4, line: 2, .. })), "{missing:?}");
    let two = text.replace("[work_offsets]", "[tool.5]\ntool = \"n.tool\"\n[work_offsets]");
    let two = JobFile::parse(&two, Path::new("a.toml")).expect("a job");
    let early = "G21 G90\nG54 G43 H3 G0 X1. Y0. Z5.\nX2.\nT3 M6\nG43 H3 Z5.\nX3.\nX4.\nM30\n";
    let missing = two.used_tools(&of(early)).expect_err("motions without a tool");
    assert!(matches!(missing, JobError::UnnamedTool { line: 3 }), "{missing}");

    for (wrong, code, word) in [
        ("unit = \"mm\"", "J0201", "line 1: missing field `part`"),
        (&*text.replace("G55", "G60"), "J0106", "`G60`"),
        (&*text.replace("fixture", "fixtur"), "J0201", "`fixtur`"),
        (&*text.replace("mm", "cm"), "J0202", "`cm`"),
    ] {
        let error = JobFile::parse(wrong, Path::new("a.toml")).expect_err(wrong);
        assert!(
            error.code() == code && error.to_string().contains(word),
            "{}: {error}",
            error.code()
        );
    }
}

#[test]
fn a_margin_that_is_no_length_is_refused() {
    let [mill, _] = tools();
    let setup = ControlSetup {
        rules: ControlRules::named("linuxcnc").expect("a control"),
        ..ControlSetup::default()
    };
    let machine = Machine::named("3-axis").expect("a machine");
    let text = "G21 G90 G54\nT1 M6\nS900 M3\nG0 X0. Y0.\nG43 H1 Z40.\nM30\n";
    let program = Program::parse(text, "up.nc", machine, &setup).expect("a program");
    let part = cuboid([-10.0, -10.0, -10.0], [10.0, 10.0, 0.0]);
    for margin in [-1.0, f64::NAN, f64::INFINITY] {
        let mut job = Job::new(&program, &part);
        job.tools.push(JobTool::numbered(1, &mill));
        let mut clamp = Body::fixture("the clamp", &part);
        clamp.role = BodyRole::Fixture { margin };
        job.bodies.push(clamp);
        assert!(matches!(job.check(&|_| ()), Err(JobError::Margin)), "{margin}");
    }
}

/// A job whose tool has a radius of 4 mm mills the outline of a block of 40 mm under compensation, up to its finished height.
#[test]
fn compensation_mills_to_the_radius_of_the_job() {
    let [mill, _] = tools();
    let part = cuboid([-20.0, -20.0, -10.0], [20.0, 20.0, 0.0]);
    let folder = tempfile::tempdir().expect("a folder");
    let program = "G21 G90 G54\nT1 M6\nS900 M3\nG0 X-40. Y0.\nG43 H1 Z5.\nG1 Z-5. F100.\nG41 D21 X-20.\nY20.\nX20.\nY-20.\nX-20.\nY0.\n\
                   G40 X-40.\nG0 Z40.\nM30\n";
    std::fs::write(folder.path().join("a.nc"), program).expect("a file");
    let text = "part = \"a.stl\"\nunit = \"mm\"\nprogram = \"a.nc\"\nmachine = \"3-axis\"\ncontrol = \"linuxcnc\"\n\
                [tool.1]\ntool = \"Mill\"\nlength = 80\n[radius_offsets]\nD21 = 4\n";
    let read = |text: &str| JobFile::parse(text, &folder.path().join("a.toml"));
    let deepest = |text: &str| {
        let program = read(text).and_then(|file| file.program())?;
        program.check_complete()?;
        let mut job = Job::new(&program, &part);
        job.tools.push(JobTool::numbered(1, &mill));
        let report = job.check(&|_| ())?;
        let depths = report.findings().iter().filter_map(|finding| match finding.detail {
            FindingDetail::Surface { .. } => Some((finding.line, finding.text.clone())),
            _ => None,
        });
        Ok::<_, JobError>(depths.collect::<Vec<_>>())
    };
    assert_eq!(deepest(text).expect("a verdict"), []);
    // A radius that is 0.1 mm too small leaves the tool as deep in the part.
    let found = deepest(&text.replace("D21 = 4", "D21 = 3.9")).expect("a verdict");
    assert!(found.iter().any(|(_, text)| text.contains("0.1000 mm deep in the part")), "{found:?}");
    let of_tool = text.replace("[radius_offsets]\nD21 = 4", "radius_offset = 4");
    let error = deepest(&of_tool).expect_err("no D21");
    assert_eq!(error.code(), "P0401", "{error}");
    assert!(error.to_string().contains(":7: the radius offset 21 "), "{error}");
    for control in ["fanuc", "haas"] {
        assert_eq!(deepest(&text.replace("linuxcnc", control)).expect(control), []);
    }
    std::fs::write(folder.path().join("a.nc"), program.replace("D21", "D1")).expect("a file");
    for control in ["linuxcnc", "fanuc", "haas", "siemens"] {
        assert_eq!(deepest(&of_tool.replace("linuxcnc", control)).expect(control), []);
    }
    let unstated = of_tool.replace("control = \"linuxcnc\"\n", "");
    assert_eq!(deepest(&unstated).expect_err("no control").code(), "J0135");
    // On any control, both forms of corners and all first motions are readings.
    let any = of_tool.replace("linuxcnc", "generic");
    assert_eq!(deepest(&any).expect("a verdict"), []);
    let readings = read(&any).and_then(|file| file.program()).expect("a program").reading_count();
    assert_eq!(readings, 6);
    for (from, to, code) in [
        ("D21 = 4", "H21 = 4", "J0209"),
        ("D21 = 4", "D0 = 4", "J0209"),
        ("D21 = 4", "D21 = nan", "J0211"),
        ("[radius_offsets]\nD21", "radius_offset = 4\n[radius_offsets]\nD1", "J0210"),
    ] {
        let error = read(&text.replace(from, to)).expect_err(to);
        assert_eq!(error.code(), code, "{to}: {error}");
    }
}

/// A part at G55 has the findings of a job whose part stands at that origin, by the same motions of the machine.
#[test]
fn another_part_is_checked_where_it_stands() {
    let [mill, ball] = tools();
    let (low, high) = ([-20.0, -20.0, -10.0], [20.0, 20.0, 0.0]);
    let by = [45.0, 10.0, -5.0];
    let moved = |corner: [f64; 3]| [0, 1, 2].map(|k| corner[k] + by[k]);
    let (part, other) = (cuboid(low, high), cuboid(moved(low), moved(high)));
    let origins = [[0.0, 0.0, -300.0], moved([0.0, 0.0, -300.0])];
    let setup = |first: usize| ControlSetup {
        work_offsets: std::array::from_fn(|k| {
            let [x, y, z] = origins[(k + first) % 2];
            (k < 2).then_some([x, y, z, 0.0, 0.0, 0.0])
        }),
        lengths: [(1, 80.0), (2, 60.0)].into(),
        rules: ControlRules::named("linuxcnc").expect("a control"),
        ..ControlSetup::default()
    };
    let program_of = |text: &str, setup: &ControlSetup| {
        let machine = Machine::named("3-axis").expect("a machine");
        Program::parse(text, "two.nc", machine, setup).expect("a program")
    };
    let mut random = Pcg64Mcg::seed_from_u64(50);
    let mut found = 0;
    for _ in 0..3 {
        let text = program(&mut random);
        let swapped = text.replace("G54", "G5X").replace("G55", "G54").replace("G5X", "G55");
        let (here, there) = (program_of(&text, &setup(0)), program_of(&swapped, &setup(1)));
        let [mut both, alone] = [&here, &there].map(|program| {
            let mut job = Job::new(program, &part);
            job.tools.extend([JobTool::numbered(1, &mill), JobTool::numbered(2, &ball)]);
            job.anyway = true;
            job
        });
        both.bodies.push(Body::other_part("the other", &other, WorkOffset::Standard(2)));
        let at_other = both.check(&|_| ()).expect("a result");
        let at_part = alone.check(&|_| ()).expect("a result");
        for tool in 0..2 {
            let of = |pairs: &[PairReport], body: usize| {
                let mut pairs = pairs.iter();
                let wanted =
                    |pair: &&PairReport| (pair.moving, pair.body) == (Moving::Tool(tool), body);
                pairs.find(wanted).expect("a pair").report.clone()
            };
            let (one, two) = (of(&at_other.pairs, 1), of(&at_part.pairs, 0));
            assert_eq!(one.findings.len(), two.findings.len());
            for (one, two) in one.findings.iter().zip(&two.findings) {
                assert_eq!((one.line, one.from, one.rapid), (two.line, two.from, two.rapid));
                let apart = one.pose.tip() - two.pose.tip();
                assert!((apart - nalgebra::Vector3::from(by)).norm() < 1e-6, "{one:?} {two:?}");
                if let (FindingKind::Deep { depth, .. }, FindingKind::Deep { depth: known, .. }) =
                    (one.kind, two.kind)
                {
                    assert!((depth.low - known.low).abs() < 1e-6, "{one:?} {two:?}");
                }
                found += 1;
            }
        }
        let texts: Vec<&str> = at_other.findings().iter().map(|finding| &*finding.text).collect();
        assert!(texts.iter().any(|text| text.contains("deep in the other at")), "{texts:?}");
    }
    assert!(found > 20, "{found}");
}

/// A part at a work offset that the program sets otherwise has no place.
#[test]
fn an_offset_that_moves_another_part_is_refused() {
    let [mill, _] = tools();
    let part = cuboid([-20.0, -20.0, -10.0], [20.0, 20.0, 0.0]);
    let other = cuboid([80.0, -20.0, -10.0], [120.0, 20.0, 0.0]);
    for (set, is_refused) in [(100.0, false), (101.0, true)] {
        let text = format!(
            "G21 G90 G54\nT1 M6\nS900 M3\nG0 X0. Y0.\nG43 H1 Z20.\nG1 Z1. F100.\nG0 Z20.\nG10 L2 P2 X{set} Y0. Z-300.\n\
             G55 G0 X0. Y0.\nG1 Z1.\nG0 Z20.\nG54 X0.\nM30\n"
        );
        let setup = ControlSetup {
            rules: ControlRules::named("linuxcnc").expect("a control"),
            work_offsets: std::array::from_fn(|k| {
                (k < 2).then_some([100.0 * k as f64, 0.0, -300.0, 0.0, 0.0, 0.0])
            }),
            lengths: [(1, 80.0)].into(),
            ..ControlSetup::default()
        };
        let machine = Machine::named("3-axis").expect("a machine");
        let program = Program::parse(text, "two.nc", machine, &setup).expect("a program");
        let mut job = Job::new(&program, &part);
        job.tools.push(JobTool::numbered(1, &mill));
        // Without the other part, nothing is near under G55.
        let alone = job.check(&|_| ()).expect("a result").refusals();
        assert!(alone.iter().any(|refusal| refusal.code() == "V0603"), "{alone:?}");
        job.bodies.push(Body::other_part("the other", &other, WorkOffset::Standard(2)));
        match job.check(&|_| ()) {
            Ok(report) => assert!(!is_refused && report.verdict() == Verdict::Clean),
            Err(error) => {
                let is_found = matches!(error, JobError::MovedPart { line: 9, .. });
                assert!(is_refused && is_found, "{error}");
            }
        }
    }
}

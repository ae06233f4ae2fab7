//! Jobs built in code: the one pass of a job gives what each check gives by itself.

use nalgebra::Point3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::path::Path;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::shapes;
use touchoff::{Tool, Unit};
use touchoff_verify::gcode::{ControlRules, ControlSetup};
use touchoff_verify::job::{Body, BodyRole, FindingDetail, JobStock, StockShape};
use touchoff_verify::machine::Machine;
use touchoff_verify::{
    FindingGroup, Job, JobError, JobFile, JobTool, Program, ToolSelection, Verdict, Verifier,
};

touchoff::tool! {
    tool Mill "8 mm end mill in a nut" {
        units mm;
        profile {
            start (0, 0); line to (4, 0) as face cutting; line to (4, 12) as flute cutting;
            line to (4, 30) as shank; line to (12, 30), (12, 60), (0, 60) as nut;
        }
        niceness cutting: 1;
    }
}

touchoff::tool! {
    tool Ball "6 mm ball" {
        units mm;
        profile { start (0, 0); arc to (3, 3) center (0, 3) as ball cutting; line to (3, 40), (0, 40) as shank; }
        niceness cutting: 1;
    }
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

#[test]
fn one_pass_gives_what_each_check_gives_by_itself() {
    let part = cuboid([-20.0, -20.0, -10.0], [20.0, 20.0, 0.0]);
    let clamp = cuboid([10.0, 10.0, 0.0], [30.0, 30.0, 6.0]);
    let setup = ControlSetup {
        work_offsets: std::array::from_fn(|k| {
            (k < 2).then_some([5.0 * k as f64, 0.0, -300.0, 0.0, 0.0, 0.0])
        }),
        lengths: [(1, 80.0), (2, 60.0)].into(),
        ..ControlSetup::default()
    };
    let mut random = Pcg64Mcg::seed_from_u64(49);
    let (mut pairs, mut found, mut most_readings) = (0, 0, 0);
    for _ in 0..3 {
        let text = program(&mut random);
        let machine = Machine::named("3-axis").expect("a machine");
        let program = Program::parse(&text, "random.nc", machine, &setup).expect("a program");
        let mut job = Job::new(&program, &part);
        job.tools.extend([JobTool::numbered(1, &Mill), JobTool::numbered(2, &Ball)]);
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
            let (tool, body): (&dyn Tool, _) = (job.tools[pair.tool].tool, &job.bodies[pair.body]);
            let mut verifier = Verifier::new(body.bvh, tool).expect("a verifier");
            if pair.body == 0 {
                verifier = verifier.with_tolerance(0.5).expect("a tolerance");
            } else {
                for surface in tool.info().surfaces.iter() {
                    verifier = verifier.with_allowance(&surface.name, -0.25).expect("a margin");
                }
            }
            let selection = ToolSelection::Number(Some(pair.tool as u32 + 1));
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
    let error = parse("FACEMILL 63").expect_err("two tools of one name").to_string();
    assert!(error.contains("the tool name `FACEMILL 63` is given twice"), "{error}");
}

/// A program that moves far away under one of two work offsets seems to be meant for another part.
#[test]
fn a_work_offset_far_from_the_part_is_open() {
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
        job.tools.push(JobTool::numbered(1, &Mill));
        let report = job.check(&|_| ()).expect("a result");
        let said = report.refusals().join("\n");
        assert_eq!(said.contains("under G55 the tool never comes"), is_far, "{said}");
        let verdict = if is_far { Verdict::None } else { Verdict::Clean };
        assert_eq!(report.verdict(), verdict, "{said}");
    }
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
    assert_eq!(job.work_offsets[1], Some([1.0, 2.0, 3.0, 0.0, 0.0, 0.0]));

    let setup = ControlSetup::default();
    let machine = || Machine::named("3-axis").expect("a machine");
    let of = |text: &str| Program::parse(text, "a.nc", machine(), &setup).expect("a program");
    let used = job.used_tools(&of("G21 T3 M6\nG0 X1.\nX2.\nM30\n")).expect("its tool");
    assert_eq!(used[0].motions, ToolSelection::Number(Some(3)));
    assert_eq!(used[0].params, ["D=6"]);
    let missing = job.used_tools(&of("G21 T4 M6\nG0 X1.\nX2.\nM30\n")).err();
    assert!(matches!(missing, Some(JobError::NoTool { number: Some(4) })), "{missing:?}");

    for (wrong, message) in [
        ("unit = \"mm\"", "line 1: missing field `part`"),
        (&*text.replace("G55", "G60"), "work offset `G60`"),
        (&*text.replace("fixture", "fixtur"), "unknown field `fixtur`"),
        (&*text.replace("mm", "cm"), "`cm` is not a unit"),
    ] {
        let error = JobFile::parse(wrong, Path::new("a.toml")).err().map(|error| error.to_string());
        assert!(error.as_deref().is_some_and(|error| error.contains(message)), "{error:?}");
    }
}

#[test]
fn a_margin_that_is_no_length_is_refused() {
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
        job.tools.push(JobTool::numbered(1, &Mill));
        let mut clamp = Body::fixture("the clamp", &part);
        clamp.role = BodyRole::Fixture { margin };
        job.bodies.push(clamp);
        assert!(matches!(job.check(&|_| ()), Err(JobError::Mismatch(_))), "{margin}");
    }
}

//! Rapid traverse at rates that are not known, against dog-legs at random rates.

use crate::oracle::{Mounted, Random, ToolPose, Worst, sample_points};
use crate::{RESOLUTION, block};
use nalgebra::{Point3, Rotation3, Vector3};
use touchoff::certify::TriangleBvh;
use touchoff::{Interval, Unit};
use touchoff_verify::gcode::{Choice, ControlRules, ControlSetup, Rule};
use touchoff_verify::machine::Machine;
use touchoff_verify::{FindingKind, MachineProgram, MovePath, ToolSelection, Verifier};

/// Number of rates per motion, and of time steps per path.
const RATES: usize = 16;
const STEPS: u32 = 32;

/// Returns the position at a time from 0 to 1 of axes that each take a part of it.
fn dog_leg([from, to]: [Vector3<f64>; 2], times: &Vector3<f64>, at: f64) -> Vector3<f64> {
    from + (to - from).zip_map(times, |way, time| way * (at / time).min(1.0))
}

#[test]
fn any_rates_agree_with_dog_legs_at_random_rates() {
    let mesh = block([-3.0, -3.0, -3.0], [3.0, 3.0, 3.0]);
    let (bvh, points) = (TriangleBvh::new(&mesh), sample_points(&mesh, 0.8));
    let mut random = Random::new(7);
    let [mut clear, mut straight, mut bent] = [0; 3];
    for k in 0..130 {
        // Half of the programs are turned about z, so that their axes are not those of the machine.
        let degrees = if k % 2 == 0 { 0.0 } else { random.between(5.0, 85.0) };
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), f64::to_radians(degrees));
        let mut end = || {
            let at = random.vector(14.0);
            Vector3::new(at.x, at.y, 0.5 * at.z).map(|value| (value * 1e3).round() * 1e-3)
        };
        let ends = [end(), end()];
        let position = |end: &Vector3<f64>| format!("X{:.3} Y{:.3} Z{:.3}", end.x, end.y, end.z);
        let text = format!(
            "G21 G90 G54 S1 M3\nG68 X0. Y0. R{degrees:.9}\nG0 {}\n{}\nM30\n",
            position(&ends[0]),
            position(&ends[1])
        );
        let machine = Machine::named("3-axis").expect("a machine");
        let program = |rules: ControlRules| {
            let setup = ControlSetup { rules, ..ControlSetup::default() };
            MachineProgram::new("box.nc", text.clone(), machine.clone(), setup).expect("a program")
        };
        let program = [
            program(ControlRules::default()),
            program(ControlRules::default().with(Rule::Rapid, Choice::Straight)),
        ];
        let [found, on_line] = program.map(|program| {
            let verifier = Verifier::new(&bvh, &Mounted).expect("a profile");
            let verifier = verifier.with_resolution(RESOLUTION).expect("a length");
            let moves =
                program.moves(ToolSelection::All, None, Unit::Millimetre).expect("the part");
            let moves: Vec<_> = moves.skip(1).collect();
            let report = verifier.check_moves(moves.clone(), &|_| ()).expect("it can be checked");
            (report.findings, matches!(moves[0].path, MovePath::Box(_)))
        });
        assert!(found.1 && !on_line.1);
        let (found, on_line) = (found.0, on_line.0);
        let ends = ends.map(|end| turn * end);
        let mut worst = Worst::none();
        for _ in 0..RATES {
            let times = Vector3::from_fn(|_, _| random.between(0.05, 1.0));
            for step in 0..=STEPS {
                let tip = dog_leg(ends, &times, f64::from(step) / f64::from(STEPS));
                let pose: ToolPose = (Point3::from(tip), Vector3::z());
                points.iter().for_each(|point| worst.add(point, &pose));
            }
        }
        let depth = worst.depth.iter().copied().fold(0.0, f64::max);
        assert!(
            depth <= RESOLUTION || !found.is_empty(),
            "{k}: {depth} deep, and not found: {text}"
        );
        // A box has at least the findings of its straight line.
        assert!(on_line.is_empty() || !found.is_empty(), "{k}: {on_line:?}");
        match (found.is_empty(), on_line.is_empty()) {
            (true, _) => clear += 1,
            (false, false) => straight += 1,
            (false, true) => bent += 1,
        }
        for finding in &found {
            assert_eq!(finding.any_rates, on_line.is_empty(), "{finding:?}");
            let tip = finding.pose.tip().coords;
            let [low, high] = [ends[0].inf(&ends[1]), ends[0].sup(&ends[1])];
            assert!(
                (0..3).all(|k| low[k] - 1e-9 <= tip[k] && tip[k] <= high[k] + 1e-9),
                "{finding:?}"
            );
            let FindingKind::Deep {
                depth: Interval { low, high },
                max_depth,
                witness,
                surface,
                ..
            } = finding.kind
            else {
                continue;
            };
            let mut actual = Worst::none();
            actual.add(&witness.point, &(finding.pose.tip(), finding.pose.axis()));
            let actual = actual.depth[surface.0];
            assert!(low <= actual + 1e-9 && actual <= high + 1e-9, "{actual}: {finding:?}");
            assert!(worst.depth[surface.0] <= max_depth + 1e-9, "{worst:?}: {finding:?}");
        }
    }
    println!(
        "{clear} boxes are clear, {straight} are not on the straight line, {bent} beside it only"
    );
    assert!(clear >= 10 && straight >= 10 && bent >= 10, "{clear}, {straight}, {bent}");
}

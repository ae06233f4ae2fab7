//! Programs that are written and read back.

use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use touchoff::program::{AptHeader, Cutter, Program, WriteError};
use touchoff::tool::Tool;
use touchoff::{Pose, Unit};

touchoff::tool! {
    tool Ball "6 mm ball, flute to 10" {
        units mm;
        profile {
            start (0, 0);
            arc to (3, 3) center (0, 3) as ball cutting;
            line to (3, 10) as flute cutting;
            line to (4, 12), (4, 30), (0, 30) as shank;
        }
        niceness cutting: 1;
    }
}

touchoff::tool! {
    tool Bull "half an inch, corners of a tenth" {
        units inch;
        profile {
            start (0, 0);
            line to (0.15, 0) as face cutting;
            arc to (0.25, 0.1) center (0.15, 0.1) as corner cutting;
            line to (0.25, 1) as flute cutting;
            line to (0, 1) as shank;
        }
        niceness cutting: 1;
    }
}

touchoff::tool! {
    tool Flat "12 mm end mill" {
        units mm;
        profile {
            start (0, 0);
            line to (6, 0) as face cutting;
            line to (6, 20) as flute cutting;
            line to (6, 60), (0, 60) as shank;
        }
        niceness cutting: 1;
    }
}

touchoff::tool! {
    tool Cone "of 45 degrees" {
        units mm;
        profile {
            start (0, 0);
            line to (5, 5) as cone cutting;
            line to (0, 5) as top;
        }
        niceness cutting: 1;
    }
}

fn pose(tip: [f64; 3], axis: [f64; 3]) -> Pose {
    Pose::from_axis(Point3::from(tip), Vector3::from(axis)).expect("an axis")
}

fn apt(program: &Program, heading: &AptHeader<'_>) -> String {
    let mut out = Vec::new();
    program.write_apt(&mut out, heading).expect("it can be written");
    String::from_utf8(out).expect("UTF-8")
}

fn csv(program: &Program) -> String {
    let mut out = Vec::new();
    program.write_csv(&mut out).expect("it can be written");
    String::from_utf8(out).expect("UTF-8")
}

/// Returns the largest difference between the entries of two poses' rotations.
fn turned(one: &Pose, other: &Pose) -> f64 {
    (one.rotation() - other.rotation()).amax()
}

fn same_bits(one: Point3<f64>, other: Point3<f64>) -> bool {
    one.iter().zip(other.iter()).all(|(one, other)| one.to_bits() == other.to_bits())
}

#[test]
fn a_program_is_written_as_people_write_it() {
    let poses = [
        (pose([1.0, 2.5, 0.0], [0.0, 0.0, 1.0]), true),
        (pose([1e-7, -2.0, 1e9], [0.6, 0.0, 0.8]), false),
    ];
    let program = Program::new("made", Some(Unit::Inch), poses).expect("two poses");
    let cutter = Cutter::of(Flat.info(), Unit::Inch);
    let text = apt(&program, &AptHeader { part: "WALL $ 1; 2", cutter });
    assert_eq!(
        text,
        "PARTNO/WALL $ 1; 2\nUNITS/INCHES\nMULTAX/ON\nCUTTER/0.47244094488188976,0\nRAPID\n\
         GOTO/1,2.5,0,0,0,1\nGOTO/0.0000001,-2,1000000000,0.6,0,0.8\nFINI\n"
    );
    assert_eq!(
        csv(&program),
        "# touchoff program: complete only with its last line `# end of program`\nx,y,z,i,j,k\n1,2.5,0,0,0,1\n\
         0.0000001,-2,1000000000,0.6,0,0.8\n# end of program\n"
    );
    let read = Program::parse(&text, "again.cl").expect("it is a program");
    assert_eq!(read.ignored, [(1, "PARTNO".to_owned())]);
    assert_eq!(read.check_cutter(Flat.info(), Unit::Inch).expect("the same"), None);
    assert_eq!(read.unit, Some(Unit::Inch));
    assert_eq!(read.locations.iter().map(|stop| stop.line).collect::<Vec<_>>(), [6, 7]);
}

#[test]
fn what_apt_cannot_say_is_refused() {
    let here = [(pose([0.0; 3], [0.0, 0.0, 1.0]), false)];
    let metre = Program::new("made", Some(Unit::Metre), here).expect("a pose");
    let error = metre.write_apt(&mut Vec::new(), &AptHeader::default()).expect_err("no such unit");
    assert_eq!(
        error.to_string(),
        "APT-CL has no word for m: write the program in mm or inch, or as a table"
    );
    let program = Program::new("made", None, here).expect("a pose");
    for part in ["A\nGOTO/1,2,3", "A\r", "\u{1b}[2J"] {
        let heading = AptHeader { part, cutter: None };
        let error = program.write_apt(&mut Vec::new(), &heading).expect_err("no line");
        assert!(matches!(error, WriteError::Part { .. }), "{error}");
    }
    assert!(!apt(&program, &AptHeader::default()).contains("UNITS"));
    let error = Program::new("made", None, []).expect_err("no pose").to_string();
    assert!(error.starts_with("made: holds no position"), "{error}");
    let inch = Program::new("made", Some(Unit::Inch), here).expect("a pose");
    let error = inch.check_unit(Unit::Millimetre).expect_err("they differ").to_string();
    assert!(error.starts_with("made: UNITS says inch"), "{error}");
}

#[test]
fn cutters_are_described_where_two_numbers_do() {
    let mm = |tool: &dyn Tool| Cutter::of(tool.info(), Unit::Millimetre);
    assert_eq!(mm(&Ball), Some(Cutter { diameter: 6.0, corner: 3.0 }));
    assert_eq!(mm(&Flat), Some(Cutter { diameter: 12.0, corner: 0.0 }));
    assert_eq!(mm(&Cone), None);
    let bull = mm(&Bull).expect("a bull nose");
    assert!((bull.diameter - 12.7).abs() < 1e-12 && (bull.corner - 2.54).abs() < 1e-12, "{bull:?}");
}

fn poses() -> impl Strategy<Value = Vec<(Pose, bool)>> {
    let size = prop_oneof![Just(1e-9), Just(1.0), Just(1e3), Just(1e8)];
    let tip =
        (prop::array::uniform3(-1.0f64..1.0), size).prop_map(|(tip, size)| tip.map(|c| c * size));
    let axis = prop::array::uniform3(-1.0f64..1.0)
        .prop_filter("a direction", |axis| Vector3::from(*axis).norm() > 1e-3)
        .prop_map(|axis| Vector3::from(axis).normalize().into());
    let upright =
        prop_oneof![Just([0.0, 0.0, 1.0]), Just([1.0, 0.0, -0.0]), Just([0.0, 0.0, -1.0])];
    let axis = prop_oneof![4 => axis, 1 => upright];
    prop::collection::vec(
        ((tip, axis).prop_map(|(tip, axis)| pose(tip, axis)), any::<bool>()),
        1..20,
    )
}

/// Bound on the change of an axis by reading, per coordinate: normalising errs by 3.5 u (2.5 u of the norm, u of the quotient), making the
/// rotation orthonormal moves it by half of 6 u and rounds once. That is 7.5 u, and u is half of this ε.
const READ: f64 = 4.0 * f64::EPSILON;

proptest! {
    #[test]
    fn what_is_read_is_what_was_written(poses in poses(), inches in any::<Option<bool>>()) {
        let unit = inches.map(|inches| if inches { Unit::Inch } else { Unit::Millimetre });
        let made = Program::new("made", unit, poses).expect("a pose at least");
        let text = apt(&made, &AptHeader { part: "A", cutter: None });
        prop_assert!(text.lines().all(|line| line.len() <= 72), "{}", text);
        let read = Program::parse(&text, "again").expect("it is a program");
        prop_assert_eq!(read.unit, unit);
        prop_assert_eq!(&read.ignored, &[(1, "PARTNO".to_owned())]);
        let table = Program::parse(csv(&made), "again").expect("it is a table");
        prop_assert_eq!((read.locations.len(), table.locations.len()), (made.locations.len(), made.locations.len()));
        for ((one, other), row) in made.locations.iter().zip(&read.locations).zip(&table.locations) {
            prop_assert_eq!(one.rapid, other.rapid);
            for pose in [&other.pose, &row.pose] {
                prop_assert!(same_bits(one.pose.tip(), pose.tip()));
                prop_assert!((one.pose.axis() - pose.axis()).amax() <= READ);
            }
        }
        // A program that was read once is written the same, except for that rounding of an axis.
        let again = Program::parse(apt(&read, &AptHeader { part: "A", cutter: None }), "again");
        let again = again.expect("it is a program");
        for (one, other) in read.locations.iter().zip(&again.locations) {
            prop_assert_eq!((one.line, one.rapid), (other.line, other.rapid));
            prop_assert!(same_bits(one.pose.tip(), other.pose.tip()));
            prop_assert!((one.pose.axis() - other.pose.axis()).amax() <= READ);
        }
    }

    #[test]
    fn spins_that_were_given_are_written(turns in prop::collection::vec(prop::array::uniform4(-1.0f64..1.0), 1..9)) {
        let full = turns.into_iter().filter_map(|turn| {
            let norm = turn.iter().map(|c| c * c).sum::<f64>().sqrt();
            let tip = Point3::new(0.1, -2.0, 1.0 / 3.0);
            (norm > 1e-2).then(|| Pose::from_quaternion(tip, turn.map(|c| c / norm)).expect("a turn"))
        });
        let Ok(made) = Program::new("made", None, full.map(|pose| (pose, false))) else { return Ok(()) };
        let read = Program::parse(csv(&made), "again").expect("it is a table");
        for (one, other) in made.locations.iter().zip(&read.locations) {
            prop_assert!(other.pose.has_spin());
            prop_assert!(turned(&one.pose, &other.pose) < 1e-14);
        }
    }
}

//! Programs that are written and read back.

use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use touchoff::tool::Tool;
use touchoff::{Pose, Unit};
use touchoff_verify::program::{AptHeader, ClData, Cutter, Decimals, WriteError};

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

fn apt(program: &ClData, header: &AptHeader<'_>) -> String {
    let mut out = Vec::new();
    program.write_apt(&mut out, header).expect("it can be written");
    String::from_utf8(out).expect("UTF-8")
}

fn csv(program: &ClData) -> String {
    let mut out = Vec::new();
    program.write_csv(&mut out).expect("it can be written");
    String::from_utf8(out).expect("UTF-8")
}

/// Returns the largest difference between the entries of two poses' rotations.
fn rotation_difference(first: &Pose, second: &Pose) -> f64 {
    (first.rotation() - second.rotation()).amax()
}

fn same_bits(first: Point3<f64>, second: Point3<f64>) -> bool {
    first.iter().zip(second.iter()).all(|(first, second)| first.to_bits() == second.to_bits())
}

#[test]
fn writes_programs_in_the_usual_form() {
    let poses = [
        (pose([1.0, 2.5, 0.0], [0.0, 0.0, 1.0]), true),
        (pose([1e-7, -2.0, 1e9], [0.6, 0.0, 0.8]), false),
    ];
    let program = ClData::new("made", Some(Unit::Inch), poses).expect("two poses");
    let cutter = Cutter::of(Flat.info(), Unit::Inch);
    let text = apt(&program, &AptHeader { part: "WALL $ 1; 2", cutter, ..AptHeader::default() });
    assert_eq!(
        text,
        "PARTNO/WALL $ 1; 2\nUNITS/INCHES\nMULTAX/ON\nCUTTER/0.47244094488188976,0\nRAPID\n\
         GOTO/1,2.5,0,0,0,1\nGOTO/0.0000001,-2,1000000000,0.6,0,0.8\nFINI\n"
    );
    assert_eq!(
        csv(&program),
        "x,y,z,i,j,k,end\n1,2.5,0,0,0,1,\n0.0000001,-2,1000000000,0.6,0,0.8,end of program\n"
    );
    let read = ClData::parse(&text, "again.cl").expect("it is a program");
    assert_eq!(read.ignored, [(1, "PARTNO".to_owned())]);
    assert_eq!(read.check_cutter(Flat.info(), Unit::Inch).expect("the same"), None);
    assert_eq!(read.unit, Some(Unit::Inch));
    assert_eq!(read.locations.iter().map(|location| location.line).collect::<Vec<_>>(), [6, 7]);
}

#[test]
fn writes_the_words_of_tool_spindle_and_feed_with_few_decimals() {
    let axis = Vector3::new(1.0, 2.0, 3.0).normalize();
    let poses = [
        (pose([1.0 / 3.0, -2e-6, 100.0], [0.0, 0.0, 1.0]), true),
        (pose([2.0 / 3.0, -2.5, 1e-4], axis.into()), false),
    ];
    let header = |unit| AptHeader {
        part: "A",
        tool_number: Some(7),
        spindle: Some(8000.0),
        feed: Some(600.5),
        decimals: Some(Decimals::of(unit)),
        ..AptHeader::default()
    };
    let program = ClData::new("made", Some(Unit::Millimetre), poses).expect("two poses");
    let text = apt(&program, &header(Unit::Millimetre));
    assert_eq!(
        text,
        "PARTNO/A\nUNITS/MM\nMULTAX/ON\nLOADTL/7\nSPINDL/8000,CLW\nFEDRAT/600.5,MMPM\nRAPID\n\
         GOTO/0.33333,0,100,0,0,1\nGOTO/0.66667,-2.5,0.0001,0.267261242,0.534522484,0.801783726\nFINI\n"
    );
    let read = ClData::parse(&text, "again.cl").expect("it is a program");
    let words: Vec<&str> = read.ignored.iter().map(|(_, word)| word.as_str()).collect();
    assert_eq!(words, ["PARTNO", "LOADTL", "SPINDL", "FEDRAT"]);
    assert_eq!(read.locations[1].pose.tip(), Point3::new(0.66667, -2.5, 0.0001));
    assert!((read.locations[1].pose.axis() - axis).amax() < 1e-9);
    // A program that was read is written as the same text.
    assert_eq!(apt(&read, &header(Unit::Millimetre)), text);

    let inch = ClData::new("made", Some(Unit::Inch), poses).expect("two poses");
    let text = apt(&inch, &header(Unit::Inch));
    assert!(
        text.contains("FEDRAT/600.5,IPM\n") && text.contains("GOTO/0.3333333,-0.000002,100,"),
        "{text}"
    );
    let refused = |program: &ClData, header: &AptHeader<'_>| {
        program.write_apt(&mut Vec::new(), header).expect_err("it is refused")
    };
    let unknown = ClData::new("made", None, poses).expect("two poses");
    assert!(matches!(refused(&unknown, &header(Unit::Inch)), WriteError::FeedUnit));
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for header in [
            AptHeader { feed: Some(rate), ..AptHeader::default() },
            AptHeader { spindle: Some(rate), ..AptHeader::default() },
        ] {
            assert!(matches!(refused(&inch, &header), WriteError::Rate { .. }));
        }
    }
}

#[test]
fn rejects_programs_that_apt_cannot_express() {
    let poses = [(pose([0.0; 3], [0.0, 0.0, 1.0]), false)];
    let metre = ClData::new("made", Some(Unit::Metre), poses).expect("a pose");
    let error = metre.write_apt(&mut Vec::new(), &AptHeader::default()).expect_err("no such unit");
    assert!(matches!(error, WriteError::Unit { unit: Unit::Metre }), "{error}");
    let program = ClData::new("made", None, poses).expect("a pose");
    for part in ["A\nGOTO/1,2,3", "A\r", "\u{1b}[2J"] {
        let header = AptHeader { part, ..AptHeader::default() };
        let error = program.write_apt(&mut Vec::new(), &header).expect_err("no line");
        assert!(matches!(error, WriteError::Part { .. }), "{error}");
    }
    assert!(!apt(&program, &AptHeader::default()).contains("UNITS"));
    let error = ClData::new("made", None, []).expect_err("no pose");
    assert_eq!(error.code(), "P0602", "{error}");
    let inch = ClData::new("made", Some(Unit::Inch), poses).expect("a pose");
    let error = inch.check_unit(Unit::Millimetre).expect_err("they differ");
    assert_eq!(error.code(), "P0605", "{error}");
}

#[test]
fn describes_cutters_that_two_numbers_define() {
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

/// Bound on the change of an axis by reading, per coordinate. Normalising errs by 3.5 u (2.5 u of the norm, u of
/// the quotient); making the rotation orthonormal moves it by half of 6 u and rounds once. The sum is 7.5 u, with
/// u = ε/2.
const AXIS_ROUNDING: f64 = 4.0 * f64::EPSILON;

proptest! {
    #[test]
    fn written_programs_are_read_back(poses in poses(), inches in any::<Option<bool>>()) {
        let unit = inches.map(|inches| if inches { Unit::Inch } else { Unit::Millimetre });
        let program = ClData::new("made", unit, poses).expect("a pose at least");
        let text = apt(&program, &AptHeader { part: "A", ..AptHeader::default() });
        prop_assert!(text.lines().all(|line| line.len() <= 72), "{}", text);
        let read = ClData::parse(&text, "again").expect("it is a program");
        prop_assert_eq!(read.unit, unit);
        prop_assert_eq!(&read.ignored, &[(1, "PARTNO".to_owned())]);
        let table = ClData::parse(csv(&program), "again").expect("it is a table");
        prop_assert_eq!((read.locations.len(), table.locations.len()), (program.locations.len(), program.locations.len()));
        for ((original, copy), row) in program.locations.iter().zip(&read.locations).zip(&table.locations) {
            prop_assert_eq!(original.rapid, copy.rapid);
            for pose in [&copy.pose, &row.pose] {
                prop_assert!(same_bits(original.pose.tip(), pose.tip()));
                prop_assert!((original.pose.axis() - pose.axis()).amax() <= AXIS_ROUNDING);
            }
        }
        // A program that was read once is written the same, except for that rounding of an axis.
        let read_twice = ClData::parse(apt(&read, &AptHeader { part: "A", ..AptHeader::default() }), "again");
        let read_twice = read_twice.expect("it is a program");
        for (original, copy) in read.locations.iter().zip(&read_twice.locations) {
            prop_assert_eq!((original.line, original.rapid), (copy.line, copy.rapid));
            prop_assert!(same_bits(original.pose.tip(), copy.pose.tip()));
            prop_assert!((original.pose.axis() - copy.pose.axis()).amax() <= AXIS_ROUNDING);
        }
    }

    #[test]
    fn given_spins_are_written(quaternions in prop::collection::vec(prop::array::uniform4(-1.0f64..1.0), 1..9)) {
        let poses = quaternions.into_iter().filter_map(|quaternion| {
            let norm = quaternion.iter().map(|c| c * c).sum::<f64>().sqrt();
            let tip = Point3::new(0.1, -2.0, 1.0 / 3.0);
            (norm > 1e-2).then(|| Pose::from_quaternion(tip, quaternion.map(|c| c / norm)).expect("a turn"))
        });
        let Ok(program) = ClData::new("made", None, poses.map(|pose| (pose, false))) else { return Ok(()) };
        let read = ClData::parse(csv(&program), "again").expect("it is a table");
        for (original, copy) in program.locations.iter().zip(&read.locations) {
            prop_assert!(copy.pose.has_spin());
            prop_assert!(rotation_difference(&original.pose, &copy.pose) < 1e-14);
        }
    }
}

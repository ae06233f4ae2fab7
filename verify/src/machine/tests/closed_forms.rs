//! Forward kinematics against closed forms: those of two tilting rotary tables (R. J. du Preez, *Axis machine
//! tools: kinematics and vismach implementation in LinuxCNC*, 2016; the modules `xyzac-trt` and `xyzbc-trt`), and the
//! rotation matrices of each machine of the library, written out.

use super::Random;
use crate::machine::{Letter, Machine, Setup};
use nalgebra::{Matrix3, Point3, Vector3};

/// Returns the file of a table that tilts about A or B and carries C. The angles of LinuxCNC's modules turn
/// the table, not the tool, so that their axes point in the opposite directions of ISO 841.
fn file(tilt: char, directions: f64, tilt_point: [f64; 3], turn_point: [f64; 3]) -> String {
    let along = if tilt == 'A' { [directions, 0.0, 0.0] } else { [0.0, directions, 0.0] };
    format!(
        r#"
name = "tilting rotary table"
axis = [
    {{ letter = "{tilt}", kind = "rotary", carries = "table", direction = {along:?}, point = {tilt_point:?} }},
    {{ letter = "C", kind = "rotary", carries = "table", direction = [0, 0, {directions:?}], point = {turn_point:?} }},
    {{ letter = "X", kind = "linear", carries = "tool" }},
    {{ letter = "Y", kind = "linear", carries = "tool" }},
    {{ letter = "Z", kind = "linear", carries = "tool" }},
]"#
    )
}

/// With the pivot L of both axes at the rotation point, the offsets D of the tilting axis from it, and P the
/// joint coordinates relative to the tilting axis, the document has Q = R_C (R_A P + D) + L. The tool's
/// length shifts the tilting axis by the same amount towards the gauge point. Written out, the rows of R_C
/// R_A are those below.
#[test]
fn poses_match_the_closed_forms_of_tilting_rotary_tables() {
    let mut random = Random::new(3);
    let mut greatest = 0.0f64;
    for case in 0..2000 {
        let tilts_about_a = case % 2 == 0;
        let directions = if case % 4 < 2 { -1.0 } else { 1.0 };
        let [pivot, offset, joints] =
            [200.0, 50.0, 300.0].map(|size| Vector3::from_fn(|_, _| size * random.unit()));
        // The offset along the tilting axis has no meaning, and neither has a pivot along C.
        let offset = match tilts_about_a {
            true => Vector3::new(0.0, offset.y, offset.z),
            false => Vector3::new(offset.x, 0.0, offset.z),
        };
        let length = 100.0 * (1.0 + random.unit());
        let text = file(
            if tilts_about_a { 'A' } else { 'B' },
            directions,
            (pivot + offset).into(),
            pivot.into(),
        );
        let machine = Machine::parse(&text, "trt").expect("a machine");
        let [tilt, turn] = [(); 2].map(|()| random.angle() % 360.0);
        let rotary = if tilts_about_a { [tilt, 0.0, turn] } else { [0.0, tilt, turn] };
        let setup = Setup { work_offset: [0.0; 6], tool_length: length };
        let chain = machine.chain(&setup).expect("a setup");
        let [a, b, c] = rotary;
        let pose = chain.pose(&[joints.x, joints.y, joints.z, a, b, c]).expect("a pose");

        // The document's angles: those of the table for `directions` −1.
        let [st, ss] = [tilt, turn].map(|angle| (-directions * angle).to_radians().sin());
        let [ct, cs] = [tilt, turn].map(|angle| angle.to_radians().cos());
        #[rustfmt::skip]
        let rows = match tilts_about_a {
            true => Matrix3::new(
                cs,  ss * ct, ss * st,
                -ss, cs * ct, cs * st,
                0.0, -st,     ct,
            ),
            false => Matrix3::new(
                cs * ct,  ss,  -cs * st,
                -ss * ct, cs,  ss * st,
                st,       0.0, ct,
            ),
        };
        let turn_rows = Matrix3::new(cs, ss, 0.0, -ss, cs, 0.0, 0.0, 0.0, 1.0);
        let lift = Vector3::new(0.0, 0.0, length);
        let p = joints - (pivot + offset + lift);
        let q = rows * p + turn_rows * (offset + lift) + pivot;
        let error = (pose.tip() - Point3::from(q - lift)).norm();
        let twist = (pose.rotation() - rows).norm();
        greatest = greatest.max(error).max(300.0 * twist);
        assert!(error < 1e-11 && twist < 1e-14, "{rotary:?}: {error:e} {twist:e}");
    }
    println!("greatest difference {greatest:e} mm");
}

/// Returns the rotation about x, y, z, or the nutating axis (0, 1, 1)/√2, by an angle in degrees.
fn written_out(axis: char, degrees: f64) -> Matrix3<f64> {
    let (s, c) = degrees.to_radians().sin_cos();
    let r = s * std::f64::consts::FRAC_1_SQRT_2;
    let [sum, rest] = [0.5 * (1.0 + c), 0.5 * (1.0 - c)];
    #[rustfmt::skip]
    let rows = match axis {
        'x' => Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c),
        'y' => Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c),
        'z' => Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0),
        _ => Matrix3::new(c, -r, r, r, sum, rest, -r, rest, sum),
    };
    rows
}

/// A rotary axis of a machine as its drawing gives it.
struct Drawn {
    letter: Letter,
    about: char,
    through: [f64; 3],
}

fn drawn(letter: Letter, about: char, through: [f64; 3]) -> Drawn {
    Drawn { letter, about, through }
}

/// The rotary axes of the machines of the library, from the workpiece to the tool, with the number of those that turn the table.
#[rustfmt::skip]
fn drawings() -> Vec<(&'static str, usize, [Drawn; 2])> {
    use Letter::{A, B, C};
    vec![
        ("A-C trunnion", 2, [drawn(C, 'z', [0.0, 0.0, -500.0]), drawn(A, 'x', [0.0, 0.0, -480.0])]),
        ("B-C table-table", 2, [drawn(C, 'z', [0.0, 0.0, -520.0]), drawn(B, 'y', [-40.0, 0.0, -470.0])]),
        ("A-B table-table", 2, [drawn(B, 'y', [0.0, 0.0, -700.0]), drawn(A, 'x', [0.0, -120.0, -700.0])]),
        ("B-C nutating table", 2, [drawn(C, 'z', [0.0, 0.0, -500.0]), drawn(B, 'n', [0.0, 0.0, -550.0])]),
        ("A head + C table", 1, [drawn(C, 'z', [0.0, 0.0, -600.0]), drawn(A, 'x', [0.0, 0.0, 160.0])]),
        ("B head + C table", 1, [drawn(C, 'z', [0.0, 0.0, -600.0]), drawn(B, 'y', [0.0, 0.0, 160.0])]),
        ("B nutating head + C table", 1, [drawn(C, 'z', [0.0, 0.0, -600.0]), drawn(B, 'n', [0.0, 0.0, 200.0])]),
        ("A-C fork head", 0, [drawn(C, 'z', [0.0, 0.0, 220.0]), drawn(A, 'x', [0.0, 0.0, 220.0])]),
        ("B-C fork head", 0, [drawn(C, 'z', [0.0, 0.0, 220.0]), drawn(B, 'y', [0.0, 0.0, 220.0])]),
        ("A-B head", 0, [drawn(A, 'x', [0.0, 0.0, 250.0]), drawn(B, 'y', [0.0, 0.0, 250.0])]),
        ("B-C nutating head", 0, [drawn(C, 'z', [0.0, 0.0, 240.0]), drawn(B, 'n', [0.0, 0.0, 240.0])]),
    ]
}

/// Poses of every machine of the library with rotary axes, and joint values for them: those of the table turn the tip after the
/// linear axes, those of the head before.
#[test]
fn machines_of_the_library_match_their_drawings() {
    let mut random = Random::new(11);
    let drawings = drawings();
    let names: Vec<&str> = Machine::names()
        .map(|name| name.trim_end_matches(" with bodies"))
        .filter(|name| !matches!(*name, "3-axis" | "4-axis"))
        .collect();
    assert!(names.iter().all(|name| drawings.iter().any(|(drawn, ..)| drawn == name)), "{names:?}");
    let mut solved = 0;
    for (name, tables, axes) in &drawings {
        let machine = Machine::named(name).expect("a machine");
        let setup = Setup { work_offset: [0.0; 6], tool_length: 130.0 };
        let chain = machine.chain(&setup).expect("a setup");
        for _ in 0..200 {
            let mut joints = [0.0; 6];
            (0..3).for_each(|k| joints[k] = 300.0 * random.unit());
            let mut turns = [Matrix3::identity(); 2];
            for (turn, Drawn { letter, about, .. }) in turns.iter_mut().zip(axes) {
                let [low, high] =
                    machine.axis(*letter).and_then(|axis| axis.limits).unwrap_or([-180.0, 180.0]);
                let angle = 0.5 * (low + high) + 0.5 * (high - low) * random.unit();
                joints[letter.index()] = angle;
                *turn = written_out(*about, angle);
            }
            let mut tip = Vector3::new(0.0, 0.0, -130.0);
            for index in [1, 0] {
                // The linear axes are between those of the head and those of the table.
                if index + 1 == *tables {
                    tip += Vector3::new(joints[0], joints[1], joints[2]);
                }
                let through = Vector3::from(axes[index].through);
                tip = through + turns[index] * (tip - through);
            }
            if *tables == 0 {
                tip += Vector3::new(joints[0], joints[1], joints[2]);
            }
            let pose = chain.pose(&joints).expect("a pose");
            let error = (pose.tip().coords - tip).norm();
            let twist = (pose.rotation() - turns[0] * turns[1]).norm();
            assert!(error < 1e-11 && twist < 1e-14, "{name}: {joints:?}: {error:e} {twist:e}");
            // Linear limits are those of a machine, and random positions are beyond some of them.
            if let Ok(solution) =
                chain.without_linear_limits().inverse(&Point3::from(tip), &pose.axis(), &joints)
            {
                for k in 0..6 {
                    assert!(
                        (solution.joints[k] - joints[k]).abs() < 1e-5,
                        "{name}: {joints:?} {solution:?}"
                    );
                }
                solved += 1;
            }
        }
    }
    assert_eq!(solved, 200 * drawings.len());
}

/// The table A of the four-axis machine, which both linear axes of its cross table carry.
#[test]
fn the_table_of_four_axes_turns_about_its_drawn_line() {
    let mut random = Random::new(5);
    let machine = Machine::named("4-axis").expect("a machine");
    let setup = Setup { work_offset: [0.0; 6], tool_length: 90.0 };
    let chain = machine.chain(&setup).expect("a setup");
    let through = Vector3::new(0.0, 0.0, -500.0);
    for _ in 0..200 {
        let [x, y, z] = [(); 3].map(|()| 200.0 * random.unit());
        let angle = random.angle() % 360.0;
        let turn = written_out('x', angle);
        let tip = through + turn * (Vector3::new(x, y, z - 90.0) - through);
        let pose = chain.pose(&[x, y, z, angle, 0.0, 0.0]).expect("a pose");
        let error = (pose.tip().coords - tip).norm();
        assert!(error < 1e-11 && (pose.rotation() - turn).norm() < 1e-14, "{angle}: {error:e}");
    }
}

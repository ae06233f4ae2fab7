//! Forward kinematics against the closed forms of two tilting rotary tables (R. J. du Preez, *Axis machine
//! tools: kinematics and vismach implementation in LinuxCNC*, 2016; the modules `xyzac-trt` and `xyzbc-trt`).

use super::Random;
use crate::machine::{Machine, Setup};
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

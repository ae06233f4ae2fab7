//! Cycles of Heidenhain Klartext: their levels along the hole, and the helix of bore milling.

use crate::common::{assert_fault, is_fault};
use crate::klartext::{at_zero, program, steps};
use touchoff_verify::gcode::{NoteKind, Spindle, Step, StepPath, read};

/// Returns the levels of Z to which the steps of the last block move, with a mark for rapid traverse.
pub(crate) fn levels(body: &str) -> Vec<(bool, f64)> {
    let steps = steps(body);
    let last = steps.last().expect("steps").line;
    let of_last = steps.iter().filter(|step| step.line == last && step.commanded[2]);
    of_last.map(|step| (step.rapid, step.end[2].expect("a level"))).collect()
}

#[test]
fn cycles_move_along_the_hole() {
    let at = "TOOL CALL 5 Z S900\nL X+10 Y+20 FMAX M3\nL Z+100 FMAX\n";
    let call = |cycle: &str| levels(&format!("{at}{cycle}\nL X+30 FMAX M99"));
    let [rapid, feed] = [true, false];
    let common = "Q200=+2 ;CLEARANCE ~\n Q201=-20 ~\n Q206=+100 ~\n Q203=+1 ~\n Q204=+50";
    let single =
        |number: u32, more: &str| call(&format!("CYCL DEF {number} NAME ~\n {common} ~\n {more}"));
    assert_eq!(
        single(200, "Q202=+8"),
        [
            (rapid, 3.0),
            (feed, -7.0),
            (rapid, 3.0),
            (rapid, -5.0),
            (feed, -15.0),
            (rapid, 3.0),
            (rapid, -13.0),
            (feed, -19.0),
            (rapid, 51.0)
        ]
    );
    assert_eq!(single(200, "Q202=+20"), [(rapid, 3.0), (feed, -19.0), (rapid, 51.0)]);
    assert_eq!(single(240, "Q343=+0"), [(rapid, 3.0), (feed, -19.0), (rapid, 51.0)]);
    assert_eq!(single(201, "Q208=AUTO"), [(rapid, 3.0), (feed, -19.0), (feed, 3.0), (rapid, 51.0)]);
    // Infeeds of 8, 6, 5 (the least one) and 1.
    assert_eq!(
        single(203, "Q202=+8 ~\n Q212=+2 ~\n Q205=+5 ~\n Q213=+0"),
        [
            (rapid, 3.0),
            (feed, -7.0),
            (feed, 3.0),
            (rapid, -5.0),
            (feed, -13.0),
            (feed, 3.0),
            (rapid, -11.0),
            (feed, -18.0),
            (feed, 3.0),
            (rapid, -16.0),
            (feed, -19.0),
            (feed, 3.0),
            (rapid, 51.0)
        ]
    );
    assert_eq!(
        single(205, "Q202=+15 ~\n Q258=+0.5 ~\n Q259=+1"),
        [(rapid, 3.0), (feed, -14.0), (rapid, 3.0), (rapid, -13.5), (feed, -19.0), (rapid, 51.0)]
    );
    // Breaks of chips between which the tool stays in the hole, which it leaves in rapid traverse.
    assert_eq!(
        single(203, "Q202=+5 ~\n Q213=+2 ~\n Q208= MAX ;RETRACTION ~\n Q256=+1"),
        [
            (rapid, 3.0),
            (feed, -14.0),
            (rapid, 3.0),
            (rapid, -12.0),
            (feed, -19.0),
            (rapid, 3.0),
            (rapid, 51.0)
        ]
    );
    // A second clearance below the first one has no part.
    let low = "CYCL DEF 207 TAP ~\n Q200=+5 ~\n Q201=-34 ~\n Q239=+1.25 ~\n Q203=+0 ~\n Q204=+1";
    assert_eq!(call(low), [(rapid, 5.0), (feed, -34.0), (feed, 5.0)]);
    let tapped = steps(&format!("{at}{low}\nCYCL CALL"));
    assert!(tapped[tapped.len() - 2..].iter().all(|step| step.spindle == Spindle::RightTap));
    // The hand of a thread is the sign of its pitch, or that of the spindle.
    let floating =
        "CYCL DEF 206 TAP ~\n Q200=+5 ~\n Q201=-34 ~\n Q206=500 ~\n Q211=0 ~\n Q203=+0 ~\n Q204=+1";
    for (spindle, cycle, hand) in [
        ("M3", low.replace("Q239=+", "Q239=-"), Spindle::LeftTap),
        ("M4", floating.to_owned(), Spindle::LeftTap),
        ("M3", format!("{floating}\nCYCL CALL"), Spindle::RightTap),
        ("M5", floating.to_owned(), Spindle::Stopped),
    ] {
        let tapped = steps(&format!("{at}{spindle}\n{cycle}\nCYCL CALL"));
        assert_eq!(tapped[tapped.len() - 1].spindle, hand, "{spindle} {cycle}");
    }
    // Boring leaves the wall by 0.2 mm along -X, and returns to the axis above the part.
    let bored = steps(&format!("{at}CYCL DEF 202 BORE ~\n {common} ~\n Q214=+1\nCYCL CALL"));
    let last: Vec<_> =
        bored[bored.len() - 6..].iter().map(|step| [step.end[0], step.end[2]]).collect();
    let expected =
        [[10.0, 3.0], [10.0, -19.0], [9.8, -19.0], [9.8, 3.0], [9.8, 51.0], [10.0, 51.0]];
    assert_eq!(last, expected.map(|point| point.map(Some)));
    // Calls: modal until M99, at a position with a higher surface, and not at all for the depth 0.
    let drill = format!("CYCL DEF 200 DRILLING ~\n {common} ~\n Q202=+30\n");
    let holes = |body: &str| {
        let steps = steps(&format!("{at}{drill}{body}"));
        let bottoms = steps.iter().filter(|step| !step.rapid);
        bottoms
            .map(|step| [step.end[0], step.end[1], step.end[2]].map(|v| v.expect("known")))
            .collect::<Vec<_>>()
    };
    assert_eq!(
        holes("L X+1 FMAX M89\nL X+2 FMAX\nL X+3 FMAX M99\nL X+4 FMAX"),
        [[1.0, 20.0, -19.0], [2.0, 20.0, -19.0], [3.0, 20.0, -19.0]]
    );
    assert_eq!(
        holes(
            "CC X+10 Y+10\nM89\nLP PR+10 PA+0 FMAX\nCP IPA+180 DR+ FMAX\nCTP PR+10 PA-90 FMAX M99"
        )
        .len(),
        3
    );
    assert_eq!(holes("CYCL CALL POS X+7 Y+8 Z+4"), [[7.0, 8.0, -15.0]]);
    let none = drill.replace("Q201=-20", "Q201=+0");
    assert_eq!(steps(&format!("{at}{none}\nCYCL CALL")).len(), steps(at).len());
}

/// Cycle 208 is the same motions in L, CC and CP; a tool of the bore's diameter plunges.
#[test]
fn a_bore_is_milled_on_a_helix() {
    let at =
        "TOOL DEF 5 L+80 R+4\nTOOL CALL 5 Z S900 F100 DR+0.5\nL X+10 Y+20 FMAX M3\nL Z+100 FMAX\n";
    let bore = |diameter: f64, more: &str| {
        format!(
            "{at}CYCL DEF 208 BORE MILLING ~\n Q200=+2 ~\n Q201=-10 ~\n Q206=+100 ~\n Q334=+0.5 ~\n Q203=+1 ~\n Q204=+20 ~\n \
             Q335={diameter:+} {more}\nCYCL CALL"
        )
    };
    let plain = |sign: char| {
        let [down, around] = [24 * 360, 360].map(|angle| format!("IPA{sign}{angle} DR{sign}"));
        format!(
            "{at}L Z+3 FMAX\nL X+13 F100\nCC X+10 Y+20\nCP {down} Z-9\nCP {around}\nL X+10 Y+20\nL Z+3 FMAX\nL Z+21 FMAX"
        )
    };
    for (more, sign) in [("", '+'), ("~\n Q342=+0 ~\n Q351=+1", '+'), ("~\n Q351=-1", '-')] {
        let (found, expected) = (steps(&bore(15.0, more)), steps(&plain(sign)));
        let moved = |step: &&Step| step.start != step.end || step.path != StepPath::Line;
        let ways = |steps: &[Step]| -> Vec<(bool, [i64; 3], Option<i64>)> {
            let moving =
                steps.iter().filter(moved).filter(|step| step.end[2] != Some(3.0) || !step.rapid);
            let rounded = |value: f64| (1e9 * value).round() as i64;
            let way = moving.map(|step| {
                let end = [0, 1, 2].map(|axis| rounded(step.end[axis].expect("a number")));
                let sweep = match step.path {
                    StepPath::Arc { centre: [10.0, 20.0], sweep, .. } => Some(rounded(sweep)),
                    _ => None,
                };
                (step.rapid, end, sweep)
            });
            way.collect()
        };
        assert_eq!(ways(&found), ways(&expected));
    }
    let (_, notes) = read(&program(&bore(15.0, "")), &at_zero()).expect("a program");
    assert!(notes.iter().any(|note| note.kind == NoteKind::HelixStart), "{notes:?}");
    assert_eq!(levels(&bore(9.0, "")), [(true, 3.0), (false, -9.0), (true, 21.0)]);
    for (body, message) in [
        (bore(8.0, ""), "P0120 CYCL"),
        (bore(18.5, ""), "P0115 a bore of more than twice the tool"),
        (bore(15.0, "").replace("Q334=+0.5", "Q334=+0"), "P0110 an infeed per turn above 0"),
        (bore(15.0, "").replace("Q334=+0.5", "Q334=+0.001"), "P0124"),
        (bore(15.0, "").replace("TOOL DEF 5 L+80 R+4\n", ""), "P0401 radius offset 5"),
    ] {
        let error = read(&program(&body), &at_zero()).expect_err(&body);
        assert!(is_fault(&error, message), "{body}\n{error}");
    }
    // A bore that was milled before needs no second pass.
    assert!(read(&program(&bore(24.0, "~\n Q342=+10")), &at_zero()).is_ok());
}

/// A parameter by which a cycle goes to another depth is refused by its name, unless it is 0.
#[test]
fn a_parameter_of_another_depth_is_refused() {
    let drilled = |number: u32, more: &str| {
        let body = format!(
            "TOOL CALL 5 Z S900\nL X+10 Y+20 FMAX M3\nL Z+100 FMAX\nCYCL DEF {number} NAME Q200=+2 Q201=-20 Q206=+100 Q202=+20 \
             Q203=+1 Q204=+50 {more}\nL X+30 FMAX M99"
        );
        read(&program(&body), &at_zero()).map(|(steps, _)| steps.len())
    };
    for number in [200, 203, 205] {
        let plain = drilled(number, "").expect("a cycle");
        assert_eq!(drilled(number, "Q395=+0").expect("a cycle"), plain);
        for refused in ["Q395=+1", "Q999=+3", "Q379=+8"] {
            let error = drilled(number, refused).expect_err(refused);
            let (name, _) = refused.split_once('=').expect("a name");
            let pattern = format!("P0115 {name} of CYCL DEF {number}");
            assert!(is_fault(&error, &pattern), "{error}");
        }
    }
    assert!(drilled(205, "Q379=+0 Q253=+750").is_ok());
}

/// Words in the place of numbers, parameters in lower case, and values that change before the call.
#[test]
fn parameters_mean_what_the_control_takes_for_them() {
    for (cycle, body, line, message) in [
        ("Q206=MAX", "M99", 5, "P0115 Q206 of CYCL DEF 200"),
        ("Q211=AUTO", "M99", 5, "P0115 Q211 of CYCL DEF 200"),
        ("q395=+1", "M99", 5, "P0115 Q395 of CYCL DEF 200"),
        ("Q211=+0 NAME", "M99", 5, "P0110 NAME"),
        ("", "Q201 = -15\nCYCL CALL", 7, "P0115 Q201 of CYCL DEF 200"),
        ("", "FN 0: Q203 = -20\nL X+1 FMAX M99", 7, "P0115 Q203 of CYCL DEF 200"),
        ("", "Q395 = 1\nM89\nL X+1 FMAX", 8, "P0115 Q395 of CYCL DEF 200"),
        ("", "M89\nL X+0 FMAX M91", 7, "P0120 M91"),
    ] {
        let text = program(&format!(
            "TOOL CALL 5 Z S900 F99\nL X+10 Y+20 FMAX M3\nL Z+100 FMAX\n\
             CYCL DEF 200 NAME Q200=+2 Q201=-20 Q206=+100 Q202=+20 Q203=+1 Q204=+50 {cycle}\n{body}"
        ));
        let error = read(&text, &at_zero()).expect_err(body);
        assert_fault(&text, &error, line, message);
    }
    // The same value, and a value of another cycle, change nothing.
    let cycle = "CYCL DEF 200 NAME Q200=+2 Q201=Q1 q206=FZ0.1 Q202=+20 Q203=+1 Q204=+50\n";
    steps(&format!(
        "TOOL CALL 5 Z S900 F99\nL X+1 Y+2 Z+9 FMAX M3\nQ1 = -5\n{cycle}Q201 = -5\nQ343 = 1\nCYCL CALL\nQ201 = -9\n{cycle}CYCL CALL"
    ));
}

/// A job states values that the machine has: a parameter that the program has not assigned, and one of the control.
#[test]
fn parameters_are_stated() {
    let body = "TOOL CALL 5 Z S900\nL X+Q50 Y+QL7 FMAX M3\nL Z+Q108 FMAX";
    assert!(read(&program(body), &at_zero()).is_err());
    let mut setup = at_zero();
    for (name, value) in [("Q50", 12.5), ("ql7", -3.0), ("Q108", 5.0)] {
        setup.variables.insert(name.to_owned(), vec![value]);
    }
    let (steps, _) = read(&program(body), &setup).expect("a program");
    assert_eq!(steps.last().expect("a step").end[..3], [12.5, -3.0, 5.0].map(Some));
}

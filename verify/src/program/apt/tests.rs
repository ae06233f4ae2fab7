use super::super::tests::{flank, line_of, refusal, shared};
use super::{MAX_ALL_CHORDS, Reader, statements};
use crate::program::{ClData, Located, ProgramError};
use nalgebra::{Point3, Vector3};
use std::f64::consts::TAU;
use std::path::Path;
use touchoff::tool::Interpreted;
use touchoff::{Tool, Unit};

fn program(text: &str) -> ClData {
    ClData::parse(text, "part.cl").expect("it is a program")
}

#[test]
fn reads_a_flank_pass_from_a_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let (text, stops) = flank();
    let path = folder.path().join("flank.apt");
    std::fs::write(&path, &text).expect("a file");
    let program = ClData::read(path).expect("it is a program");
    assert_eq!(program.unit, Some(Unit::Millimetre));
    let ignored: Vec<&str> = program.ignored.iter().map(|(_, word)| word.as_str()).collect();
    assert_eq!(ignored, ["PARTNO", "LOADTL", "SPINDL", "FEDRAT"]);
    assert!(program.check_unit(Unit::Millimetre).is_ok());
    assert!(program.check_unit(Unit::Inch).is_err());
    assert_eq!(program.locations.len(), stops.len());
    let lines: Vec<&str> = text.lines().collect();
    for (stop, ([x, y, z, i, j, k], rapid)) in program.locations.iter().zip(stops) {
        assert_eq!((stop.rapid, stop.pose.tip()), (rapid, Point3::new(x, y, z)));
        assert!((stop.pose.axis() - Vector3::new(i, j, k)).norm() < 2e-5);
        assert!(lines[stop.line - 1].starts_with(&format!("GOTO/{x:.5},")));
    }
    if let Some(path) = shared("impeller_flank.apt") {
        the_impeller(&path);
    }
}

fn the_impeller(path: &Path) {
    let program = ClData::read(path).expect("it is a program");
    assert_eq!(program.unit, Some(Unit::Millimetre));
    let ignored: Vec<&str> = program.ignored.iter().map(|(_, word)| word.as_str()).collect();
    assert_eq!(ignored, ["PARTNO", "LOADTL", "SPINDL", "FEDRAT"]);
    let cutting = program.locations.iter().filter(|stop| !stop.rapid).count();
    assert_eq!((cutting, program.locations.len()), (1274, 1302));
    let first = program.locations[0];
    assert!(first.rapid);
    assert_eq!(first.line, 9);
    assert_eq!(first.pose.tip(), Point3::new(34.73109, 4.67398, 21.56186));
    let axis = Vector3::new(0.9912089, 0.1320835, -0.0076686);
    assert!((first.pose.axis() - axis).norm() < 1e-7);
    assert!(program.check_unit(Unit::Millimetre).is_ok());
}

#[test]
fn an_axis_that_is_left_out_stays_in_files_of_nx() {
    let text =
        "TOOL PATH/A,TOOL,B\nGOTO/1,2,3\nGOTO/4,5,6,1,0,0\nGOTO/7,8,9\nMULTAX\nGOTO/1,1,1\nFINI\n";
    let axes: Vec<_> = program(text).locations.iter().map(|stop| stop.pose.axis()).collect();
    let [x, z] = [Vector3::x(), Vector3::z()];
    assert_eq!(axes, [z, x, x, x]);
    // Elsewhere it stays, or is +Z.
    let upright = program("GOTO/1,2,3,0,0,1\nGOTO/4,5,6\nMULTAX/OFF\nGOTO/7,8,9\nFINI\n");
    assert!(upright.locations.iter().all(|stop| stop.pose.axis() == z));
    for text in [
        "GOTO/4,5,6,1,0,0\nGOTO/7,8,9\nFINI",
        "GOTO/4,5,6,1,0,0\nMULTAX/OFF\nGOTO/7,8,9\nFINI",
        "GOTO/4,5,6,1,0,0\nLOADTL/2\nGOTO/7,8,9\nFINI",
        "TOOL PATH/A,TOOL,B\nGOTO/4,5,6,1,0,0\nMULTAX/OFF\nGOTO/7,8,9\nFINI",
    ] {
        assert_eq!(refusal(text).1, "P0526", "{text}");
    }
}

/// Frames among the comments, of which a second one changes what positions mean.
#[test]
fn another_frame_among_the_comments_is_refused() {
    let catia = |x: &str| {
        format!(
            "$$*CATIA0\n$$ Machining.1\n$$ 1.0 0.0 0.0 {x}\n$$ 0.0 1.0 0.0 0.0\n$$ 0.0 0.0 1.0 0.0\n"
        )
    };
    let creo = |x: &str| format!("$$-> CSYS / 1, 0, 0, {x}\n");
    // Rows of Creo are no comments in its own files. Every row counts.
    let continued = |x: &str| {
        format!(
            "$$-> CSYS / 1.0, 0.0, 0.0, {x},  $\n  0.0, 1.0, 0.0, 0.0,  $\n  0.0, 0.0, 1.0, 0.0\n"
        )
    };
    let rows = |x: &str| format!("$$-> CSYS / 1, 0, 0, 0\n$$-> 0, 1, 0, {x}\n$$-> 0, 0, 1, 0\n");
    for frame in [&catia as &dyn Fn(&str) -> String, &creo, &continued, &rows] {
        let text = |x: &str| {
            format!("UNITS/MM\n{}GOTO/1,2,3\n{}GOTO/4,5,6\nFINI\n", frame("0.0"), frame(x))
        };
        assert_eq!(program(&text("0.0")).locations.len(), 2);
        assert_eq!(refusal(text("100.0")).1, "P0512");
    }
}

/// Creo repeats its coordinate system at each operation, among other comments and with other digits.
#[test]
fn a_coordinate_system_may_be_repeated() {
    let text = "$$-> CSYS / 1.0, 0.0, 0.0, 25.40\n$$-> CUTTER / 16.0\nGOTO/1,2,3\n\
                $$-> CSYS / 1, -0.0, 0, 25.4\n$$-> FEATNO / 12\nGOTO/4,5,6\nFINI\n$$-> CSYS / 1,0,0,25.4\n";
    assert_eq!(program(text).locations.len(), 2);
}

#[test]
fn rapid_holds_for_one_goto() {
    let text = "FROM/0,0,9\nRAPID\nGOTO/1,2,3\ngoto / 4 , 5 , 6\nRAPID;GOTO/7,8,9\nFINI";
    let stops: Vec<_> =
        program(text).locations.iter().map(|stop| (stop.line, stop.rapid)).collect();
    assert_eq!(stops, [(1, true), (3, true), (4, false), (5, true)]);
}

#[test]
fn reads_comments_and_continuations() {
    let text = "$$ from the CAM\r\nPARTNO/A $ IS NO CONTINUATION $\r\nunits/inches $$ said\r\n\
                GOTO/1.5, $\r\n  $$ between\r\n 2.5,-.5$\r\n,0,1,0\r\nFINI\r\nREMARK bye\r\n";
    let program = program(text);
    assert_eq!(program.unit, Some(Unit::Inch));
    assert_eq!(program.locations.len(), 1);
    assert_eq!(program.locations[0].line, 4);
    assert_eq!(program.locations[0].pose.tip(), Point3::new(1.5, 2.5, -0.5));
    assert_eq!(program.locations[0].pose.axis(), Vector3::y());
}

#[test]
fn lists_what_it_passes_over() {
    let text = "TOOL PATH/A,TOOL,B\nMSYS/0.,0,0,1,0,0,0,1,0\nTLDATA/DRILL,2\nPPRINT hi; GOTOX/1\n\
                CYCLE/OFF\ncutcom / off\nMODE/ABSOL\nLOADTL/3\nFEDRAT/ 250.\nGOTO/1,2,3\n\
                COOLNT/OFF\nEND-OF-PATH\nFINI\n";
    let expected = [
        (1, "TOOL PATH"),
        (2, "MSYS"),
        (3, "TLDATA"),
        (4, "PPRINT"),
        (5, "CYCLE"),
        (6, "CUTCOM"),
        (7, "MODE"),
        (8, "LOADTL"),
        (9, "FEDRAT"),
        (11, "COOLNT"),
    ];
    assert_eq!(program(text).ignored, expected.map(|(line, word)| (line, word.to_owned())));
}

/// Words that move the tool, words that change the meaning of positions, and unknown words.
#[test]
fn what_could_be_a_motion_is_refused() {
    let words = "GOTOX/1,2,3|GOOT/1,2,3|GO TO/1,2,3|GOABS/1,2,3|LINEAR/1,2,3|MOVE/1,2,3|MOVETO/1,2,3|\
                 ARC/1,2,3|CIRC/1,2,3|ARCDAT/1,2,3|DRILL/1,2,3|GODLT/1,2,3|ORIGIN/0,0,35|CUTCOM/3DCOMP|\
                 MODE/INCR|THICK/-5|HEAD/2|LOADTL/2|CUTTER/50|INSERT G0 Z-5|LETTER/G1 Z-5|INSERT/X5 Y-2.|INSERT/TRANS X10|INSERT/R1=5|INSERT/L X+5|\
                 INSERT/CYCLE800(1)|INSERT/X0Y0Z-5.|INSERT/Z-5(PARK)|INSERT/Z[-5.]|INSERT/Z-5. FMAX|INSERT/X+0 Z-5. R0 FMAX|INSERT/Z-5.,F100|INSERT/'Z-5.'|INSERT/Z-5. (DOWN)|INSERT/G 0 Z -5.|INSERT/Z-5.F100.|INSERT/Z-5.*|INSERT/(A) ; Z-5.|INSERT/GOTOF ENDE|\
                 INSERT/MYSUB(1,2)|INSERT/MYSUB|INSERT/RND R5|INSERT/#1=2|INSERT/CALL LBL 5|INSERT $P_PFRAME=CTRANS(Z,-10)|INSERT $P_UIFR[1,Z,TR]=-10|\
                 INSERT $TC_DP3[1,1]=90|INSERT TCARR=1|INSERT TCH PROBE 400 BASIC ROTATION|INSERT FUNCTION RESET TCPM|\
                 INSERT FN 17: SYSWRITE ID 220 NR4 IDX3 = -10|INSERT TOROT PAROT|INSERT (A|INSERT FOO BAR=5|INSERT FOO: BAR|\
                 CSI_ROTATE_TABLE 90|CSI_WORK_OFFSET/2|RAPID/ON|OPSKIP/ON|\
                 TRACUT/M1|C1 = CIRCLE/0,0,1|M1 = MACRO/|AUXFUN/98|PREFUN/91|X|GOTO|TLDATA/MILL,50.,0.";
    for word in words.split('|') {
        let text =
            format!("UNITS/MM\nLOADTL/1\nCUTTER/2,1\nGOTO/1,2,3\n{word}\nGOTO/4,5,6\nFINI\n");
        assert_eq!(refusal(&text).0, 5, "{word}");
    }
    for word in [
        "FEDRAT/100 GOTO/0,0,-5",
        "FEDRAT/RAPID",
        "STOP/GOTO/0,0,-5",
        "ISN/5 GODLTA/0,0,-5",
        "TITLES/x$\nGOTO/0,0,-5",
        "FEDRAT/100 GOHOME",
        "FEDRAT/ 5,CYCLE,DRILL,0,0,-5",
        "FEDRAT/ 5 GO TO 0,0,-5",
        "FEDRAT/GOTO(1)",
        "CUT/TLLFT,GOFWD",
        "OPSTOP/GOHOME",
        "TOOLNO/1,GOTO,0,0,-5",
        "FINI/GOTO/0,0,-5",
        "END-OF-PATH/GOTO/0,0,-5",
        "TLAXIS/0,0,1",
        "tldata/mill,50,0,30,0,0",
        "TLDATA/MILL ,50,0",
        "TLDATA/MILL,2,1,30,20,45",
        "TLDATA/BALL,50,25",
        "CUTTER/2,1,0,1,45,30",
        "TOOLNO/2",
        "TOOL PATH/B,TOOL,D50",
        "LOADTL/2",
    ] {
        let text = format!(
            "TOOL PATH/A,TOOL,D2\nTLDATA/MILL,2,1\nTOOLNO/1\nLOADTL/1\nCUTTER/2\nGOTO/1,2,3\n{word}\nFINI\n"
        );
        assert_eq!(refusal(&text).0, 7, "{word}");
    }
    for word in [
        "LOADTL/1 GOTO/0,0,-5",
        "LOADTL/1 $\nGOTO/0,0,-5",
        "TLDATA/DRILL,2 GOTO/0,0,-5",
        "TLDATA/MILL,2,1,75,0,0,GOTO/0,0,-5",
        "TOOLNO/1,GOTO/0,0,-5",
        "TOOL PATH/A,GODLTA/0,0,-5",
        "TOOL PATH/A GOTO/0,0,-5,TOOL,B",
    ] {
        let text = format!("FROM/0,0,50\n{word}\nGOTO/0,0,1\nFINI\n");
        assert_eq!(refusal(text), (2, "P0516"), "{word}");
    }
    assert_eq!(refusal("FROM/0,0,9\nGOTO/1,2,3\nLOADTL/2\nGOTO/4,5,6\nFINI"), (3, "P0517"));
    for hidden in ["\u{c}", "\u{b}", "\u{85}", "\u{2028}", "\u{2029}", "\u{1b}"] {
        let text = format!("GOTO/1,2,3\nFEDRAT/100 {hidden}GOTO/0,0,-5\nFINI");
        assert_eq!(refusal(text), (2, "P0518"), "{hidden:?}");
    }
}

#[test]
fn the_end_of_a_path_of_nx_ends_a_program() {
    let whole = "TOOL PATH/A,TOOL,B\nGOTO/1,2,3\nGOTO/4,5,6\nEND-OF-PATH";
    assert_eq!(program(whole).locations.len(), 2);
    assert_eq!(program(&format!("{whole}\nFINI\n")).locations.len(), 2);
    assert_eq!(
        refusal(format!("{whole}\nTOOL PATH/C,TOOL,D\nGOTO/1,2,3\nEND-OF-PATH\n")),
        (5, "P0519")
    );
    assert_eq!(
        refusal(format!("{whole}\nTOOL PATH/C,TOOL,B\nGOTO/1,2,3\nEND-OF-PATH\n")),
        (5, "P0530")
    );
}

/// A tool and the lines of its positions.
type ToolLines = (Option<u32>, Vec<usize>);

/// Returns the tools of a program, each with the lines of its positions.
fn tools(text: &str) -> Result<Vec<ToolLines>, (usize, &'static str)> {
    let programs = ClData::parse_tools(text, "part.cl");
    let programs = programs.map_err(|error| (line_of(&error), error.code()))?;
    let lines = |program: &ClData| program.locations.iter().map(|at| at.line).collect();
    Ok(programs.iter().map(|program| (program.tool, lines(program))).collect())
}

#[test]
fn a_tool_change_begins_another_program() {
    let text = "UNITS/INCHES\nFROM/0,0,9\nLOADTL/3,ADJUST,3\nCUTTER/.5\nGOTO/1,2,3\nLOADTL/3\nGOTO/2,2,3\n\
                CUTTER/.25,.125\nLOADTL/7\nFROM/0,0,9\nGOTO/4,5,6\nGOTO/5,5,6\nLOADTL/3\nCUTTER/.5\n\
                GOTO/7,8,9,1,0,0\nLOADTL/0\nFINI\n";
    let expected = vec![(Some(3), vec![2, 5, 7]), (Some(7), vec![10, 11, 12]), (Some(3), vec![15])];
    assert_eq!(tools(text), Ok(expected));
    let programs = ClData::parse_tools(text, "part.cl").expect("three programs");
    assert!(programs.iter().all(|program| program.unit == Some(Unit::Inch)));
    assert_eq!(programs[2].locations[0].pose.axis(), Vector3::x());
    assert_eq!(refusal(text), (8, "P0517"));
}

#[test]
fn operations_of_nx_follow_one_another() {
    let operation = |name: &str, tool: &str, more: &str| {
        format!(
            "TOOL PATH/{name},TOOL,{tool}\nTLDATA/MILL,6,3\n{more}GOTO/1,2,3\nGOTO/2,2,3\nEND-OF-PATH\n"
        )
    };
    let both = [operation("A", "BALL", "LOADTL/1\n"), operation("B", "MILL", "LOADTL/2\n")];
    let expected = vec![(Some(1), vec![4, 5]), (Some(2), vec![10, 11])];
    assert_eq!(tools(&both.concat()), Ok(expected));
    let again = operation("A", "BALL", "") + &operation("B", "BALL", "");
    assert_eq!(tools(&again), Ok(vec![(None, vec![3, 4, 8, 9])]));
    let unnumbered = operation("A", "BALL", "") + &operation("B", "MILL", "");
    assert_eq!(tools(&unnumbered), Err((6, "P0519")));
    let unfinished = both.concat().replace("END-OF-PATH\nTOOL", "TOOL");
    let unfinished = unfinished.strip_suffix("END-OF-PATH\n").expect("the end");
    assert!(tools(unfinished).is_err_and(|(_, code)| code == "P0528"));
    assert_eq!(tools("LOADTL/1\nGOTO/1,2,3\nLOADTL/NEXT\nGOTO/1,2,3\nFINI"), Err((3, "P0520")));
    assert!(tools("LOADTL/1\nGOTO/1,2,3\nLOADTL/2\nUNITS/MM\nGOTO/1,2,3\nFINI").is_err());
}

#[test]
fn the_cutter_is_compared_with_the_tool() {
    let text = "tool Ball { units mm; profile { start (0, 0); arc to (3, 3) center (0, 3) as ball cutting; \
                line to (3, 20), (0, 20) as shank; } niceness cutting: 1; }";
    let ball = Interpreted::from_text("ball.tool", text).expect("a tool");
    let check = |cutter: &str, unit: Unit| {
        let text = format!("{cutter}\nGOTO/1,2,3\nGOTO/4,5,6\nFINI");
        program(&text).check_cutter(ball.info(), unit)
    };
    let mm = Unit::Millimetre;
    for same in [
        "CUTTER/6.0,3.0",
        "$$-> CUTTER / 6.000000",
        "TLDATA/DRILL,MILL,6.0000,0.0000,80.0000,118.0000,35.0000",
        "CUTTER/6.,3.,0.,3.,0.,0.,30.",
        "CUTTER/6.,3.,0.,0.,0.,0.,30.",
        "CUTTER/6.001,3",
        "TLDATA/MILL,6.0000,3.0000,30.0000,0.0000,0.0000",
        "UNITS/INCHES\nCUTTER/.23622,.11811",
        "PPRINT none",
    ] {
        assert_eq!(check(same, mm).expect(same), None);
    }
    assert_eq!(check("CUTTER/.23622,.11811", Unit::Inch).expect("the same"), None);
    for other in [
        "CUTTER/50",
        // A corner that is left out is 0.
        "CUTTER/6",
        "$$-> CUTTER / 8.000000",
        "$$->CUTTER/6,0",
        "TLDATA/DRILL,MILL,8.0000,0.0000,80.0000,118.0000,35.0000",
        "TLDATA/TCUTTER,20.0000,0.0000,75.0000,5.0000,0.0000,0,0,0",
        "CUTTER/6,0",
        "CUTTER/6,3,0,3,0,5",
        "UNITS/INCHES\nCUTTER/6,3",
    ] {
        assert!(check(other, mm).is_err(), "{other}");
    }
    let error = check("CUTTER/50,1", mm).expect_err("another one");
    let is_found = matches!(&error, ProgramError::Cutter { line: 1, stated, expected, .. } if (&**stated, &**expected) == ("50,1", "6,3"));
    assert!(is_found, "{error}");
    assert_eq!(check("TLDATA/BARREL,6,5,75,5", mm).expect("another kind"), Some(1));
}

/// Two numbers do not describe a drill, but its diameter is compared.
#[test]
fn the_diameter_of_other_tools_is_compared() {
    let text = "tool Drill { units mm; profile { start (0, 0); line to (2.5, 1.5) as point cutting; \
                line to (2.5, 40) as flute cutting; line to (2.5, 60), (0, 60) as shank; } niceness cutting: 1; }";
    let drill = Interpreted::from_text("drill.tool", text).expect("a tool");
    let check = |cutter: &str| {
        let text = format!("{cutter}\nGOTO/1,2,3\nGOTO/4,5,6\nFINI");
        program(&text).check_cutter(drill.info(), Unit::Millimetre)
    };
    assert_eq!(check("TLDATA/DRILL,MILL,5,0,50,118,35").expect("the same"), None);
    // The angle of a side says where the diameter is.
    for same in ["CUTTER/5,0", "TLDATA/MILL,5,0,75,0,0", "CUTTER/1,0,0,0,0,30,50"] {
        assert_eq!(check(same).expect(same), Some(1));
    }
    for other in ["CUTTER/10,0", "CUTTER/10", "TLDATA/DRILL,MILL,10,0,50,118,35"] {
        let error = check(other).expect_err(other).to_string();
        assert!(error.contains("CUTTER/10") && error.ends_with("to try another"), "{error}");
        assert!(error.contains("which is CUTTER/5 in mm"), "{error}");
    }
}

#[test]
fn holds_the_program_to_the_part() {
    let program = program("\nUNITS/MMS\nGOTO/1,2,3\nFINI\n");
    let error = program.check_unit(Unit::Inch).expect_err("they differ");
    assert_eq!((line_of(&error), error.code()), (2, "P0605"), "{error}");
}

/// Without a unit, arcs are divided into chords as in millimetres.
#[test]
fn arcs_need_the_unit_of_the_part() {
    let text = "GOTO/1,0,0\nCIRCLE/0,0,0,0,0,1,1\nGOTO/-1,0,0\nFINI\n";
    let unstated = program(text);
    assert!(unstated.check_unit(Unit::Millimetre).is_ok());
    for part in [Unit::Inch, Unit::Metre] {
        let error = unstated.check_unit(part).expect_err("an arc");
        assert_eq!((line_of(&error), error.code()), (3, "P0607"), "{error}");
    }
    let straight = text.replace("CIRCLE/0,0,0,0,0,1,1\n", "");
    assert!(program(&straight).check_unit(Unit::Inch).is_ok());
    assert!(program(&format!("UNITS/INCHES\n{text}")).check_unit(Unit::Inch).is_ok());
}

/// The words are those of the bodies that the sentences show.
#[test]
fn every_refusal_names_its_line_and_word() {
    for (body, line, code, word) in [
        ("GODLTA/0,0,1\nFINI", 2, "P0510", "GODLTA"),
        ("TLLFT, gofwd / L1,PAST,L2\nFINI", 2, "P0510", "TLLFT"),
        ("GOTOX/1,2,3\nFINI", 2, "P0515", "`GOTOX`"),
        ("C1 = LINE/P1,P2\nFINI", 2, "P0515", "`C1 = LINE`"),
        ("LOADTL/1\nGOTO/1,2,3\nLOADTL/2\nFINI", 4, "P0519", "line 2"),
        ("INSERT G0 Z-5\nFINI", 2, "P0514", "INSERT"),
        ("L1) CYCLE/DRILL,5\nFINI", 2, "P0510", "CYCLE"),
        ("MSYS/0,0,5,1,0,0,0,1,0\nFINI", 2, "P0512", "MSYS"),
        ("0010 GOTO/1,2,3\nFINI", 2, "P0521", "`0010 GOTO/1,2,3`"),
        ("GOTO 1,2,3\nFINI", 2, "P0521", "`GOTO 1,2,3`"),
        ("GOTO/1,2\nFINI", 2, "P0509", "GOTO has 2 "),
        ("GOTO\nFINI", 2, "P0509", "GOTO has 0 "),
        ("GOTO/1,2,1e999\nFINI", 2, "P0506", "`1e999`"),
        ("GOTO/1,NaN,3\nFINI", 2, "P0506", "`NaN`"),
        ("GOTO/P1\nFINI", 2, "P0505", "`P1`"),
        ("GOTO/1,2,3,0,0,0\nFINI", 2, "P0507", "i,j,k"),
        ("GOTO/1,2,3,0,3,4\nFINI", 2, "P0508", "norm 5"),
        ("MULTAX/3\nFINI", 2, "P0522", "MULTAX/3"),
        ("UNITS/CM\nFINI", 2, "P0523", "UNITS/CM"),
        ("UNITS/INCH\nFINI", 2, "P0524", "from mm to inch"),
        ("GOTO/1,2,3\nFROM/4,5,6\nFINI", 3, "P0527", "FROM"),
        ("GOTO/1,2,3\n\n", 2, "P0528", "FINI"),
        ("GOTO/1,2,3\nGOTO/4,5", 3, "P0528", "FINI"),
        ("GOTO/1,2,3\nGOTO/4,5,6,0,0.7", 3, "P0528", "FINI"),
        ("GOTO/1,2,3,$\n0,0,1$", 2, "P0528", "FINI"),
        ("GOTO/1,2,3\nFIN", 3, "P0515", "`FIN`"),
        ("GOTO/1,2,3\nFINI\n\nPPRINT BYE\nGOTO/1,2,3", 6, "P0530", "FINI"),
    ] {
        let text = format!("UNITS/MM\n{body}");
        let error = ClData::parse(&text, "part.cl").expect_err(body);
        assert_eq!((line_of(&error), error.code()), (line, code), "{text:?}: {error}");
        assert!(error.to_string().contains(word), "{text:?}: {error}");
    }
    assert_eq!(refusal("GOTO/1,2,3\nUNITS/MM\nFINI"), (2, "P0525"));
}

/// No truncated file is taken for a whole one.
#[test]
fn no_beginning_is_a_program() {
    let whole = "PARTNO/A\nUNITS/MM\nRAPID\nGOTO/1,2,3,0,0,1\nGOTO/4,5,6,$\n0,1,0\nFINI";
    assert_eq!(program(whole).locations.len(), 2);
    for end in 0..whole.len() {
        assert!(ClData::parse(&whole[..end], "part.cl").is_err(), "{:?}", &whole[..end]);
    }
}

/// A program as SolidWorks CAM posts it: settings of its own, prose of the control, a frame that is none, arcs and holes.
#[test]
fn programs_of_solidworks_are_read() {
    let text = "PARTNO/PLATE\nUNIT/MM\nINSERT/TOOL AT DOOR 2, X9. [HOLDER=ER32] 10MM 2FL\nCSI_TOOL/1,\"END MILL\"\n\
        CSYS/1,0,0,0,0,1,0,0,0,0,1,0\nTRNTYP/WORLD,0,0,0\nLOAD/TOOL,3\nSPINDL/RPM,4000,CLW\n\
        RAPID/\nGOTO/20,0,10\nFEDRAT/300,MMPM\nGOTO/20,0,-2\nCUTCOM/LEFT,3\n\
        CIRCLE/0,0,-2,0,0,1,20\nGOTO/0,20,-2\nCUTCOM/OFF\nRAPID/\nGOTO/0,20,10\nFINI\n";
    let read = program(text);
    assert_eq!((read.unit, read.tool), (Some(Unit::Millimetre), Some(3)));
    let arc: Vec<_> = read.locations.iter().filter(|stop| stop.line == 15).collect();
    assert!(arc.len() > 100 && arc.iter().all(|stop| !stop.rapid));
    for stop in &arc {
        let tip = stop.pose.tip();
        assert!((tip.coords.xy().norm() - 20.0).abs() < 1e-9 && tip.z == -2.0, "{tip}");
        assert!(tip.x > -1e-9 && tip.y > 0.0, "{tip}");
    }
    let rapids = read.locations.iter().filter(|stop| stop.rapid).map(|stop| stop.line);
    assert_eq!(rapids.collect::<Vec<_>>(), [10, 18]);
    for text in
        ["INSERT/(G0 Z-5)", "INSERT TOOL 3: 10MM END MILL (LONG)", "LETTER/FACE THE TOP, 2 PASSES"]
    {
        assert_eq!(program(&format!("{text}\nGOTO/1,2,3\nFINI\n")).ignored.len(), 1);
    }
    // The other way round is three quarters of the circle.
    let other = program(&text.replace("0,0,1,20", "0,0,-1,20"));
    let lowest = other.locations.iter().map(|stop| stop.pose.tip().y).fold(0.0, f64::min);
    assert!((lowest + 20.0).abs() < 1e-4, "{lowest}");
}

/// The lengths and the ranges of y of paths with arcs, as several systems write them.
#[test]
fn arcs_of_several_systems_are_read() {
    let creo = "$$-> MFGNO / A\n";
    let third = "CIRCLE/0,0,0,0,0,1,10\nGOTO/-5,8.6602540378,0\nGOTO/-5,-8.6602540378,0\nGOTO/10,0,0\nGOTO/30,0,0\nFINI";
    let catia = |end: &str| {
        format!(
            "GOTO/0,-10,0\nAUTOPS\nINDIRV/ 1.0, 0.0, 0.0\nTLON,GOFWD/ (CIRCLE/ 0.0, 0.0, 0.0,$\n 10.0),{end}\nFINI"
        )
    };
    let movarc = |arc: &str| format!("GOTO/10,0,0\nMOVARC/{arc}\nGOTO/0,-10,0\nFINI");
    let turn = std::f64::consts::TAU * 10.0;
    for (text, length, [lowest, highest]) in [
        // NX turns clockwise about the vector, and adds four numbers.
        (
            "TOOL PATH/A,TOOL,B\nGOTO/-10,0,0,0,0,1\nCIRCLE/0,0,0,0,0,1,10,.06,.5,10,0\nGOTO/0,10,0\nEND-OF-PATH".to_owned(),
            turn / 4.0,
            [0.0, 10.0],
        ),
        // Creo states several positions on one arc; elsewhere the next position is its end.
        (format!("{creo}GOTO/10,0,0\n{third}"), turn + 20.0, [-10.0, 10.0]),
        (format!("GOTO/10,0,0\n{third}"), turn / 3.0 + 20.0 * 3f64.sqrt() + 20.0, [-8.66025, 10.0]),
        // Half a circle, and back along its diameter.
        (
            format!("{creo}GOTO/10,0,0\nCIRCLE/0,0,0,0,0,1,10\nGOTO/0,10,0\nGOTO/-10,0,0\nGOTO/10,0,0\nFINI"),
            turn / 2.0 + 20.0,
            [0.0, 10.0],
        ),
        (catia("ON,(LINE/ 0.0, 0.0, 0.0, 10.0, 0.0, 0.0)"), turn / 4.0, [-10.0, 0.0]),
        (catia("ON,2,INTOF,$\n(LINE/ 0.0, 0.0, 0.0,$\n -10.0, 0.0, 0.0)"), 0.75 * turn, [-10.0, 10.0]),
        // Autodesk's post processors state the angle, some of them with one normal for both directions.
        (movarc("0, 0, 0, 0, 0, -1., 10., ANGLE, 90."), turn / 4.0, [-10.0, 0.0]),
        (movarc("0, 0, 0, 0, 0, 1., 10., ANGLE, 90."), turn / 4.0, [-10.0, 0.0]),
        (movarc("0, 0, 0, 0, 0, 1., 10., ANGLE, 270."), 0.75 * turn, [-10.0, 10.0]),
        // A stub of a turn is none.
        ("GOTO/40,0,0\nCIRCLE/-1000,0,0,0,0,1,1040\nGOTO/40,0.001,0\nFINI".to_owned(), 0.001, [0.0, 0.001]),
        // Without an angle, a clockwise arc has to tell that normals state directions.
        (movarc(" CENTER, 0, 0, 0, AXIS, 0, 0, -1, RADIUS, 10"), turn / 4.0, [-10.0, 0.0]),
        (
            movarc("CENTER, 0, 0, 0, AXIS, 0, 0, 1, RADIUS, 10\nGOTO/0,-10,0\nMOVARC/CENTER, 0, 0, 0, AXIS, 0, 0, -1, RADIUS, 10\nGOTO/-10,0,0"),
            turn + 200f64.sqrt(),
            [-10.0, 10.0],
        ),
        // A statement between them ends Creo's arc.
        (
            format!("{creo}GOTO/10,0,0\nCIRCLE/0,0,0,0,0,1,10\nGOTO/0,10,0\nFEDRAT/400\nGOTO/7.0710678,7.0710678,0\nFINI"),
            turn / 4.0 + 20.0 * (TAU / 16.0).sin(),
            [0.0, 10.0],
        ),
    ] {
        let stops = program(&text).locations;
        let tips: Vec<_> = stops.iter().map(|stop| stop.pose.tip()).collect();
        let found: f64 = tips.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        assert!((found - length).abs() < 1e-3, "{found}, not {length}: {text}");
        let ends = tips.iter().fold([f64::MAX, f64::MIN], |[a, b], tip| [a.min(tip.y), b.max(tip.y)]);
        assert!((ends[0] - lowest).abs() < 1e-3 && (ends[1] - highest).abs() < 1e-3, "{ends:?}: {text}");
    }
    let helix =
        |end: &str| format!("UNITS/MM\nGOTO/10,0,0\nCIRCLE/0,0,0,0,0,1,10\nGOTO/{end}\nFINI");
    let half = "MOVARC/0, 20, 0, 0, 0, 1., 15., ANGLE, 180.\nGOTO/0,5,0\n";
    for text in [
        // A helix that ends near its start could be a whole turn.
        helix("9.9999999,-0.0001,-1"),
        // A shorter way behind equal ones may be the rest of the circle or a chord.
        format!(
            "{creo}GOTO/10,0,0\nCIRCLE/0,0,0,0,0,1,10\nGOTO/0,10,0\nGOTO/-10,0,0\nGOTO/0,-10,0\nGOTO/9.659258,-2.588190,0\nFINI"
        ),
        // A counter-clockwise arc has the same normal in files of both kinds.
        format!(
            "GOTO/10,0,0\nMOVARC/0,0,0,0,0,1,10,ANGLE,90\nGOTO/0,10,0\nGOTO/0,35,0\n{half}FINI"
        ),
        movarc("0, 0, 0, 0, 0, 1., 10., ANGLE, 45."),
        movarc("0, 0, 0, 0, 0, 1., 10."),
        movarc("CENTER, 0, 0, 0, AXIS, 0, 0, 1, RADIUS, 10"),
        // Radii that differ, of which each control makes another way, a way that could be a whole turn, and half a turn in a file that
        // states one normal for both directions.
        "UNITS/MM\nGOTO/200,0,0\nCIRCLE/0,0,0,0,0,1,200\nGOTO/-200.002,0,0\nFINI".to_owned(),
        "UNITS/MM\nGOTO/200,0,0\nCIRCLE/0,0,0,0,0,1,200\nGOTO/199.9995,-0.01,0\nFINI".to_owned(),
        "UNITS/MM\nGOTO/40,0,0\nCIRCLE/-1000,0,0,0,0,1,1040\nGOTO/40,0.0001,0\nFINI".to_owned(),
        movarc(
            "0, 0, 0, 0, 0, 1., 10., ANGLE, 90.\nGOTO/0,-10,0\nMOVARC/-30, -10, 0, 0, 0, 1., 30., ANGLE, 180.\nGOTO/-60,-10,0",
        ),
        "UNITS/MM\nGOTO/10,0,0\nMOVARC/0, 0, 0, 0, 0, 1., 10., ANGLE, 180.\nGOTO/-10,0,0\nFINI"
            .to_owned(),
        catia("ON,2,INTOF,(LINE/ 0.0, 0.0, 0.0, 10.0, 0.0, 0.0)"),
        catia("ON,(LINE/ 0.0, 0.0, 0.0, -10.0, 0.0, 0.0)"),
        catia("PAST,(LINE/ 0.0, 0.0, 0.0, 10.0, 0.0, 0.0)"),
        catia("ON,(LINE/ 0.0, 0.0, 0.0, 10.0, 0.0, 0.0)")
            .replace("INDIRV/ 1.0, 0.0, 0.0", "PPRINT"),
        "GOTO/10,0,0\nCIRCLE/0,0,0,0,0,1,10,1\nGOTO/0,10,0\nFINI".to_owned(),
    ] {
        assert_eq!(refusal(&text).1, "P0532", "{text}");
    }
}

/// A helix of a whole turn is one in every plane, although its ends are rounded, and also with a stated angle.
#[test]
fn a_helix_of_a_whole_turn_is_read_in_every_plane() {
    for degrees in [0.0_f64, 10.0, 20.0, 30.0, 35.0, 40.0, 50.0, 60.0] {
        let (y, z) = degrees.to_radians().sin_cos();
        let start = format!("UNITS/MM\nGOTO/-6,20,-5,0,{y:.7},{z:.7}\n");
        let centre = format!("4,20,-5,0,{y:.7},{z:.7},10");
        let end = format!("GOTO/-6,{:.6},{:.6},0,{y:.7},{z:.7}\n", 20.0 - y, -5.0 - z);
        // A clockwise circle on the other side proves that normals state directions.
        let proof = format!(
            "MOVARC/-16,20,-5,0,{:.7},{:.7},10,ANGLE,360\nGOTO/-6,20,-5,0,{y:.7},{z:.7}\n",
            -y, -z
        );
        for arc in [format!("CIRCLE/{centre}\n"), format!("{proof}MOVARC/{centre},ANGLE,360\n")] {
            let text = format!("{start}{arc}{end}FINI");
            let stops = program(&text).locations;
            let farthest = stops.iter().map(|stop| stop.pose.tip().x).fold(f64::MIN, f64::max);
            assert!((farthest - 14.0).abs() < 1e-4, "{degrees}: {farthest}");
        }
    }
}

/// Fewer chords would be farther from the arc than the tolerance, and a program of few bytes may have very many.
#[test]
fn arcs_with_too_many_chords_are_refused() {
    let quarter = |r: f64| format!("GOTO/{r},0,0\nCIRCLE/0,0,0,0,0,1\nGOTO/0,{r},0\nFINI");
    assert_eq!(refusal(quarter(1e8)), (3, "P0533"));
    let count = program(&quarter(1e4)).locations.len() - 1;
    assert!(count as f64 > 0.99 * TAU / 4.0 / (8.0 * 2e-5 / 1e4_f64).sqrt(), "{count}");
    // Each chord is within the limit of an arc, and one more than those of the program is too many.
    for (left, is_read) in [(count, true), (count - 1, false)] {
        let mut reader = Reader { chords: MAX_ALL_CHORDS - left, ..Reader::default() };
        let statements = statements(&quarter(1e4)).0;
        let read: Result<(), Located> =
            statements.iter().try_for_each(|(line, text)| reader.statement(*line, text, false));
        match read {
            Ok(()) => assert!(is_read),
            Err((line, fault)) => assert!(!is_read && (line, fault.code()) == (3, "P0534")),
        }
    }
}

/// CATIA names the tool and loads it again in each operation, and ends without `FINI`.
#[test]
fn programs_of_catia_are_read() {
    let text = "MULTAX\nTOOLNO/1,MILL,1,0, 100.0,$\n 60.0,,RPM,CLW,$\nON,,NOTE\nTPRINT/T1 DRILL 1/2,T1 DRILL\nLOADTL/1,1,1\n\
        LOADTL/1,1\nGOTO / 1.0, 2.0, 3.0, 0.0, 0.0, 1.0\nEND\nLOADTL/1,1\nGOTO / 4.0, 2.0, 3.0, 0.0, 0.0, 1.0\n\
        SPINDL/OFF\nREWIND/0\nEND\n";
    assert_eq!(program(text).locations.len(), 2);
    assert_eq!(refusal(text.replace("\nEND\n", "\n")).1, "P0528");
    assert_eq!(refusal(text.replace("\nLOADTL/1,1\n", "\nLOADTL/2,1\n")), (7, "P0519"));
    // The beginning of `END-OF-PATH` ends nothing.
    assert_eq!(refusal("TOOL PATH/A,TOOL,B\nGOTO/1,2,3\nGOTO/4,5,6\nEND").1, "P0528");
}

/// Creo says whether positions are those of the contour, about which the control has to correct the whole radius.
#[test]
fn positions_of_the_contour_are_refused() {
    let text = |kind: &str, side: &str| {
        format!(
            "$$-> CUTCOM_GEOMETRY_TYPE / {kind}\nGOTO/1,2,3\nCUTCOM / {side}\nGOTO/4,5,6\nFINI\n"
        )
    };
    assert_eq!(refusal(text("OUTPUT_ON_PROFILE", "LEFT, 1")), (3, "P0511"));
    assert_eq!(refusal(text("OUTPUT_ON_PROFILE $", "LEFT, 1")), (3, "P0511"));
    let late = "CUTCOM/LEFT,1\n$$-> CUTCOM_GEOMETRY_TYPE / OUTPUT_ON_PROFILE\nGOTO/1,2,3\nGOTO/4,5,6\nFINI\n";
    assert_eq!(refusal(late), (2, "P0511"));
    for (kind, side) in [("OUTPUT_ON_CENTER", "LEFT, 1"), ("OUTPUT_ON_PROFILE", "OFF")] {
        assert_eq!(program(&text(kind, side)).locations.len(), 2);
    }
}

/// The ways of a cycle at its holes: heights and rapid traverse.
#[test]
fn cycles_drill_at_each_position() {
    let heights = |cycle: &str| -> Vec<(f64, bool)> {
        let text = format!("UNITS/MM\nRAPID\nGOTO/0,0,30\n{cycle}\nGOTO/5,0,0\nCYCLE/OFF\nFINI\n");
        let stops = program(&text).locations.into_iter().skip(1);
        stops.map(|stop| (stop.pose.tip().z, stop.rapid)).collect()
    };
    let down = [(30.0, true), (3.0, true), (-5.0, false)];
    let drilled = heights("CYCLE/DRILL,FEDTO,5,MMPM,125,RAPTO,3,RTRCTO,25,DWELL,0");
    assert_eq!(drilled, [&down[..], &[(25.0, true)]].concat());
    assert_eq!(heights("cycle/deep,fedto,-5,rapto,3"), [&down[..], &[(3.0, true)]].concat());
    // Other words for the same lengths, and a cycle that changes one of them.
    for cycle in [
        "CYCLE/DEEP,DEPTH,5,STEP,2,PERMIN,125,CLEAR,3,RETURN,25",
        "CYCLE/DRILL,DEEP,STEP,2,CLEAR,3,FEDTO,-5,RTRCTO,25",
        "CYCLE/DRILL,BRKCHP,STEP,2,RAPTO,3,FEDTO,-9,RTRCTO,25\nCYCLE/ON,FEDTO,-5",
    ] {
        assert_eq!(heights(cycle), drilled, "{cycle}");
    }
    for cycle in
        ["CYCLE/ON,FEDTO,5", "CYCLE/DRILL,DEPTH,5,CLEAR,3,RAPTO,1", "CYCLE/DRILL,5,MMPM,100,3"]
    {
        let text = format!("GOTO/0,0,30\n{cycle}\nGOTO/5,0,0\nFINI\n");
        assert_eq!(refusal(text), (2, "P0531"), "{cycle}");
    }
    let back = [&down[..], &[(3.0, false), (30.0, true)]].concat();
    assert_eq!(heights("CYCLE/TAP,FEDTO,5,RAPTO,3,RTRCTO,AUTO"), back);
    // To a hole that is higher than the one before some controls rise first, and some go sideways.
    let text = "UNITS/MM\nGOTO/0,0,3\nCYCLE/DRILL,FEDTO,5,RAPTO,3\nGOTO/5,0,20\nCYCLE/OFF\nFINI\n";
    assert_eq!(refusal(text), (4, "P0531"));
    let above = text.replace("GOTO/0,0,3", "GOTO/5,0,3");
    let ends = program(&above).locations.into_iter().map(|stop| stop.pose.tip().z);
    assert!(ends.eq([3.0, 23.0, 23.0, 15.0, 23.0]), "{above}");
}

/// Every obstacle is said at once, each with its first line.
#[test]
fn all_obstacles_are_found_at_once() {
    let text = "UNITS/MM\nGOTO/0,0,3\nCYCLE/THREAD,FEDTO,5\nGOTO/5,0,0\nTRACUT/1,2\nCUTCOM/3DCOMP\n\
        GOFWD/A\nTRACUT/3,4\nCIRCLE/1,2\nGOTO/5,0,5\nFINI\n";
    let error = ClData::parse(text, "part.cl").expect_err("obstacles");
    let ProgramError::Line { line, others, .. } = &error else { panic!("{error}") };
    let codes: Vec<_> = others.iter().map(|(line, fault)| (*line, fault.code())).collect();
    assert_eq!((*line, error.code()), (3, "P0531"));
    assert_eq!(codes, [(5, "P0512"), (6, "P0511"), (7, "P0510"), (9, "P0532")], "{error}");
    let said = error.to_string();
    for line in [3, 5, 6, 7, 9] {
        assert!(said.contains(&format!("part.cl:{line}: ")), "{said}");
    }
    // The message lists the first of them, and says how many it leaves out.
    let many: String = (0..200_000).map(|number| format!("WORD{number}/1\n")).collect();
    let said = ClData::parse(&many, "part.cl").expect_err("obstacles").to_string();
    assert!(said.lines().count() == 102, "{said}");
    assert!(said.ends_with("\npart.cl: 199899 more faults from line 102 on"), "{said}");
}

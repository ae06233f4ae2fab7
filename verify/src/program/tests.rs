//! Both formats, with valid and invalid input.

use super::*;
use std::path::PathBuf;

/// Returns the line, with 0 for none, and the code of content that is refused.
pub(super) fn refusal(content: impl AsRef<[u8]>) -> (usize, &'static str) {
    let error = ClData::parse(content, "part.cl").expect_err("it is refused");
    (line_of(&error), error.code())
}

pub(super) fn line_of(error: &ProgramError) -> usize {
    match error {
        ProgramError::OnePosition { line, .. }
        | ProgramError::Cutter { line, .. }
        | ProgramError::Line { line, .. }
        | ProgramError::NoSpin { line, .. }
        | ProgramError::UnscaledArc { line, .. } => *line,
        ProgramError::Unit { line, .. } => line.unwrap_or(0),
        ProgramError::Read { .. } | ProgramError::NoPosition { .. } => 0,
    }
}

/// Returns a table like published ones, and its rows: a fan of tilted tool axes over an arc, rounded to four
/// digits, under a comment with the columns' names.
pub(super) fn fan() -> (String, Vec<[f64; 6]>) {
    let rows: Vec<[f64; 6]> = (0..25)
        .map(|k| {
            let turn = 0.15 * f64::from(k) - 0.5;
            let (lean, round) = (0.7 + 0.01 * f64::from(k), 1.0 + turn);
            let row = [
                115.0 * turn.cos(),
                -115.0 * turn.sin(),
                0.2 * f64::from(k) - 2.0,
                lean.sin() * round.cos(),
                lean.sin() * round.sin(),
                lean.cos(),
            ];
            row.map(|number| (number * 1e4).round() / 1e4)
        })
        .collect();
    let mut text = String::from("# x,y,z,i,j,k  (mm, unit tool vector tip->spindle)\n");
    for row in &rows {
        text += &row.map(|number| format!("{number:.4}")).join(",");
        text.push('\n');
    }
    (text, rows)
}

/// Returns a program as CAM systems post it, and its positions, each with a flag that is set in rapid traverse:
/// a flank pass about a cone, with a rapid link after every tenth position, and words that move nothing.
pub(super) fn flank() -> (String, Vec<([f64; 6], bool)>) {
    let mut text = String::from(
        "PARTNO/CONE FLANK PASS\nUNITS/MM\nMULTAX/ON\nCUTTER/2.,1.,0.,1.,0.,0.,5.\nLOADTL/1\n\
         SPINDL/12000,CLW\nFEDRAT/600,MMPM\n",
    );
    let stops: Vec<_> = (0..500)
        .map(|k| {
            let (sine, cosine) = (0.05 * f64::from(k)).sin_cos();
            let out = if k % 10 == 0 { 30.0 } else { 10.0 };
            let row = [out * cosine, out * sine, 20.0, 0.6 * cosine, 0.6 * sine, 0.8];
            (row.map(|number| (number * 1e5).round() / 1e5), k % 10 == 0)
        })
        .collect();
    for (row, rapid) in &stops {
        text += if *rapid { "RAPID\n" } else { "" };
        text += &format!("GOTO/{}\n", row.map(|number| format!("{number:.5}")).join(","));
    }
    (text + "FINI\n", stops)
}

/// Returns the path of a file in the shared data. If it is absent, as in a checkout alone, this prints so and
/// returns `None`; its tests also run on a stand-in made here.
pub(super) fn shared(name: &str) -> Option<PathBuf> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/paths");
    let path = root.join(name);
    if path.is_file() {
        return Some(path);
    }
    eprintln!("{} is absent: only the stand-in is read", path.display());
    None
}

#[test]
fn refuses_what_is_neither_format() {
    for empty in ["", "\u{feff}", "# only\n\n$$ comments\r\n", "FINI\n"] {
        assert_eq!(refusal(empty), (0, "P0602"), "{empty:?}");
    }
    assert_eq!(refusal("G0 X1 Y-2.5\nM30\n"), (1, "P0513"));
    assert_eq!(refusal("\n%\nO1000\n"), (2, "P0502"));
    for (content, line, byte) in
        [(&b"\xff\xfe1\0"[..], 1, 3), (&b"1,2,3,0,0,1\r\n1\0,\0"[..], 2, 14)]
    {
        let error = ClData::parse(content, "part.cl").expect_err("no text");
        let ProgramError::Line { line: found, fault, .. } = error else { panic!("{error}") };
        assert_eq!((found, fault), (line, ProgramFault::NotText { byte }));
    }
}

/// The first line tells G-code, also where it is a call or a declaration of Sinumerik.
#[test]
fn the_first_line_tells_g_code() {
    for first in [
        "G17 G90",
        "%",
        "(A)",
        "O<a> sub",
        "0 BEGIN PGM A MM",
        "MSG(\"T1 D=6\")",
        "CYCLE832(0.01, _FINISH, 1)",
        "N10 MSG(\"A\")",
        "DEF REAL A",
        "PROC A",
        "T=\"MILL 6\"",
    ] {
        let read = ProgramFile::parse(format!("; A\n\n{first}\n"), "a.mpf");
        assert!(matches!(read, Ok(ProgramFile::Gcode(_))), "{first}: {read:?}");
    }
    for first in [
        "PARTNO/A",
        "GOTO/1,2,3,0,0,1",
        "UNITS/MM",
        "1,2,3,0,0,1",
        "x,y,z,i,j,k",
        "PARTNO A (B)",
        "PARTNO (OP10)",
        "PPRINT (A)",
    ] {
        let read = ProgramFile::parse(format!("{first}\n"), "a.cl");
        assert!(!matches!(read, Ok(ProgramFile::Gcode(_))), "{first}: {read:?}");
    }
}

#[test]
fn names_a_file_that_is_absent() {
    let error = ClData::read("no/such.cl").expect_err("it is absent");
    assert!(matches!(&error, ProgramError::Read { file, .. } if file == "no/such.cl"), "{error}");
}

#[test]
fn quotes_briefly_and_in_one_line() {
    assert_eq!(shown("\u{1b}[2J"), "`\\u{1b}[2J`");
    assert_eq!(shown(&"é".repeat(99)), format!("`{}…`", "é".repeat(40)));
}

/// Any bytes give a program or an error, never a panic.
#[test]
fn survives_mutations() {
    let mut seeds = vec![
        b"\xef\xbb\xbfx,y,z,qx,qy,qz,qw\r\n1,2,3,0,0,0,1 # a\r\n4,5,6,1,0,0,0\n".to_vec(),
        b"UNITS/MM\nMULTAX/ON\nRAPID;GOTO/1,2,3,$\n0,0,1\nCYCLE/OFF\nGOTO/4,5,6\nFINI\n".to_vec(),
    ];
    seeds.extend([fan().0.into_bytes(), flank().0.into_bytes()]);
    for name in ["impeller_flank.apt", "ijms2021_fan_xyzijk.csv"] {
        seeds.extend(shared(name).and_then(|path| std::fs::read(path).ok()));
    }
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = move |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        usize::try_from(state >> 33).unwrap_or(0) % below.max(1)
    };
    let spice = b"\0\r\n,;/$#.-+eE09 \xff\xc3xG\"";
    for seed in &seeds {
        for _ in 0..3000 {
            let start = random(seed.len() / 2);
            let length = random(600.min(seed.len() - start)) + 1;
            let mut bytes = seed[start..start + length].to_vec();
            for _ in 0..random(6) {
                let at = random(bytes.len());
                match random(3) {
                    0 => bytes[at] = spice[random(spice.len())],
                    1 => bytes.insert(at, spice[random(spice.len())]),
                    _ => bytes.truncate(at + 1),
                }
            }
            match ClData::parse(&bytes, "mutant") {
                Ok(program) => assert!(!program.locations.is_empty()),
                Err(error) => assert!(error.to_string().starts_with("mutant:")),
            }
        }
    }
}

/// Posts write comments in Windows-1252, which no UTF-8 is, or in another code page; control characters are refused.
#[test]
fn programs_in_windows_1252_are_read() {
    let read = |bytes: &[u8]| ProgramFile::parse(bytes, "a.mpf");
    let Ok(ProgramFile::Gcode(text)) = read(b"G0 X1 ; Fr\xe4sen mit \xd810 \x80\n") else {
        panic!("a program")
    };
    assert_eq!(text, "G0 X1 ; Fräsen mit Ø10 €\n");
    assert!(read(b"G0 X1 ; \x8d\xe9\n").is_ok());
    assert!(read(b"G0 X1 ;\xe4\x0c G1\n").is_err());
}

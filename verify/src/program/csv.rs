//! Tables of poses: `x,y,z,i,j,k`, or `x,y,z,qx,qy,qz,qw`, one pose per row.
//!
//! `x,y,z` is the tip and `i,j,k` the unit vector from the tip to the spindle. The quaternion turns the tool's
//! frame into the part's. The first row decides the number of columns, which every other row must have too.
//! Columns are separated by commas, semicolons or tabs, as the first row has them; `#` opens a comment, blank lines
//! are skipped, and a first row may have the names above.
//!
//! A table that [`ClData::write_csv`](super::ClData::write_csv) wrote has a further column, `end`, which is empty in all rows but
//! the last. Without that mark the table was truncated and is refused. Earlier versions wrote comments instead, which are read, too: the
//! first line announces the last. Tables of other programs need no mark.

use super::{CutterLocation, Located, PLAIN_NUMBER, ProgramFault, axis_pose, lines, number, shown};
use nalgebra::Point3;
use touchoff::{Pose, cancellation};

const AXIS: [&str; 6] = ["x", "y", "z", "i", "j", "k"];
const QUATERNION: [&str; 7] = ["x", "y", "z", "qx", "qy", "qz", "qw"];

/// The name of the column with the end mark.
pub(super) const END_COLUMN: &str = "end";
/// The end mark, in the last row.
pub(super) const END_MARK: &str = "end of program";
/// The first line of a table that an earlier version wrote.
const HEAD: &str = "# touchoff program: complete only with its last line `# end of program`";
/// The last line of a table that an earlier version wrote.
const END: &str = "# end of program";

/// Reads the positions of a table.
pub(super) fn read(text: &str) -> Result<Vec<CutterLocation>, Located> {
    check_end(text)?;
    let mut locations = Vec::new();
    let mut columns = None;
    let mut separator = None;
    // The rows so far have a column for the end mark; and whether it was there.
    let (mut is_marked, mut has_ended) = (false, false);
    for (line, raw) in lines(text) {
        cancellation::check();
        let row = raw.split_once('#').map_or(raw, |(row, _)| row.trim_end());
        if row.is_empty() {
            continue;
        }
        let separator = *separator.get_or_insert_with(|| separator_of(row));
        let mut cells: Vec<&str> = row.split(separator).map(str::trim).collect();
        if columns.is_none() && cells.last().is_some_and(|cell| is_named(cell, END_COLUMN)) {
            is_marked = true;
            cells.pop();
        } else if is_marked {
            if has_ended {
                return Err((line, ProgramFault::AfterEnd { end: END_MARK }));
            }
            let mark = cells.pop().unwrap_or_default();
            has_ended = is_named(mark, END_MARK);
            if !has_ended && !mark.is_empty() {
                return Err((line, ProgramFault::NoEndMark));
            }
        }
        let is_header =
            columns.is_none() && is_names(row, &cells).map_err(|fault| (line, fault))?;
        if !is_header {
            let pose = pose(row, &cells, columns).map_err(|fault| (line, fault))?;
            locations.push(CutterLocation { line, pose, rapid: false });
        }
        columns = Some(cells.len());
    }
    if is_marked && !has_ended {
        return Err((lines(text).last().map_or(1, |(line, _)| line), ProgramFault::NoEndMark));
    }
    Ok(locations)
}

/// Returns whether a cell is a name, in quotes or not.
fn is_named(cell: &str, name: &str) -> bool {
    cell.trim_matches('"').eq_ignore_ascii_case(name)
}

/// Returns the separator of a first row. A comma beside semicolons is a decimal comma, which is refused later.
fn separator_of(row: &str) -> char {
    match row {
        row if row.contains(';') => ';',
        row if row.contains('\t') && !row.contains(',') => '\t',
        _ => ',',
    }
}

/// Refuses a table that announces an end mark and does not end with it.
fn check_end(text: &str) -> Result<(), Located> {
    let mut filled = lines(text).filter(|(_, line)| !line.is_empty());
    let Some((first, head)) = filled.next() else { return Ok(()) };
    if !is_mark(head, HEAD) {
        return Ok(());
    }
    match filled.last() {
        Some((_, line)) if is_mark(line, END) => Ok(()),
        last => Err((last.map_or(first, |(line, _)| line), ProgramFault::NoEndMark)),
    }
}

/// Returns whether a line is a mark. Spreadsheets pad it with separators and may put it in quotes.
fn is_mark(line: &str, mark: &str) -> bool {
    line.trim_end_matches([',', ';', '\t', ' ']).trim_matches('"') == mark
}

/// Returns whether a first row has the columns' names; a row of other names is refused.
fn is_names(row: &str, cells: &[&str]) -> Result<bool, ProgramFault> {
    if cells.iter().any(|cell| cell.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)))
        // `inf` and `nan` are refused as numbers.
        || cells.iter().any(|cell| cell.parse::<f64>().is_ok())
    {
        return Ok(false);
    }
    let is_known = [&AXIS[..], &QUATERNION].into_iter().any(|names| {
        cells.len() == names.len()
            && cells.iter().zip(names).all(|(cell, name)| is_named(cell, name))
    });
    if is_known { Ok(true) } else { Err(ProgramFault::Names { names: shown(row) }) }
}

/// Returns the pose of a row, which must have `columns` cells if an earlier row has set that number.
fn pose(row: &str, cells: &[&str], columns: Option<usize>) -> Result<Pose, ProgramFault> {
    let found = cells.len();
    let expected = match columns {
        Some(6) => "6 (x,y,z,i,j,k)",
        Some(_) => "7 (x,y,z,qx,qy,qz,qw)",
        None => "6 (x,y,z,i,j,k) or 7 (x,y,z,qx,qy,qz,qw)",
    };
    let columns_error =
        || ProgramFault::Columns { found, expected, remedy: columns_remedy(row, found) };
    if columns.is_some_and(|columns| columns != found) {
        return Err(columns_error());
    }
    if !matches!(found, 6 | 7) {
        return Err(columns_error());
    }
    let values = cells.iter().map(|cell| number(cell)).collect::<Result<Vec<f64>, ProgramFault>>();
    match values.map_err(with_remedy)?[..] {
        [x, y, z, i, j, k] => axis_pose([x, y, z], [i, j, k]),
        [x, y, z, qx, qy, qz, qw] => quaternion_pose([x, y, z], [qx, qy, qz, qw]),
        _ => Err(columns_error()),
    }
}

fn quaternion_pose(tip: [f64; 3], quaternion: [f64; 4]) -> Result<Pose, ProgramFault> {
    if quaternion == [0.0; 4] {
        let remedy = "give the unit quaternion from the tool's frame to the part's";
        return Err(ProgramFault::NoDirection { what: "the quaternion qx,qy,qz,qw", remedy });
    }
    Ok(Pose::from_quaternion(Point3::from(tip), quaternion)?)
}

const DECIMAL_COMMA: &str = "write decimals with a point";

/// Returns the remedy for a wrong number of columns, guessed from the formats of spreadsheets.
fn columns_remedy(row: &str, found: usize) -> &'static str {
    if found == 1 && row.contains(char::is_whitespace) {
        "separate the columns by commas, semicolons or tabs, not blanks"
    } else if found > QUATERNION.len() && !row.contains('.') {
        "these look like decimal commas (`0,5`): write points (`0.5`)"
    } else {
        "correct the row"
    }
}

/// Adapts the remedy of a fault to decimal commas.
fn with_remedy(fault: ProgramFault) -> ProgramFault {
    match fault {
        ProgramFault::NotNumber { cell, .. } => {
            let remedy = if cell.contains(',') { DECIMAL_COMMA } else { PLAIN_NUMBER };
            ProgramFault::NotNumber { cell, remedy }
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{fan, line_of, refusal, shared};
    use super::{END, HEAD};
    use crate::program::{ClData, CutterLocation};
    use nalgebra::{Point3, Vector3};
    use std::path::Path;
    use touchoff::Pose;

    fn locations(text: &str) -> Vec<CutterLocation> {
        ClData::parse(text, "part.csv").expect("it is a table").locations
    }

    /// No truncated table that was written here is taken for a whole one.
    #[test]
    fn no_beginning_is_a_table() {
        let pose = |x| Pose::from_axis(Point3::new(x, 0.5, -12.25), Vector3::z()).expect("a pose");
        let made = ClData::new("made", None, [1.0, 2.0, 3.0].map(|x| (pose(x), false)));
        let mut whole = Vec::new();
        made.expect("poses").write_csv(&mut whole).expect("memory");
        let whole = String::from_utf8(whole).expect("UTF-8");
        assert_eq!(locations(&whole).iter().map(|stop| stop.line).collect::<Vec<_>>(), [2, 3, 4]);
        let last = whole.trim_end().len();
        assert_eq!(locations(&whole[..last]).len(), 3);
        for end in 0..last {
            assert!(ClData::parse(&whole[..end], "part.csv").is_err(), "{:?}", &whole[..end]);
        }
        assert_eq!(refusal(whole.trim_end().trim_end_matches("end of program")), (4, "P0529"));
        // As a spreadsheet saves it.
        let sheet = whole.replace('\n', "\r\n").replace(',', ";").replace("end of", "\"end of");
        assert_eq!(locations(&sheet.replace("program", "program\"")).len(), 3, "{sheet}");
        for after in ["4,5,6,0,0,1,\n", "4,5,6,0,0,1\n", "4,5,6,0,0,1,end of program\n"] {
            assert_eq!(refusal(format!("{whole}{after}")), (5, "P0530"));
        }
    }

    /// Readers of CSV know neither comments nor marks: each row has the cells that the first row names.
    #[test]
    fn a_table_is_plain_csv() {
        let pose = |x| Pose::from_axis(Point3::new(x, 0.5, -12.25), Vector3::z()).expect("a pose");
        let made = ClData::new("made", None, [1.0, 2.0].map(|x| (pose(x), false)));
        let mut whole = Vec::new();
        made.expect("poses").write_csv(&mut whole).expect("memory");
        let rows = "x,y,z,i,j,k,end\n1,0.5,-12.25,0,0,1,\n2,0.5,-12.25,0,0,1,end of program\n";
        assert_eq!(String::from_utf8(whole).expect("UTF-8"), rows);
    }

    /// Earlier versions wrote their marks as comments.
    #[test]
    fn reads_marks_that_are_comments() {
        let whole = format!("{HEAD}\nx,y,z,i,j,k\n1,2,3,0,0,1\n4,5,6,0,0,1\n{END}\n");
        assert_eq!(locations(&whole).len(), 2);
        assert_eq!(refusal(whole.trim_end().trim_end_matches(END)), (4, "P0529"));
        // As a spreadsheet saves it: comment lines are padded with empty cells.
        let sheet =
            whole.replace(HEAD, &format!("{HEAD},,,,,")).replace(END, &format!("{END},,,,,"));
        assert_eq!(locations(&sheet).len(), 2, "{sheet}");
        assert!(ClData::parse(format!("{whole}4,5,6,0,0,1\n"), "part.csv").is_err());
    }

    #[test]
    fn reads_a_fan_from_a_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let (text, rows) = fan();
        let path = folder.path().join("fan.csv");
        std::fs::write(&path, text).expect("a file");
        let program = ClData::read(path).expect("it is a table");
        assert_eq!((program.locations.len(), program.unit), (25, None));
        assert!(program.ignored.is_empty());
        for ((stop, [x, y, z, i, j, k]), line) in program.locations.iter().zip(rows).zip(2..) {
            assert_eq!((stop.line, stop.rapid), (line, false));
            assert_eq!(stop.pose.tip(), Point3::new(x, y, z));
            // The file's axis is rounded to four digits; it is normalised when read.
            assert!((stop.pose.axis() - Vector3::new(i, j, k)).norm() < 1e-4);
            assert!((stop.pose.axis().norm() - 1.0).abs() < 1e-15);
        }
        if let Some(path) = shared("ijms2021_fan_xyzijk.csv") {
            the_published_fan(&path);
        }
    }

    fn the_published_fan(path: &Path) {
        let program = ClData::read(path).expect("it is a table");
        assert_eq!(program.locations.len(), 25);
        assert_eq!(program.unit, None);
        assert!(program.ignored.is_empty());
        let last = program.locations[24];
        assert_eq!(last.line, 26);
        assert_eq!(last.pose.tip(), Point3::new(-49.4389, -108.7844, 2.0895));
        assert!((last.pose.axis() - Vector3::new(0.6189, -0.2239, 0.7529)).norm() < 1e-4);
        for stop in &program.locations {
            assert!((stop.pose.axis().norm() - 1.0).abs() < 1e-15);
            assert!(!stop.rapid);
        }
    }

    #[test]
    fn skips_comments_names_and_a_byte_order_mark() {
        let text = "\u{feff}# made by hand\r\n\r\n X , y,Z, i,j,\"k\"\r\n\
                    \t1 , -2,+3.5,0,.6,8e-1 # tip\r\n4,5,6,0,0,-1";
        let locations = locations(text);
        assert_eq!(locations.iter().map(|stop| stop.line).collect::<Vec<_>>(), [4, 5]);
        assert_eq!(locations[0].pose.tip(), Point3::new(1.0, -2.0, 3.5));
        assert!((locations[0].pose.axis() - Vector3::new(0.0, 0.6, 0.8)).norm() < 1e-15);
        assert_eq!(locations[1].pose.axis(), Vector3::new(0.0, 0.0, -1.0));
    }

    #[test]
    fn reads_semicolons_and_tabs() {
        for separator in [";", "\t", " ; "] {
            let text = "x,y,z,i,j,k\n1,2,3.5,0,0,1\n4,5,6,0,0,1\n".replace(',', separator);
            assert_eq!(locations(&text)[0].pose.tip(), Point3::new(1.0, 2.0, 3.5), "{text}");
        }
    }

    #[test]
    fn counts_lone_carriage_returns_as_lines() {
        let locations = locations("# old\r1,2,3,0,0,1\r4,5,6,0,0,1\r");
        assert_eq!(locations.iter().map(|stop| stop.line).collect::<Vec<_>>(), [2, 3]);
    }

    #[test]
    fn reads_quaternions() {
        let half = 0.5f64.sqrt();
        let locations =
            locations(&format!("x,y,z,qx,qy,qz,qw\n1,2,3,0,0,0,1\n1,2,3,{half},0,0,{half}\n"));
        assert_eq!(locations[0].pose.axis(), Vector3::z());
        assert!((locations[1].pose.axis() - Vector3::new(0.0, -1.0, 0.0)).norm() < 1e-15);
    }

    #[test]
    fn every_refusal_names_its_line_and_word() {
        for (text, line, code, word) in [
            ("1,2,3\n", 1, "P0503", "found 3 columns"),
            (
                "1,2,3,0,0,1\n1,2,3,0,0,0,1\n",
                2,
                "P0503",
                "found 7 columns, expected 6 (x,y,z,i,j,k)",
            ),
            ("x,y,z,qx,qy,qz,qw\n1,2,3,0,0,1\n", 2, "P0503", "expected 7 (x,y,z,qx,qy,qz,qw)"),
            ("1,5,2,5,3,5,0,0,0,0,1,0\n", 1, "P0503", "decimal commas"),
            ("0,5;1,5;2,5;0,0;1,0;0,0\n", 1, "P0505", "`0,5`"),
            ("1;2;3;0;0;1\n1,2,3,0,0,1\n", 2, "P0503", "found 1 column, expected 6 (x,y,z,i,j,k)"),
            ("1 2 3 0 0 1\n", 1, "P0503", "not blanks"),
            ("i,j,k,x,y,z\n", 1, "P0504", "`i,j,k,x,y,z`"),
            ("1,2,3,0,0,1\nx,y,z,i,j,k\n", 2, "P0505", "`x`"),
            ("1,2,,0,0,1\n", 1, "P0505", "an empty cell"),
            ("nan,2,3,0,0,1\n", 1, "P0506", "`nan`"),
            ("1,2,3,0,0,1\n1,-1e400,3,0,0,1\n", 2, "P0506", "`-1e400`"),
            ("1,2,3,0,0,-0\n", 1, "P0507", "i,j,k"),
            ("1,2,3,0,0,0,0\n", 1, "P0507", "qx,qy,qz,qw"),
            ("# a\n\n1,2,3,0,0,0.5\n", 3, "P0508", "norm 0.5"),
            ("1,2,3,0,0,0,2\n", 1, "P0508", "norm 2"),
        ] {
            let error = ClData::parse(text, "part.csv").expect_err(text);
            assert_eq!((line_of(&error), error.code()), (line, code), "{text:?}: {error}");
            assert!(error.to_string().contains(word), "{text:?}: {error}");
        }
    }
}

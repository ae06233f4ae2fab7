//! Mutated tool libraries. The reader must not panic, a tool that it returns loads or is refused with a reason, and
//! each dimension of it follows from numbers of the file.
//!
//! `MUTANTS=100000 cargo test -p touchoff-import --test import mutated -- --nocapture` runs 10⁵ mutants of each format, `mutated_tables`
//! instead of `mutated` those of one.

use crate::libraries::{self, LibraryFile};
use std::collections::HashSet;
use std::io::Write;
use std::time::{Duration, Instant};
use touchoff_import::{ImportError, ImportedTool, Library, Note};
use touchoff_tests::count::case_count;
use touchoff_tests::oracle::rng::Rng;
use zip::write::SimpleFileOptions;

/// Texts that replace a number or a word.
const VALUES: [&str; 24] = [
    "0",
    "-0",
    "-1",
    "1e-9",
    "1e9",
    "1e308",
    "1e-320",
    "1e999",
    "NaN",
    "inf",
    "null",
    "true",
    "\"x\"",
    "[]",
    "{}",
    "",
    "180",
    "89.9999999",
    "0.1",
    "2147483648",
    "6,0",
    "6mm",
    "\u{fffd}",
    "-3.5",
];

/// Declares a test per format, so that one can be run by its name.
macro_rules! formats {
    ($($test:ident $file:literal;)*) => {
        $(
            #[test]
            fn $test() {
                try_mutants($file);
            }
        )*

        #[test]
        fn every_mutated_format_has_a_test() {
            let names: Vec<&str> = libraries::files().iter().map(|file| file.name).collect();
            assert_eq!(names, [$($file),*]);
        }
    };
}

formats! {
    mutated_fusion "fusion.json";
    mutated_kiri "kiri.json";
    mutated_camotics "camotics.json";
    mutated_bits "bits.fctb";
    mutated_holders "holder.fcholder";
    mutated_hsm "hsm.hsmlib";
    mutated_cutters "cutters.apt";
    mutated_tables "table.tbl";
}

/// Reads mutants of the library of this name.
fn try_mutants(name: &str) {
    let count = case_count("MUTANTS", 300);
    let seeds = libraries::files();
    let seed = seeds.iter().find(|seed| seed.name == name).expect("a library");
    let mut run = Run::default();
    for index in 0..count {
        run.try_mutant(seed, index as u64);
    }
    println!(
        "{name}: {count} mutants, {} refused; {} tools, {} left out, {} of {} that differ are no solid; slowest {:.1} ms to \
         read, {:.1} ms to load",
        run.refused,
        run.tools,
        run.skipped,
        run.no_solid,
        run.loaded.len(),
        run.slowest[0].as_secs_f64() * 1e3,
        run.slowest[1].as_secs_f64() * 1e3,
    );
    if let Ok(status) = std::fs::read_to_string("/proc/self/status") {
        let peak = status.lines().find(|line| line.starts_with("VmHWM"));
        println!("{name}: peak memory of the process: {}", peak.unwrap_or("unknown"));
    }
    // Mutants that are all refused, or all read as before, would test nothing.
    assert!(run.refused + run.skipped > 0, "{name}: every mutant was read");
    assert!(run.tools > 0 || name == "table.tbl", "{name}: no mutant was read");
}

/// The counts of one format.
#[derive(Default)]
struct Run {
    refused: usize,
    tools: usize,
    skipped: usize,
    no_solid: usize,
    /// The texts of the tools loaded so far.
    loaded: HashSet<Vec<String>>,
    /// The longest times to read a file and to load a tool.
    slowest: [Duration; 2],
}

impl Run {
    fn try_mutant(&mut self, seed: &LibraryFile, index: u64) {
        let mut rng = Rng::new(0x51ed_2701 ^ index);
        let text = mutant(seed.text.as_bytes(), &mut rng);
        let (name, content) = packed(seed.name, &text, &mut rng);
        let start = Instant::now();
        let library = Library::parse(name.as_ref(), &content);
        self.slowest[0] = self.slowest[0].max(start.elapsed());
        let library = match library {
            Ok(library) => library,
            Err(error) => {
                assert!(matches!(error, ImportError::Malformed { .. }), "{name} {index}: {error}");
                self.refused += 1;
                return;
            }
        };
        self.skipped += library.skipped().len();
        for skipped in library.skipped() {
            assert!(!skipped.reason.is_empty(), "{name} {index}: left out without a reason");
        }
        let mut numbers = numbers(&String::from_utf8_lossy(&text));
        if name.ends_with("fctb") {
            // A comma is a decimal one.
            numbers.extend(self::numbers(&String::from_utf8_lossy(&text).replace(',', ".")));
            add_lengths_in_mm(&mut numbers);
        }
        for tool in library.tools() {
            self.tools += 1;
            let texts: Vec<String> = tool.files.iter().map(|file| file.text.clone()).collect();
            if !self.loaded.insert(texts) {
                continue;
            }
            for (param, value) in params(tool) {
                assert!(
                    follows(value, &numbers) || is_noted(tool, value),
                    "{name} {index}: `{param} = {value}` does not follow from the file\n{}",
                    String::from_utf8_lossy(&text)
                );
            }
            let start = Instant::now();
            match tool.load() {
                Ok(_) => {}
                Err(ImportError::Tool(_)) => self.no_solid += 1,
                Err(other) => panic!("{name} {index}: {other}"),
            }
            self.slowest[1] = self.slowest[1].max(start.elapsed());
        }
    }
}

/// Returns a text with one to three errors.
fn mutant(text: &[u8], rng: &mut Rng) -> Vec<u8> {
    let mut text = text.to_vec();
    for _ in 0..=(rng.bits() % 6).saturating_sub(3) {
        let tokens = tokens(&text);
        let has_digit = |token: &&std::ops::Range<usize>| {
            text[token.start..token.end].iter().any(u8::is_ascii_digit)
        };
        let numbers: Vec<_> = tokens.iter().filter(has_digit).collect();
        if numbers.is_empty() {
            break;
        }
        let [token, other] = [0; 2].map(|_| tokens[rng.bits() as usize % tokens.len()].clone());
        match rng.bits() % 16 {
            // Most errors of people and programs concern one number.
            0..=8 => {
                let number = numbers[rng.bits() as usize % numbers.len()].clone();
                let value = VALUES[rng.bits() as usize % VALUES.len()];
                text.splice(number, value.bytes());
            }
            9..=10 => {
                let value = VALUES[rng.bits() as usize % VALUES.len()];
                text.splice(token, value.bytes());
            }
            11 => drop(text.drain(token)),
            12 => {
                let copied = text[token].to_vec();
                text.splice(other, copied);
            }
            13 => text[token.start] = rng.bits() as u8,
            _ => {
                let [start, end] = [token.start.min(other.start), token.end.max(other.end)];
                match rng.bits() % 3 {
                    0 => text.truncate(start),
                    1 => drop(text.drain(start..end)),
                    _ => {
                        let copied = text[start..end].to_vec();
                        text.splice(start..start, copied);
                    }
                }
            }
        }
    }
    text
}

/// Returns the words, numbers and other characters of a text.
fn tokens(text: &[u8]) -> Vec<std::ops::Range<usize>> {
    let mut tokens: Vec<std::ops::Range<usize>> = Vec::new();
    let is_word = |byte: u8| byte.is_ascii_alphanumeric() || b"_.+-".contains(&byte);
    for (at, byte) in text.iter().enumerate() {
        match tokens.last_mut() {
            Some(last) if last.end == at && is_word(*byte) && is_word(text[at - 1]) => {
                last.end += 1;
            }
            _ if byte.is_ascii_whitespace() => {}
            _ => tokens.push(at..at + 1),
        }
    }
    tokens
}

/// Returns the name and the content of a file: as it is, in an archive, or in another encoding.
fn packed(name: &str, text: &[u8], rng: &mut Rng) -> (String, Vec<u8>) {
    let is_changed = rng.bits().is_multiple_of(4);
    match name {
        "fusion.json" if is_changed => {
            let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
            archive.start_file("tools.json", SimpleFileOptions::default()).expect("an entry");
            archive.write_all(text).expect("an archive");
            let mut content = archive.finish().expect("an archive").into_inner();
            if rng.bits().is_multiple_of(2) {
                let at = rng.bits() as usize % content.len();
                content[at] ^= 1 << (rng.bits() % 8);
            }
            ("fusion.tools".to_owned(), content)
        }
        "hsm.hsmlib" if is_changed => {
            let mut content = vec![0xff, 0xfe];
            let text = String::from_utf8_lossy(text).into_owned();
            content.extend(text.encode_utf16().flat_map(u16::to_le_bytes));
            (name.to_owned(), content)
        }
        _ => (name.to_owned(), text.to_vec()),
    }
}

/// Returns the numbers of a text, in whatever they stand.
fn numbers(text: &str) -> Vec<f64> {
    let is_part = |c: char| c.is_ascii_digit() || "+-.eE".contains(c);
    let parts = text.split(|c: char| !is_part(c)).filter_map(|part| {
        let whole: Option<f64> = part.trim_matches(['e', 'E']).parse().ok();
        whole.or_else(|| part.trim_end_matches(['-', '+', '.', 'e', 'E']).parse().ok())
    });
    let mut numbers: Vec<f64> = parts.filter(|number| number.is_finite()).collect();
    numbers.push(0.0);
    numbers.sort_by(f64::total_cmp);
    numbers.dedup();
    numbers
}

/// Adds each number as a length in every unit that FreeCAD's texts may have.
fn add_lengths_in_mm(numbers: &mut Vec<f64>) {
    let units = [10.0, 1000.0, 25.4, 304.8, 1e-3];
    let converted: Vec<f64> =
        numbers.iter().flat_map(|number| units.map(|unit| number * unit)).collect();
    numbers.extend(converted);
    numbers.sort_by(f64::total_cmp);
}

/// Returns the params of a tool's files.
fn params(tool: &ImportedTool) -> Vec<(String, f64)> {
    let lines = tool.files.iter().flat_map(|file| file.text.lines());
    lines
        .filter_map(|line| {
            let (name, value) = line.trim().strip_prefix("param ")?.split_once('=')?;
            let value = value.trim().trim_end_matches(';').trim_end_matches("deg");
            Some((name.trim().to_owned(), value.parse().expect("a number")))
        })
        .collect()
}

/// Returns true for a number of the file, its half or its double, the sum of two, and half of one less another: the centre of a
/// corner that only a note states.
fn follows(value: f64, numbers: &[f64]) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1.0);
    let is_number = |wanted: f64| {
        let above = numbers.partition_point(|number| *number < wanted);
        let beside = above.saturating_sub(1)..numbers.len().min(above + 1);
        numbers[beside].iter().any(|number| near(*number, wanted))
    };
    [value, 2.0 * value, value / 2.0].into_iter().any(is_number)
        || numbers
            .iter()
            .any(|number| is_number(value - number) || is_number(2.0 * (value + number)))
}

/// Returns true if a note says that the file does not state the value.
fn is_noted(tool: &ImportedTool, value: f64) -> bool {
    tool.entry
        .notes
        .iter()
        .any(|note| matches!(note, Note::Unstated(_, taken) if *taken == format!("taken: {value}")))
}

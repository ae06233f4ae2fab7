//! Frozen outcomes: what the package made of generated programs when the file of this folder was written. A change that is meant to move
//! nothing leaves them as they are.
//!
//! `UPDATE_FROZEN=1` writes the files anew. `OUTCOMES=../before` writes each program with its outcome as text into a folder: those of two
//! builds are compared by `diff`.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// The most blocks that a file keeps.
const MOST_BLOCKS: usize = 200;

/// Outcomes in the order of their programs, a digest per block of programs.
pub(crate) struct Frozen {
    name: &'static str,
    /// The number of programs in a block.
    length: usize,
    count: usize,
    digest: u64,
    digests: Vec<u64>,
    texts: Option<String>,
}

impl Frozen {
    pub(crate) fn new(name: &'static str, length: usize) -> Frozen {
        let texts = env::var_os("OUTCOMES").map(|_| String::new());
        Frozen { name, length, count: 0, digest: START, digests: Vec::new(), texts }
    }

    /// Adds the outcome of the next program. Numbers in it have few digits, so that rounding does not change it.
    pub(crate) fn add(&mut self, program: &str, outcome: &str) {
        let outcome = outcome.replace("-0.000000", "0.000000");
        self.digest = add(add(self.digest, program), &outcome);
        self.count += 1;
        if let Some(texts) = &mut self.texts {
            let _ = writeln!(texts, "==== {}\n{program}\n----\n{outcome}", self.count);
        }
        if self.count.is_multiple_of(self.length) {
            self.digests.push(self.digest);
            self.digest = START;
        }
    }

    /// Asserts that whole blocks are those of the file, as far as it goes.
    pub(crate) fn assert(self) {
        if let (Some(texts), Some(folder)) = (&self.texts, env::var_os("OUTCOMES")) {
            fs::create_dir_all(&folder).expect("a folder");
            let path = Path::new(&folder).join(self.name).with_extension("txt");
            fs::write(path, texts).expect("a file");
        }
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/frozen").join(self.name);
        let path = path.with_extension("txt");
        let lines: Vec<String> =
            self.digests.iter().take(MOST_BLOCKS).map(|digest| format!("{digest:016x}")).collect();
        if env::var_os("UPDATE_FROZEN").is_some() {
            return fs::write(path, lines.join("\n") + "\n").expect("a file");
        }
        let frozen = fs::read_to_string(&path).expect("a file of digests");
        let pairs = frozen.lines().zip(&lines);
        let others: Vec<String> = pairs
            .enumerate()
            .filter(|(_, (frozen, now))| frozen != now)
            .map(|(block, _)| {
                format!("{} to {}", block * self.length + 1, (block + 1) * self.length)
            })
            .collect();
        assert!(
            others.is_empty(),
            "{}: programs {} have other outcomes: compare those that both builds write with OUTCOMES=folder",
            self.name,
            others.join(", ")
        );
    }
}

/// FNV-1a of no bytes.
const START: u64 = 0xcbf2_9ce4_8422_2325;

/// Adds a text to a digest, FNV-1a.
fn add(digest: u64, text: &str) -> u64 {
    // A byte that no text has ends each.
    let bytes = text.bytes().chain([0xff]);
    bytes.fold(digest, |digest, byte| (digest ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

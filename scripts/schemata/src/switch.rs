//! Which mutant runs: that of the variable `MUTANT`. With `REACHED`, the numbers of all that are reached are appended to that file.
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

const UNKNOWN: u32 = u32::MAX;
const RECORDED: u32 = u32::MAX - 1;
const NONE: u32 = u32::MAX - 2;

static ACTIVE: AtomicU32 = AtomicU32::new(UNKNOWN);
static REACHED: [AtomicBool; COUNT] = [const { AtomicBool::new(false) }; COUNT];

#[inline(always)]
pub(crate) fn on(number: u32) -> bool {
    let active = ACTIVE.load(Relaxed);
    active == number || (active > NONE && rare(number))
}

#[cold]
#[inline(never)]
fn rare(number: u32) -> bool {
    if ACTIVE.load(Relaxed) == UNKNOWN {
        let active = match std::env::var("MUTANT") {
            Ok(text) => text.parse().expect("a number"),
            Err(_) if std::env::var_os("REACHED").is_some() => RECORDED,
            Err(_) => NONE,
        };
        ACTIVE.store(active, Relaxed);
        return on(number);
    }
    if !REACHED[number as usize].swap(true, Relaxed) {
        use std::io::Write;
        let place = std::env::var_os("REACHED").expect("a file");
        let mut file =
            std::fs::OpenOptions::new().append(true).create(true).open(place).expect("a file");
        file.write_all(format!("{number}\n").as_bytes()).expect("room");
    }
    false
}

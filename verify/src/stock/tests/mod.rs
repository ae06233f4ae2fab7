//! Tests of stocks.

mod brute;
mod contacts;
mod cutting;
mod inside;
mod part;
mod setups;

use super::*;
use nalgebra::Vector3;
use std::path::{Path, PathBuf};
use touchoff::tool::Tool;
use touchoff::{Motion, Pose};

touchoff::tool! {
    tool Mill "an end mill whose shank is as wide as its flute" {
        units mm;
        profile {
            start (0, 0);
            line to (3, 0), (3, 10) as flute cutting;
            line to (3, 30), (0, 30) as shank;
        }
        niceness cutting: 1;
    }
}

touchoff::tool! {
    tool Ball "a ball end mill" {
        units mm;
        profile {
            start (0, 0);
            arc to (3, 3) center (0, 3) as ball cutting;
            line to (3, 30), (0, 30) as shank;
        }
        niceness cutting: 1;
    }
}

touchoff::tool! {
    tool Reduced "an end mill with a thicker shank" {
        units mm;
        profile {
            start (0, 0);
            line to (3, 0), (3, 8) as flute cutting;
            line to (4, 8), (4, 30), (0, 30) as shank;
        }
        niceness cutting: 1;
    }
}

const UNIT: Unit = Unit::Millimetre;

fn block(low: [f64; 3], high: [f64; 3], spacing: f64) -> Stock {
    Stock::from_box([low.into(), high.into()], spacing, UNIT).expect("a stock")
}

fn upright(tip: [f64; 3]) -> Pose {
    Pose::from_axis(tip.into(), Vector3::z()).expect("a pose")
}

/// Moves a tool from one pose to another.
fn advance(
    stock: &mut Stock,
    tool: &dyn Tool,
    [from, to]: [Pose; 2],
    mode: MotionMode,
    tolerance: f64,
) -> Vec<StockContact> {
    let motion = Motion::new(&from, &to).expect("a motion");
    let travel = stock.max_travel(tool, &motion);
    stock.advance(tool, &|time| motion.pose(time), travel, mode, tolerance).expect("advanced")
}

/// Returns the path of shared data, if it exists: a checkout alone has none.
fn shared(file: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data").join(file);
    if path.is_file() {
        return Some(path);
    }
    println!("shared data `{file}` is absent: only parts made here are used");
    None
}

/// Returns the nodes of a stock with their positions, and whether each is left.
fn nodes(stock: &Stock) -> Vec<([f64; 3], bool)> {
    let remaining = stock.remaining();
    let initial = stock.initial.iter();
    initial.map(|node| (stock.lattice.position(node), remaining.contains(node))).collect()
}

/// Random numbers from 0 to 1.
struct Random(u64);

impl Random {
    /// Returns the next number, by splitmix64 (Steele, Lea, Flood 2014).
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 * 2f64.powi(-53)
    }
}

/// Returns a random unit vector.
fn direction(random: &mut Random) -> Vector3<f64> {
    loop {
        let v = Vector3::from_fn(|_, _| 2.0 * random.next() - 1.0);
        if (0.01..=1.0).contains(&v.norm()) {
            return v.normalize();
        }
    }
}

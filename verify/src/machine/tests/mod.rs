//! Tests against 256-bit kinematics, against published closed forms, and against dense samples.

mod bodies;
mod closed_forms;
mod exact;
mod file;
mod forward;
mod inverse;
mod limits;
mod motion;
mod sampled;
mod singular;

use super::{Chain, Joints, Letter, Machine, Setup};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A table with a nutating axis at 45° to the vertical, whose lines do not meet, and linear axes on both
/// sides.
const NUTATING: &str = r#"
name = "nutating table"
axis = [
    { letter = "X", kind = "linear", carries = "table", direction = [1, 0, 0] },
    { letter = "B", kind = "rotary", carries = "table", direction = [0, 1, 1], point = [3, -40.5, -310] },
    { letter = "Z", kind = "linear", carries = "tool" },
    { letter = "Y", kind = "linear", carries = "tool" },
    { letter = "C", kind = "rotary", carries = "table", direction = [0.02, -0.01, 7], point = [-2.25, 11, 4] },
]
"#;

/// A swivel head in oblique directions, and a table about x.
const OBLIQUE: &str = r#"
name = "oblique head"
axis = [
    { letter = "X", kind = "linear", carries = "tool" },
    { letter = "B", kind = "rotary", carries = "tool", direction = [0.3, 1, -0.4], point = [30, 2, 190], limits = [-200, 170] },
    { letter = "Y", kind = "linear", carries = "table" },
    { letter = "Z", kind = "linear", carries = "table" },
    { letter = "A", kind = "rotary", carries = "table", direction = [-1, 0.1, 0.05], point = [0, 25, -300] },
]
"#;

/// A machine with one rotary axis.
const FOUR_AXIS: &str = r#"
name = "4-axis"
axis = [
    { letter = "X", kind = "linear", carries = "table" },
    { letter = "A", kind = "rotary", carries = "table", direction = [1, 0, 0], point = [0, 10, -300] },
    { letter = "Y", kind = "linear", carries = "tool" },
    { letter = "Z", kind = "linear", carries = "tool" },
]
"#;

/// Returns the machines of the library.
fn library() -> Vec<Machine> {
    Machine::names().map(|name| Machine::named(name).expect("a machine")).collect()
}

/// Returns the chain of a machine of the library, with the workpiece at a height on the z axis and a tool of
/// a length.
fn chain(name: &str, height: f64, tool_length: f64) -> Chain {
    let setup = Setup { work_offset: [0.0, 0.0, height, 0.0, 0.0, 0.0], tool_length };
    Machine::named(name).expect("a machine").chain(&setup).expect("a setup")
}

/// Returns the texts of the machines of the library and of those of this module.
fn texts() -> Vec<&'static str> {
    super::LIBRARY.iter().map(|(_, text)| *text).chain([NUTATING, OBLIQUE, FOUR_AXIS]).collect()
}

/// Returns the number of cases: that of an environment variable, or the default.
fn cases(variable: &str, default: usize) -> usize {
    match std::env::var(variable) {
        Ok(text) => text.parse().expect("the variable is a number of cases"),
        Err(_) => default,
    }
}

/// Reproducible random numbers.
struct Random(Pcg64Mcg);

impl Random {
    fn new(seed: u64) -> Random {
        Random(Pcg64Mcg::seed_from_u64(seed))
    }

    /// Returns a number from −1 to 1.
    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / 2f64.powi(52) - 1.0
    }

    fn below(&mut self, count: usize) -> usize {
        (self.0.next_u64() % count as u64) as usize
    }

    fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// Returns an angle in degrees: any, a multiple of 45°, nearly a multiple of 90°, or many turns.
    fn angle(&mut self) -> f64 {
        match self.below(5) {
            0 | 1 => 200.0 * self.unit(),
            2 => 45.0 * (8.0 * self.unit()).round(),
            3 => 90.0 * (4.0 * self.unit()).round() + self.unit() * self.pick(&[1e-3, 1e-8, 1e-14]),
            _ => 1e6 * self.unit(),
        }
    }

    /// Returns values of a machine's axes; those that it lacks are 0.
    fn joints(&mut self, machine: &Machine, size: f64) -> Joints {
        let mut joints = [0.0; 6];
        for letter in Letter::ALL {
            if machine.axis(letter).is_some() {
                joints[letter.index()] =
                    if letter.is_rotary() { self.angle() } else { size * self.unit() };
            }
        }
        joints
    }

    /// Returns a setup; half of them have no rotary offset.
    fn setup(&mut self, machine: &Machine) -> Setup {
        let mut work_offset = self.joints(machine, 500.0);
        if self.below(2) == 0 {
            work_offset[3..].fill(0.0);
        }
        Setup { work_offset, tool_length: self.pick(&[0.0, 1.0, -300.0]) + 150.0 * self.unit() }
    }
}

//! A hand that presses a flat end onto a plane: how stiff a wall may be.
//!
//! A mass at a spring that is sampled and held comes to rest as long as the eigenvalues of one cycle are
//! within the unit circle (Gil et al., *Stability boundary for haptic rendering*, 2004): theory, by a
//! two by two matrix, beside what the loop does.

use super::{block, tool, upright};
use nalgebra::{Matrix2, Vector2};
use touchoff::haptic::{Axes, Coupling, Grip, Hand, Limits, Rendering, Session, Settings};
use touchoff::{Law, Part, Probe};

/// The device that the hand holds.
pub const LIMITS: Limits =
    Limits { axes: Axes::Five, force: 20.0, torque: 1000.0, stiffness: 1.0, turning: 2000.0 };

/// How contact is rendered.
pub const DIRECT: Rendering = Rendering::Direct { scaled: false, damping: 0.0 };

/// The exponential by its series, after halving.
fn exponential(matrix: Matrix2<f64>) -> Matrix2<f64> {
    let small = matrix / 1024.0;
    let mut term = Matrix2::identity();
    let mut sum = term;
    for k in 1..20 {
        term = term * small / f64::from(k);
        sum += term;
    }
    (0..10).fold(sum, |power, _| power * power)
}

/// The largest stiffness of a wall, N/mm, at which a grip comes to rest.
pub fn theory(grip: &Grip, rate: f64) -> f64 {
    let by = 1000.0 / grip.mass;
    let own = Matrix2::new(0.0, 1.0, -grip.stiffness * by, -grip.damping * by);
    let after = exponential(own / rate);
    // What a force of 1 N does in a period.
    let inverse = own.try_inverse().expect("a hand with a spring");
    let force = inverse * (after - Matrix2::identity()) * Vector2::new(0.0, by);
    largest(|stiffness| {
        let closed = after - force * Vector2::new(stiffness, 0.0).transpose();
        closed.complex_eigenvalues().iter().all(|value| value.norm() < 1.0)
    })
}

/// The largest number up to which something holds, to a part in a hundred; infinite beyond 10^5.
fn largest(holds: impl Fn(f64) -> bool) -> f64 {
    const MOST: f64 = 1e5;
    let mut high = 0.1;
    while holds(high) {
        high *= 2.0;
        if high > MOST {
            return f64::INFINITY;
        }
    }
    let mut low = high / 2.0;
    while high > low * 1.01 {
        let middle = (low * high).sqrt();
        if holds(middle) { low = middle } else { high = middle }
    }
    low
}

/// A wall and a hand at it.
pub struct Wall<'a> {
    /// The part.
    pub part: &'a Part,
    /// Cycles a second.
    pub rate: f64,
    /// How contact is rendered.
    pub rendering: Rendering,
    /// What the device's encoders tell apart, mm.
    pub step: f64,
}

impl Wall<'_> {
    /// How far the tip still swings in the last tenth of some seconds, mm, if the wall is so stiff, N/mm.
    pub fn swing(&self, stiffness: f64) -> f64 {
        let mut probe = Probe::new(self.part, tool("Flat")).law(Law::Gradient);
        let face = probe.stiffness(&upright(-1e-3)).matrix[(2, 2)];
        let settings = Settings {
            stiffness: stiffness / face,
            rendering: Some(self.rendering),
            passive: false,
            ..Settings::new(self.rate)
        };
        // Presses with a fifth of a newton, and a little more to begin with.
        let wish = |time: f64| upright(if time < 0.2 { -1.05 } else { -1.0 });
        let limits = Limits { force: 1e6, torque: 1e9, ..LIMITS };
        let hand =
            Hand::new(limits, self.rate, wish).and_then(|hand| hand.encoders(self.step, 0.0));
        let mut hand = hand.expect("a hand");
        let mut session = Session::new(probe, &settings, limits).expect("settings");
        // Longer than it takes to come to rest, and not longer than one cares to wait.
        let seconds = (2e4 / self.rate).clamp(1.0, 4.0);
        let cycles = (seconds * self.rate) as usize;
        let (mut low, mut high) = (f64::MAX, f64::MIN);
        for cycle in 0..cycles {
            session.cycle(&mut hand);
            // No hand is as fast.
            if session.faults().jumps > 0 {
                return f64::INFINITY;
            }
            let Some(pose) = hand.is_at().filter(|_| cycle >= cycles * 9 / 10) else { continue };
            (low, high) = (low.min(pose.tip().z), high.max(pose.tip().z));
        }
        high - low
    }

    /// The stiffest wall at which it comes to rest, N/mm: swings by no more than a micrometre, or two steps of
    /// the encoders.
    pub fn stiffest(&self) -> f64 {
        let rest = (2.0 * self.step).max(1e-3);
        largest(|stiffness| self.swing(stiffness) <= rest)
    }
}

/// What was measured at a rate.
pub struct Row {
    /// Cycles a second.
    pub rate: f64,
    /// The limit by theory, N/mm.
    pub theory: f64,
    /// The limit as measured: direct; with encoders of 0.01 mm; scaled; coupled.
    pub measured: [f64; 4],
    /// How stiff a coupling may be.
    pub coupling: f64,
}

/// Encoders, mm.
pub const STEP: f64 = 0.01;

/// The limits at a rate.
pub fn row(rate: f64) -> Row {
    let part = block(5_000);
    let theory = theory(&Grip::default(), rate);
    let limits = Limits { force: 1e6, torque: 1e9, ..LIMITS };
    let scaled = Rendering::Direct { scaled: true, damping: 0.0 };
    let coupled = Rendering::Coupled(Coupling::of(&limits));
    let ways = [(DIRECT, 0.0), (DIRECT, STEP), (scaled, 0.0), (coupled, 0.0)];
    let measured =
        ways.map(|(rendering, step)| Wall { part: &part, rate, rendering, step }.stiffest());
    let coupling = largest(|stiffness| {
        let rendering = Rendering::Coupled(Coupling { stiffness, ..Coupling::of(&limits) });
        Wall { part: &part, rate, rendering, step: 0.0 }.swing(1e4) <= 1e-3
    });
    Row { rate, theory, measured, coupling }
}

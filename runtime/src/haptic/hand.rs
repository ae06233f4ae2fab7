//! A simulated hand that holds a device: with it the loop is closed, and whether that is stable can be
//! computed and not only felt.

use super::frame::{Frame, halves, join};
use super::setting::{self, SettingError};
use super::{Device, DeviceError, Limits, Push};
use crate::pose::{Pose, PoseError};
use crate::unit::Unit;
use nalgebra::{Matrix2, Matrix3, Point3, Vector2, Vector3, Vector6};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// What a handle and the hand about it are to a push: a mass, a damper to the ground, and a spring to where the
/// hand wants it; the same for turning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grip {
    /// kg
    pub mass: f64,
    /// N·s/mm
    pub damping: f64,
    /// N/mm
    pub stiffness: f64,
    /// kg·mm²
    pub inertia: f64,
    /// N·mm·s/rad
    pub turning_damping: f64,
    /// N·mm/rad
    pub turning: f64,
}

/// The light grip of three fingers about a stylus, in round figures: 0.1 kg, 5 N·s/m, 0.2 N/mm.
impl Default for Grip {
    fn default() -> Grip {
        Grip {
            mass: 0.1,
            damping: 0.005,
            stiffness: 0.2,
            inertia: 250.0,
            turning_damping: 12.5,
            turning: 500.0,
        }
    }
}

/// How a hand trembles about where it wants to be, each coordinate by itself: noise that a filter of second
/// order lets through about a frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tremor {
    /// Root mean square, mm.
    pub size: f64,
    /// Hz; hands have 8 to 12.
    pub frequency: f64,
    /// The same seed, the same trembling.
    pub seed: u64,
}

/// A hand with a device in it.
pub struct Hand<F> {
    wish: F,
    frame: Frame,
    limits: Limits,
    period: f64,
    cycle: u64,
    way: Swing,
    turn: Swing,
    at: Option<At>,
    push: Push,
    tremor: Option<Trembling>,
    /// What encoders tell apart, mm and rad; 0 for everything.
    steps: [f64; 2],
}

/// Where the handle is, and how fast in mm/s and rad/s.
#[derive(Clone, Copy)]
struct At {
    pose: Pose,
    start: Pose,
    speed: Vector6<f64>,
}

impl<F: FnMut(f64) -> Pose> Hand<F> {
    /// A hand that wants the tool where a function of the time in seconds says, with a device of that many
    /// cycles a second. It begins there, at rest.
    ///
    /// # Errors
    /// If the rate or a limit is out of its range.
    pub fn new(limits: Limits, rate: f64, wish: F) -> Result<Hand<F>, SettingError> {
        limits.check()?;
        let frame = Frame { centre: Point3::origin(), unit: 1.0, axes: limits.axes };
        let period = setting::period(rate)?;
        let [way, turn] = Swing::both(&Grip::default(), period)?;
        let (push, steps) = (Push::default(), [0.0; 2]);
        Ok(Hand {
            wish,
            frame,
            limits,
            period,
            cycle: 0,
            way,
            turn,
            at: None,
            push,
            tremor: None,
            steps,
        })
    }

    /// With another grip.
    ///
    /// # Errors
    /// If a number of the grip is out of its range.
    pub fn grip(mut self, grip: &Grip) -> Result<Hand<F>, SettingError> {
        grip.check()?;
        [self.way, self.turn] = Swing::both(grip, self.period)?;
        Ok(self)
    }

    /// Held at another point of the tool than its tip, in the tool's frame and the part's unit.
    ///
    /// # Errors
    /// If a coordinate is not finite.
    pub fn held_at(mut self, centre: Point3<f64>, unit: Unit) -> Result<Hand<F>, SettingError> {
        setting::centre(&centre)?;
        self.frame.centre = centre;
        self.frame.unit = unit.to(Unit::Millimetre);
        Ok(self)
    }

    /// Trembling.
    ///
    /// # Errors
    /// If its size or its frequency is out of its range.
    pub fn trembling(mut self, tremor: &Tremor) -> Result<Hand<F>, SettingError> {
        tremor.check(self.period)?;
        self.tremor = Some(Trembling::new(tremor, self.period));
        Ok(self)
    }

    /// With encoders that tell so many mm and radians apart; 0 for all.
    ///
    /// # Errors
    /// If either is negative or not finite.
    pub fn encoders(mut self, way: f64, turn: f64) -> Result<Hand<F>, SettingError> {
        setting::not_negative("step of the encoders in mm", way)?;
        setting::not_negative("step of the encoders in rad", turn)?;
        self.steps = [way, turn];
        Ok(self)
    }

    /// Where the handle truly is.
    pub fn is_at(&self) -> Option<Pose> {
        self.at.map(|at| at.pose)
    }

    /// What an encoder says.
    fn encoded(&self, at: &At) -> Result<Pose, PoseError> {
        if self.steps == [0.0; 2] {
            return Ok(at.pose);
        }
        let off = self.frame.between(&at.start, &at.pose);
        let step = |row: usize| self.steps[row / 3];
        let told = Vector6::from_fn(|row, _| match step(row) {
            0.0 => off[row],
            step => (off[row] / step).round() * step,
        });
        self.frame.moved(&at.start, &told)
    }
}

impl<F: FnMut(f64) -> Pose> Device for Hand<F> {
    fn pose(&mut self) -> Result<Pose, DeviceError> {
        let mut wish = (self.wish)(self.cycle as f64 * self.period);
        if let Some(tremor) = &mut self.tremor {
            wish = self.frame.moved(&wish, &join(&tremor.next(), &Vector3::zeros()))?;
        }
        self.cycle += 1;
        let at = match self.at {
            None => At { pose: wish, start: wish, speed: Vector6::zeros() },
            Some(at) => {
                let [off, turned] = halves(&self.frame.between(&wish, &at.pose));
                let [speed, spin] = halves(&at.speed);
                let (off, speed) = self.way.after(off, speed, &self.push.force);
                let (turned, spin) = self.turn.after(turned, spin, &self.push.torque);
                let pose = self.frame.moved(&wish, &join(&off, &turned))?;
                At { pose, speed: join(&speed, &spin), ..at }
            }
        };
        self.at = Some(at);
        Ok(self.encoded(&at)?)
    }

    fn push(&mut self, push: &Push) -> Result<(), DeviceError> {
        self.push = *push;
        Ok(())
    }

    fn limits(&self) -> Limits {
        self.limits
    }
}

/// What a mass on a spring and a damper does in a cycle under a force that does not change: exactly, by the
/// exponential of its matrix.
#[derive(Clone, Copy, Debug)]
struct Swing {
    own: Matrix2<f64>,
    by_force: Vector2<f64>,
}

/// N in kg·mm/s².
const NEWTON: f64 = 1000.0;

impl Swing {
    fn both(grip: &Grip, period: f64) -> Result<[Swing; 2], SettingError> {
        let way = ("mass of the grip in kg", [grip.mass, grip.damping, grip.stiffness]);
        let turn =
            ("inertia of the grip in kg·mm²", [grip.inertia, grip.turning_damping, grip.turning]);
        Ok([Swing::new(way, period)?, Swing::new(turn, period)?])
    }

    /// # Errors
    /// If the mass is so small beside damper and spring that its motion in a period overflows.
    fn new(
        (what, [mass, damping, stiffness]): (&'static str, [f64; 3]),
        period: f64,
    ) -> Result<Swing, SettingError> {
        let by = NEWTON / mass;
        let rates = Matrix3::new(
            0.0,
            1.0,
            0.0, //
            -stiffness * by,
            -damping * by,
            by, //
            0.0,
            0.0,
            0.0,
        );
        let after = (rates * period).exp();
        if !after.iter().all(|part| part.is_finite()) {
            let range = "one that is not so small beside damping and stiffness";
            return Err(SettingError { what, value: mass, range });
        }
        Ok(Swing {
            own: after.fixed_view::<2, 2>(0, 0).into_owned(),
            by_force: after.fixed_view::<2, 1>(0, 2).into_owned(),
        })
    }

    /// Where it is from where it is wanted, and its speed, a cycle later.
    fn after(
        &self,
        off: Vector3<f64>,
        speed: Vector3<f64>,
        force: &Vector3<f64>,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let (own, by) = (&self.own, &self.by_force);
        (
            own[(0, 0)] * off + own[(0, 1)] * speed + by[0] * force,
            own[(1, 0)] * off + own[(1, 1)] * speed + by[1] * force,
        )
    }
}

struct Trembling {
    draw: Pcg64Mcg,
    /// `x' = a x + b y + noise` of the last two.
    last: [Vector3<f64>; 2],
    own: [f64; 2],
    noise: f64,
}

/// Of the poles: how far inside the unit circle.
const DAMPED: f64 = 0.1;

impl Trembling {
    fn new(tremor: &Tremor, period: f64) -> Trembling {
        let angle = std::f64::consts::TAU * tremor.frequency * period;
        let radius = (-DAMPED * angle).exp();
        let own = [2.0 * radius * angle.cos(), -radius * radius];
        // The variance of such a process (Box, Jenkins and Reinsel, *Time Series Analysis*, eq. 3.2.30).
        let [first, second] = own;
        let gain = (1.0 - second) / ((1.0 + second) * ((1.0 - second).powi(2) - first * first));
        let draw = Pcg64Mcg::seed_from_u64(tremor.seed);
        // Uniform noise between -1 and 1 has a variance of a third.
        let noise = tremor.size * (3.0 / gain).sqrt();
        Trembling { draw, last: [Vector3::zeros(); 2], own, noise }
    }

    fn next(&mut self) -> Vector3<f64> {
        let mut uniform = || (self.draw.next_u64() >> 11) as f64 / 2f64.powi(52) - 1.0;
        let noise = Vector3::new(uniform(), uniform(), uniform()) * self.noise;
        let [last, before] = self.last;
        let next = self.own[0] * last + self.own[1] * before + noise;
        self.last = [next, last];
        next
    }
}

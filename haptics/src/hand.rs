//! A simulated hand that holds a device. It closes the loop, so that stability can be computed and not only felt.

use super::frame::{Frame, halves, join};
use super::setting::{self, SettingError, above_zero, check, not_negative};
use super::{Device, DeviceError, DeviceLimits, DeviceWrench};
use nalgebra::{Matrix2, Matrix3, Point3, Vector2, Vector3, Vector6};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::fmt;
use touchoff::{Pose, PoseError, Unit};

/// Impedance of a handle and the hand that holds it: a mass, a damper to ground and a spring to the
/// commanded position; likewise in rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandImpedance {
    /// Mass, kg.
    pub mass: f64,
    /// Damping, N·s/mm.
    pub damping: f64,
    /// Stiffness, N/mm.
    pub stiffness: f64,
    /// Moment of inertia, kg·mm².
    pub inertia: f64,
    /// Rotational damping, N·mm·s/rad.
    pub turning_damping: f64,
    /// Rotational stiffness, N·mm/rad.
    pub turning_stiffness: f64,
}

impl HandImpedance {
    fn check(&self) -> Result<(), SettingError> {
        above_zero("mass of the grip in kg", self.mass)?;
        above_zero("inertia of the grip in kg·mm²", self.inertia)?;
        not_negative("damping of the grip in N·s/mm", self.damping)?;
        not_negative("rotational damping of the grip in N·mm·s/rad", self.turning_damping)?;
        not_negative("stiffness of the grip in N/mm", self.stiffness)?;
        not_negative("rotational stiffness of the grip in N·mm/rad", self.turning_stiffness)
    }
}

/// The light grip of three fingers on a stylus, in round figures: 0.1 kg, 5 N·s/m, 0.2 N/mm.
impl Default for HandImpedance {
    fn default() -> HandImpedance {
        HandImpedance {
            mass: 0.1,
            damping: 0.005,
            stiffness: 0.2,
            inertia: 250.0,
            turning_damping: 12.5,
            turning_stiffness: 500.0,
        }
    }
}

/// Tremor of a hand about its commanded position, independent in each coordinate: noise filtered by a
/// second-order resonance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tremor {
    /// Root mean square amplitude, mm.
    pub size: f64,
    /// Resonance frequency, Hz; human hands have 8 to 12.
    pub frequency: f64,
    /// Seed of the random generator; equal seeds give equal tremor.
    pub seed: u64,
}

impl Tremor {
    fn check(&self, period: f64) -> Result<(), SettingError> {
        not_negative("size of the tremor in mm", self.size)?;
        // The filter resonates at the frequency, and samples at the loop's rate show no more than half of that.
        let is_valid = self.frequency > 0.0 && self.frequency * period <= 0.5;
        let what = "frequency of the tremor in Hz";
        check(is_valid, what, self.frequency, "a number above 0, up to half the rate")
    }
}

/// A simulated hand that holds a device.
pub struct SimulatedHand<F> {
    target: F,
    frame: Frame,
    limits: DeviceLimits,
    period: f64,
    cycle: u64,
    linear: Oscillator,
    angular: Oscillator,
    state: Option<HandleState>,
    wrench: DeviceWrench,
    tremor: Option<TremorFilter>,
    /// Encoder resolutions, mm and rad; 0 for exact values.
    encoder_steps: [f64; 2],
}

impl<F> fmt::Debug for SimulatedHand<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SimulatedHand")
            .field("cycle", &self.cycle)
            .field("limits", &self.limits)
            .finish_non_exhaustive()
    }
}

/// The pose of the handle, its initial pose, and its velocity in mm/s and rad/s.
#[derive(Clone, Copy)]
struct HandleState {
    pose: Pose,
    start: Pose,
    speed: Vector6<f64>,
}

impl<F: FnMut(f64) -> Pose> SimulatedHand<F> {
    /// Creates a hand that commands the tool pose `target` as a function of time in seconds, with a device
    /// of `rate` cycles per second. The handle starts at the first commanded pose, at rest.
    ///
    /// # Errors
    /// Fails if the rate or a limit is out of its range.
    pub fn new(
        limits: DeviceLimits,
        rate: f64,
        target: F,
    ) -> Result<SimulatedHand<F>, SettingError> {
        limits.check()?;
        let frame = Frame { centre: Point3::origin(), unit: 1.0, axes: limits.axes };
        let period = setting::period(rate)?;
        let [linear, angular] = Oscillator::linear_and_angular(&HandImpedance::default(), period)?;
        let (wrench, encoder_steps) = (DeviceWrench::default(), [0.0; 2]);
        Ok(SimulatedHand {
            target,
            frame,
            limits,
            period,
            cycle: 0,
            linear,
            angular,
            state: None,
            wrench,
            tremor: None,
            encoder_steps,
        })
    }

    /// Sets the impedance of the hand.
    ///
    /// # Errors
    /// Fails if a number of the impedance is out of its range.
    pub fn with_impedance(
        mut self,
        grip: &HandImpedance,
    ) -> Result<SimulatedHand<F>, SettingError> {
        grip.check()?;
        [self.linear, self.angular] = Oscillator::linear_and_angular(grip, self.period)?;
        Ok(self)
    }

    /// Sets the point of the tool at which it is held, in the tool frame and in `unit`; the default is the tip.
    ///
    /// # Errors
    /// Fails if a coordinate is not finite.
    pub fn with_centre(
        mut self,
        centre: Point3<f64>,
        unit: Unit,
    ) -> Result<SimulatedHand<F>, SettingError> {
        setting::centre(&centre)?;
        self.frame.centre = centre;
        self.frame.unit = unit.factor_to(Unit::Millimetre);
        Ok(self)
    }

    /// Adds tremor.
    ///
    /// # Errors
    /// Fails if its amplitude or frequency is out of its range.
    pub fn with_tremor(mut self, tremor: &Tremor) -> Result<SimulatedHand<F>, SettingError> {
        tremor.check(self.period)?;
        self.tremor = Some(TremorFilter::new(tremor, self.period));
        Ok(self)
    }

    /// Adds encoders with resolutions in mm and rad; 0 for exact values.
    ///
    /// # Errors
    /// Fails if a resolution is negative or not finite.
    pub fn with_encoders(
        mut self,
        linear: f64,
        angular: f64,
    ) -> Result<SimulatedHand<F>, SettingError> {
        not_negative("step of the encoders in mm", linear)?;
        not_negative("step of the encoders in rad", angular)?;
        self.encoder_steps = [linear, angular];
        Ok(self)
    }

    /// Returns the true pose of the handle, or `None` before the first cycle.
    pub fn pose_of_handle(&self) -> Option<Pose> {
        self.state.map(|state| state.pose)
    }

    /// Returns the pose as quantised by the encoders.
    fn quantized_pose(&self, state: &HandleState) -> Result<Pose, PoseError> {
        if self.encoder_steps == [0.0; 2] {
            return Ok(state.pose);
        }
        let offset = self.frame.between(&state.start, &state.pose);
        let quantized = Vector6::from_fn(|row, _| match self.encoder_steps[row / 3] {
            0.0 => offset[row],
            step => (offset[row] / step).round() * step,
        });
        self.frame.moved(&state.start, &quantized)
    }
}

impl<F: FnMut(f64) -> Pose> Device for SimulatedHand<F> {
    fn pose(&mut self) -> Result<Pose, DeviceError> {
        let mut target = (self.target)(self.cycle as f64 * self.period);
        if let Some(tremor) = &mut self.tremor {
            target = self.frame.moved(&target, &join(&tremor.next(), &Vector3::zeros()))?;
        }
        self.cycle += 1;
        let state = match self.state {
            None => HandleState { pose: target, start: target, speed: Vector6::zeros() },
            Some(state) => {
                let [offset, turned] = halves(&self.frame.between(&target, &state.pose));
                let [speed, spin] = halves(&state.speed);
                let (offset, speed) = self.linear.advance(offset, speed, &self.wrench.force);
                let (turned, spin) = self.angular.advance(turned, spin, &self.wrench.torque);
                let pose = self.frame.moved(&target, &join(&offset, &turned))?;
                HandleState { pose, speed: join(&speed, &spin), ..state }
            }
        };
        self.state = Some(state);
        Ok(self.quantized_pose(&state)?)
    }

    fn apply(&mut self, wrench: &DeviceWrench) -> Result<(), DeviceError> {
        self.wrench = *wrench;
        Ok(())
    }

    fn limits(&self) -> DeviceLimits {
        self.limits
    }
}

/// A mass on a spring and a damper, in translation or in rotation.
struct MassOnSpring {
    /// The name of the mass in errors.
    name: &'static str,
    /// kg or kg·mm².
    mass: f64,
    damping: f64,
    stiffness: f64,
}

/// Discrete-time model of a mass on a spring and a damper under a force that is constant over a cycle:
/// exact, by the matrix exponential.
#[derive(Clone, Copy, Debug)]
struct Oscillator {
    transition: Matrix2<f64>,
    by_force: Vector2<f64>,
}

/// One newton in kg·mm/s².
const NEWTON: f64 = 1000.0;

impl Oscillator {
    fn linear_and_angular(
        impedance: &HandImpedance,
        period: f64,
    ) -> Result<[Oscillator; 2], SettingError> {
        let linear = MassOnSpring {
            name: "mass of the grip in kg",
            mass: impedance.mass,
            damping: impedance.damping,
            stiffness: impedance.stiffness,
        };
        let angular = MassOnSpring {
            name: "inertia of the grip in kg·mm²",
            mass: impedance.inertia,
            damping: impedance.turning_damping,
            stiffness: impedance.turning_stiffness,
        };
        Ok([Oscillator::new(&linear, period)?, Oscillator::new(&angular, period)?])
    }

    /// Computes the model.
    ///
    /// # Errors
    /// Fails if the mass is so small compared with damping and stiffness that its motion in a period overflows.
    fn new(model: &MassOnSpring, period: f64) -> Result<Oscillator, SettingError> {
        let MassOnSpring { name: what, mass, damping, stiffness } = *model;
        let gain = NEWTON / mass;
        // The rates of offset, speed and force, of which the force is constant over a cycle.
        let rates = Matrix3::new(
            0.0,
            1.0,
            0.0, //
            -stiffness * gain,
            -damping * gain,
            gain, //
            0.0,
            0.0,
            0.0,
        );
        // The last row keeps the force, so one exponential has the transition and the gain.
        let exponential = (rates * period).exp();
        if !exponential.iter().all(|part| part.is_finite()) {
            let range = "one that is not so small beside damping and stiffness";
            return Err(SettingError { what, value: mass, range });
        }
        Ok(Oscillator {
            transition: exponential.fixed_view::<2, 2>(0, 0).into_owned(),
            by_force: exponential.fixed_view::<2, 1>(0, 2).into_owned(),
        })
    }

    /// Returns the offset from the commanded position and the velocity, one cycle later.
    fn advance(
        &self,
        offset: Vector3<f64>,
        speed: Vector3<f64>,
        force: &Vector3<f64>,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let (transition, gain) = (&self.transition, &self.by_force);
        (
            transition[(0, 0)] * offset + transition[(0, 1)] * speed + gain[0] * force,
            transition[(1, 0)] * offset + transition[(1, 1)] * speed + gain[1] * force,
        )
    }
}

struct TremorFilter {
    random: Pcg64Mcg,
    /// The last two outputs of the recursion `x' = a x + b y + noise`.
    last: [Vector3<f64>; 2],
    transition: [f64; 2],
    noise: f64,
}

/// Damping ratio of the resonance: the poles' distance from the unit circle, relative to the angle per cycle.
const DAMPING_RATIO: f64 = 0.1;

impl TremorFilter {
    fn new(tremor: &Tremor, period: f64) -> TremorFilter {
        let angle = std::f64::consts::TAU * tremor.frequency * period;
        // The poles of the recursion are at this radius, and at plus and minus the angle.
        let radius = (-DAMPING_RATIO * angle).exp();
        let transition = [2.0 * radius * angle.cos(), -radius * radius];
        // The variance of such a process (Box, Jenkins and Reinsel, *Time Series Analysis*, eq. 3.2.30).
        let [first, second] = transition;
        let gain = (1.0 - second) / ((1.0 + second) * ((1.0 - second).powi(2) - first * first));
        let random = Pcg64Mcg::seed_from_u64(tremor.seed);
        // Uniform noise between -1 and 1 has a variance of a third.
        let noise = tremor.size * (3.0 / gain).sqrt();
        TremorFilter { random, last: [Vector3::zeros(); 2], transition, noise }
    }

    fn next(&mut self) -> Vector3<f64> {
        // 53 random bits, from -1 to 1.
        let uniform = [(); 3].map(|()| (self.random.next_u64() >> 11) as f64 / 2f64.powi(52) - 1.0);
        let noise = Vector3::from(uniform) * self.noise;
        let [last, before] = self.last;
        let next = self.transition[0] * last + self.transition[1] * before + noise;
        self.last = [next, last];
        next
    }
}

//! A haptic session: the computation of one cycle.

use super::coupling::{Coupling, as_push, as_vector, rendered, saturated, spring, springs};
use super::frame::{Frame, halves};
use super::input_filter::{DeviceFaults, FilteredInput, InputFilter, SpeedLimit};
use super::passivity::{EnergyBalance, Passivity};
use super::setting::{self, SettingError};
use super::{Device, DeviceAxes, DeviceLimits, DeviceWrench};
use crate::debug::debug;
use crate::pose::Pose;
use crate::probe::{Law, Probe, Stiffness, Wrench};
use crate::tool::BatchEvaluator;
use crate::tool::Tool;
use nalgebra::{Matrix6, Vector6};
use std::time::Duration;

/// Methods of computing the device's wrench from contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rendering {
    /// The contact wrench at the device's pose.
    Direct {
        /// `true` to scale the wrench down wherever contact is stiffer than the device can render, by
        /// the largest eigenvalue of the contact's stiffness.
        scaled: bool,
        /// Time constant of a damper in contact, s: the damping coefficient is this time times the
        /// stiffness that the device can render.
        damping: f64,
    },
    /// Virtual coupling: the tool yields at the other end of a spring.
    Coupled(Coupling),
}

/// The settings of a session. [`Session::new`] checks all numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SessionSettings {
    /// Cycles per second, 0.001 to 1,000,000.
    pub rate: f64,
    /// Force in N per unit of a [`Wrench`]'s force: N/mm³ if the part is in mm and the magnitude is the
    /// depth.
    pub stiffness: f64,
    /// The rendering method; `None` for a coupling as stiff as the device can render.
    pub rendering: Option<Rendering>,
    /// `true` to dissipate generated energy.
    pub passive: bool,
    /// The largest plausible speed of the hand.
    pub fastest: SpeedLimit,
}

impl SessionSettings {
    /// Returns settings with `rate` cycles per second, 1 N/mm³, and passivity control.
    pub fn new(rate: f64) -> SessionSettings {
        SessionSettings {
            rate,
            stiffness: 1.0,
            rendering: None,
            passive: true,
            fastest: SpeedLimit::default(),
        }
    }
}

/// The state after a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SessionState {
    /// The index of the cycle, from 0.
    pub cycle: u64,
    /// The pose of the device; the last known one if there is no new pose.
    pub device: Pose,
    /// The pose of the tool.
    pub tool: Pose,
    /// The wrench that the device applies to the hand.
    pub wrench_on_hand: DeviceWrench,
    /// The contact wrench on the tool, as returned by the probe.
    pub wrench: Wrench,
    /// The largest eigenvalue of the contact's stiffness, relative to the stiffness that the device can
    /// render.
    pub stiffest: f64,
    /// The energy balance.
    pub energy: EnergyBalance,
    /// `true` if the device returned no usable pose in this cycle.
    pub held: bool,
}

/// A tool at a part, held by a hand through a device. No cycle waits or allocates, even if its contact
/// is much larger than earlier ones: [`Session::new`] reserves memory for a contact of all points of the
/// part. A device may allocate, and so may a user-defined [`Tool`] without [`Tool::reserve`].
pub struct Session<'a, T: ?Sized = dyn Tool + 'a> {
    probe: Probe<'a, T>,
    newtons: f64,
    rendering: Rendering,
    passive: bool,
    period: f64,
    limits: DeviceLimits,
    frame: Frame,
    guard: InputFilter,
    passivity: Passivity,
    /// The poses of device and tool, and their difference.
    place: Option<CoupledPoses>,
    /// The contact force at the tool's pose.
    last: Option<ContactForce>,
    push: DeviceWrench,
    /// The fraction of the wrench that is applied, from 0 to 1; it ramps up after a start.
    engaged: f64,
    cycle: u64,
}

debug!([T: ?Sized] Session<'_, T>, "Session", |this| { period: this.period, limits: this.limits });

#[derive(Clone, Copy)]
struct CoupledPoses {
    device: Pose,
    tool: Pose,
    stretch: Vector6<f64>,
}

/// A contact force, in N, N·mm and mm.
#[derive(Clone, Copy)]
struct ContactForce {
    wrench: Wrench,
    force: Vector6<f64>,
    /// Energy, N·mm.
    energy: f64,
    matrix: Matrix6<f64>,
    stiffest: f64,
}

/// Duration of the ramp of the wrench after the motion begins anew, s.
const COMING_ON: f64 = 0.1;
/// Maximum number of tool evaluations per cycle.
const ASKED: usize = 6;
/// Largest residual of the balance between spring and contact, relative to the device's maxima.
const BALANCED: f64 = 1e-7;

impl<'a, T: BatchEvaluator + ?Sized> Session<'a, T> {
    /// Creates a session for a probe, with the probe's law and compliance centre. It reserves 127 bytes
    /// per point of the part, 13 MB for 100,000 points, and some 100 kB for an interpreted tool.
    ///
    /// # Errors
    /// Fails if a setting, a limit of the device or the compliance centre is out of its range, such as a
    /// rate of 0 or a stiffness of NaN.
    pub fn new(
        mut probe: Probe<'a, T>,
        settings: &SessionSettings,
        limits: DeviceLimits,
    ) -> Result<Session<'a, T>, SettingError> {
        settings.check()?;
        limits.check()?;
        let period = setting::period(settings.rate)?;
        let (centre, unit) = probe.centre_and_unit();
        setting::centre(&centre)?;
        probe.reserve();
        let coupled = || Rendering::Coupled(Coupling::of(&limits));
        Ok(Session {
            newtons: settings.stiffness,
            rendering: settings.rendering.unwrap_or_else(coupled),
            passive: settings.passive,
            period,
            limits,
            frame: Frame { centre, unit, axes: limits.axes },
            guard: InputFilter::new(settings.fastest, period),
            passivity: Passivity::default(),
            place: None,
            last: None,
            push: DeviceWrench::default(),
            engaged: 0.0,
            cycle: 0,
            probe,
        })
    }

    /// Returns the duration of a cycle.
    pub fn period(&self) -> Duration {
        Duration::from_secs_f64(self.period)
    }

    /// Returns the counts of device faults.
    pub fn faults(&self) -> DeviceFaults {
        self.guard.faults
    }

    /// Executes one cycle: reads the device's pose and applies a wrench to it. Returns `None` until the
    /// device has reported its first pose.
    pub fn cycle(&mut self, device: &mut impl Device) -> Option<SessionState> {
        let taken = self.guard.take(device.pose(), &self.frame);
        let held = matches!(taken, FilteredInput::Held);
        let before = self.place.map(|place| place.device);
        let (now, way) = match (taken, before) {
            (FilteredInput::On(pose), Some(before)) => (pose, self.frame.between(&before, &pose)),
            (FilteredInput::Held, Some(before)) => (before, Vector6::zeros()),
            (FilteredInput::On(pose) | FilteredInput::Anew(pose), _) => {
                self.begin(pose);
                (pose, Vector6::zeros())
            }
            // The pose of the tool is still unknown.
            (FilteredInput::Held, None) => return None,
        };
        self.passivity.moved(&self.push, &way);
        let (evaluations, push, energy) = match self.rendering {
            Rendering::Direct { scaled, damping } => self.direct(now, &way, (scaled, damping)),
            Rendering::Coupled(coupling) => self.coupled(now, &coupling),
        };
        // A hand that begins inside a part is not struck: the energy of the ramp counts as supplied.
        let more = (self.engaged + self.period / COMING_ON).min(1.0) - self.engaged;
        self.engaged += more;
        self.passivity.given(more * energy);
        self.passivity.holds(self.engaged * energy);
        let mut push = saturated(&push.scaled(self.engaged), &self.limits);
        if self.passive {
            let damped = self.passivity.damped(&way, &springs(&self.limits));
            push = saturated(&push.and(&damped), &self.limits);
        }
        if device.apply(&push).is_err() {
            self.guard.faults.failed_writes += 1;
        }
        self.push = push;
        let state = SessionState {
            cycle: self.cycle,
            device: now,
            tool: self.place.map_or(now, |place| place.tool),
            wrench_on_hand: push,
            wrench: evaluations.wrench,
            stiffest: evaluations.stiffest,
            energy: self.passivity.energy,
            held,
        };
        self.cycle += 1;
        Some(state)
    }

    /// Moves the tool to the hand's pose, without a wrench.
    fn begin(&mut self, pose: Pose) {
        self.place = Some(CoupledPoses { device: pose, tool: pose, stretch: Vector6::zeros() });
        self.push = DeviceWrench::default();
        self.passivity = Passivity::default();
        self.last = None;
        self.engaged = 0.0;
    }

    /// Returns the contact force on the tool at a pose.
    fn contact_force(&mut self, pose: &Pose) -> ContactForce {
        let Stiffness { wrench, matrix } = self.probe.stiffness(pose);
        let (newtons, unit) = (self.newtons, self.frame.unit);
        // A torque has one more length dimension than a force; a derivative by length has one less.
        let lengths = |row: usize| if row < 3 { 1.0 } else { unit };
        let mut torque = wrench.torque;
        if self.frame.axes == DeviceAxes::Five {
            torque -= pose.axis() * pose.axis().dot(&torque);
        }
        let force = as_vector(&DeviceWrench { force: wrench.force, torque });
        let matrix = Matrix6::from_fn(|row, column| {
            newtons * lengths(row) * lengths(column) / unit * matrix[(row, column)]
        });
        let (matrix, stiffest) = match wrench.colliding {
            0 => (Matrix6::zeros(), 0.0),
            _ => rendered(&matrix, &self.limits),
        };
        ContactForce {
            wrench,
            force: Vector6::from_fn(|row, _| newtons * lengths(row) * force[row]),
            // Other laws have no energy.
            energy: if wrench.law == Law::Gradient { newtons * unit * wrench.energy } else { 0.0 },
            matrix,
            stiffest,
        }
    }

    /// Renders directly: the tool is at the device's pose.
    fn direct(
        &mut self,
        now: Pose,
        way: &Vector6<f64>,
        (scaled, damping): (bool, f64),
    ) -> (ContactForce, DeviceWrench, f64) {
        let evaluations = self.contact_force(&now);
        let gain = if scaled { 1.0 / evaluations.stiffest.max(1.0) } else { 1.0 };
        let mut force = evaluations.force * gain;
        if evaluations.wrench.colliding > 0 {
            force -= springs(&self.limits).component_mul(way) * (damping / self.period);
        }
        self.place = Some(CoupledPoses { device: now, tool: now, stretch: Vector6::zeros() });
        let held = evaluations.energy * gain;
        (evaluations, as_push(&force), held)
    }

    /// Renders through the coupling: finds the pose at which contact and coupling balance, by Newton's
    /// method from the last pose. The next cycle corrects the residual, which depends on the hand's
    /// displacement; the hand gets the spring force as it is.
    fn coupled(&mut self, now: Pose, coupling: &Coupling) -> (ContactForce, DeviceWrench, f64) {
        let (mut tool, before) = match &self.place {
            Some(place) => (place.tool, place.stretch),
            None => (now, Vector6::zeros()),
        };
        let damper = coupling.springs() * (coupling.damping / self.period);
        let mut evaluations = self.last.take().unwrap_or_else(|| self.contact_force(&tool));
        let mut asked = 0;
        loop {
            let stretch = self.frame.between(&tool, &now);
            let (stiffness, energy) = spring(coupling, &self.limits, &stretch);
            let pull =
                stiffness.component_mul(&stretch) + damper.component_mul(&(stretch - before));
            let left = pull + evaluations.force;
            let solved = match asked < ASKED && !self.balanced(&left) {
                true => {
                    (evaluations.matrix + Matrix6::from_diagonal(&(stiffness + damper))).cholesky()
                }
                false => None,
            };
            let Some(solved) = solved else {
                self.place = Some(CoupledPoses { device: now, tool, stretch });
                let held = evaluations.energy + energy;
                self.last = Some(evaluations);
                return (evaluations, as_push(&-pull), held);
            };
            let step = solved.solve(&left);
            asked += 1;
            match self.frame.moved(&tool, &step) {
                Ok(moved) => tool = moved,
                // Reject a step out of bounds, and end the iteration.
                Err(_) => asked = ASKED,
            }
            evaluations = self.contact_force(&tool);
        }
    }

    fn balanced(&self, left: &Vector6<f64>) -> bool {
        let [force, torque] = halves(left).map(|part| part.norm());
        force <= BALANCED * self.limits.force && torque <= BALANCED * self.limits.torque
    }
}

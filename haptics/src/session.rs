//! A haptic session: the computation of one cycle.

use super::frame::{Frame, halves};
use super::input_filter::{DeviceFaults, FilteredInput, InputFilter, SpeedLimit};
use super::rendering::{
    Coupling, EnergyBalance, Passivity, Rendering, limit_stiffness, saturate, spring, springs,
    to_vector, to_wrench,
};
use super::setting::{self, SettingError, above_zero, check, not_negative};
use super::{Device, DeviceAxes, DeviceLimits, DeviceWrench};
use nalgebra::{Matrix6, Vector6};
use std::fmt;
use std::time::Duration;
use touchoff::tool::BatchEvaluator;
use touchoff::{Law, Pose, Probe, Stiffness, Tool, Unit, Wrench};

/// The settings of a session. [`Session::new`] checks all numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SessionSettings {
    /// Cycles per second, 0.001 to 1,000,000.
    pub rate: f64,
    /// Force in N per unit of a [`Wrench`]'s force: N/mm³ if the part is in mm and the magnitude is the depth.
    /// [`ContactStiffness::derived`](crate::ContactStiffness::derived) has one that suits a tool and a part.
    pub stiffness: f64,
    /// The rendering method; `None` for a coupling as stiff as the device can render.
    pub rendering: Option<Rendering>,
    /// `true` to dissipate generated energy.
    pub passive: bool,
    /// The largest plausible speed of the hand.
    pub fastest: SpeedLimit,
}

impl SessionSettings {
    fn check(&self) -> Result<(), SettingError> {
        let SessionSettings { rate, stiffness, rendering, passive: _, fastest } = *self;
        setting::period(rate)?;
        above_zero("stiffness of contact", stiffness)?;
        match rendering {
            Some(Rendering::Direct { scaled: _, damping }) => {
                not_negative("damping of direct rendering in s", damping)?;
            }
            Some(Rendering::Coupled(coupling)) => coupling.check()?,
            None => {}
        }
        let SpeedLimit { linear, angular } = fastest;
        let speeds =
            [("largest speed in mm/s", linear), ("largest turning speed in rad/s", angular)];
        speeds.into_iter().try_for_each(|(what, speed)| {
            check(speed > 0.0, what, speed, "a number above 0, or infinity to accept any speed")
        })
    }

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
#[non_exhaustive]
pub struct SessionState {
    /// The index of the cycle, from 0.
    pub cycle: u64,
    /// The pose of the device; the last known one if there is no new pose.
    pub device: Pose,
    /// The pose of the tool.
    pub tool: Pose,
    /// The wrench that the device applies to the hand: the last one that it took.
    pub wrench_on_hand: DeviceWrench,
    /// The contact wrench on the tool, as returned by the probe.
    pub wrench: Wrench,
    /// The largest eigenvalue of the contact's stiffness, relative to the stiffness that the device can render.
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
    input_filter: InputFilter,
    passivity: Passivity,
    /// The poses of device and tool, and their difference.
    poses: Option<CoupledPoses>,
    /// The contact force at the tool's pose.
    last: Option<ContactForce>,
    device_wrench: DeviceWrench,
    /// The fraction of the wrench that is applied, from 0 to 1; it ramps up after a start.
    ramp: f64,
    cycle: u64,
}

impl<T: ?Sized> fmt::Debug for Session<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Session")
            .field("period", &self.period)
            .field("limits", &self.limits)
            .finish_non_exhaustive()
    }
}

#[derive(Clone, Copy)]
struct CoupledPoses {
    device: Pose,
    tool: Pose,
    displacement: Vector6<f64>,
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
const RAMP_TIME: f64 = 0.1;
/// Maximum number of tool evaluations per cycle.
const MAX_EVALUATIONS: usize = 6;
/// Largest residual of the balance between spring and contact, relative to the device's maxima.
const BALANCE_TOLERANCE: f64 = 1e-7;

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
        let (centre, unit) = (probe.centre(), probe.unit().factor_to(Unit::Millimetre));
        setting::centre(&centre)?;
        probe.reserve();
        Ok(Session {
            newtons: settings.stiffness,
            rendering: settings
                .rendering
                .unwrap_or_else(|| Rendering::Coupled(Coupling::of(&limits))),
            passive: settings.passive,
            period,
            limits,
            frame: Frame { centre, unit, axes: limits.axes },
            input_filter: InputFilter::new(settings.fastest, period),
            passivity: Passivity::default(),
            poses: None,
            last: None,
            device_wrench: DeviceWrench::default(),
            ramp: 0.0,
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
        self.input_filter.faults
    }

    /// Executes one cycle: reads the device's pose and applies a wrench to it. Returns `None` until the
    /// device has reported its first pose.
    pub fn cycle(&mut self, device: &mut impl Device) -> Option<SessionState> {
        let input = self.input_filter.filter(device.pose(), &self.frame);
        let held = matches!(input, FilteredInput::Held);
        let previous = self.poses.map(|poses| poses.device);
        let (device_pose, displacement) = match (input, previous) {
            (FilteredInput::Continued(pose), Some(previous)) => {
                (pose, self.frame.between(&previous, &pose))
            }
            (FilteredInput::Held, Some(previous)) => (previous, Vector6::zeros()),
            (FilteredInput::Continued(pose) | FilteredInput::Restarted(pose), _) => {
                self.restart(pose);
                (pose, Vector6::zeros())
            }
            // The pose of the tool is still unknown.
            (FilteredInput::Held, None) => return None,
        };
        self.passivity.add_work(&self.device_wrench, &displacement);
        let (evaluations, device_wrench, energy) = match self.rendering {
            Rendering::Direct { scaled, damping } => {
                self.direct(device_pose, &displacement, scaled, damping)
            }
            Rendering::Coupled(coupling) => self.coupled(device_pose, &coupling),
        };
        // A hand that begins inside a part is not struck: the energy of the ramp counts as supplied.
        let ramp_step = (self.ramp + self.period / RAMP_TIME).min(1.0) - self.ramp;
        self.ramp += ramp_step;
        self.passivity.supply(ramp_step * energy);
        self.passivity.set_stored(self.ramp * energy);
        let undamped = saturate(&device_wrench.scaled(self.ramp), &self.limits);
        let mut device_wrench = undamped;
        if self.passive {
            let damping = self.passivity.damping_wrench(&displacement, &springs(&self.limits));
            // The sum may exceed what each of both keeps to.
            device_wrench = saturate(&undamped.and(&damping), &self.limits);
        }
        // The loop goes on without the force: a device that stops answering must not stop the cycles. The wrench before
        // goes on to act on the hand.
        match device.apply(&device_wrench) {
            Ok(()) => {
                self.device_wrench = device_wrench;
                self.passivity.set_damping(&device_wrench, &undamped);
            }
            Err(_) => self.input_filter.faults.failed_writes += 1,
        }
        let state = SessionState {
            cycle: self.cycle,
            device: device_pose,
            tool: self.poses.map_or(device_pose, |poses| poses.tool),
            wrench_on_hand: self.device_wrench,
            wrench: evaluations.wrench,
            stiffest: evaluations.stiffest,
            energy: self.passivity.energy,
            held,
        };
        self.cycle += 1;
        Some(state)
    }

    /// Moves the tool to the hand's pose, without a wrench on the hand.
    fn restart(&mut self, pose: Pose) {
        self.poses =
            Some(CoupledPoses { device: pose, tool: pose, displacement: Vector6::zeros() });
        self.device_wrench = DeviceWrench::default();
        self.passivity = Passivity::default();
        self.last = None;
        self.ramp = 0.0;
    }

    /// Returns the contact force on the tool at a pose.
    fn contact_force(&mut self, pose: &Pose) -> ContactForce {
        let Stiffness { wrench, matrix } = self.probe.stiffness(pose);
        let (newtons, unit) = (self.newtons, self.frame.unit);
        // A torque has one more length dimension than a force; a derivative by length has one less.
        let length_factor = [1.0, 1.0, 1.0, unit, unit, unit];
        // A device of five axes cannot render a torque about the tool's axis.
        let mut torque = wrench.torque;
        if self.frame.axes == DeviceAxes::Five {
            torque -= pose.axis() * pose.axis().dot(&torque);
        }
        let force = to_vector(&DeviceWrench { force: wrench.force, torque });
        let matrix = Matrix6::from_fn(|row, column| {
            newtons * length_factor[row] * length_factor[column] / unit * matrix[(row, column)]
        });
        let (matrix, stiffest) = match wrench.colliding {
            0 => (Matrix6::zeros(), 0.0),
            // A negative stiffness would let Newton's method run to a maximum of the energy.
            _ => limit_stiffness(&matrix, &self.limits),
        };
        ContactForce {
            wrench,
            force: Vector6::from_fn(|row, _| newtons * length_factor[row] * force[row]),
            // Other laws have no energy.
            energy: if wrench.law == Law::Gradient { newtons * unit * wrench.energy } else { 0.0 },
            matrix,
            stiffest,
        }
    }

    /// Renders directly: the tool is at the device's pose.
    fn direct(
        &mut self,
        device: Pose,
        displacement: &Vector6<f64>,
        scaled: bool,
        damping: f64,
    ) -> (ContactForce, DeviceWrench, f64) {
        let evaluations = self.contact_force(&device);
        let gain = if scaled { 1.0 / evaluations.stiffest.max(1.0) } else { 1.0 };
        let mut force = evaluations.force * gain;
        // Free motion is not damped.
        if evaluations.wrench.colliding > 0 {
            force -= springs(&self.limits).component_mul(displacement) * (damping / self.period);
        }
        self.poses = Some(CoupledPoses { device, tool: device, displacement: Vector6::zeros() });
        let stored = evaluations.energy * gain;
        (evaluations, to_wrench(&force), stored)
    }

    /// Renders through the coupling: finds the pose at which contact and coupling balance, by Newton's
    /// method from the last pose. The next cycle corrects the residual, which depends on the hand's
    /// displacement; the hand gets the spring force as it is.
    fn coupled(&mut self, device: Pose, coupling: &Coupling) -> (ContactForce, DeviceWrench, f64) {
        let (mut tool, previous) = match &self.poses {
            Some(poses) => (poses.tool, poses.displacement),
            None => (device, Vector6::zeros()),
        };
        let damper = coupling.springs() * (coupling.damping / self.period);
        // The contact at the tool's pose is known from the cycle before, so a cycle in balance evaluates nothing.
        let mut evaluations = self.last.take().unwrap_or_else(|| self.contact_force(&tool));
        let mut evaluations_done = 0;
        loop {
            let displacement = self.frame.between(&tool, &device);
            let (stiffness, energy) = spring(coupling, &self.limits, &displacement);
            let spring_force = stiffness.component_mul(&displacement)
                + damper.component_mul(&(displacement - previous));
            let residual = spring_force + evaluations.force;
            let solved = match evaluations_done < MAX_EVALUATIONS && !self.is_balanced(&residual) {
                true => {
                    (evaluations.matrix + Matrix6::from_diagonal(&(stiffness + damper))).cholesky()
                }
                false => None,
            };
            let Some(solved) = solved else {
                self.poses = Some(CoupledPoses { device, tool, displacement });
                let stored = evaluations.energy + energy;
                self.last = Some(evaluations);
                return (evaluations, to_wrench(&-spring_force), stored);
            };
            let step = solved.solve(&residual);
            evaluations_done += 1;
            match self.frame.moved(&tool, &step) {
                Ok(moved) => tool = moved,
                // Reject a step out of bounds, and end the iteration.
                Err(_) => evaluations_done = MAX_EVALUATIONS,
            }
            evaluations = self.contact_force(&tool);
        }
    }

    fn is_balanced(&self, residual: &Vector6<f64>) -> bool {
        let [force, torque] = halves(residual).map(|part| part.norm());
        force <= BALANCE_TOLERANCE * self.limits.force
            && torque <= BALANCE_TOLERANCE * self.limits.torque
    }
}

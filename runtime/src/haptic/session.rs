//! One cycle after another.

use super::coupling::{Coupling, as_push, as_vector, rendered, saturated, spring, springs};
use super::frame::{Frame, halves};
use super::guard::{Fastest, Faults, Guard, Taken};
use super::passivity::{Energy, Passivity};
use super::setting::{self, SettingError};
use super::{Axes, Device, Limits, Push};
use crate::pose::Pose;
use crate::probe::{Law, Probe, Stiffness, Wrench};
use crate::tool::Senses;
use crate::tool::Tool;
use nalgebra::{Matrix6, Vector6};
use std::time::Duration;

/// How contact becomes a push.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rendering {
    /// What the tool feels where the device is.
    Direct {
        /// Whether it is scaled down wherever contact is stiffer than the device can render: by the largest
        /// eigenvalue of the contact's stiffness.
        scaled: bool,
        /// A damper in contact, by the time that it remembers: its damping is that times what the device can
        /// render, s.
        damping: f64,
    },
    /// Through a spring, at whose other end the tool gives way.
    Coupled(Coupling),
}

/// The settings of a session. [`Session::new`] checks all numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Cycles per second, 0.001 to 1,000,000.
    pub rate: f64,
    /// N for each unit of a [`Wrench`]'s force: N/mm³, if the part is in mm and the magnitude is the depth.
    pub stiffness: f64,
    /// How contact becomes a push; `None` for a spring as stiff as the device can render.
    pub rendering: Option<Rendering>,
    /// Whether energy that came from nowhere is taken out again.
    pub passive: bool,
    /// How fast a hand may be.
    pub fastest: Fastest,
}

impl Settings {
    /// So many cycles a second, 1 N/mm³.
    pub fn new(rate: f64) -> Settings {
        Settings {
            rate,
            stiffness: 1.0,
            rendering: None,
            passive: true,
            fastest: Fastest::default(),
        }
    }
}

/// What a cycle came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// The cycle, from 0.
    pub cycle: u64,
    /// Where the device was, or was last.
    pub device: Pose,
    /// Where the tool is.
    pub tool: Pose,
    /// What the hand feels.
    pub push: Push,
    /// What the tool feels.
    pub wrench: Wrench,
    /// The largest eigenvalue of the contact's stiffness, 1 being what the device can render.
    pub stiffest: f64,
    /// The energy.
    pub energy: Energy,
    /// Whether the device said nothing that could be used.
    pub held: bool,
}

/// A tool at a part, in a hand. No cycle waits or allocates, however much larger its contact is than those
/// before: [`Session::new`] reserves memory for a contact of all points of the part. A device allocates what
/// it will, and so does a [`Tool`] of one's own that has no [`Tool::reserve`].
pub struct Session<'a, T: ?Sized = dyn Tool + 'a> {
    probe: Probe<'a, T>,
    newtons: f64,
    rendering: Rendering,
    passive: bool,
    period: f64,
    limits: Limits,
    frame: Frame,
    guard: Guard,
    passivity: Passivity,
    /// Device, tool, and how they differed.
    place: Option<Place>,
    /// What the tool felt where it is.
    last: Option<Felt>,
    push: Push,
    /// How much of the push the hand feels by now.
    engaged: f64,
    cycle: u64,
}

#[derive(Clone, Copy)]
struct Place {
    device: Pose,
    tool: Pose,
    stretch: Vector6<f64>,
}

/// What is felt, in N, N·mm and mm.
#[derive(Clone, Copy)]
struct Felt {
    wrench: Wrench,
    force: Vector6<f64>,
    /// N·mm
    energy: f64,
    matrix: Matrix6<f64>,
    stiffest: f64,
}

/// So long it takes for a push to come on after the hand began anew, s.
const COMING_ON: f64 = 0.1;
/// So often at most the tool is asked in a cycle.
const ASKED: usize = 6;
/// Springs and contact balance where what is left is no more than this share of what the device can push.
const BALANCED: f64 = 1e-7;

impl<'a, T: Senses + ?Sized> Session<'a, T> {
    /// A session of a probe, whose law and compliance centre it goes by. It reserves 127 bytes per point of
    /// the part, 13 MB for 100,000 points, and some 100 kB for a tool that is interpreted.
    ///
    /// # Errors
    /// If a setting, a limit of the device or the compliance centre is out of its range: a rate of 0, a
    /// stiffness that is NaN.
    pub fn new(
        mut probe: Probe<'a, T>,
        settings: &Settings,
        limits: Limits,
    ) -> Result<Session<'a, T>, SettingError> {
        settings.check()?;
        limits.check()?;
        let period = setting::period(settings.rate)?;
        let (centre, unit) = probe.place();
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
            guard: Guard::new(settings.fastest, period),
            passivity: Passivity::default(),
            place: None,
            last: None,
            push: Push::default(),
            engaged: 0.0,
            cycle: 0,
            probe,
        })
    }

    /// How long a cycle is.
    pub fn period(&self) -> Duration {
        Duration::from_secs_f64(self.period)
    }

    /// What was not as it should be.
    pub fn faults(&self) -> Faults {
        self.guard.faults
    }

    /// One cycle: asks the device where it is, and pushes it. `None` as long as it has never said where it is.
    pub fn cycle(&mut self, device: &mut impl Device) -> Option<State> {
        let taken = self.guard.take(device.pose(), &self.frame);
        let held = matches!(taken, Taken::Held);
        let before = self.place.map(|place| place.device);
        let (now, way) = match (taken, before) {
            (Taken::On(pose), Some(before)) => (pose, self.frame.between(&before, &pose)),
            (Taken::Held, Some(before)) => (before, Vector6::zeros()),
            (Taken::On(pose) | Taken::Anew(pose), _) => {
                self.begin(pose);
                (pose, Vector6::zeros())
            }
            // Nobody knows where the tool is.
            (Taken::Held, None) => return None,
        };
        self.passivity.moved(&self.push, &way);
        let (felt, push, energy) = match self.rendering {
            Rendering::Direct { scaled, damping } => self.direct(now, &way, (scaled, damping)),
            Rendering::Coupled(coupling) => self.coupled(now, &coupling),
        };
        // A hand that begins inside a part is not struck: what comes on counts as put in.
        let more = (self.engaged + self.period / COMING_ON).min(1.0) - self.engaged;
        self.engaged += more;
        self.passivity.given(more * energy);
        self.passivity.holds(self.engaged * energy);
        let mut push = saturated(&push.scaled(self.engaged), &self.limits);
        if self.passive {
            let damped = self.passivity.damped(&way, &springs(&self.limits));
            push = saturated(&push.and(&damped), &self.limits);
        }
        if device.push(&push).is_err() {
            self.guard.faults.not_pushed += 1;
        }
        self.push = push;
        let state = State {
            cycle: self.cycle,
            device: now,
            tool: self.place.map_or(now, |place| place.tool),
            push,
            wrench: felt.wrench,
            stiffest: felt.stiffest,
            energy: self.passivity.energy,
            held,
        };
        self.cycle += 1;
        Some(state)
    }

    /// The tool jumps to where the hand is, without a push.
    fn begin(&mut self, pose: Pose) {
        self.place = Some(Place { device: pose, tool: pose, stretch: Vector6::zeros() });
        self.push = Push::default();
        self.passivity = Passivity::default();
        self.last = None;
        self.engaged = 0.0;
    }

    /// What the tool feels at a pose.
    fn feel(&mut self, pose: &Pose) -> Felt {
        let Stiffness { wrench, matrix } = self.probe.stiffness(pose);
        let (newtons, unit) = (self.newtons, self.frame.unit);
        // A torque is a length more, what is per length a length less.
        let lengths = |row: usize| if row < 3 { 1.0 } else { unit };
        let mut torque = wrench.torque;
        if self.frame.axes == Axes::Five {
            torque -= pose.axis() * pose.axis().dot(&torque);
        }
        let force = as_vector(&Push { force: wrench.force, torque });
        let matrix = Matrix6::from_fn(|row, column| {
            newtons * lengths(row) * lengths(column) / unit * matrix[(row, column)]
        });
        let (matrix, stiffest) = match wrench.colliding {
            0 => (Matrix6::zeros(), 0.0),
            _ => rendered(&matrix, &self.limits),
        };
        Felt {
            wrench,
            force: Vector6::from_fn(|row, _| newtons * lengths(row) * force[row]),
            // Other laws have none.
            energy: if wrench.law == Law::Gradient { newtons * unit * wrench.energy } else { 0.0 },
            matrix,
            stiffest,
        }
    }

    /// The tool is where the device is.
    fn direct(
        &mut self,
        now: Pose,
        way: &Vector6<f64>,
        (scaled, damping): (bool, f64),
    ) -> (Felt, Push, f64) {
        let felt = self.feel(&now);
        let gain = if scaled { 1.0 / felt.stiffest.max(1.0) } else { 1.0 };
        let mut force = felt.force * gain;
        if felt.wrench.colliding > 0 {
            force -= springs(&self.limits).component_mul(way) * (damping / self.period);
        }
        self.place = Some(Place { device: now, tool: now, stretch: Vector6::zeros() });
        let held = felt.energy * gain;
        (felt, as_push(&force), held)
    }

    /// The tool is where contact and coupling balance, by Newton's method from where it was. What is left over,
    /// a matter of how far the hand moved, is for the next cycle: the hand feels the spring as it is.
    fn coupled(&mut self, now: Pose, coupling: &Coupling) -> (Felt, Push, f64) {
        let (mut tool, before) = match &self.place {
            Some(place) => (place.tool, place.stretch),
            None => (now, Vector6::zeros()),
        };
        let damper = coupling.springs() * (coupling.damping / self.period);
        let mut felt = self.last.take().unwrap_or_else(|| self.feel(&tool));
        let mut asked = 0;
        loop {
            let stretch = self.frame.between(&tool, &now);
            let (stiffness, energy) = spring(coupling, &self.limits, &stretch);
            let pull =
                stiffness.component_mul(&stretch) + damper.component_mul(&(stretch - before));
            let left = pull + felt.force;
            let solved = match asked < ASKED && !self.balanced(&left) {
                true => (felt.matrix + Matrix6::from_diagonal(&(stiffness + damper))).cholesky(),
                false => None,
            };
            let Some(solved) = solved else {
                self.place = Some(Place { device: now, tool, stretch });
                let held = felt.energy + energy;
                self.last = Some(felt);
                return (felt, as_push(&-pull), held);
            };
            let step = solved.solve(&left);
            asked += 1;
            match self.frame.moved(&tool, &step) {
                Ok(moved) => tool = moved,
                // A step out of all bounds is not taken, nor tried again.
                Err(_) => asked = ASKED,
            }
            felt = self.feel(&tool);
        }
    }

    fn balanced(&self, left: &Vector6<f64>) -> bool {
        let [force, torque] = halves(left).map(|part| part.norm());
        force <= BALANCED * self.limits.force && torque <= BALANCED * self.limits.torque
    }
}

//! A tool at a part: the hand that holds it, the session, and a probe that lists the contacts.

use crate::error::EngineError;
use nalgebra::Point3;
use self_cell::self_cell;
use std::rc::Rc;
use touchoff::tool::{Interpreted, Symmetry};
use touchoff::{Contact, Law, Motion, Part, Pose, Probe, Tool};
use touchoff_haptics::{
    Device, DeviceError, DeviceLimits, DeviceWrench, Session, SessionSettings, SessionState,
};

/// A part and a tool that are shared with the engine.
#[derive(Debug)]
pub(crate) struct Touched {
    pub(crate) part: Rc<Part>,
    pub(crate) tool: Rc<Interpreted>,
}

/// What borrows the part and the tool.
#[derive(Debug)]
pub(crate) struct Queries<'a> {
    session: Session<'a, Interpreted>,
    probe: Probe<'a, Interpreted>,
}

self_cell!(
    /// A session with the part and the tool that it borrows.
    pub(crate) struct Touch {
        owner: Touched,
        #[covariant]
        dependent: Queries,
    }

    impl {Debug}
);

/// The depth of contact by surface of the tool.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceContact {
    pub(crate) points: usize,
    pub(crate) depth: f64,
    pub(crate) niceness: f64,
}

/// Values per contact in the list for the page.
const CONTACT_VALUES: usize = 10;

impl Touch {
    /// Begins a session.
    ///
    /// # Errors
    /// Fails if a setting is out of its range.
    pub(crate) fn begin(
        touched: Touched,
        settings: &SessionSettings,
        hand: &Hand,
    ) -> Result<Touch, EngineError> {
        Touch::try_new(touched, |touched| {
            let probe = Probe::new(&touched.part, &*touched.tool).with_law(Law::default());
            let session = Session::new(probe.clone(), settings, hand.limits())?;
            Ok(Queries { session, probe })
        })
    }

    /// Executes one cycle.
    pub(crate) fn cycle(&mut self, hand: &mut Hand) -> Option<SessionState> {
        self.with_dependent_mut(|_, queries| queries.session.cycle(hand))
    }

    /// Lists the contacts at a pose: at most `most` of them, evenly chosen, each as its point, depth, niceness, surface,
    /// part normal and triangle; and the contact by surface, of all.
    pub(crate) fn contacts(&mut self, pose: &Pose, most: usize) -> (Vec<f32>, Vec<SurfaceContact>) {
        self.with_dependent_mut(|touched, queries| {
            let none = SurfaceContact { points: 0, depth: 0.0, niceness: f64::INFINITY };
            let mut surfaces = vec![none; touched.tool.info().surfaces.len()];
            let contacts = queries.probe.contacts(pose);
            for contact in contacts {
                let surface = &mut surfaces[contact.surface.0];
                surface.points += 1;
                surface.depth = surface.depth.max(contact.depth);
                surface.niceness = surface.niceness.min(contact.niceness);
            }
            // Evenly chosen, as the first ones would all lie in one part of the contact.
            let stride = contacts.len().div_ceil(most.max(1)).max(1);
            let listed = contacts.iter().step_by(stride).flat_map(values).collect();
            (listed, surfaces)
        })
    }

    /// Queries the probe.
    pub(crate) fn probe<R>(&mut self, query: impl FnOnce(&mut Probe<'_, Interpreted>) -> R) -> R {
        self.with_dependent_mut(|_, queries| query(&mut queries.probe))
    }
}

fn values(contact: &Contact) -> [f32; CONTACT_VALUES] {
    let [point, normal] =
        [contact.point.coords, contact.normal].map(|vector| vector.map(|c| c as f32));
    [
        point.x,
        point.y,
        point.z,
        contact.depth as f32,
        contact.niceness as f32,
        contact.surface.0 as f32,
        normal.x,
        normal.y,
        normal.z,
        contact.triangle.0 as f32,
    ]
}

/// Greatest distance in mm and angle in rad per cycle: half of the speed that a session takes for plausible at 1 kHz.
const MAX_STEP: [f64; 2] = [5.0, 0.05];

/// A device that moves from its pose to a target in a number of cycles, and stays there.
#[derive(Debug)]
pub(crate) struct Hand {
    pose: Pose,
    target: Pose,
    motion: Option<Motion>,
    /// The cycles since the target was set, and those that the motion takes.
    cycle: f64,
    cycles: f64,
    limits: DeviceLimits,
}

impl Hand {
    pub(crate) fn new(pose: Pose, limits: DeviceLimits) -> Hand {
        Hand { pose, target: pose, motion: None, cycle: 0.0, cycles: 0.0, limits }
    }

    /// Sets the target, to be reached in `cycles` cycles, or in more if that were too fast for a hand. `unit` is the
    /// length of the part's unit in mm.
    pub(crate) fn move_to(&mut self, target: Pose, cycles: f64, symmetry: Symmetry, unit: f64) {
        let motion = match symmetry {
            Symmetry::Revolved => Motion::new(&self.pose, &target),
            Symmetry::Solid { .. } => Motion::with_spin(&self.pose, &target),
        };
        // An ambiguous rotation is a jump, which the session accepts once the hand stays.
        self.motion = motion.ok();
        let distance = (target.tip() - self.pose.tip()).norm() * unit;
        let turn = self.pose.rotation().transpose() * target.rotation();
        // The trace is 1 + 2 cos; rounding may lead beyond the cosines.
        let angle = ((turn.trace() - 1.0) / 2.0).clamp(-1.0, 1.0).acos();
        let [longest, widest] = MAX_STEP;
        self.cycles = cycles.max(distance / longest).max(angle / widest);
        self.cycle = 0.0;
        self.target = target;
    }
}

impl Device for Hand {
    fn pose(&mut self) -> Result<Pose, DeviceError> {
        self.cycle += 1.0;
        self.pose = match &self.motion {
            Some(motion) if self.cycle < self.cycles => motion.pose(self.cycle / self.cycles),
            _ => self.target,
        };
        Ok(self.pose)
    }

    fn apply(&mut self, _: &DeviceWrench) -> Result<(), DeviceError> {
        Ok(())
    }

    fn limits(&self) -> DeviceLimits {
        self.limits
    }
}

/// Returns the pose of seven values: the tip, and a quaternion x, y, z, w.
///
/// # Errors
/// Fails for another number of values, and if they are no pose.
pub(crate) fn pose_of(values: &[f64]) -> Result<Pose, EngineError> {
    let values: [f64; 7] = values.try_into().map_err(|_| EngineError::PoseLength(values.len()))?;
    let [x, y, z, rotation @ ..] = values;
    Ok(Pose::from_quaternion(Point3::new(x, y, z), rotation)?)
}

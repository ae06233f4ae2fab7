//! The devices of the command: a simulated hand, a program that is played back, and a SpaceMouse.

use super::HapticRun;
use crate::failure::Failure;
use crate::program;
use nalgebra::{Point3, Vector3};
use std::path::Path;
use touchoff::tool::Symmetry;
use touchoff::{Pose, Unit};
use touchoff_haptics::{Device, DeviceAxes, DeviceLimits, PlaybackDevice, SimulatedHand, Tremor};

/// Height above the part at which a hand begins, and depth to which it presses, in mm.
const START_HEIGHT: f64 = 2.0;
const PRESS_DEPTH: f64 = 3.0;

impl HapticRun<'_> {
    /// Creates a hand that presses down on the part again and again.
    pub(super) fn hand(&self) -> Result<impl Device + Send + use<>, Failure> {
        let unit = self.arguments.part.unit;
        let motion = pressing(self.start(), unit);
        let tremor = Tremor { size: 0.02, frequency: 10.0, seed: self.arguments.part.seed };
        Ok(SimulatedHand::new(self.limits(), self.arguments.rate, motion)?
            .with_centre(Point3::origin(), unit)?
            .with_tremor(&tremor)?)
    }

    /// Creates a device that plays the program.
    pub(super) fn playback(&self) -> Result<PlaybackDevice, Failure> {
        let file = self.arguments.program.as_deref();
        let file = file.ok_or(Failure::Usage("`--device playback` plays `--program FILE`"))?;
        let program = program::read(file, self.tool.info(), self.arguments.part.unit)?;
        let poses: Vec<Pose> = program.locations.iter().map(|location| location.pose).collect();
        Ok(PlaybackDevice::new(poses, self.cycles, self.limits())?)
    }

    /// Opens the SpaceMouse, which moves the tool from above the part.
    #[cfg(unix)]
    pub(super) fn spacenav(&self) -> Result<touchoff_haptics::spacenav::Spacenav, Failure> {
        use touchoff_haptics::spacenav::{SOCKET, Spacenav, SpeedGains};
        let gains = SpeedGains { linear: 100.0, angular: 1.0 };
        let (unit, rate) = (self.arguments.part.unit, self.arguments.rate);
        Spacenav::open(Path::new(SOCKET), self.start(), unit, rate, gains)
            .map_err(|source| Failure::Spacenav { socket: SOCKET, source })
    }

    /// Returns the limits of a simulated device.
    fn limits(&self) -> DeviceLimits {
        DeviceLimits {
            axes: match self.tool.info().symmetry {
                Symmetry::Revolved => DeviceAxes::Five,
                Symmetry::Solid { .. } => DeviceAxes::Six,
            },
            force: self.arguments.max_force,
            stiffness: self.arguments.device_stiffness,
            ..DeviceLimits::default()
        }
    }

    /// Returns the pose of the tool upright above the highest point of the part.
    fn start(&self) -> Pose {
        let tree = self.part.tree();
        let points = (0..tree.len()).map(|index| tree.point(index));
        let highest = points.max_by(|a, b| a.z.total_cmp(&b.z)).unwrap_or_default();
        let height = START_HEIGHT * Unit::Millimetre.factor_to(self.arguments.part.unit);
        let tip = highest + Vector3::z() * height;
        match self.tool.info().symmetry {
            Symmetry::Revolved => Pose::from_axis(tip, Vector3::z()),
            Symmetry::Solid { .. } => Pose::from_quaternion(tip, [0.0, 0.0, 0.0, 1.0]),
        }
        .expect("a point of a part is finite, and upright is a direction")
    }
}

/// Returns the motion of a hand that presses down and lets go every five seconds. Meanwhile it goes round once a
/// second, on circles with a radius of up to a millimetre.
fn pressing(start: Pose, unit: Unit) -> impl FnMut(f64) -> Pose {
    let mm = Unit::Millimetre.factor_to(unit);
    move |time| {
        let turn = std::f64::consts::TAU * time;
        let down = 0.5 - 0.5 * (turn / 5.0).cos();
        let displacement =
            Vector3::new(turn.cos() - 1.0, turn.sin(), -START_HEIGHT - PRESS_DEPTH) * (down * mm);
        start.translated(displacement).unwrap_or(start)
    }
}

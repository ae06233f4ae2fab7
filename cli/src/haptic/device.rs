//! The devices of the command: a simulated hand, a program that is played back, and a SpaceMouse.

use super::HapticRun;
use crate::failure::Failure;
use crate::program;
use nalgebra::{Point3, Vector3};
use std::path::Path;
use touchoff::tool::Symmetry;
use touchoff::{Pose, Unit};
use touchoff_haptics::{Device, HandImpedance, PlaybackDevice, SimulatedHand, Tremor};

/// Height above the part at which a hand begins, in mm.
const START_HEIGHT: f64 = 2.0;
/// Fraction of the session in which a hand that follows a program comes down onto its first location.
const APPROACH: f64 = 0.2;
/// Fraction of the part's height that counts as its highest surface, for rounding.
const TOP_FRACTION: f64 = 1e-3;

impl HapticRun<'_> {
    /// Creates a hand that presses down on the part again and again, or that presses while it follows the program.
    pub(super) fn hand(&self) -> Result<impl Device + Send + use<>, Failure> {
        let unit = self.arguments.part.unit;
        let depth = self.press_depth() * Unit::Millimetre.factor_to(unit);
        let mut motion: Box<dyn FnMut(f64) -> Pose + Send> = match &self.arguments.program {
            None => Box::new(pressing(self.start(), unit, self.arguments.circle, depth)),
            Some(_) => {
                // The hand comes down onto the first location before it follows the others.
                let approach = APPROACH * self.cycles as f64 / self.arguments.rate;
                let mut path = self.path(((1.0 - APPROACH) * self.cycles as f64) as u64)?;
                let mut location = path.pose().unwrap_or_default();
                let height = START_HEIGHT * Unit::Millimetre.factor_to(unit);
                Box::new(move |time| {
                    if time > approach {
                        // The last location is held at the end.
                        location = path.pose().unwrap_or(location);
                    }
                    let down = (time / approach).min(1.0);
                    let along = height - (height + depth) * down;
                    location.translated(location.axis() * along).unwrap_or(location)
                })
            }
        };
        let motion = move |time| motion(time);
        let tremor = Tremor { size: 0.02, frequency: 10.0, seed: self.arguments.part.seed };
        Ok(SimulatedHand::new(self.limits, self.arguments.rate, motion)?
            .with_centre(Point3::origin(), unit)?
            .with_tremor(&tremor)?)
    }

    /// Returns the depth below a surface, in mm, at which the hand wants the tool so that it presses with its force: that stretches the
    /// grip, and the coupling if there is one.
    fn press_depth(&self) -> f64 {
        let grip = HandImpedance::default().stiffness;
        let coupling = if self.arguments.direct { 0.0 } else { 1.0 / self.limits.stiffness };
        self.arguments.press * (1.0 / grip + coupling)
    }

    /// Creates a device that plays the program.
    pub(super) fn playback(&self) -> Result<PlaybackDevice, Failure> {
        self.path(self.cycles)
    }

    /// Returns the path of the program, which takes some cycles.
    fn path(&self, cycles: u64) -> Result<PlaybackDevice, Failure> {
        let file = self.arguments.program.as_deref();
        let file = file.ok_or(Failure::Usage("`--device playback` plays `--program FILE`"))?;
        let program = program::read(file, self.tool.info(), self.arguments.part.unit)?;
        let poses: Vec<Pose> = program.locations.iter().map(|location| location.pose).collect();
        Ok(PlaybackDevice::new(poses, cycles, self.limits)?)
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

    /// Returns the place that the hand presses: the given one, or the point in the middle of the part's highest surface.
    fn place(&self) -> Point3<f64> {
        if let Some(at) = self.arguments.at {
            return at;
        }
        let tree = self.part.tree();
        let points =
            || (0..tree.slots()).filter(|slot| tree.has_point(*slot)).map(|k| tree.point(k));
        let heights = points().map(|point| point.z);
        let [low, high] = heights
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| [low.min(z), high.max(z)]);
        let top = || points().filter(|point| point.z >= high - TOP_FRACTION * (high - low));
        let count = top().count().max(1) as f64;
        let middle = top().fold(Vector3::zeros(), |sum, point| sum + point.coords) / count;
        let from_middle = |point: &Point3<f64>| (point.coords - middle).norm_squared();
        let nearest = top().min_by(|a, b| from_middle(a).total_cmp(&from_middle(b)));
        nearest.unwrap_or_default()
    }

    /// Returns the pose of the tool upright above the place that the hand presses.
    fn start(&self) -> Pose {
        let height = START_HEIGHT * Unit::Millimetre.factor_to(self.arguments.part.unit);
        let tip = self.place() + Vector3::z() * height;
        match self.tool.info().symmetry {
            Symmetry::Revolved => Pose::from_axis(tip, Vector3::z()),
            Symmetry::Solid { .. } => Pose::from_quaternion(tip, [0.0, 0.0, 0.0, 1.0]),
        }
        .expect("a point of a part is finite, and upright is a direction")
    }
}

/// Returns the motion of a hand that presses down to a depth below the surface and lets go every five seconds. Meanwhile it goes round
/// once a second, on circles with a radius of up to `circle` mm.
fn pressing(start: Pose, unit: Unit, circle: f64, depth: f64) -> impl FnMut(f64) -> Pose {
    let mm = Unit::Millimetre.factor_to(unit);
    move |time| {
        let turn = std::f64::consts::TAU * time;
        let down = 0.5 - 0.5 * (turn / 5.0).cos();
        let aside = Vector3::new(turn.cos() - 1.0, turn.sin(), 0.0) * (circle * mm);
        let displacement = aside - Vector3::z() * (START_HEIGHT * mm + depth);
        start.translated(displacement * down).unwrap_or(start)
    }
}

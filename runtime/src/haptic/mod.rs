//! The haptic loop (Ho 1999, chapters 5 and 7): a hand moves a device, the tool feels the part, the device
//! pushes the hand.
//!
//! ```text
//! device ──pose──▶ guard ──▶ coupling ⇄ probe ──▶ push ──▶ saturation, passivity ──push──▶ device
//!                               │ State, every cycle
//!                               ├──▶ the latest of them: display
//!                               └──▶ all of them, as far as there is room: record
//! ```
//!
//! A [`Session`] is what happens in one cycle, without a clock; [`run`] lets it happen so many times a second.
//!
//! ```
//! use nalgebra::{Point3, Vector3};
//! use touchoff::haptic::{Device, Hand, Limits, Session, Settings};
//! use touchoff::{Law, Part, Pose, Probe, Unit, mesh::shapes};
//! # touchoff::tool! { tool Ball { units mm; profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; } } }
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//!
//! let block = shapes::cuboid(Point3::new(-20., -20., -10.), Point3::new(20., 20., 0.), Unit::Millimetre)?;
//! let part = Part::from_mesh(&block, 20_000, 1)?;
//! let probe = Probe::new(&part, &Ball).law(Law::Gradient);
//! let over = Pose::from_axis(Point3::new(0.0, 0.0, 0.5), Vector3::z())?;
//! let into = Pose::from_axis(Point3::new(0.0, 0.0, -1.0), Vector3::z())?;
//!
//! let mut hand = Hand::new(Limits::default(), 1000.0, |time| if time < 0.5 { over } else { into })?;
//! let mut session = Session::new(probe, &Settings::new(1000.0), hand.limits())?;
//! let mut state = None;
//! for _ in 0..2000 {
//!     state = session.cycle(&mut hand);
//! }
//! let state = state.expect("the hand was somewhere");
//! assert!(state.push.force.z > 0.1 && state.device.tip().z < state.tool.tip().z);
//! # Ok(()) }
//! ```

mod coupling;
mod device;
mod frame;
mod guard;
mod hand;
mod passivity;
mod realtime;
mod run;
mod session;
mod setting;
#[cfg(all(unix, feature = "spacenav"))]
pub mod spacenav;

pub use coupling::Coupling;
pub use device::{Axes, Device, DeviceError, Limits, Push, Recorded, Scripted};
pub use guard::{Fastest, Faults};
pub use hand::{Grip, Hand, Tremor};
pub use passivity::Energy;
pub use realtime::{Realtime, Refused, check_core};
pub use run::{Clock, Latest, Monotonic, Report, Samples, Times, Unhurried, Watch, run, watched};
pub use session::{Rendering, Session, Settings, State};
pub use setting::SettingError;

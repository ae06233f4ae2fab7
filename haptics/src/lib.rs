//! The haptic loop (Ho 1999, chapters 5 and 7): a hand moves a device, the tool touches the part, and
//! the device applies the contact force to the hand.
//!
//! ```text
//! device ──pose──▶ guard ──▶ coupling ⇄ probe ──▶ push ──▶ saturation, passivity ──push──▶ device
//!                               │ State, every cycle
//!                               ├──▶ the latest of them: display
//!                               └──▶ all of them, as far as there is room: record
//! ```
//!
//! A [`Session`] computes one cycle and needs no clock; with the feature `realtime`, `Session::run` executes it at a fixed
//! rate.
//!
//! ```
//! use nalgebra::{Point3, Vector3};
//! use touchoff_haptics::{Device, SimulatedHand, DeviceLimits, Session, SessionSettings};
//! use touchoff::{Law, Part, Pose, Probe, Sampling, Unit, mesh::shapes};
//! # touchoff::tool! { tool Ball { units mm; profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; } } }
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//!
//! let block = shapes::cuboid(Point3::new(-20., -20., -10.), Point3::new(20., 20., 0.), Unit::Millimetre)?;
//! let part = Part::from_mesh(&block, Sampling::new(20_000))?;
//! let probe = Probe::new(&part, &Ball).with_law(Law::Gradient);
//! let over = Pose::from_axis(Point3::new(0.0, 0.0, 0.5), Vector3::z())?;
//! let into = Pose::from_axis(Point3::new(0.0, 0.0, -1.0), Vector3::z())?;
//!
//! let mut hand = SimulatedHand::new(DeviceLimits::default(), 1000.0, |time| if time < 0.5 { over } else { into })?;
//! let mut session = Session::new(probe, &SessionSettings::new(1000.0), hand.limits())?;
//! let mut state = None;
//! for _ in 0..2000 {
//!     state = session.cycle(&mut hand);
//! }
//! let state = state.expect("the hand was somewhere");
//! assert!(state.wrench_on_hand.force.z > 0.1 && state.device.tip().z < state.tool.tip().z);
//! # Ok(()) }
//! ```

#![deny(missing_docs, missing_debug_implementations, unnameable_types)]

#[cfg(doctest)]
#[doc = include_str!("../../docs/haptics.md")]
struct HapticsPage;

mod device;
mod frame;
mod hand;
mod input_filter;
mod rendering;
#[cfg(feature = "realtime")]
mod run;
mod session;
mod setting;
#[cfg(all(unix, feature = "realtime"))]
pub mod spacenav;
mod stiffness;

pub use device::{
    Device, DeviceAxes, DeviceError, DeviceLimits, DeviceWrench, PlaybackDevice, ScriptedDevice,
};
pub use hand::{HandImpedance, SimulatedHand, Tremor};
pub use input_filter::{DeviceFaults, SpeedLimit};
pub use rendering::{Coupling, EnergyBalance, Rendering};
#[cfg(feature = "realtime")]
pub use run::{
    Clock, LatencyHistogram, LatestState, LoopReport, MonotonicClock, Realtime, RealtimeError,
    SimulatedClock, StatePublisher, StateStream, check_core, state_channel,
};
pub use session::{Session, SessionSettings, SessionState};
pub use setting::SettingError;
pub use stiffness::{ContactStiffness, StiffnessSource, ThinPlace};

//! `touchoff haptic`: the haptic loop with a device, a part and a tool for some seconds.

mod device;
mod recordings;
mod report;

use crate::arguments::{DeviceKind, Haptic};
use crate::failure::{Failure, INTERRUPTED};
use crate::loaded_tool::LoadedTool;
use crate::output::refuse_inputs;
use crate::part::{self, DenseSampling};
use recordings::{Recordings, Table, map_of};
use report::{print_json, print_text, show};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use touchoff::certify::TriangleBvh;
use touchoff::tool::Symmetry;
use touchoff::{Part, Probe, Tool};
use touchoff_haptics::{
    ContactStiffness, Coupling, Device, DeviceAxes, DeviceLimits, MonotonicClock, Realtime,
    Rendering, Session, SessionSettings, check_core, state_channel,
};
use touchoff_postures::Recorder;

/// Number of states by which recordings may lag behind the loop: 65 s at 1 kHz.
const STATE_BUFFER: usize = 1 << 16;
/// Status lines per second.
const STATUS_RATE: f64 = 4.0;

/// Runs the loop.
pub(crate) fn haptic(arguments: &Haptic, json: bool) -> Result<(), Failure> {
    check_arguments(arguments)?;
    let loaded_tool = LoadedTool::load(&arguments.tool, &arguments.params)?;
    let tool = loaded_tool.tool();
    let loaded = part::load(&arguments.part, Some(tool.info()), DenseSampling::Sample, json)?;
    let map = match (&arguments.postures, &loaded.mesh) {
        (None, _) => None,
        (Some(file), Some(mesh)) => {
            Some((map_of(file, mesh, &arguments.part.part, tool)?, TriangleBvh::new(mesh)))
        }
        (Some(_), None) => {
            return Err(part::no_triangles(&arguments.part.part, "--postures"));
        }
    };
    let part = loaded.part;
    let table = arguments.record.as_deref().map(|path| Table::create(path, arguments.rate));
    let recorder = map.as_ref().map(|(map, bvh)| Recorder::new(map, &part, bvh, tool));
    let recordings = Recordings::new(table.transpose()?, recorder.transpose()?);
    // At least one cycle is run, however short the duration.
    let cycles = (arguments.duration * arguments.rate).round().max(1.0) as u64;
    let limits = limits(arguments, tool);
    let contact = contact_stiffness(arguments, &part, tool, &limits);
    let run = HapticRun { arguments, json, cycles, part: &part, tool, limits, contact };
    match arguments.device {
        DeviceKind::Hand => run.drive(run.hand()?, recordings),
        DeviceKind::Playback => run.drive(run.playback()?, recordings),
        #[cfg(not(unix))]
        DeviceKind::Spacenav => Err(Failure::Usage(
            "`--device spacenav` needs a daemon that only Unix systems have: take another device",
        )),
        #[cfg(unix)]
        DeviceKind::Spacenav => run.drive(run.spacenav()?, recordings),
    }
}

/// Refuses options that do not go together, outputs that are inputs, and a core that the machine does not have.
fn check_arguments(arguments: &Haptic) -> Result<(), Failure> {
    if arguments.program.is_some() && arguments.device == DeviceKind::Spacenav {
        return Err(Failure::Usage(
            "`--program` is what `--device playback` plays and `--device hand` follows: take one of these devices, or no program",
        ));
    }
    if arguments.press > arguments.max_force {
        return Err(Failure::Usage(
            "`--press` is a force that the device renders, up to `--max-force`: lower the one, or raise the other",
        ));
    }
    let program = arguments.program.as_deref();
    let inputs = [&*arguments.part.part, Path::new(&arguments.tool)].into_iter().chain(program);
    let inputs = inputs.chain(arguments.params.library.as_deref());
    let outputs = arguments.postures.as_deref().into_iter().chain(arguments.record.as_deref());
    refuse_inputs(outputs, inputs)?;
    match arguments.core {
        Some(core) => Ok(check_core(core)?),
        None => Ok(()),
    }
}

/// A session of the loop: a tool at a part, for some cycles.
struct HapticRun<'a> {
    arguments: &'a Haptic,
    json: bool,
    cycles: u64,
    part: &'a Part,
    tool: &'a dyn Tool,
    limits: DeviceLimits,
    contact: ContactStiffness,
}

/// Returns the limits of a simulated device.
fn limits(arguments: &Haptic, tool: &dyn Tool) -> DeviceLimits {
    DeviceLimits {
        axes: match tool.info().symmetry {
            Symmetry::Revolved => DeviceAxes::Five,
            Symmetry::Solid { .. } => DeviceAxes::Six,
        },
        force: arguments.max_force,
        stiffness: arguments.device_stiffness,
        ..DeviceLimits::default()
    }
}

/// Takes the stiffness of the command line, or derives one, and says what may happen with it.
fn contact_stiffness(
    arguments: &Haptic,
    part: &Part,
    tool: &dyn Tool,
    limits: &DeviceLimits,
) -> ContactStiffness {
    let contact = match arguments.stiffness {
        Some(stiffness) => ContactStiffness::of(stiffness, part, tool, arguments.law, limits),
        None => ContactStiffness::derived(part, tool, arguments.law, limits),
    };
    for warning in contact.warnings() {
        message!("{warning}");
    }
    contact
}

impl<'a> HapticRun<'a> {
    /// Creates the session.
    fn session(&self, limits: DeviceLimits) -> Result<Session<'a>, Failure> {
        let rendering = match self.arguments.direct {
            true => Rendering::Direct { scaled: true, damping: 0.0 },
            false => Rendering::Coupled(Coupling::of(&limits)),
        };
        let settings = SessionSettings {
            stiffness: self.contact.stiffness,
            rendering: Some(rendering),
            ..SessionSettings::new(self.arguments.rate)
        };
        let probe = Probe::new(self.part, self.tool).with_law(self.arguments.law);
        Ok(Session::new(probe, &settings, limits)?)
    }

    /// Runs the loop in a thread of its own, and monitors it from this one.
    fn drive(
        &self,
        mut device: impl Device + Send,
        mut recordings: Recordings<'_>,
    ) -> Result<(), Failure> {
        let HapticRun { arguments, json, cycles, contact, .. } = *self;
        // Created before memory is locked, so that a lock which has no room for it is refused and reported.
        let mut session = self.session(device.limits())?;
        let (mut publisher, mut latest, mut states) = state_channel(STATE_BUFFER);
        let stop = stopped_by_signals();
        let report = std::thread::scope(|scope| {
            let looped = scope.spawn(|| {
                // Priority and core are the thread's own, so they are set in it.
                let realtime = Realtime {
                    priority: arguments.realtime.then_some(80),
                    core: arguments.core,
                    locked: arguments.realtime,
                };
                for error in realtime.apply() {
                    message!("{error}");
                }
                let clock = &mut MonotonicClock::new(Duration::from_micros(arguments.spin));
                session.run(&mut device, clock, cycles, &mut publisher, &stop)
            });
            let mut shown = 0;
            while !looped.is_finished() {
                std::thread::sleep(Duration::from_millis(20));
                recordings.take(&mut states);
                if !json
                    && let Some(state) = latest.read()
                    && state.cycle >= shown
                {
                    shown = state.cycle + (arguments.rate / STATUS_RATE) as u64;
                    show(state, arguments.rate);
                }
            }
            looped.join().expect("the loop panics at nothing")
        });
        // The states recorded after the last look.
        recordings.take(&mut states);
        let recorded = recordings.end();
        // The report is printed even if a recording failed.
        match json {
            true => print_json(&report, arguments, &contact),
            false => print_text(&report, arguments, &contact),
        }?;
        recorded?;
        if stop.load(Ordering::Relaxed) { Err(Failure::Interrupted) } else { Ok(()) }
    }
}

/// Returns a flag that Ctrl-C and the other termination signals set, so that a session ends in order and its
/// recordings are kept. A second signal ends the program at once.
fn stopped_by_signals() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let handled = ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED.into());
        }
    });
    if let Err(error) = handled {
        message!("Ctrl-C will end the session without its recordings: {error}");
    }
    stop
}

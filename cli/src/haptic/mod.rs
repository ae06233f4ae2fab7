//! `touchoff haptic`: the haptic loop with a device, a part and a tool for some seconds.

mod recordings;

use crate::arguments::{DeviceKind, Haptic};
use crate::failure::{Failure, INTERRUPTED};
use crate::loaded_tool::LoadedTool;
use crate::output::{Output, refuse_inputs};
use crate::part::{self, DenseSampling};
use crate::program;
use nalgebra::{Point3, Vector3};
use recordings::{Recordings, Table, map_of};
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use touchoff::certify::TriangleBvh;
use touchoff::tool::{Symmetry, ToolInfo};
use touchoff::{Part, Pose, Probe, Tool, Unit};
use touchoff_haptics::{
    Coupling, Device, DeviceAxes, DeviceLimits, LoopReport, MonotonicClock, PlaybackDevice,
    Realtime, Rendering, Session, SessionSettings, SessionState, SimulatedHand, Tremor, check_core,
    state_channel,
};
use touchoff_postures::Recorder;

/// Number of states by which recordings may lag behind the loop: 65 s at 1 kHz.
const STATE_BUFFER: usize = 1 << 16;
/// Status lines per second.
const STATUS_RATE: f64 = 4.0;

/// Runs the loop.
pub(crate) fn haptic(arguments: &Haptic, json: bool) -> Result<(), Failure> {
    if arguments.program.is_some() && arguments.device != DeviceKind::Playback {
        return Err(Failure::Usage(
            "`--program` is what `--device playback` plays: give both, or neither",
        ));
    }
    let program = arguments.program.as_deref();
    let inputs = [&*arguments.part.part, Path::new(&arguments.tool)].into_iter().chain(program);
    refuse_inputs(arguments.postures.as_deref(), inputs.clone())?;
    refuse_inputs(arguments.record.as_deref(), inputs.chain(arguments.postures.as_deref()))?;
    if let Some(core) = arguments.core {
        check_core(core)?;
    }
    let loaded_tool = LoadedTool::load(&arguments.tool, &arguments.params)?;
    let tool = loaded_tool.tool();
    let unit = arguments.part.unit;
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
    let axes = match tool.info().symmetry {
        Symmetry::Revolved => DeviceAxes::Five,
        Symmetry::Solid { .. } => DeviceAxes::Six,
    };
    let limits = DeviceLimits {
        axes,
        force: arguments.max_force,
        stiffness: arguments.device_stiffness,
        ..DeviceLimits::default()
    };
    let start = above(&part, tool.info(), unit);
    // At least one cycle is run, however short the duration.
    let cycles = (arguments.duration * arguments.rate).round().max(1.0) as u64;
    let run = HapticRun { arguments, json, cycles, part: &part, tool };
    match arguments.device {
        DeviceKind::Hand => {
            let motion = pressing(start, unit);
            let tremor = Tremor { size: 0.02, frequency: 10.0, seed: arguments.part.seed };
            let hand = SimulatedHand::new(limits, arguments.rate, motion)?
                .with_centre(Point3::origin(), unit)?
                .with_tremor(&tremor)?;
            run.drive(hand, recordings)
        }
        DeviceKind::Playback => {
            let file =
                program.ok_or(Failure::Usage("`--device playback` plays `--program FILE`"))?;
            let program = program::read(file, tool.info(), unit)?;
            let poses: Vec<Pose> = program.locations.iter().map(|location| location.pose).collect();
            let device = PlaybackDevice::new(poses, cycles, limits)?;
            run.drive(device, recordings)
        }
        #[cfg(not(unix))]
        DeviceKind::Spacenav => Err(Failure::Usage(
            "`--device spacenav` needs a daemon that only Unix systems have: take another device",
        )),
        #[cfg(unix)]
        DeviceKind::Spacenav => {
            use touchoff_haptics::spacenav::{SOCKET, Spacenav, SpeedGains};
            let gains = SpeedGains { linear: 100.0, angular: 1.0 };
            let mouse = Spacenav::open(Path::new(SOCKET), start, unit, arguments.rate, gains)
                .map_err(|source| Failure::Spacenav { socket: SOCKET, source })?;
            run.drive(mouse, recordings)
        }
    }
}

/// Height above the part at which a hand begins, and depth to which it presses, in mm.
const START_HEIGHT: f64 = 2.0;
const PRESS_DEPTH: f64 = 3.0;

/// Returns the pose of the tool upright above the highest point of the part.
fn above(part: &Part, info: &ToolInfo, unit: Unit) -> Pose {
    let tree = part.tree();
    let points = (0..tree.len()).map(|index| tree.point(index));
    let highest = points.max_by(|a, b| a.z.total_cmp(&b.z)).unwrap_or_default();
    let tip = highest + Vector3::z() * (START_HEIGHT * Unit::Millimetre.factor_to(unit));
    match info.symmetry {
        Symmetry::Revolved => Pose::from_axis(tip, Vector3::z()),
        Symmetry::Solid { .. } => Pose::from_quaternion(tip, [0.0, 0.0, 0.0, 1.0]),
    }
    .expect("a point of a part is finite, and upright is a direction")
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

/// A session of the loop: a tool at a part, for some cycles.
struct HapticRun<'a> {
    arguments: &'a Haptic,
    json: bool,
    cycles: u64,
    part: &'a Part,
    tool: &'a dyn Tool,
}

impl HapticRun<'_> {
    /// Runs the loop in a thread of its own, and monitors it from this one.
    fn drive(
        self,
        mut device: impl Device + Send,
        mut recordings: Recordings<'_>,
    ) -> Result<(), Failure> {
        let HapticRun { arguments, json, cycles, part, tool } = self;
        let limits = device.limits();
        let rendering = match arguments.direct {
            true => Rendering::Direct { scaled: true, damping: 0.0 },
            false => Rendering::Coupled(Coupling::of(&limits)),
        };
        let settings = SessionSettings {
            stiffness: arguments.stiffness,
            rendering: Some(rendering),
            ..SessionSettings::new(arguments.rate)
        };
        let probe = Probe::new(part, tool).with_law(arguments.law);
        // Created before memory is locked, so that a lock which has no room for it is refused and reported.
        let mut session = Session::new(probe, &settings, limits)?;
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
        if json { print_json(&report, arguments) } else { print_text(&report, arguments) }?;
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

/// Prints the current state on one line.
fn show(state: &SessionState, rate: f64) {
    let [x, y, z] = [0, 1, 2].map(|k| state.tool.tip()[k]);
    message!(
        "{:>8.2} s  tip {x:>9.3} {y:>9.3} {z:>9.3}  depth {:>7.4}  force {:>7.3} N  torque {:>8.2} N·mm",
        state.cycle as f64 / rate,
        state.wrench.depth(),
        state.wrench_on_hand.force.norm(),
        state.wrench_on_hand.torque.norm(),
    );
}

/// The report of a run, for programs.
#[derive(Serialize)]
struct RunSummary<'a> {
    device: &'a str,
    rate_hz: f64,
    cycles: u64,
    missed_deadlines: u64,
    skipped_cycles: u64,
    stalls: u64,
    cycle_time_ns: Quantiles,
    start_delay_ns: Quantiles,
    /// In N and in N·mm.
    peak_force: f64,
    peak_torque: f64,
    /// In N·mm.
    energy_in: f64,
    energy_stored: f64,
    energy_generated: f64,
    energy_dissipated: f64,
    faults: FaultCounts,
    dropped_states: u64,
    law: String,
}

/// Numbers of cycles with a fault of the device.
#[derive(Serialize)]
struct FaultCounts {
    no_pose: u64,
    jumps: u64,
    not_responding: u64,
    failed_writes: u64,
}

#[derive(Serialize)]
struct Quantiles {
    p50: u64,
    p99: u64,
    p999: u64,
    max: u64,
}

impl Quantiles {
    fn of(times: &touchoff_haptics::LatencyHistogram) -> Quantiles {
        let [p50, p99, p999] = [0.5, 0.99, 0.999].map(|share| times.value_at_quantile(share));
        Quantiles { p50, p99, p999, max: times.max() }
    }

    fn format(&self) -> String {
        let [p50, p99, p999, max] =
            [self.p50, self.p99, self.p999, self.max].map(|ns| ns as f64 / 1e3);
        format!("median {p50:.1}, p99 {p99:.1}, p99.9 {p999:.1}, max {max:.1}")
    }
}

fn print_json(report: &LoopReport, arguments: &Haptic) -> Result<(), Failure> {
    let energy = report.last.map(|state| state.energy).unwrap_or_default();
    let faults = report.faults;
    let summary = RunSummary {
        device: arguments.device.name(),
        rate_hz: arguments.rate,
        cycles: report.cycles,
        missed_deadlines: report.missed,
        skipped_cycles: report.skipped,
        stalls: report.stalls,
        cycle_time_ns: Quantiles::of(&report.durations),
        start_delay_ns: Quantiles::of(&report.start_delays),
        peak_force: report.peak_wrench[0],
        peak_torque: report.peak_wrench[1],
        energy_in: energy.input,
        energy_stored: energy.stored,
        energy_generated: energy.generated,
        energy_dissipated: energy.dissipated,
        faults: FaultCounts {
            no_pose: faults.no_pose,
            jumps: faults.jumps,
            not_responding: faults.not_responding,
            failed_writes: faults.failed_writes,
        },
        dropped_states: report.dropped_states,
        law: arguments.law.to_string(),
    };
    let mut out = Output::lines();
    out.json(&summary)?;
    Ok(out.flush()?)
}

fn print_text(report: &LoopReport, arguments: &Haptic) -> Result<(), Failure> {
    let mut out = Output::lines();
    let energy = report.last.map(|state| state.energy).unwrap_or_default();
    let faults = report.faults;
    let LoopReport { cycles, missed, skipped, stalls, .. } = report;
    let of = arguments.rate;
    writeln!(
        out,
        "{cycles} cycles at {of} Hz, {missed} missed their deadline, {skipped} skipped; law {}",
        arguments.law
    )?;
    writeln!(out, "  cycle time, µs:   {}", Quantiles::of(&report.durations).format())?;
    writeln!(out, "  start delay, µs:  {}", Quantiles::of(&report.start_delays).format())?;
    let [force, torque] = report.peak_wrench;
    writeln!(out, "  peak:             {force:.3} N, {torque:.2} N·mm")?;
    writeln!(
        out,
        "  energy, N·mm:     {:.4} in, {:.4} stored at the end; at most {:.2e} generated, {:.2e} dissipated",
        energy.input, energy.stored, energy.generated, energy.dissipated,
    )?;
    let wrong = [
        (faults.no_pose, "cycles without a pose"),
        (faults.jumps, "jumps of the device"),
        (faults.not_responding, "cycles without a response"),
        (faults.failed_writes, "failed writes of the wrench"),
        (*stalls, "stalls of clock or thread"),
        (report.dropped_states, "states not recorded"),
    ];
    for (count, what) in wrong.into_iter().filter(|(count, _)| *count > 0) {
        writeln!(out, "  {count} {what}")?;
    }
    Ok(out.flush()?)
}

//! `touchoff haptic`: the haptic loop with a device, a part and a tool for some seconds.

mod kept;

use crate::arguments::{Haptic, Wielded};
use crate::failure::{Failure, INTERRUPTED};
use crate::files::Found;
use crate::output::{Output, refuse_inputs};
use crate::part::{self, Fine};
use crate::program;
use kept::{Kept, Table, map_of};
use nalgebra::{Point3, Vector3};
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use touchoff::certify::TriangleBvh;
use touchoff::haptic::{
    Coupling, Device, DeviceAxes, DeviceLimits, LoopReport, MonotonicClock, PlaybackDevice,
    Realtime, Rendering, Session, SessionSettings, SessionState, SimulatedHand, StatePublisher,
    Tremor, check_core, run, state_channel,
};
use touchoff::postures::Recorder;
use touchoff::tool::{Symmetry, ToolInfo};
use touchoff::{Part, Pose, Probe, Tool, Unit};

/// Number of states by which recordings may lag behind the loop: 65 s at 1 kHz.
const ROOM: usize = 1 << 16;
/// Status lines per second.
const SHOWN: f64 = 4.0;

/// Runs the loop.
pub(crate) fn haptic(wanted: &Haptic, json: bool) -> Result<(), Failure> {
    let wielded = wanted.wielded().map_err(Failure::Device)?;
    let program = if let Wielded::Path(path) = &wielded { Some(&**path) } else { None };
    let inputs = [&*wanted.part.part, Path::new(&wanted.tool)].into_iter().chain(program);
    refuse_inputs(wanted.postures.as_deref(), inputs.clone())?;
    refuse_inputs(wanted.record.as_deref(), inputs.chain(wanted.postures.as_deref()))?;
    if let Some(core) = wanted.core {
        check_core(core)?;
    }
    let found = Found::find(&wanted.tool, &wanted.given)?;
    let tool = found.tool();
    let unit = wanted.part.unit;
    let loaded = part::load(&wanted.part, Some(tool.info()), Fine::Points)?;
    let map = match (&wanted.postures, &loaded.mesh) {
        (None, _) => None,
        (Some(file), Some(mesh)) => {
            Some((map_of(file, (mesh, &wanted.part.part), tool)?, TriangleBvh::new(mesh)))
        }
        (Some(_), None) => {
            let file = wanted.part.part.display().to_string();
            return Err(Failure::NoTriangles { file, what: "--postures" });
        }
    };
    let part = loaded.part;
    let table = wanted.record.as_deref().map(|path| Table::create(path, wanted.rate));
    let recorder = map.as_ref().map(|(map, bvh)| Recorder::new(map, (&part, bvh), tool));
    let record = Kept::new(table.transpose()?, recorder.transpose()?);
    let axes = match tool.info().symmetry {
        Symmetry::Revolved => DeviceAxes::Five,
        Symmetry::Solid { .. } => DeviceAxes::Six,
    };
    let limits = DeviceLimits {
        axes,
        force: wanted.most_force,
        stiffness: wanted.device_stiffness,
        ..DeviceLimits::default()
    };
    let start = above(&part, tool.info(), unit);
    // At least one cycle is run, however short the duration.
    let cycles = (wanted.seconds * wanted.rate).round().max(1.0) as u64;
    match wielded {
        Wielded::Hand => {
            let wish = pressing(start, unit);
            let tremor = Tremor { size: 0.02, frequency: 10.0, seed: wanted.part.seed };
            let hand = SimulatedHand::new(limits, wanted.rate, wish)?
                .with_centre(Point3::origin(), unit)?
                .with_tremor(&tremor)?;
            wield(hand, (wanted, json, cycles), (&part, tool), record)
        }
        Wielded::Path(path) => {
            let program = program::read(&path, tool.info(), unit)?;
            let poses: Vec<Pose> = program.locations.iter().map(|stop| stop.pose).collect();
            let played = PlaybackDevice::new(poses, cycles, limits).map_err(Failure::Motion)?;
            wield(played, (wanted, json, cycles), (&part, tool), record)
        }
        #[cfg(not(unix))]
        Wielded::Spacenav => {
            Err(Failure::Device("`spacenav` is a daemon of Unix systems".to_owned()))
        }
        #[cfg(unix)]
        Wielded::Spacenav => {
            use touchoff::haptic::spacenav::{SOCKET, Spacenav, SpeedGains};
            let flight = SpeedGains { linear: 100.0, angular: 1.0 };
            let mouse = Spacenav::open(Path::new(SOCKET), (start, unit), (wanted.rate, flight))
                .map_err(|source| Failure::Spacenav { socket: SOCKET, source })?;
            wield(mouse, (wanted, json, cycles), (&part, tool), record)
        }
    }
}

/// Height above the part at which a hand begins, and depth to which it presses, in mm.
const OVER: f64 = 2.0;
const DEEP: f64 = 3.0;

/// Returns the pose of the tool upright above the highest point of the part.
fn above(part: &Part, info: &ToolInfo, unit: Unit) -> Pose {
    let tree = part.tree();
    let points = (0..tree.len()).map(|place| tree.point(place));
    let highest = points.max_by(|a, b| a.z.total_cmp(&b.z)).unwrap_or_default();
    let tip = highest + Vector3::z() * (OVER * Unit::Millimetre.factor_to(unit));
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
        let way = Vector3::new(turn.cos() - 1.0, turn.sin(), -OVER - DEEP) * (down * mm);
        start.translated(way).unwrap_or(start)
    }
}

/// Runs the loop in a thread of its own, and monitors it from this one.
fn wield(
    mut device: impl Device + Send,
    (wanted, json, cycles): (&Haptic, bool, u64),
    (part, tool): (&Part, &dyn Tool),
    mut record: Kept<'_>,
) -> Result<(), Failure> {
    let limits = device.limits();
    let rendering = match wanted.direct {
        true => Rendering::Direct { scaled: true, damping: 0.0 },
        false => Rendering::Coupled(Coupling::of(&limits)),
    };
    let settings = SessionSettings {
        stiffness: wanted.stiffness,
        rendering: Some(rendering),
        ..SessionSettings::new(wanted.rate)
    };
    let probe = Probe::new(part, tool).with_law(wanted.law);
    // Created before memory is locked, so that a lock which has no room for it is refused and reported.
    let mut session = Session::new(probe, &settings, limits)?;
    let (mut watch, mut latest, mut samples) = state_channel(ROOM);
    let stop = stopped_by_signals();
    let mut looped = |watch: &mut StatePublisher| {
        let realtime = Realtime {
            priority: wanted.realtime.then_some(80),
            core: wanted.core,
            locked: wanted.realtime,
        };
        for refused in realtime.apply() {
            say!("{refused}");
        }
        let clock = &mut MonotonicClock::new(Duration::from_micros(wanted.awake));
        run((&mut session, &mut device), (clock, cycles), watch, &stop)
    };
    let report = std::thread::scope(|scope| {
        let looped = scope.spawn(|| looped(&mut watch));
        let mut shown = 0;
        while !looped.is_finished() {
            std::thread::sleep(Duration::from_millis(20));
            record.take(&mut samples);
            if !json
                && let Some(state) = latest.read()
                && state.cycle >= shown
            {
                shown = state.cycle + (wanted.rate / SHOWN) as u64;
                show(state, wanted.rate);
            }
        }
        looped.join().expect("the loop panics at nothing")
    });
    record.take(&mut samples);
    let kept = record.end();
    if json { said(&report, wanted) } else { told(&report, wanted) }?;
    kept?;
    if stop.load(Ordering::Relaxed) { Err(Failure::Interrupted) } else { Ok(()) }
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
        say!("Ctrl-C will not end the session in order: {error}");
    }
    stop
}

/// Prints the current state on one line.
fn show(state: &SessionState, rate: f64) {
    let [x, y, z] = [0, 1, 2].map(|k| state.tool.tip()[k]);
    say!(
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
    rate: f64,
    cycles: u64,
    missed: u64,
    left_out: u64,
    stalls: u64,
    took_ns: Times,
    late_ns: Times,
    peak_force: f64,
    peak_torque: f64,
    put_in: f64,
    held: f64,
    generated: f64,
    taken_out: f64,
    faults: [u64; 4],
    lost: u64,
    law: String,
}

#[derive(Serialize)]
struct Times {
    p50: u64,
    p99: u64,
    p999: u64,
    max: u64,
}

impl Times {
    fn of(times: &touchoff::haptic::LatencyHistogram) -> Times {
        let at = |share: f64| times.value_at_quantile(share);
        Times { p50: at(0.5), p99: at(0.99), p999: at(0.999), max: times.max() }
    }

    fn shown(&self) -> String {
        let [p50, p99, p999, max] =
            [self.p50, self.p99, self.p999, self.max].map(|ns| ns as f64 / 1e3);
        format!("{p50:.1} median, {p99:.1} p99, {p999:.1} p99.9, {max:.1} at most")
    }
}

fn said(report: &LoopReport, wanted: &Haptic) -> Result<(), Failure> {
    let energy = report.last.map(|state| state.energy).unwrap_or_default();
    let faults = report.faults;
    let said = RunSummary {
        device: wanted.device[0].as_str(),
        rate: wanted.rate,
        cycles: report.cycles,
        missed: report.missed,
        left_out: report.skipped,
        stalls: report.stalls,
        took_ns: Times::of(&report.durations),
        late_ns: Times::of(&report.start_delays),
        peak_force: report.peak_wrench[0],
        peak_torque: report.peak_wrench[1],
        put_in: energy.put_in,
        held: energy.held,
        generated: energy.generated,
        taken_out: energy.taken_out,
        faults: [faults.no_pose, faults.jumps, faults.not_responding, faults.failed_writes],
        lost: report.dropped_states,
        law: wanted.law.to_string(),
    };
    let mut out = Output::lines();
    serde_json::to_writer(&mut out, &said)?;
    writeln!(out)?;
    out.flush()?;
    Ok(())
}

fn told(report: &LoopReport, wanted: &Haptic) -> Result<(), Failure> {
    let mut out = Output::lines();
    let energy = report.last.map(|state| state.energy).unwrap_or_default();
    let faults = report.faults;
    let LoopReport { cycles, missed, skipped: left_out, stalls, .. } = report;
    let of = wanted.rate;
    writeln!(
        out,
        "{cycles} cycles at {of} Hz, {missed} missed their deadline, {left_out} left out; law {}",
        wanted.law
    )?;
    writeln!(out, "  took, µs:   {}", Times::of(&report.durations).shown())?;
    writeln!(out, "  late, µs:   {}", Times::of(&report.start_delays).shown())?;
    let [force, torque] = report.peak_wrench;
    writeln!(out, "  at most:    {force:.3} N, {torque:.2} N·mm")?;
    writeln!(
        out,
        "  energy:     {:.4} N·mm put in, {:.4} held at the end; {:.2e} generated at most, {:.2e} taken out",
        energy.put_in, energy.held, energy.generated, energy.taken_out,
    )?;
    let wrong = [
        (faults.no_pose, "cycles without a pose"),
        (faults.jumps, "jumps of the device"),
        (faults.not_responding, "cycles without an answer"),
        (faults.failed_writes, "pushes that failed"),
        (*stalls, "stalls of clock or thread"),
        (report.dropped_states, "states not recorded"),
    ];
    for (count, what) in wrong.into_iter().filter(|(count, _)| *count > 0) {
        writeln!(out, "  {count} {what}")?;
    }
    out.flush()?;
    Ok(())
}

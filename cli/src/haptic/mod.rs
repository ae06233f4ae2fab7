//! The haptic loop from the command line: a device, a part and a tool for some seconds.

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
use touchoff::certify::Facets;
use touchoff::haptic::{
    Axes, Coupling, Device, Hand, Limits, Monotonic, Realtime, Recorded, Rendering, Report,
    Session, Settings, State, Tremor, Watch, check_core, run, watched,
};
use touchoff::postures::Recorder;
use touchoff::tool::{Card, Shape};
use touchoff::{Part, Pose, Probe, Tool, Unit};

/// States that a record can be behind: some seconds.
const ROOM: usize = 1 << 16;
/// So often a second the screen is told.
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
    let loaded = part::load(&wanted.part, Some(tool.card()), Fine::Points)?;
    let map = match (&wanted.postures, &loaded.mesh) {
        (None, _) => None,
        (Some(file), Some(mesh)) => {
            Some((map_of(file, (mesh, &wanted.part.part), tool)?, Facets::new(mesh)))
        }
        (Some(_), None) => {
            let file = wanted.part.part.display().to_string();
            return Err(Failure::NoTriangles { file, what: "--postures" });
        }
    };
    let part = loaded.part;
    let table = wanted.record.as_deref().map(|path| Table::create(path, wanted.rate));
    let recorder = map.as_ref().map(|(map, facets)| Recorder::new(map, (&part, facets), tool));
    let record = Kept::new(table.transpose()?, recorder.transpose()?);
    let axes = match tool.card().shape {
        Shape::Revolved => Axes::Five,
        Shape::Solid { .. } => Axes::Six,
    };
    let limits = Limits {
        axes,
        force: wanted.most_force,
        stiffness: wanted.device_stiffness,
        ..Limits::default()
    };
    let start = above(&part, tool.card(), unit);
    // However short, a cycle is run.
    let cycles = (wanted.seconds * wanted.rate).round().max(1.0) as u64;
    match wielded {
        Wielded::Hand => {
            let wish = pressing(start, unit);
            let tremor = Tremor { size: 0.02, frequency: 10.0, seed: wanted.part.seed };
            let hand = Hand::new(limits, wanted.rate, wish)?
                .held_at(Point3::origin(), unit)?
                .trembling(&tremor)?;
            wield(hand, (wanted, json, cycles), (&part, tool), record)
        }
        Wielded::Path(path) => {
            let program = program::read(&path, tool.card(), unit)?;
            let poses: Vec<Pose> = program.stops.iter().map(|stop| stop.pose).collect();
            let played = Recorded::new(poses, cycles, limits).map_err(Failure::Motion)?;
            wield(played, (wanted, json, cycles), (&part, tool), record)
        }
        #[cfg(not(unix))]
        Wielded::Spacenav => {
            Err(Failure::Device("`spacenav` is a daemon of Unix systems".to_owned()))
        }
        #[cfg(unix)]
        Wielded::Spacenav => {
            use touchoff::haptic::spacenav::{Flight, SOCKET, Spacenav};
            let flight = Flight { way: 100.0, turn: 1.0 };
            let mouse = Spacenav::open(Path::new(SOCKET), (start, unit), (wanted.rate, flight))
                .map_err(|source| Failure::Spacenav { socket: SOCKET, source })?;
            wield(mouse, (wanted, json, cycles), (&part, tool), record)
        }
    }
}

/// How far over the part a hand begins, and how deep it presses, mm.
const OVER: f64 = 2.0;
const DEEP: f64 = 3.0;

/// The tool upright over the highest point of the part.
fn above(part: &Part, card: &Card, unit: Unit) -> Pose {
    let tree = part.tree();
    let points = (0..tree.len()).map(|place| tree.point(place));
    let highest = points.max_by(|a, b| a.z.total_cmp(&b.z)).unwrap_or_default();
    let tip = highest + Vector3::z() * (OVER * Unit::Millimetre.to(unit));
    match card.shape {
        Shape::Revolved => Pose::from_axis(tip, Vector3::z()),
        Shape::Solid { .. } => Pose::from_quaternion(tip, [0.0, 0.0, 0.0, 1.0]),
    }
    .expect("a point of a part is finite, and upright is a direction")
}

/// A hand that presses down and lets go every five seconds, and goes round in circles of a millimetre
/// meanwhile.
fn pressing(start: Pose, unit: Unit) -> impl FnMut(f64) -> Pose {
    let mm = Unit::Millimetre.to(unit);
    move |time| {
        let turn = std::f64::consts::TAU * time;
        let down = 0.5 - 0.5 * (turn / 5.0).cos();
        let way = Vector3::new(turn.cos() - 1.0, turn.sin(), -OVER - DEEP) * (down * mm);
        start.shifted(way).unwrap_or(start)
    }
}

/// Runs the loop in a thread of its own, and watches it from this one.
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
    let settings = Settings {
        stiffness: wanted.stiffness,
        rendering: Some(rendering),
        ..Settings::new(wanted.rate)
    };
    let probe = Probe::new(part, tool).law(wanted.law);
    // Made before memory is locked, so that a lock which has no room for it is refused and said.
    let mut session = Session::new(probe, &settings, limits)?;
    let (mut watch, mut latest, mut samples) = watched(ROOM);
    let stop = stopped_by_signals();
    let mut looped = |watch: &mut Watch| {
        let realtime = Realtime {
            priority: wanted.realtime.then_some(80),
            core: wanted.core,
            locked: wanted.realtime,
        };
        for refused in realtime.ask() {
            say!("{refused}");
        }
        let clock = &mut Monotonic::new(Duration::from_micros(wanted.awake));
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

/// Returns a flag that Ctrl-C and the other signals that end a program set, so that a session ends in order and
/// what was recorded is kept. The second signal ends the program at once.
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

/// Where it is, on one line.
fn show(state: &State, rate: f64) {
    let [x, y, z] = [0, 1, 2].map(|k| state.tool.tip()[k]);
    say!(
        "{:>8.2} s  tip {x:>9.3} {y:>9.3} {z:>9.3}  depth {:>7.4}  force {:>7.3} N  torque {:>8.2} N·mm",
        state.cycle as f64 / rate,
        state.wrench.depth(),
        state.push.force.norm(),
        state.push.torque.norm(),
    );
}

/// What came of it, for programs.
#[derive(Serialize)]
struct Said<'a> {
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
    fn of(times: &touchoff::haptic::Times) -> Times {
        let at = |share: f64| times.value_at_quantile(share);
        Times { p50: at(0.5), p99: at(0.99), p999: at(0.999), max: times.max() }
    }

    fn shown(&self) -> String {
        let [p50, p99, p999, max] =
            [self.p50, self.p99, self.p999, self.max].map(|ns| ns as f64 / 1e3);
        format!("{p50:.1} median, {p99:.1} p99, {p999:.1} p99.9, {max:.1} at most")
    }
}

fn said(report: &Report, wanted: &Haptic) -> Result<(), Failure> {
    let energy = report.last.map(|state| state.energy).unwrap_or_default();
    let faults = report.faults;
    let said = Said {
        device: wanted.device[0].as_str(),
        rate: wanted.rate,
        cycles: report.cycles,
        missed: report.missed,
        left_out: report.left_out,
        stalls: report.stalls,
        took_ns: Times::of(&report.took),
        late_ns: Times::of(&report.late),
        peak_force: report.peak[0],
        peak_torque: report.peak[1],
        put_in: energy.put_in,
        held: energy.held,
        generated: energy.generated,
        taken_out: energy.taken_out,
        faults: [faults.no_pose, faults.jumps, faults.gone, faults.not_pushed],
        lost: report.lost,
        law: wanted.law.to_string(),
    };
    let mut out = Output::lines();
    serde_json::to_writer(&mut out, &said)?;
    writeln!(out)?;
    out.flush()?;
    Ok(())
}

fn told(report: &Report, wanted: &Haptic) -> Result<(), Failure> {
    let mut out = Output::lines();
    let energy = report.last.map(|state| state.energy).unwrap_or_default();
    let faults = report.faults;
    let Report { cycles, missed, left_out, stalls, .. } = report;
    let of = wanted.rate;
    writeln!(
        out,
        "{cycles} cycles at {of} Hz, {missed} missed their deadline, {left_out} left out; law {}",
        wanted.law
    )?;
    writeln!(out, "  took, µs:   {}", Times::of(&report.took).shown())?;
    writeln!(out, "  late, µs:   {}", Times::of(&report.late).shown())?;
    let [force, torque] = report.peak;
    writeln!(out, "  at most:    {force:.3} N, {torque:.2} N·mm")?;
    writeln!(
        out,
        "  energy:     {:.4} N·mm put in, {:.4} held at the end; {:.2e} generated at most, {:.2e} taken out",
        energy.put_in, energy.held, energy.generated, energy.taken_out,
    )?;
    let wrong = [
        (faults.no_pose, "cycles without a pose"),
        (faults.jumps, "jumps of the device"),
        (faults.gone, "cycles without an answer"),
        (faults.not_pushed, "pushes that failed"),
        (*stalls, "stalls of clock or thread"),
        (report.lost, "states not recorded"),
    ];
    for (count, what) in wrong.into_iter().filter(|(count, _)| *count > 0) {
        writeln!(out, "  {count} {what}")?;
    }
    out.flush()?;
    Ok(())
}

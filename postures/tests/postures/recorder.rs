//! A recorded loop: the map holds the loop's postures, and the loop is not affected.

use crate::{BALL, MILL};
use nalgebra::{Point3, Vector3};
use std::num::NonZeroU16;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use touchoff::certify::{Certifier, PoseVerdict, TriangleBvh};
use touchoff::mesh::shapes;
use touchoff::tool::Interpreted;
use touchoff::{Law, Mesh, Part, Pose, Probe, Sampling, Tool, TriangleId, Unit};
use touchoff_haptics::{
    DeviceError, DeviceLimits, LoopReport, ScriptedDevice, Session, SessionSettings, SessionState,
    SimulatedClock, state_channel,
};
use touchoff_postures::{
    MapIdentity, MapRow, PostureMap, Recorder, RecorderError, RecorderStats, Rules,
};

const CYCLES: u64 = 4000;

fn sphere() -> Mesh {
    shapes::sphere(12.0, 3, Unit::Millimetre).expect("a sphere")
}

fn identity() -> MapIdentity {
    let rules = Rules { tolerance: 0.2, niceness: 0.5, allowed: Vec::new() };
    let keep = NonZeroU16::new(2).expect("not 0");
    MapIdentity::new(&sphere(), &[&*BALL, &*MILL], rules).expect("rules").with_keep(keep)
}

/// A hand that winds about the sphere and leans back and forth, at times too deep.
fn pose(cycle: u64) -> Result<Pose, DeviceError> {
    let time = cycle as f64 / 1000.0;
    let (height, angle) = (0.9 * (0.7 * time).sin(), 1.3 * time);
    let radius = (1.0 - height * height).sqrt();
    let outward = Vector3::new(radius * angle.cos(), radius * angle.sin(), height);
    let lean = Vector3::new((2.0 * time).sin(), (3.0 * time).cos(), (5.0 * time).sin()) * 0.6;
    let depth = 0.15 + 0.3 * (9.0 * time).sin();
    let axis = (outward + lean).normalize();
    let tip = Point3::from(outward * (12.0 - depth + 3.0) - axis * 3.0);
    Ok(Pose::from_axis(tip, axis)?)
}

/// Runs the loop over a range of cycles as fast as possible. A recorder consumes the states if there is a map;
/// otherwise all states are returned.
fn run_loop(
    (part, bvh): (&Part, &TriangleBvh),
    cycles: std::ops::Range<u64>,
    (map, capacity): (Option<&PostureMap>, usize),
) -> (Vec<SessionState>, LoopReport, Option<RecorderStats>) {
    let limits = DeviceLimits::default();
    let mut device = ScriptedDevice::new(limits, move |cycle| pose(cycles.start + cycle));
    let probe = Probe::new(part, &*MILL).with_law(Law::Gradient);
    let mut session = Session::new(probe, &SessionSettings::new(1000.0), limits).expect("settings");
    let (mut publisher, _, mut samples) = state_channel(capacity);
    let mut states = Vec::new();
    let count = cycles.end - cycles.start;
    std::thread::scope(|scope| {
        let session_thread = scope.spawn(move || {
            let (clock, stop) = (&mut SimulatedClock::default(), AtomicBool::new(false));
            session.run(&mut device, clock, count, &mut publisher, &stop)
        });
        let recorded = match map {
            Some(map) => {
                let mut recorder = Recorder::new(map, part, bvh, &*MILL).expect("a recorder");
                Some(recorder.follow(&mut samples).expect("recorded"))
            }
            None => {
                while !samples.is_closed() {
                    states.extend(samples.by_ref());
                }
                states.extend(samples.by_ref());
                None
            }
        };
        (states, session_thread.join().expect("it ends"), recorded)
    })
}

fn rows(map: &PostureMap) -> Vec<(TriangleId, MapRow)> {
    map.rows().expect("rows").collect::<Result<_, _>>().expect("whole")
}

fn open(folder: &Path, name: &str) -> PostureMap {
    PostureMap::open(folder.join(name), &identity()).expect("a map")
}

#[test]
fn a_session_fills_a_map_and_resumes() {
    let mesh = sphere();
    let (part, bvh) =
        (Part::from_mesh(&mesh, Sampling::new(30_000)).expect("a part"), TriangleBvh::new(&mesh));
    let folder = tempfile::tempdir().expect("a folder");
    let (workpiece, capacity) = ((&part, &bvh), CYCLES as usize);
    let map = open(folder.path(), "whole");
    let (_, report, recorded) = run_loop(workpiece, 0..CYCLES, (Some(&map), capacity));
    let recorded = recorded.expect("statistics");
    assert_eq!((report.dropped_states, recorded.skipped, recorded.states), (0, 0, report.cycles));
    assert!(recorded.accepted > 100 && recorded.judged > recorded.accepted, "{recorded:?}");
    let whole = rows(&map);
    assert!(whole.len() > 50, "{} of {}", whole.len(), mesh.triangles().len());

    // Records are acceptable, and as nice as they state.
    let mut probe = Probe::new(&part, &*MILL);
    let mut certifier = Certifier::new(&bvh, &*MILL).expect("a profile");
    for surface in ["ball", "flute"] {
        certifier = certifier.with_allowance(surface, 0.2).expect("a surface");
    }
    for (triangle, row) in &whole {
        assert!((1..=2).contains(&row.best.len()) && row.access.is_empty());
        for record in &row.best {
            let pose = record.pose().expect("a pose");
            assert_eq!(record.tool, 1);
            assert_eq!(probe.posture(&pose).niceness, Some(record.niceness));
            assert!(probe.contacts(&pose).iter().any(|contact| contact.triangle == *triangle));
            assert_eq!(certifier.check_pose(&pose), PoseVerdict::Clear);
        }
    }

    // The same in sections, each with a map that is opened again: nothing is lost or duplicated.
    for cycles in [0..1500, 1500..1600, 1600..CYCLES] {
        let map = open(folder.path(), "pieces");
        run_loop(workpiece, cycles, (Some(&map), capacity));
    }
    let resumed = rows(&open(folder.path(), "pieces"));
    let covered =
        |rows: &[(TriangleId, MapRow)]| rows.iter().map(|(id, _)| *id).collect::<Vec<_>>();
    let shared = covered(&resumed).iter().filter(|id| covered(&whole).contains(id)).count();
    // The loop's springs start anew with each section, so some cycles differ.
    assert!(shared * 10 > 9 * whole.len(), "{shared} of {}", whole.len());
    let rows_before = rows(&map);
    run_loop(workpiece, 0..CYCLES, (Some(&map), capacity));
    assert_eq!(rows(&map), rows_before);
}

#[test]
fn the_recorder_does_not_change_the_loop() {
    let mesh = sphere();
    let (part, bvh) =
        (Part::from_mesh(&mesh, Sampling::new(30_000)).expect("a part"), TriangleBvh::new(&mesh));
    let folder = tempfile::tempdir().expect("a folder");
    let (workpiece, capacity) = ((&part, &bvh), CYCLES as usize);
    let (expected_states, ..) = run_loop(workpiece, 0..CYCLES, (None, capacity));
    assert_eq!(expected_states.len() as u64, CYCLES);

    // The recorder consumes the states of its loop. To compare them, run the cycles by hand.
    let map = open(folder.path(), "map");
    let limits = DeviceLimits::default();
    let mut device = ScriptedDevice::new(limits, pose);
    let probe = Probe::new(&part, &*MILL).with_law(Law::Gradient);
    let mut session = Session::new(probe, &SessionSettings::new(1000.0), limits).expect("settings");
    let mut recorder = Recorder::new(&map, &part, &bvh, &*MILL).expect("a recorder");
    for (cycle, expected) in expected_states.iter().enumerate() {
        let state = session.cycle(&mut device).expect("a state");
        recorder.process(&state).expect("recorded");
        assert!(bits(&state) == bits(expected), "cycle {cycle}");
    }
    recorder.write().expect("recorded");
    let (_, report, recorded) =
        run_loop(workpiece, 0..CYCLES, (Some(&open(folder.path(), "other")), capacity));
    assert_eq!(recorded.map(|stats| stats.states), Some(CYCLES));
    let last = report.last.expect("a state");
    assert!(bits(&last) == bits(&expected_states[CYCLES as usize - 1]));
    assert_eq!(rows(&map), rows(&open(folder.path(), "other")));
}

/// Returns the bits of all numbers of a state that matter to a hand or a map.
fn bits(state: &SessionState) -> Vec<u64> {
    let vectors = [
        state.tool.tip().coords,
        state.tool.axis(),
        state.device.tip().coords,
        state.wrench_on_hand.force,
        state.wrench_on_hand.torque,
        state.wrench.force,
        state.wrench.torque,
    ];
    let numbers = [state.stiffest, state.wrench.integral, state.wrench.energy];
    let values = vectors.iter().flat_map(|vector| vector.iter().copied()).chain(numbers);
    values.map(f64::to_bits).collect()
}

#[test]
fn states_are_dropped_when_the_recorder_is_too_slow() {
    let mesh = sphere();
    let (part, bvh) =
        (Part::from_mesh(&mesh, Sampling::new(30_000)).expect("a part"), TriangleBvh::new(&mesh));
    let folder = tempfile::tempdir().expect("a folder");
    let map = open(folder.path(), "map");
    // Room for four states: most are lost, and all others are seen.
    let (_, report, recorded) = run_loop((&part, &bvh), 0..CYCLES, (Some(&map), 4));
    let recorded = recorded.expect("statistics");
    assert_eq!(report.cycles, CYCLES);
    assert_eq!(recorded.states + report.dropped_states, CYCLES);
    // Cycles after the last state that was seen are lost, but not counted as skipped.
    assert!(
        recorded.skipped <= report.dropped_states,
        "{recorded:?}, {} lost",
        report.dropped_states
    );
}

#[test]
fn rejects_another_tool_version_and_another_unit() {
    let mesh = sphere();
    let (part, bvh) =
        (Part::from_mesh(&mesh, Sampling::new(1000)).expect("a part"), TriangleBvh::new(&mesh));
    let folder = tempfile::tempdir().expect("a folder");
    let map = open(folder.path(), "map");
    let other_version = interpreted("1 - depth/2");
    let error = Recorder::new(&map, &part, &bvh, &other_version).expect_err("another version");
    assert!(matches!(error, RecorderError::Tool { .. }), "{error:?}");
    assert!(error.to_string().contains("Mill is no tool of the map, which has `Ball`, `Mill`"));
    let inch = part.converted_to(Unit::Inch);
    let error = Recorder::new(&map, &inch, &bvh, &*MILL).expect_err("another unit");
    assert!(matches!(error, RecorderError::Unit { .. }), "{error:?}");
}

#[test]
fn interpreted_and_compiled_tools_have_the_same_digest() {
    let interpreted_mill = interpreted("1 - depth/3");
    assert_eq!(interpreted_mill.info().digest, MILL.info().digest);
    assert_eq!(identity().tool(interpreted_mill.info()), Some(1));
    assert_ne!(interpreted("1 - depth/4").info().digest, MILL.info().digest);
    assert_ne!(BALL.info().digest, MILL.info().digest);
}

/// Returns a tool like [`Mill`], except for its niceness, its layout and its title.
fn interpreted(niceness: &str) -> Interpreted {
    let text = format!(
        "tool Mill \"another title\" {{ units mm; // in millimetres
         profile {{ start (0, 0); arc to (3, 3) center (0, 3) as ball cutting;
         line to (3, 12) as flute cutting; line to (2.5, 12), (2.5, 20) as neck;
         line to (9, 20), (9, 40), (0, 40) as holder; }}
         niceness cutting: {niceness}; }}"
    );
    let source = touchoff_dsl::source::Source::new("mill.tool", text);
    Interpreted::parse(&source).expect("a tool")
}

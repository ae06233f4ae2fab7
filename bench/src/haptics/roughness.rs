//! Roughness of the rendered force while a hand moves a tool evenly along a part.

use super::smooth::Fig73Smooth;
use nalgebra::Vector3;
use touchoff::scenes::{BALL, ScenePath};
use touchoff::{Law, Part, Pose, Probe, Tool};
use touchoff_haptics::{
    Coupling, DeviceLimits, Rendering, Session, SessionSettings, SimulatedHand,
};
use touchoff_tests::haptics::tool;
use touchoff_tests::haptics::wall::LIMITS;

/// Update rate, Hz.
const RATE: f64 = 1000.0;
/// Duration of the hand's motion, s.
const MOTION_SECONDS: f64 = 8.0;
/// Depth inside the wall that the hand aims at, mm. With the hand's impedance it presses with about 0.6 N.
const TARGET_DEPTH: f64 = 3.0;

/// Lowering of the tool along the edge, mm, so that the contact moves from the flute to the taper and on.
const EDGE_LOWERING: f64 = 2.5;

/// A path of the hand along the tube, at about 10 mm/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HandPath {
    /// The ball slides on the outer wall.
    Wall,
    /// Flute, taper and spindle slide along the top edge, which passes from one region of the tool to the next.
    Edge,
}

impl HandPath {
    /// Returns the name in the table.
    pub fn name(self) -> &'static str {
        match self {
            HandPath::Wall => "wall",
            HandPath::Edge => "edge",
        }
    }

    fn pose(self, time: f64) -> Pose {
        let [from, to] = match self {
            HandPath::Wall => [0.05, 0.25],
            HandPath::Edge => [0.65, 0.90],
        };
        const POSES: usize = 10_000_000;
        let fraction = from + (to - from) * time / MOTION_SECONDS;
        let pose = ScenePath::Outside.pose((fraction * POSES as f64) as usize, POSES);
        let centre = pose.tip() + pose.axis() * BALL;
        let inward = -Vector3::new(centre.x, centre.y, 0.0).normalize();
        // The approach starts outside: the wall is thinner than the depth that the hand aims at.
        let depth = TARGET_DEPTH * (2.0 * time).min(1.0) - 0.3 * (1.0 - 2.0 * time).max(0.0);
        let lowering = if self == HandPath::Edge { EDGE_LOWERING } else { 0.0 };
        let displacement = inward * depth - Vector3::z() * lowering;
        pose.translated(displacement).expect("a pose beside the tube")
    }
}

/// Returns the tools: Fig. 7.3 with the thesis's own magnitudes, with exact distances, and with exact distances whose
/// directions turn in fans at corners.
pub fn tools() -> [(&'static str, &'static dyn Tool); 3] {
    [("Fig73", tool("Fig73")), ("Fig73Exact", tool("Fig73Exact")), ("smooth", &Fig73Smooth)]
}

/// A case to measure.
#[derive(Clone, Copy)]
pub struct Case<'a> {
    /// The path.
    pub path: HandPath,
    /// The tool's name and the tool.
    pub tool: (&'static str, &'a dyn Tool),
    /// The force law.
    pub law: Law,
    /// The rendering: `direct`, `scaled` or `coupled`.
    pub rendering: &'static str,
    /// Contact stiffness under [`Law::Gradient`], N/mm³. The other laws use half of it, since in ideal contact they
    /// push twice as hard.
    pub stiffness: f64,
}

/// The force that the hand received and the stiffness of the contact. `force` and `rough` are root mean squares.
#[derive(Clone, Copy, Debug, Default)]
pub struct ForceStats {
    /// The force, N.
    pub force: f64,
    /// The part of the force above 30 Hz, N, which is perceived as roughness and not as shape.
    pub roughness: f64,
    /// The largest change of the force from one cycle to the next, N.
    pub max_step: f64,
    /// The largest eigenvalue of the contact's stiffness, N/mm.
    pub max_stiffness: f64,
}

/// Moves the tool along its path and returns the statistics of the force.
pub fn force_stats(part: &Part, case: &Case<'_>) -> ForceStats {
    let limits = DeviceLimits { force: 50.0, torque: 2000.0, ..LIMITS };
    let rendering = match case.rendering {
        "coupled" => Rendering::Coupled(Coupling::of(&limits)),
        how => Rendering::Direct { scaled: how == "scaled", damping: 0.0 },
    };
    let share = if case.law == Law::Gradient { 1.0 } else { 0.5 };
    let settings = SessionSettings {
        stiffness: share * case.stiffness,
        rendering: Some(rendering),
        passive: false,
        ..SessionSettings::new(RATE)
    };
    let probe = Probe::new(part, case.tool.1).with_law(case.law);
    let mut session = Session::new(probe, &settings, limits).expect("settings");
    let mut hand = SimulatedHand::new(limits, RATE, |time| case.path.pose(time)).expect("a hand");
    let (mut sums, mut filtered, mut previous) =
        (ForceStats::default(), [Vector3::zeros(); 2], None);
    let mut count = 0.0;
    // A first-order low-pass filter at 30 Hz, applied twice.
    let share = 1.0 - (-std::f64::consts::TAU * 30.0 / RATE).exp();
    for cycle in 0..(MOTION_SECONDS * RATE) as usize {
        let Some(state) = session.cycle(&mut hand) else { continue };
        let force = state.wrench_on_hand.force;
        filtered[0] += share * (force - filtered[0]);
        filtered[1] += share * (filtered[0] - filtered[1]);
        // The first second, the approach, does not count.
        if cycle as f64 > RATE {
            count += 1.0;
            sums.force += force.norm_squared();
            sums.roughness += (force - filtered[1]).norm_squared();
            sums.max_stiffness = sums.max_stiffness.max(state.stiffest * limits.stiffness);
            let step = previous.map_or(0.0, |previous: Vector3<f64>| (force - previous).norm());
            sums.max_step = sums.max_step.max(step);
        }
        previous = Some(force);
    }
    ForceStats {
        force: (sums.force / count).sqrt(),
        roughness: (sums.roughness / count).sqrt(),
        ..sums
    }
}

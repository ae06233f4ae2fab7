//! How much a push shakes while a hand moves a tool evenly along a part.

use super::smooth::Fig73Smooth;
use nalgebra::Vector3;
use touchoff::haptic::{Coupling, Hand, Limits, Rendering, Session, Settings};
use touchoff::scenes::{BALL, Path};
use touchoff::{Law, Part, Pose, Probe, Tool};
use touchoff_tests::haptics::tool;
use touchoff_tests::haptics::wall::LIMITS;

/// Cycles a second.
const RATE: f64 = 1000.0;
/// How long the hand takes for its way, s.
const SECONDS: f64 = 8.0;
/// How far inside the wall the hand wants the tool, mm: by its grip it presses with some 0.6 N.
const INSIDE: f64 = 3.0;

/// How far the tool is let down along the edge, mm, so that the edge goes from flute to taper and on.
const DOWN: f64 = 2.5;

/// A way of the hand along the tube, some ten millimetres a second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// The ball on the outer wall.
    Wall,
    /// Flute, taper and spindle along the top edge, which goes from one of the tool's regions to the next.
    Edge,
}

impl Way {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Way::Wall => "wall",
            Way::Edge => "edge",
        }
    }

    fn pose(self, time: f64) -> Pose {
        let [from, to] = match self {
            Way::Wall => [0.05, 0.25],
            Way::Edge => [0.65, 0.90],
        };
        const POSES: usize = 10_000_000;
        let share = from + (to - from) * time / SECONDS;
        let pose = Path::Outside.pose((share * POSES as f64) as usize, POSES);
        let centre = pose.tip() + pose.axis() * BALL;
        let inward = -Vector3::new(centre.x, centre.y, 0.0).normalize();
        // It comes from outside: the wall is thinner than the way that the hand would have it.
        let inside = INSIDE * (2.0 * time).min(1.0) - 0.3 * (1.0 - 2.0 * time).max(0.0);
        let down = if self == Way::Edge { DOWN } else { 0.0 };
        let way = inward * inside - Vector3::z() * down;
        pose.shifted(way).expect("a pose beside the tube")
    }
}

/// The tools: with the thesis's own magnitudes, exact, and exact with directions that turn in fans.
pub fn tools() -> [(&'static str, &'static dyn Tool); 3] {
    [("Fig73", tool("Fig73")), ("Fig73Exact", tool("Fig73Exact")), ("smooth", &Fig73Smooth)]
}

/// What is measured.
#[derive(Clone, Copy)]
pub struct Case<'a> {
    /// Along what.
    pub way: Way,
    /// The tool, and what it is called.
    pub tool: (&'static str, &'a dyn Tool),
    /// The law.
    pub law: Law,
    /// Direct, scaled or coupled.
    pub how: &'static str,
    /// N/mm³ by the gradient's law; by the others half of it, since in ideal contact they push twice as much.
    pub stiffness: f64,
}

/// What the hand felt: root mean squares in N.
#[derive(Clone, Copy, Debug, Default)]
pub struct Shaking {
    /// Of the force.
    pub force: f64,
    /// Of what of it is above 30 Hz, which is felt as roughness and not as shape.
    pub rough: f64,
    /// The largest change from one cycle to the next.
    pub step: f64,
    /// The largest eigenvalue of the contact's stiffness, N/mm.
    pub stiffest: f64,
}

/// Moves the tool along its way.
pub fn shaking(part: &Part, case: &Case<'_>) -> Shaking {
    let limits = Limits { force: 50.0, torque: 2000.0, ..LIMITS };
    let rendering = match case.how {
        "coupled" => Rendering::Coupled(Coupling::of(&limits)),
        how => Rendering::Direct { scaled: how == "scaled", damping: 0.0 },
    };
    let share = if case.law == Law::Gradient { 1.0 } else { 0.5 };
    let settings = Settings {
        stiffness: share * case.stiffness,
        rendering: Some(rendering),
        passive: false,
        ..Settings::new(RATE)
    };
    let probe = Probe::new(part, case.tool.1).law(case.law);
    let mut session = Session::new(probe, &settings, limits).expect("settings");
    let mut hand = Hand::new(limits, RATE, |time| case.way.pose(time)).expect("a hand");
    let (mut sums, mut low, mut before) = (Shaking::default(), [Vector3::zeros(); 2], None);
    let mut count = 0.0;
    // A filter of first order, twice.
    let share = 1.0 - (-std::f64::consts::TAU * 30.0 / RATE).exp();
    for cycle in 0..(SECONDS * RATE) as usize {
        let Some(state) = session.cycle(&mut hand) else { continue };
        let force = state.push.force;
        low[0] += share * (force - low[0]);
        low[1] += share * (low[0] - low[1]);
        // Not while it comes.
        if cycle as f64 > RATE {
            count += 1.0;
            sums.force += force.norm_squared();
            sums.rough += (force - low[1]).norm_squared();
            sums.stiffest = sums.stiffest.max(state.stiffest * limits.stiffness);
            let step = before.map_or(0.0, |before: Vector3<f64>| (force - before).norm());
            sums.step = sums.step.max(step);
        }
        before = Some(force);
    }
    Shaking { force: (sums.force / count).sqrt(), rough: (sums.rough / count).sqrt(), ..sums }
}

//! Looking for the worst: an optimiser that hunts for the points and poses at which a contract is nearest to being broken.
//!
//! `climb` is the optimiser, [`asked`] a tool whose forms are compared wherever it was asked. [`evaluator`] hunts for errors of single
//! points and [`borders`] for jumps between neighbours, both judged as in [`touchoff_tests::accuracy`]; [`wrenches`] for jumps of the
//! wrench, [`clouds`] for depths beyond `Probe::error` and `Probe::depth_bound`, [`certified`] for depths beyond a proved interval.

pub mod asked;
pub mod borders;
pub mod certified;
pub mod clouds;
pub mod evaluator;
pub mod found;
pub mod page;
pub mod tool;
pub mod wrenches;

mod climb;
mod poses;

pub use climb::{Best, Climb, beside, halfway, neighbours};

/// The worst that a question found.
#[derive(Clone, Debug, Default)]
pub struct Find {
    /// How large, in the question's measure.
    pub error: f64,
    /// Where, to the last bit, and what else tells it.
    pub at: String,
    /// The points of the tool's frame that show it; none where a pose does.
    pub points: Vec<[f64; 3]>,
}

impl Find {
    /// Takes what is worse.
    pub fn see(&mut self, error: f64, at: impl FnOnce() -> (String, Vec<[f64; 3]>)) {
        if error.is_nan() || error > self.error {
            let (at, points) = at();
            *self = Find { error, at, points };
        }
    }
}

/// How much is tried.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Seeds that are judged, beside corners and the axis.
    pub seeds: usize,
    /// From how many of them each question is climbed.
    pub starts: usize,
    /// Steps of each climb.
    pub steps: usize,
}

impl Effort {
    /// So many steps of each climb, and as much else as goes with them.
    pub fn of(steps: usize) -> Effort {
        Effort { seeds: 4 * steps, starts: (steps / 40).clamp(4, 40), steps }
    }
}

/// One answer: what was asked, the worst of it, and what it may be.
#[derive(Clone, Debug)]
pub struct Answer {
    /// What was asked.
    pub question: Question,
    /// The worst that was found.
    pub find: Find,
    /// The worst among the seeds, before any climb.
    pub seeds: f64,
    /// What it may be; `None` where there is no promise.
    pub bar: Option<f64>,
}

impl Answer {
    /// Whether it is more than it may be.
    pub fn missed(&self) -> bool {
        self.find.error.is_nan() || self.bar.is_some_and(|bar| self.find.error > bar)
    }
}

macro_rules! questions {
    ($($(#[$doc:meta])* $name:ident $word:literal $unit:literal,)*) => {
        /// What is hunted for.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Question {
            $($(#[$doc])* $name,)*
        }

        impl Question {
            /// Every question.
            pub const ALL: &[Question] = &[$(Question::$name,)*];

            /// The words for it.
            pub fn name(self) -> &'static str {
                match self { $(Question::$name => $word,)* }
            }

            /// In what it is measured.
            pub fn unit(self) -> &'static str {
                match self { $(Question::$name => $unit,)* }
            }
        }
    };
}

questions! {
    /// Error of the depth.
    Depth "depth" "ulp(S)",
    /// Error of the direction, over its bound.
    Direction "direction" "of its bound",
    /// Error of the direction's length.
    Length "length of the direction" "ε",
    /// Error of the distance outside.
    Clearance "distance outside" "ulp(S)",
    /// How far from the surface the side is wrong.
    Side "side" "ulp(S)",
    /// By how much the owner is farther than the nearest.
    Owner "owner" "ulp(S)",
    /// Jump of the depth between neighbours.
    DepthJump "jump of depth" "ulp(S)",
    /// Jump of the magnitude between neighbours.
    MagnitudeJump "jump of magnitude" "ulp(S)",
    /// Jump of direction times depth between neighbours.
    PushJump "jump of direction · depth" "unit",
    /// Jump of the niceness between neighbours.
    NicenessJump "jump of niceness" "1",
    /// Jump of the force between neighbouring poses, by the sum of all pushes.
    ForceShare "jump of force" "Σ w·m",
    /// The same, by what the points that changed their region can do.
    ForceJump "jump of force by its points" "of its bound",
    /// Jump of the sum of magnitudes between neighbouring poses.
    IntegralJump "jump of Σ w·m" "of its bound",
    /// Depth of a stored point beside that of the given one.
    CloudError "`Probe::error`" "of its bound",
    /// Depth of the surface beside `Probe::depth_bound`.
    DepthBound "`Probe::depth_bound`" "of its bound",
    /// Depth of a triangle's point above what is certified.
    Certified "`Certifier::deepest`" "64 ε sizes",
    /// Depth of a triangle's point where the tool is said to be clear.
    Cleared "`Certifier::clear`" "64 ε sizes",
}

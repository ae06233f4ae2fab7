//! Tools as oracles know them, whose depth is asked for millions of times.

use touchoff_tests::oracle::outline::Outline;
use touchoff_tests::oracle::{
    Block, Cylinder, Fig73, LBracket, Nearest, Oracle, UnitSphere, restated,
};

/// Tools by their profile.
pub const PROFILES: [&str; 6] =
    ["Fig73Exact", "BullNose", "Lollipop", "TSlot", "BallEr16", "TaperedBall"];

/// Regions written by hand, solids, and profiles that overhang.
pub const FIELDS: [&str; 7] =
    ["Fig73", "Cylinder", "UnitSphere", "Block", "LBracket", "BoringBar", "FaceMill"];

/// No field of the list changes by more than so many times the way: the thesis's tool by √5.
const STEEPEST: f64 = 2.24;

/// A tool whose depth is asked for many times.
pub enum Subject {
    /// By its profile.
    Profile(Box<Nearest>, Outline),
    /// By its field.
    Field(Box<dyn Oracle + Send + Sync>),
}

impl Subject {
    /// A tool of the lists above.
    ///
    /// # Panics
    /// If it is in neither.
    pub fn of(name: &str) -> Subject {
        match name {
            "Fig73" => Subject::Field(Box::<Fig73>::default()),
            "Cylinder" => Subject::Field(Box::new(Cylinder)),
            "UnitSphere" => Subject::Field(Box::new(UnitSphere)),
            "Block" => Subject::Field(Box::new(Block)),
            "LBracket" => Subject::Field(Box::new(LBracket)),
            _ => {
                let nearest = Box::new(Nearest::of(name));
                match restated::of(name).and_then(|tool| Outline::of(&tool)) {
                    Some(outline) => Subject::Profile(nearest, outline),
                    None => Subject::Field(nearest),
                }
            }
        }
    }

    /// The tool in the oracles' terms.
    pub fn oracle(&self) -> &dyn Oracle {
        match self {
            Subject::Profile(nearest, _) => &**nearest,
            Subject::Field(field) => &**field,
        }
    }

    /// The depth of a point; below 0 outside.
    pub(super) fn depth(&self, p: [f64; 3]) -> f64 {
        match self {
            Subject::Profile(_, outline) => {
                outline.depth([(p[0] * p[0] + p[1] * p[1]).sqrt(), p[2]])
            }
            Subject::Field(field) => {
                field.sense(p).map_or_else(|| -field.signed_distance(p), |sense| sense.depth)
            }
        }
    }

    /// The bound of the depth's change, as a multiple of the way.
    pub(super) fn steepest(&self) -> f64 {
        match self {
            Subject::Profile(..) => 1.0,
            Subject::Field(_) => STEEPEST,
        }
    }

    /// The smallest gap, as a part of the tool's size, that a verdict is asked about: a field is searched to a thousandth.
    pub(super) fn finest(&self) -> f64 {
        match self {
            Subject::Profile(..) => 1e-7,
            Subject::Field(_) => 1e-2,
        }
    }

    /// Returns the tolerance to ask for, and how near samples should come to the lower bound, in the part's unit. A
    /// field is asked for a millionth of the unit, whatever the tool's size.
    pub(super) fn tolerance(&self, size: f64) -> [f64; 2] {
        match self {
            Subject::Profile(..) => [1e-9 * size; 2],
            Subject::Field(_) => [1e-6, 1e-6 * size],
        }
    }
}

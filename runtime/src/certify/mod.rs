//! What lies between the points of a cloud: how deep a tool is in a part's triangles, proved.
//!
//! ```text
//! pose ──look──▶ nodes ──hull──▶ triangles ──batch──▶ eight at a time ──facet, course──▶ deepest
//!                 f32              f32                  f64                 f64
//! ```
//!
//! A [`Certifier`] searches a tree of triangles, [`Facets`], by branch and bound: what cannot be deeper
//! than what was found is left. Depth is that of the tool's profile, the distance to its surface; bounds
//! come from its pieces (`hull`), and where they leave a triangle open, from its edges and the one line
//! in it on which depth can be greatest (`facet`, `course`).
//!
//! **Rounding.** Every place is known to within a part in 2^46 of the tool's and the part's size, and
//! answers are widened by that. Thin triangles are known less well: their *skew* is added. `rounding` derives
//! both.

mod along;
mod answer;
mod apart;
mod body;
mod bounds;
mod containment;
mod part;
mod question;
mod rounding;
mod space;
mod sweep;
mod triangle;
mod work;

pub use answer::{
    AllowanceError, Along, Clear, Clearance, Penetration, Sweep, Uncertified, Witness,
};
#[cfg(feature = "postures")]
pub(crate) use containment::Containment;
pub use part::Facets;
#[cfg(feature = "postures")]
pub(crate) use part::Location;

use crate::bvh::QuerySetup;
use crate::pose::Pose;
use crate::tool::{Card, Tool};
use apart::Apart;
use body::Body;
use body::field::Field;
use body::owners::Owners;
use body::section::Section;
#[cfg(not(feature = "postures"))]
use containment::Containment;
use containment::Cores;
use fearless_simd::Level;
#[cfg(feature = "postures")]
use nalgebra::{Point3, Vector3};
use question::Question;
use std::slice;
use sweep::Sweeper;
use triangle::course::Goal;
use work::{Setting, Work};

/// A tool beside a part's triangles, ready to be asked what is proved at one pose after another.
///
/// Memory is kept between questions, and each begins at the triangle that the last one ended at. What
/// is asked about is the tool's surface as its profile draws it.
///
/// ```
/// use nalgebra::{Point3, Vector3};
/// use touchoff::certify::{Certifier, Facets};
/// use touchoff::{Pose, Unit, mesh::shapes};
///
/// touchoff::tool! {
///     tool Ball "a ball of 3 mm radius" {
///         units mm;
///         profile {
///             start (0, 0);
///             arc to (0, 6) center (0, 3) as ball cutting;
///         }
///         niceness cutting: 1;
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let low = Point3::new(-20.0, -20.0, -10.0);
/// let block = shapes::cuboid(low, Point3::new(20.0, 20.0, 0.0), Unit::Millimetre)?;
/// let facets = Facets::new(&block);
/// let mut certifier = Certifier::new(&facets, &Ball)?;
/// let pose = Pose::from_axis(Point3::new(0.3, 0.1, -0.5), Vector3::z())?;
/// let [low, high] = certifier.deepest(&pose, 1e-9).depth;
/// assert!(low <= 0.5 && 0.5 <= high && high - low < 2e-9);
/// # Ok(()) }
/// ```
pub struct Certifier<'a> {
    setting: Setting<'a>,
    card: &'a Card,
    /// How deep the tool is, whichever surface it is.
    whole: Question,
    /// Of each surface, once it was asked for.
    each: Vec<Option<Question>>,
    /// Of each surface, how deep it may be in the part's unit, and what to ask for that, if anything was
    /// allowed.
    allowed: Vec<f64>,
    rules: Option<Vec<Question>>,
    /// Points of what may not be in the part: by the rules, of all of the tool, and of each surface with how
    /// deep it may be, in the tool's unit.
    cores: Cores,
    whole_cores: Cores,
    each_cores: Vec<Option<(f64, Cores)>>,
    /// Of the surfaces whose distance was asked for last, what to ask for it.
    apart: Option<Apart>,
    budget: u32,
    work: Work,
    sweeper: Sweeper,
}

impl<'a> Certifier<'a> {
    /// A certifier of a tool beside a part.
    ///
    /// # Errors
    /// Where neither the distance from the tool is known nor how fast its depth changes; see
    /// [`Uncertified`].
    pub fn new(facets: &'a Facets, tool: &'a dyn Tool) -> Result<Certifier<'a>, Uncertified> {
        let (card, level) = (tool.card(), Level::new());
        let length = card.unit.to(facets.unit());
        let setup = QuerySetup::new(&facets.frame, card, length);
        let part = f64::from(facets.frame.size) * facets.frame.scale / length;
        let error = rounding::place(card, part);
        let (body, error) = match Section::new(card, error) {
            Some(section) => (Body::Profile(section), error),
            None => match Field::new(tool, level) {
                Some(field) => {
                    let error = field.error + field.steep * error;
                    (Body::Field(field), error)
                }
                None => return Err(Uncertified { tool: card.name.to_string() }),
            },
        };
        let surfaces = card.surfaces.len();
        let (size, exact) = (card.size(), card.exact());
        let setting = Setting { facets, body, size, exact, setup, level, length, error };
        let whole = setting.question(0.0, |_| true);
        Ok(Certifier {
            whole,
            each: (0..surfaces).map(|_| None).collect(),
            allowed: vec![0.0; surfaces],
            rules: None,
            cores: Cores::whole(card),
            whole_cores: Cores::whole(card),
            each_cores: (0..surfaces).map(|_| None).collect(),
            apart: None,
            budget: 1 << 20,
            work: Work::default(),
            sweeper: Sweeper::default(),
            card,
            setting,
        })
    }

    /// With a budget: how many nodes, triangles and intervals of edges a question may look at. When it
    /// is spent, the answer is what is known until then. The default is a million.
    #[must_use]
    pub fn budget(mut self, budget: u32) -> Certifier<'a> {
        self.budget = budget;
        self
    }

    /// With another SIMD level than the best of this machine.
    #[must_use]
    pub fn level(mut self, level: Level) -> Certifier<'a> {
        self.setting.level = level;
        if let Body::Field(field) = &mut self.setting.body {
            field.level = level;
        }
        self
    }

    /// With an allowance for a surface of the tool: how deep it may be in the part, in the part's unit,
    /// where it is the nearest surface; infinity for as deep as it will. Below 0 it is a margin: how far the
    /// surface has to keep from all of the part. [`Certifier::clear`] goes by it; no allowance is 0.
    ///
    /// # Errors
    /// If there is no such surface, or the allowance is not a number or keeps infinitely far, or it is a margin
    /// of a tool without a profile: how far places outside are from which surface its file does not say.
    pub fn allow(mut self, surface: &str, allowed: f64) -> Result<Certifier<'a>, AllowanceError> {
        if allowed.is_nan() || allowed / self.setting.length == f64::NEG_INFINITY {
            return Err(AllowanceError::NoLength { surface: surface.to_owned(), allowed });
        }
        let surfaces = &self.card.surfaces;
        let Some(index) = surfaces.iter().position(|known| known.name == surface) else {
            let known: Vec<String> = surfaces.iter().map(|s| format!("`{}`", s.name)).collect();
            return Err(AllowanceError::NoSurface {
                tool: self.card.name.to_string(),
                surface: surface.to_owned(),
                known: known.join(", "),
            });
        };
        if let (Body::Field(_), true) = (&self.setting.body, allowed < 0.0) {
            let (tool, surface) = (self.card.name.to_string(), surface.to_owned());
            return Err(AllowanceError::NoMargin { tool, surface });
        }
        self.allowed[index] = allowed;
        let length = self.setting.length;
        let allowed: Vec<f64> = self.allowed.iter().map(|allowed| allowed / length).collect();
        self.rules = Some(Question::all(&self.setting, &allowed));
        self.cores = Cores::new(allowed);
        Ok(self)
    }

    /// The deepest penetration of the part's triangles into the tool. The interval is no wider than the
    /// tolerance, in the part's unit, and what rounding adds; a tolerance below that, or 0, is taken as
    /// that. Where triangles are thinner than the tolerance, or the budget is spent, it is wider.
    pub fn deepest(&mut self, pose: &Pose, tolerance: f64) -> Penetration {
        let Certifier { setting, whole, work, budget, .. } = self;
        penetration(setting, whole, work, pose, (tolerance, *budget))
    }

    /// The deepest penetration where a surface, by its place in the card's list, is the nearest: the
    /// same, of that surface alone. Where two are as near, both count. Of a tool without a profile that
    /// surface is the nearest whose region has the place.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn deepest_on(&mut self, surface: usize, pose: &Pose, tolerance: f64) -> Penetration {
        let Certifier { setting, each, work, budget, .. } = self;
        let question =
            each[surface].get_or_insert_with(|| setting.question(0.0, |other| other == surface));
        penetration(setting, question, work, pose, (tolerance, *budget))
    }

    /// Whether the tool is clear of the part, or no deeper in it than is [allowed](Certifier::allow). It
    /// stops at the first point that is.
    pub fn clear(&mut self, pose: &Pose) -> Clear {
        match self.touches(pose) {
            Touch::Yes(witness) => Clear::Touching(witness),
            Touch::Undecided(high) => Clear::Undecided(high),
            Touch::No => match self.containment(pose) {
                Containment::Inside(surface) => Clear::Inside(surface),
                Containment::Outside => Clear::Clear,
                Containment::Unknown => Clear::SurfaceOnly,
                Containment::Undecided => Clear::Undecided(0.0),
            },
        }
    }

    /// Returns where what may not be in the part is. Call only if no triangle touches it.
    pub(crate) fn containment(&mut self, pose: &Pose) -> Containment {
        let cores = (self.card, &mut self.cores);
        self.setting.containment(cores, pose, 4.0 * self.setting.error)
    }

    /// Returns whether all of the tool is wholly inside the material and touches no triangle, whatever is
    /// allowed; `None` where that is not known: the part has no inside, or rounding decides.
    pub fn is_buried(&mut self, pose: &Pose) -> Option<bool> {
        let Certifier { setting, card, whole, whole_cores, work, budget, .. } = self;
        match touches(setting, slice::from_ref(whole), work, pose, *budget) {
            Touch::Yes(_) => Some(false),
            Touch::Undecided(_) => None,
            Touch::No => {
                match setting.containment((card, whole_cores), pose, 4.0 * setting.error) {
                    Containment::Inside(_) => Some(true),
                    Containment::Outside => Some(false),
                    Containment::Unknown | Containment::Undecided => None,
                }
            }
        }
    }

    /// Returns the greatest depth that a surface can have, by its place in the card's list, in the part's
    /// unit: that of the deepest point of the tool that it is the nearest to, to a hundredth. It has it
    /// where the part's surface passes the middle of the tool. `None` where it is not found in time.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn greatest_depth(&self, surface: usize) -> Option<f64> {
        assert!(surface < self.card.surfaces.len());
        let depth = match &self.setting.body {
            Body::Profile(section) => {
                Owners::of(section, |other| other == surface).greatest_depth(section)
            }
            Body::Field(field) => {
                let owners = Owners::of_regions(self.card, |_, of| of.surface == surface);
                field.deepest(&owners, 0.0, 1.01)?.map_or(0.0, |(_, depth)| depth.value)
            }
        };
        Some(depth * self.setting.length)
    }

    /// Returns whether what may not be in the part is one piece: the points that are deeper than their limit by twice
    /// what rounding adds, which [`Certifier::is_too_deep`] tells.
    #[cfg(feature = "postures")]
    pub(crate) fn is_one_piece(&mut self) -> bool {
        self.setting.is_one_piece((self.card, &mut self.cores), self.setting.error)
    }

    /// Begins as if nothing had been asked yet.
    #[cfg(feature = "postures")]
    pub(crate) fn forget(&mut self) {
        self.work.forget();
    }

    /// Whether a triangle of the part is in the tool, deeper than is allowed.
    pub(crate) fn touches(&mut self, pose: &Pose) -> Touch {
        let Certifier { setting, whole, rules, work, budget, .. } = self;
        let rules = rules.as_deref().unwrap_or(slice::from_ref(whole));
        touches(setting, rules, work, pose, *budget)
    }

    /// Whether a place of the part, in the world, is surely deeper than is [allowed](Certifier::allow).
    #[cfg(feature = "postures")]
    pub(crate) fn is_too_deep(
        &mut self,
        pose: (&Point3<f64>, &Vector3<f64>),
        place: &Point3<f64>,
    ) -> bool {
        let Certifier { setting, whole, rules, work, .. } = self;
        let rules = rules.as_deref().unwrap_or(slice::from_ref(whole));
        let (tip, axis) = pose;
        let way = (place - tip) / setting.length;
        let z = way.dot(axis);
        let d = (way.norm_squared() - z * z).max(0.0).sqrt();
        rules.iter().any(|rule| {
            rule.limit >= 0.0
                && work.depth(setting, rule, [d, 0.0, z]) > rule.limit + 2.0 * setting.error
        })
    }
}

/// Whether a triangle is deeper than is allowed.
pub(crate) enum Touch {
    No,
    Yes(Witness),
    /// By no more than this, in the part's unit.
    Undecided(f64),
}

/// Returns whether a triangle is deeper than rules allow.
fn touches(
    setting: &Setting<'_>,
    rules: &[Question],
    work: &mut Work,
    pose: &Pose,
    budget: u32,
) -> Touch {
    let touch = 2.0 * setting.error;
    let mut open: Option<f64> = None;
    for rule in rules {
        let least = rule.limit - touch;
        let enough = rule.limit + touch;
        let goal = Goal { least, tolerance: touch, enough, budget };
        if rule.limit < 0.0 {
            setting.look(work, pose);
            work.outside(setting, rule, pose, goal);
        } else {
            work.inside(setting, rule, pose, goal);
        }
        if let Some(best) = &work.best
            && work.search.best > goal.enough + work.skew
        {
            return Touch::Yes(setting.witness(best, pose));
        }
        if work.best.is_some() || work.search.open() {
            let high = work.search.most.max(work.search.wanted()) + touch + work.skew;
            open = Some(open.unwrap_or(0.0).max(high - rule.limit));
        }
    }
    open.map_or(Touch::No, |high| Touch::Undecided(high * setting.length))
}

/// The deepest place that owners have.
fn penetration(
    setting: &Setting<'_>,
    question: &Question,
    work: &mut Work,
    pose: &Pose,
    (tolerance, budget): (f64, u32),
) -> Penetration {
    // Written so that what is not a number is no tolerance.
    let tolerance = (4.0 * setting.error).max(tolerance / setting.length);
    let goal = Goal { least: setting.error, tolerance, enough: f64::INFINITY, budget };
    work.inside(setting, question, pose, goal);
    let more = setting.error + work.skew;
    let (low, high) = match work.best {
        // Slabs reach farther by the error, so that a place outside may count as that deep.
        Some(_) => (work.search.best - more - setting.error, work.search.best + tolerance),
        None => (0.0, setting.error),
    };
    let high = if work.descent.looked() { high.max(work.search.most) + more } else { 0.0 };
    Penetration {
        depth: [low.max(0.0), high].map(|depth| depth * setting.length),
        witness: work.best.as_ref().map(|best| setting.witness(best, pose)),
    }
}

//! A program held to a part: where on its way the tool is deeper in the finished part than it may be.
//!
//! ```text
//! program ──two stops──▶ motion ──sweep_clear──▶ clear
//!                                      └──────▶ each surface ──deepest_along──▶ finding
//! ```
//!
//! Every two stops are a [`Motion`], checked all along and not only at its ends, so what gouges between two
//! points is found. A motion that is not proved clear is asked of each surface of the tool by itself, so that
//! a flute that gouges does not hide a shank that rubs: one finding for each motion and surface.
//!
//! **What is proved.** A motion without a finding is nowhere deeper than is allowed by more than the
//! [resolution](Verifier::resolution). A finding is deeper than that at the pose it names, its interval contains
//! the depth there, and its `most` bounds that of the whole motion. Depth is that of the tool's profile as it stands still:
//! neither runout nor deflection counts. Motions are taken as [`Motion`] means them, rapid ones too.

mod approach;
mod finding;

pub use approach::Approach;
pub use finding::{Finding, Kind, Report, VerifyError};

use crate::certify::{Along, Certifier, Facets, Sweep};
use crate::cores;
use crate::motion::{Motion, MotionError};
use crate::pose::Pose;
use crate::program::{Program, Stop};
use crate::tool::{Card, Shape, Tool};

/// Checks programs of a tool beside a part.
///
/// Lengths are in the part's unit. All surfaces may be as deep as the tolerance, unless another depth is
/// [allowed](Verifier::allow); in rapid traverse nothing may be deeper than the tolerance.
///
/// ```
/// use nalgebra::Point3;
/// use touchoff::certify::Facets;
/// use touchoff::verify::{Kind, Verifier};
/// use touchoff::{Program, Unit, mesh::shapes};
///
/// touchoff::tool! {
///     tool Ball "6 mm" {
///         units mm;
///         profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; }
///         niceness cutting: 1;
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let (low, high) = (Point3::new(-5., -5., -9.), Point3::new(5., 5., 0.));
/// let block = Facets::new(&shapes::cuboid(low, high, Unit::Millimetre)?);
/// // Both points are clear of the block; the way between them is not.
/// let program = Program::parse("-20,0,-0.5,0,0,1\n20,0,-0.5,0,0,1\n", "across.csv")?;
/// let report = Verifier::new(&block, &Ball)?.tolerance(0.01)?.check(&program)?;
/// let [finding] = &report.findings[..] else { panic!("{report:?}") };
/// assert_eq!((finding.from, finding.line), (Some(1), 2));
/// assert!(matches!(finding.kind, Kind::Deep { depth: [low, _], .. } if low > 0.499));
/// # Ok(()) }
/// ```
pub struct Verifier<'a> {
    facets: &'a Facets,
    tool: &'a dyn Tool,
    tolerance: f64,
    resolution: f64,
    /// What was allowed of surfaces by their place in the card's list.
    allowed: Vec<Option<f64>>,
    budget: u32,
}

/// A micrometre, in mm: meshes are seldom as close to what they mean.
const RESOLUTION: f64 = 1e-3;

/// So many motions one after the other are asked of the same certifiers, so that answers are the same however
/// many cores there are.
const TOGETHER: usize = 32;

impl<'a> Verifier<'a> {
    /// A verifier of a tool beside a part, with a tolerance of 0.
    ///
    /// # Errors
    /// If nothing can be proved of the tool.
    pub fn new(facets: &'a Facets, tool: &'a dyn Tool) -> Result<Verifier<'a>, VerifyError> {
        let card = tool.card();
        Certifier::new(facets, tool)?;
        Ok(Verifier {
            facets,
            tool,
            tolerance: 0.0,
            resolution: RESOLUTION / facets.unit().millimetres(),
            allowed: vec![None; card.surfaces.len()],
            budget: 1 << 20,
        })
    }

    /// With a tolerance: how deep any surface may be for which nothing else is allowed, 0 or more.
    ///
    /// # Errors
    /// If it is no such length.
    pub fn tolerance(mut self, tolerance: f64) -> Result<Verifier<'a>, VerifyError> {
        if !(0.0..f64::INFINITY).contains(&tolerance) {
            return Err(VerifyError::Tolerance { tolerance });
        }
        self.tolerance = tolerance;
        Ok(self)
    }

    /// With a depth that a surface is allowed where it is the nearest: infinity for any, below 0 a margin that
    /// it has to keep from all of the part.
    ///
    /// # Errors
    /// If there is no such surface, or that is no depth.
    pub fn allow(mut self, surface: &str, allowed: f64) -> Result<Verifier<'a>, VerifyError> {
        // What a certifier takes, and no more.
        Certifier::new(self.facets, self.tool)?.allow(surface, allowed)?;
        let surfaces = &self.tool.card().surfaces;
        let index = surfaces.iter().position(|known| known.name == surface);
        if let Some(known) = index.and_then(|index| self.allowed.get_mut(index)) {
            *known = Some(allowed);
        }
        Ok(self)
    }

    /// With a resolution: what is deeper than allowed by no more than this may or may not be found. One below what rounding adds is taken as that. The default is 0.001 mm.
    ///
    /// # Errors
    /// If it is not a length above 0 or 0.
    pub fn resolution(mut self, resolution: f64) -> Result<Verifier<'a>, VerifyError> {
        if !(0.0..f64::INFINITY).contains(&resolution) {
            return Err(VerifyError::Tolerance { tolerance: resolution });
        }
        self.resolution = resolution;
        Ok(self)
    }

    /// With another [budget](Certifier::budget) of each question.
    #[must_use]
    pub fn budget(mut self, budget: u32) -> Verifier<'a> {
        self.budget = budget;
        self
    }

    /// The tool's card: a finding's surface is a place in its list.
    pub fn card(&self) -> &Card {
        self.tool.card()
    }

    /// Checks a program: its first stop, and every motion from one stop to the next. With the feature
    /// `parallel` on all cores; the findings are the same, in the program's order.
    ///
    /// # Errors
    /// If the program states another unit than the part's, or another cutter than the tool, or if its poses have no
    /// spin and the tool is a solid without an axis.
    pub fn check(&self, program: &Program) -> Result<Report, VerifyError> {
        program.check_unit(self.facets.unit())?;
        program.check_poses(self.tool.card())?;
        program.check_cutter(self.tool.card(), self.facets.unit())?;
        let stops = &program.stops;
        let certifier = Certifier::new(self.facets, self.tool)?;
        let surfaces = 0..self.allowed.len();
        let greatest = |surface| certifier.greatest_depth(surface).unwrap_or(f64::INFINITY);
        let greatest: Vec<f64> = surfaces.map(greatest).collect();
        let found = cores::ranges(stops.len(), TOGETHER, |range| {
            let mut checker = Checker::new(self, &greatest)?;
            Ok(range.flat_map(|stop| checker.stop(stops, stop)).collect::<Vec<_>>())
        });
        let found: Vec<_> = found.into_iter().collect::<Result<_, VerifyError>>()?;
        let findings: Vec<Finding> = found.into_iter().flatten().collect();
        Ok(Report {
            motions: stops.len().saturating_sub(1),
            approach: self.approach(stops, &findings)?,
            findings,
            inside_known: self.facets.has_inside(),
            nothing_restricted: !self.restricts(stops, &greatest),
        })
    }

    /// Returns whether a surface of the tool could be deeper than it may be, or nearer, given how deep each can be
    /// at all.
    fn restricts(&self, stops: &[Stop], greatest: &[f64]) -> bool {
        let modes =
            [false, true].into_iter().filter(|mode| stops.iter().any(|stop| stop.rapid == *mode));
        modes
            .flat_map(|rapid| self.limits(rapid).into_iter().zip(greatest))
            .any(|(limit, greatest)| limit < 0.0 || limit + self.resolution < *greatest)
    }

    /// Returns the motion from one pose to another: of a tool of revolution the spin is none of it.
    fn motion(&self, from: &Pose, to: &Pose) -> Result<Motion, MotionError> {
        match self.tool.card().shape {
            Shape::Revolved => Motion::new(from, to),
            Shape::Solid { .. } => Motion::with_spin(from, to),
        }
    }

    /// How deep each surface may be.
    fn limits(&self, rapid: bool) -> Vec<f64> {
        let limit = |allowed: &Option<f64>| {
            let allowed = allowed.unwrap_or(self.tolerance);
            if rapid { allowed.min(self.tolerance) } else { allowed }
        };
        self.allowed.iter().map(limit).collect()
    }
}

/// Checks one motion after the other.
struct Checker<'a> {
    of: &'a Verifier<'a>,
    /// In feed, and in rapid traverse.
    modes: [Mode<'a>; 2],
}

/// A certifier that goes by what is allowed.
struct Mode<'a> {
    certifier: Certifier<'a>,
    limits: Vec<f64>,
    /// The greatest depth that each surface can have.
    greatest: &'a [f64],
}

/// What is no less deep than this part of the greatest depth that there is goes right through.
const THROUGH: f64 = 0.98;

impl<'a> Checker<'a> {
    fn new(of: &'a Verifier<'a>, greatest: &'a [f64]) -> Result<Checker<'a>, VerifyError> {
        let mode = |rapid| {
            let limits = of.limits(rapid);
            let mut certifier = Certifier::new(of.facets, of.tool)?.budget(of.budget);
            for (surface, limit) in of.tool.card().surfaces.iter().zip(&limits) {
                certifier = certifier.allow(&surface.name, *limit)?;
            }
            Ok::<_, VerifyError>(Mode { certifier, limits, greatest })
        };
        Ok(Checker { of, modes: [mode(false)?, mode(true)?] })
    }

    /// What there is to say of the way to a stop.
    fn stop(&mut self, stops: &[Stop], index: usize) -> Vec<Finding> {
        let to = stops[index];
        let before = index.checked_sub(1).map(|before| stops[before]);
        let from = before.map_or(to.pose, |before| before.pose);
        let finding = |part: f64, pose: Pose, kind: Kind| Finding {
            stop: index,
            line: to.line,
            from: before.map(|before| before.line),
            rapid: to.rapid,
            part,
            pose,
            kind,
        };
        let mode = &mut self.modes[usize::from(to.rapid)];
        let mut findings = Vec::new();
        // Where the way is not known, the stop itself is.
        let motion = self.of.motion(&from, &to.pose).or_else(|error| {
            findings.push(finding(1.0, to.pose, Kind::Ambiguous(error)));
            self.of.motion(&to.pose, &to.pose)
        });
        if let Ok(motion) = motion {
            for (part, kind) in mode.motion(&motion, self.of.resolution) {
                findings.push(finding(part, motion.pose(part), kind));
            }
        }
        findings
    }
}

impl Mode<'_> {
    /// What a motion does that it may not, and at which part of the way.
    fn motion(&mut self, motion: &Motion, resolution: f64) -> Vec<(f64, Kind)> {
        let swept = self.certifier.sweep_clear(motion, resolution);
        if matches!(swept, Sweep::Clear | Sweep::SurfaceOnly) {
            return Vec::new();
        }
        let mut found = Vec::new();
        let mut inside = Vec::new();
        for (surface, allowed) in self.limits.iter().copied().enumerate() {
            if allowed == f64::INFINITY {
                continue;
            }
            match self.certifier.deepest_along(surface, motion, allowed, resolution) {
                Along::Within => (),
                Along::Deeper { at, depth: [low, high], most, witness } if low < 0.0 => {
                    let [from, to, least] = [-high, -low, -most].map(|distance| distance.max(0.0));
                    let (margin, distance) = (-allowed, [from, to]);
                    found.push((at, Kind::Near { surface, margin, distance, least, witness }));
                }
                Along::Deeper { at, depth, most, witness } => {
                    let through = depth[1] >= THROUGH * self.greatest[surface];
                    found
                        .push((at, Kind::Deep { surface, allowed, depth, most, through, witness }));
                }
                Along::Inside => inside.push(surface),
                Along::Undecided(at) => found.push((at, Kind::Undecided { surface })),
            }
        }
        if let (Sweep::Inside(surface), []) = (swept, &inside[..]) {
            inside.push(surface);
        }
        if !inside.is_empty() && self.certifier.is_buried(&motion.pose(0.0)) == Some(true) {
            found.push((0.0, Kind::Inside { surface: None }));
        } else {
            let of = |surface| (0.0, Kind::Inside { surface: Some(surface) });
            found.extend(inside.into_iter().map(of));
        }
        found
    }
}

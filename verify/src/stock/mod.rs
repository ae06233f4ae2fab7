//! Stock in process: the material that is left after each motion of a program.
//!
//! ```text
//! mesh or box ──winding numbers──▶ lattice of points ──▶ point BVH
//!                                                          │ advance(tool, motion), motion by motion
//!        contacts of surfaces that must not touch ◀────────┤ removes the points in cutting surfaces
//!                                                          ▼
//!     remaining mesh, comparison with the finished part ◀── points that are left
//! ```
//!
//! A stock is the set of the nodes of a regular lattice that are inside it. A feed motion removes those that
//! come into a cutting surface of the tool. Points in any other surface, and points in any surface in rapid
//! traverse, are [contacts](StockContact).
//!
//! **Resolution.** A node of a lattice with spacing h is the nearest one to the points of a cube with edges
//! of length h, its cell, and the corners of a cube are √3/2 h from its centre. Every point of space is thus
//! within √3/2 h of a node, and every ball of material with a larger radius contains one. A tool that enters
//! a smaller piece of material only is not found. [`Stock::missed_ball_radius`] returns this radius, with the
//! rounding of stored points added.
//!
//! **Sampling.** A motion is sampled at equal times, so closely that no point of the tool travels more than a
//! [step](Stock::step) from one sample to the next: a quarter of the spacing. From any time of the motion to
//! the nearest sample, no point of the tool travels more than half a step. Let `e` be half a step times the
//! Lipschitz constant of the tool's depth, which is 1 for a tool with a profile. A point that is deeper than
//! `e` at any time is farther than half a step from the tool's surface, and hence inside at the nearest
//! sample. It follows:
//!
//! - Nothing is removed that is not cut: a point that is removed was inside a cutting surface at a sample.
//!   The exception are contacts that have ended, see below.
//! - A point that is left was at no time of a feed motion deeper than `e` in the tool, unless its nearest
//!   surface at the sample does not cut. Points that were cut less deeply may be left, as may those between
//!   two samples of a tool that is thinner than a step along its motion. A tolerance below `e` can report
//!   such points on a later motion, even one back over the same poses; a larger one does not report them
//!   there.
//! - The depth of a contact is that of a point at a sample. At other times, a point is at most `e` deeper
//!   than at the nearest sample.
//! - A contact is found if, at some time of a motion, a ball of material that is larger than the missed ball
//!   is all deeper than the tolerance plus `e` in a surface that must not touch, and nearer to that surface
//!   than to any other by a step. The exception is material of contacts that have ended.
//!
//! A part of a tool that is thinner than the points are apart passes between them: [`Stock::found_layer_of`] takes it into
//! account.
//!
//! For a tool without a Lipschitz constant (a file with formulas, of which no bound is proved), nothing is
//! known between samples.
//!
//! **Contacts.** Points in contact stay while the tool is around them, so that depths do not depend on how a
//! path is divided into motions. They are removed at the end of the first motion after which they are outside
//! the tool, or when the tool changes: the rest of the program is judged as if that material had been cut. A
//! motion reports a surface only if it touches new points or goes deeper than before, and marks a contact
//! that goes on as [continued](StockContact::continued). A crash that lasts a thousand motions is thus one
//! contact that is not continued and those that follow it. Points within the tolerance are neither reported
//! nor removed.

mod advance;
mod error;
mod lattice;
mod remaining;

pub use advance::{MotionMode, StockContact};
pub use error::StockError;
pub use remaining::{DeviationPoint, PartComparison};

use advance::OpenContacts;
use lattice::{BitSet, Lattice, QuarterTurn, nodes_inside};
use nalgebra::{Point3, Vector3};
use std::fmt;
use touchoff::mesh::{LARGEST_COORDINATE, Mesh};
use touchoff::tool::{
    DepthBounds, Evaluations, Outputs, PointBatch, ProfileSegment, Segment, Tool,
};
use touchoff::{Cloud, InsidePoint, InsideQuery, Interval, Level, PointBvh, TriangleId, Unit};

/// The greatest number of points of a stock. A point takes some 34 bytes, and 110 while the stock is built: at
/// most 2.2 gigabytes.
pub const MAX_POINTS: usize = 20_000_000;

/// The step as a fraction of the spacing. Its half, the error of sampling, is then a seventh of the radius
/// below which balls of material are missed.
const STEP_FRACTION: f64 = 0.25;

/// The material that is left, as the points of a lattice.
///
/// Lengths are in the unit of the mesh or box that the stock was built from, points in its frame.
///
/// ```
/// use nalgebra::{Point3, Vector3};
/// use touchoff_verify::stock::{MotionMode, Stock};
/// use touchoff::{Motion, Pose, Unit};
///
/// touchoff::tool! {
///     tool Mill "6 mm end mill" {
///         units mm;
///         profile {
///             start (0, 0);
///             line to (3, 0), (3, 10)  as flute cutting;
///             line to (3, 30), (0, 30) as shank;
///         }
///         niceness cutting: 1;
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = [Point3::new(0.0, 0.0, -20.0), Point3::new(40.0, 20.0, 0.0)];
/// let mut stock = Stock::from_box(corners, 0.5, Unit::Millimetre)?;
/// let pose = |x: f64, z: f64| Pose::from_axis(Point3::new(x, 10.0, z), Vector3::z());
/// // A slot 5 mm deep: the flute cuts, and nothing else touches the material.
/// let motion = Motion::new(&pose(-5.0, -5.0)?, &pose(45.0, -5.0)?)?;
/// let travel = stock.max_travel(&Mill, &motion);
/// let contacts = stock.advance(&Mill, &|time| motion.pose(time), travel, MotionMode::Feed, 0.1)?;
/// assert!(contacts.is_empty());
/// assert!((stock.volume() - (40.0 * 20.0 * 20.0 - 40.0 * 6.0 * 5.0)).abs() < 200.0);
/// // A rapid motion through the wall of the slot touches material.
/// let outside = Pose::from_axis(Point3::new(20.0, 30.0, -5.0), Vector3::z())?;
/// let motion = Motion::new(&pose(20.0, -5.0)?, &outside)?;
/// let travel = stock.max_travel(&Mill, &motion);
/// let contacts = stock.advance(&Mill, &|time| motion.pose(time), travel, MotionMode::Rapid, 0.1)?;
/// assert_eq!(contacts.len(), 1);
/// # Ok(()) }
/// ```
pub struct Stock {
    lattice: Lattice,
    unit: Unit,
    /// The nodes that were inside at the beginning.
    initial: BitSet,
    /// The points that are left; their ids are the indices of the nodes.
    tree: PointBvh,
    contacts: OpenContacts,
    query: InsideQuery,
    /// Points inside the tool at one sample.
    inside: Vec<InsidePoint>,
}

/// The points that are left of a stock: the stock of a later set-up.
#[derive(Clone, Debug, PartialEq)]
pub struct RemainingPoints {
    lattice: Lattice,
    nodes: BitSet,
    unit: Unit,
}

impl RemainingPoints {
    /// Returns the distance of neighbouring points.
    pub fn spacing(&self) -> f64 {
        self.lattice.spacing()
    }

    /// Returns the corners of the box of what remains: half a spacing beyond the points.
    pub(crate) fn bounds(&self) -> [Point3<f64>; 2] {
        let half = Vector3::repeat(0.5 * self.spacing());
        let none = [f64::INFINITY, f64::NEG_INFINITY].map(|value| Point3::from([value; 3]));
        self.nodes.iter().fold(none, |[low, high], node| {
            let point = Point3::from(self.lattice.position(node));
            [low.inf(&(point - half)), high.sup(&(point + half))]
        })
    }

    /// Returns the points in the frame of another set-up, in which the frame of this one has its origin and the directions of its
    /// axes x and z. The points stay those of a lattice, and so nothing is sampled again, if these are directions of coordinate
    /// axes.
    ///
    /// # Errors
    /// [`StockError::Turn`] if they are not, and [`StockError::Resolution`] if the spacing is too small for the coordinates there.
    pub fn placed(
        &self,
        origin: Point3<f64>,
        x: [f64; 3],
        z: [f64; 3],
    ) -> Result<RemainingPoints, StockError> {
        let turn = QuarterTurn::new(x, z).ok_or(StockError::Turn { x, z })?;
        let lattice = self.lattice.placed(&turn, origin)?;
        let mut nodes = BitSet::new(lattice.len());
        for node in self.nodes.iter() {
            nodes.insert(self.lattice.placed_index(&lattice, &turn, node));
        }
        Ok(RemainingPoints { lattice, nodes, unit: self.unit })
    }
}

impl fmt::Debug for Stock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Stock")
            .field("lattice", &self.lattice)
            .field("unit", &self.unit)
            .field("points", &self.tree.len())
            .finish_non_exhaustive()
    }
}

/// Largest number of places along a profile at which its thickness is tried.
const MAX_PLACES: f64 = 20_000.0;

impl Stock {
    /// Creates a stock from the inside of a mesh. A point of the lattice on the mesh counts as the point just
    /// above it.
    ///
    /// # Errors
    /// If the mesh has no inside or is inside out somewhere, if the spacing is not a length above 0 or too
    /// small for the coordinates, or if there are no points, more than [`MAX_POINTS`], or more than 2³² − 1
    /// nodes in the box around the mesh.
    pub fn from_mesh(mesh: &Mesh, spacing: f64) -> Result<Stock, StockError> {
        if !mesh.diagnostics().is_solid() {
            return Err(StockError::NoInside { what: "stock" });
        }
        let lattice = Lattice::new(mesh.bounds(), spacing)?;
        let triangles = mesh.corners().map(|corners| corners.map(|corner| corner.into()));
        let inside = nodes_inside(triangles, &lattice)?;
        Stock::new(lattice, inside, mesh.unit())
    }

    /// Creates a stock from a box, given by its lowest and its highest corner in `unit`. If its sides are
    /// multiples of the spacing, the cells of the points fill it exactly.
    ///
    /// # Errors
    /// If the corners do not bound a box, or as for [`Stock::from_mesh`].
    pub fn from_box(
        [low, high]: [Point3<f64>; 2],
        spacing: f64,
        unit: Unit,
    ) -> Result<Stock, StockError> {
        for (axis, name) in ['x', 'y', 'z'].into_iter().enumerate() {
            let (low, high) = (low[axis], high[axis]);
            if !(-LARGEST_COORDINATE <= low && low < high && high <= LARGEST_COORDINATE) {
                return Err(StockError::Box { axis: name, low, high });
            }
        }
        let lattice = Lattice::new([low, high], spacing)?;
        check_count(lattice.len(), spacing)?;
        let mut inside = BitSet::new(lattice.len());
        (0..lattice.len()).for_each(|node| {
            inside.insert(node);
        });
        Stock::new(lattice, inside, unit)
    }

    fn new(lattice: Lattice, initial: BitSet, unit: Unit) -> Result<Stock, StockError> {
        check_count(initial.len(), lattice.spacing())?;
        let count = initial.len();
        // A node of the lattice is a point whose triangle id is its index; normals and weights are not used.
        let cloud = Cloud::new(
            initial.iter().map(|node| Point3::from(lattice.position(node))).collect(),
            vec![Vector3::z(); count],
            initial.iter().map(|node| TriangleId(node as u32)).collect(),
            vec![1.0; count],
            unit,
        )?;
        Ok(Stock {
            tree: PointBvh::new(&cloud),
            lattice,
            unit,
            initial,
            contacts: OpenContacts::default(),
            query: InsideQuery::default(),
            inside: Vec::new(),
        })
    }

    /// Creates a stock from the points that are left of another one.
    ///
    /// # Errors
    /// [`StockError::Empty`] if there are none.
    pub fn from_points(points: &RemainingPoints) -> Result<Stock, StockError> {
        Stock::new(points.lattice.clone(), points.nodes.clone(), points.unit)
    }

    /// Returns the points that are left.
    pub fn remaining_points(&self) -> RemainingPoints {
        let (lattice, nodes) = (self.lattice.clone(), self.remaining());
        RemainingPoints { lattice, nodes, unit: self.unit }
    }

    /// Returns the distance of neighbouring points, which is the edge of their cells.
    pub fn spacing(&self) -> f64 {
        self.lattice.spacing()
    }

    /// Returns the unit of length.
    pub fn unit(&self) -> Unit {
        self.unit
    }

    /// Returns the number of points that are left, each of which stands for a cell.
    pub fn len(&self) -> usize {
        self.tree.len()
    }

    /// Returns whether nothing is left.
    pub fn is_empty(&self) -> bool {
        self.tree.is_empty()
    }

    /// Returns the number of points at the beginning.
    pub fn initial_len(&self) -> usize {
        self.initial.len()
    }

    /// Returns the volume of the cells that are left, in the cube of the unit. It differs from the volume of
    /// the material by at most the volume within √3/2 of a spacing of its surface, and for smooth surfaces by
    /// far less.
    pub fn volume(&self) -> f64 {
        self.len() as f64 * self.spacing().powi(3)
    }

    /// Returns the radius above which every ball of material contains a point: √3/2 of the spacing, and the
    /// greatest distance of a point as it is stored from its node.
    pub fn missed_ball_radius(&self) -> f64 {
        // A node is the origin plus a multiple of the spacing, each rounded.
        let node = 2.0 * f64::EPSILON * self.lattice.largest_coordinate();
        3f64.sqrt() * (0.5 * self.spacing() + node + self.tree.rounding())
    }

    /// Returns the thickness from which a layer of material is found for certain, where a surface that must not touch it passes
    /// through it: the diameter of the missed ball, plus the tolerance and the error of sampling by which a point has to be
    /// deeper. It holds for a tool with a profile.
    pub fn found_layer(&self, tolerance: f64) -> f64 {
        2.0 * self.missed_ball_radius() + tolerance + 0.5 * self.step()
    }

    /// Returns the thickness from which a layer of material is found for certain, however it lies, by a tool of which no surface may
    /// touch it, as in rapid traverse; `None` if the tool is nowhere wide enough for the points.
    ///
    /// A layer is found if a ball about the tool's axis lies in it that is not missed, and whose points are deeper in the tool
    /// than the tolerance and the error of sampling. It is thicker than [`Stock::found_layer`] by the thin parts of the tool: a
    /// pointed or a thin end, or a neck, which the layer may surround. The balls that are tried have centres an eighth of their
    /// radius apart, or farther on a tool of more than 100,000 of them.
    pub fn found_layer_of(&self, tool: &dyn Tool, tolerance: f64) -> Option<f64> {
        let info = tool.info();
        let DepthBounds { lower_slope: Some(slope), lipschitz: Some(lipschitz), .. } = info.depth
        else {
            return None;
        };
        let unit = info.unit.factor_to(self.unit);
        let missed = self.missed_ball_radius();
        // Points at this distance from the surface are deep enough to be found.
        let needed = missed + (tolerance + 0.5 * lipschitz * self.step()) / slope;
        let Interval { low, high } = info.reach();
        let (low, high) = (low * unit, high * unit);
        // No ball that fits has its centre nearer to an end; the excess is above rounding.
        let end = (1.0 + 1e-9) * needed;
        let (first, travel) = (low + end, high - low - 2.0 * end);
        if travel < 0.0 {
            return None;
        }
        if self.has_thin_rim(tool, needed) {
            return None;
        }
        let count = (8.0 * travel / needed).ceil().clamp(1.0, 100_000.0);
        let centre = |index: usize| first + travel * (index as f64 / count);
        let mut points = PointBatch::default();
        for index in 0..=count as usize {
            points.push([0.0, 0.0, centre(index) / unit]);
        }
        let outputs = Outputs { depth: true, ..Outputs::INSIDE };
        let mut evaluations = Evaluations::default();
        tool.evaluate(Level::new(), outputs, &points, unit, &mut evaluations);
        let mut thickness = self.found_layer(tolerance);
        let mut last = None;
        for index in evaluations.inside_indices() {
            if evaluations.depth[index] * unit / lipschitz < needed {
                continue;
            }
            let centre = centre(index);
            // The thickest layer without a ball ends at the top of the first, lies about two in a row, or begins at the
            // bottom of the last.
            let layer = match last {
                None => centre - low + missed,
                Some(last) => centre - last + 2.0 * missed,
            };
            thickness = thickness.max(layer);
            last = Some(centre);
        }
        last.map(|last| thickness.max(high - last + missed))
    }

    /// Returns whether a part of a tool with a profile stands out sideways, in which no ball of a radius fits, such as a disc or a collar:
    /// layers of material can surround it that no ball about the axis meets.
    ///
    /// Places along the profile are tried, a quarter of the radius apart, or farther on one of more than [`MAX_PLACES`]: whether the ball
    /// that touches it there from within is inside. An edge of 45° or more keeps balls away for less than 5 radii along both sides. A
    /// pointed end about the axis is left to the balls there.
    fn has_thin_rim(&self, tool: &dyn Tool, radius: f64) -> bool {
        let info = tool.info();
        let unit = info.unit.factor_to(self.unit);
        let radius = radius / unit;
        let outline: Vec<Segment> = info.outline.iter().map(ProfileSegment::geometry).collect();
        let length: f64 = outline.iter().map(Segment::length).sum();
        let step = (0.25 * radius).max(length / MAX_PLACES);
        let mut places = Vec::new();
        let mut points = PointBatch::default();
        for segment in &outline {
            let count = (segment.length() / step).ceil().max(1.0);
            for index in 0..count as usize {
                let place = segment.place((index as f64 + 0.5) / count);
                let ([d, z], [out, up]) = (place.point, place.outward());
                places.push((d, segment.length() / count));
                points.push([d - out * radius, 0.0, z - up * radius]);
            }
        }
        let outputs = Outputs { depth: true, ..Outputs::INSIDE };
        let mut evaluations = Evaluations::default();
        tool.evaluate(Level::new(), outputs, &points, 1.0, &mut evaluations);
        let mut fits = vec![false; places.len()];
        for index in evaluations.inside_indices() {
            fits[index] = evaluations.depth[index] >= (1.0 - 1e-6) * radius;
        }
        let mut run = 0.0;
        places.iter().zip(fits).any(|((from_axis, length), fits)| {
            run = if fits || *from_axis <= 2.0 * radius { 0.0 } else { run + length };
            run > 5.0 * radius
        })
    }

    /// Returns the step: no point of a tool travels farther between two samples of a motion.
    pub fn step(&self) -> f64 {
        STEP_FRACTION * self.spacing()
    }

    /// Returns the nodes that are left.
    fn remaining(&self) -> BitSet {
        let mut remaining = BitSet::new(self.lattice.len());
        // Removed points leave empty slots.
        for slot in (0..self.tree.slots()).filter(|slot| self.tree.has_point(*slot)) {
            remaining.insert(self.tree.triangle(slot).0 as usize);
        }
        remaining
    }
}

/// Fails for a number of points of 0 or more than [`MAX_POINTS`].
pub(crate) fn check_count(points: usize, spacing: f64) -> Result<(), StockError> {
    match points {
        0 => Err(StockError::Empty { spacing }),
        1..=MAX_POINTS => Ok(()),
        _ => {
            let coarser = 1.01 * spacing * (points as f64 / MAX_POINTS as f64).cbrt();
            Err(StockError::TooManyPoints { spacing, points, coarser })
        }
    }
}

#[cfg(test)]
mod tests;

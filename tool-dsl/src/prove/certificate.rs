//! What is proved about a tool: facts about its regions and their borders, and the bounds of depth that follow.

use crate::diagnostic::Statement;
use crate::expr::interval::{Cell, Interval, ZERO};

/// The relative tolerance within which both bounds must be 1 for depth to count as the distance, see
/// [`Certificate::is_exact`]. `c` of a distance is lowered by a tenth of it ([`slope::SLOPE_MARGIN`]).
const EXACT_TOLERANCE: f64 = 1e-8;

/// The facts proved about a tool.
#[derive(Clone, Debug)]
pub struct Certificate {
    /// The facts about each region.
    pub regions: Vec<RegionFacts>,
    /// The facts about each pair of neighbours and, for regions by hand, each curve that separates them.
    pub borders: Vec<Border>,
    /// The boxes where a proof did not finish.
    pub undecided: Vec<OpenProof>,
    /// The largest change of depth at points where several regions meet, and the largest amount by which it
    /// is below 0 inside, in the file's unit.
    pub tolerance: f64,
    /// The number of boxes examined.
    pub examined_boxes: usize,
    /// The least slope of the depth toward the surface.
    pub(super) min_slope: f64,
    /// The slack of all bounds, in the file's unit: `c · distance - slack ≤ depth ≤ L · distance + slack`,
    /// and depth changes by at most L times the length of a path plus the slack. It includes jumps of depth
    /// at points where regions meet that no curve joins. For a profile it is the greatest difference of depth
    /// from the distance. A value below 2^-95 of the tool's size counts as 0, since constants have 256 bits.
    pub slack: f64,
}

/// The facts proved about a region.
#[derive(Clone, Debug)]
pub struct RegionFacts {
    /// The region's share of the section's area, or of a solid's volume. It is estimated, not proved.
    pub share: f64,
    /// The range of depths, in the file's unit.
    pub depth: Interval,
    /// The range of the length of the depth's gradient.
    pub gradient_length: Interval,
    /// A point of a box in which that length has no bound, in the tool's frame, if there is such a box.
    pub steep_at: Option<[f64; 3]>,
    /// True if the depth is the distance to a line, a circle or a point, or the least of several.
    pub is_distance: bool,
    /// The range of magnitudes.
    pub magnitude: Interval,
    /// The range of niceness, before values below 0 are replaced by 0.
    pub niceness: Interval,
    /// True if niceness nowhere grows with depth, according to the product of both gradients, within 1e-9 of
    /// the product of their lengths. The tolerance is needed because a file's constants have few digits.
    pub niceness_never_rises: bool,
    /// The angle between the direction and the steepest descent of depth, in radians, if it is known
    /// anywhere.
    pub direction_error: Option<Interval>,
    /// The largest angle that is certain at a point, in radians. Present only where the direction is not that of steepest descent.
    pub oblique_witness: Option<CertainValue>,
    /// The largest rate at which niceness rises with depth at the points examined, per unit of depth.
    pub rising_witness: Option<CertainValue>,
    /// The boxes where the direction vanishes; there it is along z.
    pub singular_cells: Vec<Cell>,
    /// True if the direction is perpendicular to an axis that the region touches, so that it turns there by
    /// up to half a turn.
    pub turns_on_axis: bool,
    /// A bound of the difference between the computed depth and the exact value of its expression, in the
    /// file's unit.
    pub rounding_error: f64,
}

impl RegionFacts {
    pub(super) const NONE: RegionFacts = RegionFacts {
        share: 0.0,
        depth: ZERO,
        gradient_length: ZERO,
        steep_at: None,
        is_distance: false,
        magnitude: ZERO,
        niceness: ZERO,
        niceness_never_rises: true,
        direction_error: None,
        oblique_witness: None,
        rising_witness: None,
        singular_cells: Vec::new(),
        turns_on_axis: false,
        rounding_error: 0.0,
    };
}

/// A region and its neighbour, or the outside, where depth is 0. Of two regions, the one listed earlier is first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Pair {
    /// The index of the region.
    pub own: usize,
    /// That of its neighbour, `None` for the outside.
    pub other: Option<usize>,
}

/// A point of a border where depth jumps.
#[derive(Clone, Copy, Debug)]
pub struct JumpPoint {
    /// The point, in the tool's frame.
    pub point: [f64; 3],
    /// The depths on both sides of the border there.
    pub depths: [f64; 2],
}

/// A value that is certain at a point.
#[derive(Clone, Copy, Debug)]
pub struct CertainValue {
    /// The value.
    pub value: f64,
    /// The point, in the tool's frame.
    pub point: [f64; 3],
}

/// The facts proved about two neighbours, or about a region and the outside.
#[derive(Clone, Debug)]
pub struct Border {
    /// The two.
    pub sides: Pair,
    /// The difference of their depths on it, 0 if they agree exactly. The depth of the outside is 0.
    pub depth_jump: Interval,
    /// The difference of their magnitudes on it.
    pub magnitude_jump: Interval,
    /// The angle between their directions, in radians.
    pub direction_angle: Interval,
    /// The same angle where they meet on the surface, if they do.
    pub direction_angle_on_surface: Option<Interval>,
    /// The depths at which they meet.
    pub depth: Interval,
    /// A point of the tool's frame where depth jumps, with both depths, if one was found.
    pub jump_point: Option<JumpPoint>,
}

/// A box where a proof did not finish, and the statement to be proved.
#[derive(Clone, Debug)]
pub struct OpenProof {
    /// The box, in the tool's frame.
    pub cell: Cell,
    /// The statement.
    pub statement: Statement,
}

impl Border {
    /// Adds the facts of another border between the same two owners.
    pub fn merge(&mut self, other: &Border) {
        self.depth_jump = self.depth_jump.hull(other.depth_jump);
        self.magnitude_jump = self.magnitude_jump.hull(other.magnitude_jump);
        self.direction_angle = self.direction_angle.hull(other.direction_angle);
        self.direction_angle_on_surface =
            match (self.direction_angle_on_surface, other.direction_angle_on_surface) {
                (Some(a), Some(b)) => Some(a.hull(b)),
                (one, other) => one.or(other),
            };
        self.depth = self.depth.hull(other.depth);
        self.jump_point = self.jump_point.or(other.jump_point);
    }

    /// Returns whether depths agree exactly on the border. Otherwise it is a point where other regions lie
    /// between the two.
    pub fn has_equal_depths(&self) -> bool {
        self.depth_jump.high == 0.0
    }
}

impl Certificate {
    /// Returns whether depth is continuous and 0 on the surface, within [`Certificate::tolerance`].
    pub fn is_continuous(&self) -> bool {
        self.undecided.is_empty()
            && self.borders.iter().all(|border| border.depth_jump.high <= self.tolerance)
    }

    /// Returns `L`, if it is proved: depth is at most `L` times the distance to the surface, and changes by
    /// at most `L` times the length of a path, up to the [slack](Certificate::slack).
    pub fn lipschitz(&self) -> Option<f64> {
        let steepest =
            self.regions.iter().map(|region| region.gradient_length.high).fold(0.0, f64::max);
        // The slopes bound the changes within regions only; a jump would be a change along a path of no length.
        (self.is_continuous() && steepest.is_finite()).then_some(steepest)
    }

    /// Returns `c`, if it is proved: depth is at least `c` times the distance to the surface, up to the
    /// [slack](Certificate::slack).
    pub fn lower_slope(&self) -> Option<f64> {
        (self.is_continuous() && self.min_slope > 0.0).then_some(self.min_slope)
    }

    /// Returns whether depth is proved to be the distance to the surface, to a part in 10^8 and up to the
    /// [slack](Certificate::slack).
    pub fn is_exact(&self) -> bool {
        let bounds = [self.lipschitz(), self.lower_slope()];
        bounds.iter().all(|b| b.is_some_and(|b| (b - 1.0).abs() < EXACT_TOLERANCE))
    }
}

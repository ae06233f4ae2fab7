//! Offset curves of lines and arcs in a plane, and the corners between them.
//!
//! Points are in the coordinates of the plane (first axis, second axis), in millimetres. An offset d is to the left of the motion if it is
//! positive. The offset curve of a line is parallel to it, that of an arc of radius R is an arc of radius R − d about the same centre (R + d
//! if the arc is clockwise). Each begins and ends beside the ends of its motion: at p + d n for the end p and the normal n to the left.
//!
//! At an inside corner the tool goes from one offset curve to the next where they meet. If a corner would cut off more of a motion than it
//! has, the tool would move backwards and gouge, and the motion is refused: so do LinuxCNC (`move_endpoint_and_flush`,
//! `convert_straight_comp2` and `convert_arc_comp2` of its interpreter) and, by their interference check, Fanuc and Haas.

use crate::gcode::error::CompensationFault;
use nalgebra::Vector2;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A point or a direction in a plane.
pub(super) type Vector = Vector2<f64>;

/// Smallest radius of an offset curve, in millimetres.
const LEAST_RADIUS: f64 = 1e-7;
/// Length in millimetres, or angle in radians, up to which a corner may cut off more than there is: rounding.
const ROUNDING: f64 = 1e-7;

/// Shape of a path in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    Line,
    Arc {
        centre: Vector,
        /// The angle in radians, positive from the first axis to the second.
        sweep: f64,
    },
}

/// A motion along a line or an arc, and its offset curve.
#[derive(Clone, Debug)]
pub(super) struct Contour {
    /// Ends of the motion.
    ends: [Vector; 2],
    /// Directions of the motion at its ends.
    tangents: [Vector; 2],
    offset: f64,
    /// The offset curve, with its whole sweep.
    shape: Shape,
    /// Radii of the offset curve at its ends; of an arc whose radii differ a little, it is a spiral, too.
    radii: [f64; 2],
    /// Length of a line, or the angle of an arc.
    extent: f64,
    /// Parts that the corners at both ends cut off from it. Less than zero where one has lengthened a line.
    cut: [f64; 2],
}

/// The way of the tool around a corner.
#[derive(Clone, Debug)]
pub(super) struct Corner {
    /// End of the motion before.
    pub(super) end: Vector,
    /// Paths that are added to the motion before.
    pub(super) before: Vec<Leg>,
    /// A path that is added to the motion after. Motions across the plane between both are executed before it.
    pub(super) after: Option<Leg>,
    /// Start of the motion after.
    pub(super) start: Vector,
}

/// A path that a control adds at a corner.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leg {
    pub(super) end: Vector,
    pub(super) shape: Shape,
}

/// Form of the path around outside corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outside {
    /// An arc about the corner.
    Arc,
    /// Straight on, to where both paths meet. Above a turn of 90 degrees, straight on by the offset on both sides, and straight between.
    Straight,
    /// Straight from the end of one offset curve to the start of the next.
    Chord,
}

/// Kind of a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bend {
    /// The directions differ by no more than a tolerance.
    Tangent,
    Inside,
    Outside,
}

/// Returns a direction turned to the left by 90 degrees.
fn left(direction: Vector) -> Vector {
    Vector::new(-direction.y, direction.x)
}

/// Returns the angle from one direction to another, from −π to π.
fn angle(from: Vector, to: Vector) -> f64 {
    from.perp(&to).atan2(from.dot(&to))
}

impl Contour {
    /// Returns the contour of a motion between two points that differ, or of an arc.
    ///
    /// # Errors
    /// If the tool is inside an arc that is not larger than the offset.
    pub(super) fn new(
        ends: [Vector; 2],
        shape: Shape,
        offset: f64,
    ) -> Result<Contour, CompensationFault> {
        let cut = [0.0; 2];
        match shape {
            Shape::Line => {
                let way = ends[1] - ends[0];
                let extent = way.norm();
                let tangents = [way / extent; 2];
                Ok(Contour { ends, tangents, offset, shape, radii: [0.0; 2], extent, cut })
            }
            Shape::Arc { centre, sweep } => {
                let from_centre = ends.map(|end| end - centre);
                let tangents = from_centre.map(|way| left(way).normalize() * sweep.signum());
                let programmed = from_centre.map(|way| way.norm());
                let radii = programmed.map(|radius| radius - offset * sweep.signum());
                if radii.into_iter().any(|radius| radius < LEAST_RADIUS) {
                    let radius = programmed[0].min(programmed[1]);
                    return Err(CompensationFault::InsideArc { radius, offset: offset.abs() });
                }
                Ok(Contour { ends, tangents, offset, shape, radii, extent: sweep.abs(), cut })
            }
        }
    }

    /// Returns the contour of an arc on which the tool comes to its offset: it starts at the start of the programmed arc, and ends
    /// beside its end in the same direction (`convert_arc_comp1` of LinuxCNC's interpreter).
    ///
    /// # Errors
    /// As [`Contour::new`], and if there is no such arc.
    pub(super) fn entry_arc(
        ends: [Vector; 2],
        centre: Vector,
        sweep: f64,
        offset: f64,
    ) -> Result<Contour, CompensationFault> {
        let programmed = Contour::new(ends, Shape::Arc { centre, sweep }, offset)?;
        let (start, end) = (ends[0], programmed.beside(1));
        // The centre is on the normal at the end, as far from it as from the start.
        let (chord, normal) = (start - end, (centre - end).normalize());
        let slope = chord.dot(&normal);
        let radius = chord.norm_squared() / (2.0 * slope);
        if slope <= 1e-9 * chord.norm() || !radius.is_finite() {
            return Err(CompensationFault::EntryArc);
        }
        let centre = end + normal * radius;
        let turn = angle(start - centre, end - centre);
        // The arc of both that turns as the programmed one.
        let extent = if turn * sweep.signum() <= 0.0 { TAU - turn.abs() } else { turn.abs() };
        let shape = Shape::Arc { centre, sweep: extent * sweep.signum() };
        Ok(Contour { shape, radii: [radius; 2], extent, ..programmed })
    }

    /// Returns the end of the motion.
    pub(super) fn end(&self) -> Vector {
        self.ends[1]
    }

    /// Returns the point beside the start (0) or the end (1) of the motion.
    pub(super) fn beside(&self, end: usize) -> Vector {
        self.ends[end] + left(self.tangents[end]) * self.offset
    }

    /// Returns the path of the tool between two points of the offset curve.
    pub(super) fn path(&self, from: Vector, to: Vector) -> Shape {
        let Shape::Arc { centre, sweep } = self.shape else { return Shape::Line };
        let rest = (self.extent - self.cut[0] - self.cut[1]) * sweep.signum();
        let turn = angle(from - centre, to - centre);
        Shape::Arc { centre, sweep: turn + TAU * ((rest - turn) / TAU).round() }
    }

    /// Returns whether an arc turns from one point of the offset curve to another as a control does that knows its direction alone, and its
    /// full turns: by more than nothing, and by a full turn at most beyond these.
    pub(super) fn keeps_direction(&self, from: Vector, to: Vector) -> bool {
        let Shape::Arc { sweep: programmed, .. } = self.shape else { return true };
        let Shape::Arc { sweep, .. } = self.path(from, to) else { return true };
        let full_turns = TAU * ((programmed.abs() - ROUNDING) / TAU).floor().max(0.0);
        let rest = sweep * programmed.signum() - full_turns;
        rest > ROUNDING && rest < TAU + ROUNDING
    }

    /// Returns the curvature of the programmed motion at its start (0) or its end (1), positive to the left.
    fn curvature(&self, end: usize) -> f64 {
        match self.shape {
            Shape::Line => 0.0,
            Shape::Arc { sweep, .. } => {
                let radius = self.radii[end] + self.offset * sweep.signum();
                sweep.signum() / radius
            }
        }
    }

    /// Returns how far a point of the offset curve is behind its start or before its end, as [`Contour::extent`] counts: less than zero
    /// where a line does not reach it.
    fn cut_at(&self, end: usize, point: Vector) -> f64 {
        let Shape::Arc { centre, sweep } = self.shape else {
            let way = (point - self.beside(end)).dot(&self.tangents[end]);
            return if end == 0 { way } else { -way };
        };
        let [point, end_point] = [point, self.beside(end)].map(|place| place - centre);
        let turn = if end == 0 { angle(end_point, point) } else { angle(point, end_point) };
        let turn = turn * sweep.signum();
        if turn < -ROUNDING { turn + TAU } else { turn }
    }
}

/// Returns the kind of the corner between two motions, of which the second begins where the first ends, and the angle by which the tool
/// turns there, positive to the left. `tolerance` is an angle.
pub(super) fn bend(before: &Contour, after: &Contour, tolerance: f64) -> (Bend, f64) {
    let turn = angle(before.tangents[1], after.tangents[0]);
    let side = after.offset.signum();
    if turn.abs() <= tolerance {
        return (Bend::Tangent, turn);
    }
    // The curvatures decide on which side of the first motion the second one is, where it turns back.
    let is_inside = match turn.abs() > PI - tolerance {
        true => side * (before.curvature(1) + after.curvature(0)) < 0.0,
        false => side * turn > 0.0,
    };
    match is_inside {
        true => (Bend::Inside, turn),
        false if side * turn > 0.0 => (Bend::Outside, turn - TAU * side),
        false => (Bend::Outside, turn),
    }
}

impl Contour {
    /// Returns whether the corners at both ends leave something of the offset curve, which keeps its direction then.
    pub(super) fn is_kept(&self) -> bool {
        self.cut[0] + self.cut[1] <= self.extent + ROUNDING
    }
}

/// Returns the way through a place where one motion ends and the next begins.
pub(super) fn at(place: Vector) -> Corner {
    Corner { end: place, before: Vec::new(), after: None, start: place }
}

/// Returns the way around an outside corner with a turn. `stands_between` is set if there are motions across the plane in it.
///
/// # Errors
/// If it is open where these motions are executed.
pub(super) fn around(
    before: &mut Contour,
    after: &mut Contour,
    turn: f64,
    form: Outside,
    stands_between: bool,
) -> Result<Corner, CompensationFault> {
    let (end, start) = (before.beside(1), after.beside(0));
    let [direction, next] = [before.tangents[1], after.tangents[0]];
    let line = |end: Vector| Leg { end, shape: Shape::Line };
    match form {
        Outside::Arc => {
            let shape = Shape::Arc { centre: after.ends[0], sweep: turn };
            let arc = Leg { end: start, shape };
            Ok(Corner { end, before: Vec::new(), after: Some(arc), start })
        }
        Outside::Chord => Ok(Corner { end, before: Vec::new(), after: Some(line(start)), start }),
        Outside::Straight => {
            let (first, second) = if turn.abs() <= FRAC_PI_2 + ROUNDING {
                let beyond = direction * (after.offset.abs() * (0.5 * turn.abs()).tan());
                (end + beyond, end + beyond)
            } else if stands_between {
                return Err(CompensationFault::MotionInCorner);
            } else {
                let beyond = after.offset.abs();
                (end + direction * beyond, start - next * beyond)
            };
            // A line goes straight on. An arc is followed by a line along its tangent, or begins after one.
            let mut added = Vec::new();
            let end = match before.shape {
                Shape::Line => {
                    before.cut[1] = -(first - end).norm();
                    first
                }
                Shape::Arc { .. } => {
                    added.push(line(first));
                    end
                }
            };
            if second != first {
                added.push(line(second));
            }
            let (after, start) = match after.shape {
                Shape::Line => {
                    after.cut[0] = -(start - second).norm();
                    (None, second)
                }
                Shape::Arc { .. } => (Some(line(start)), start),
            };
            Ok(Corner { end, before: added, after, start })
        }
    }
}

/// Returns the way through an inside corner: to the point nearest to it at which the offset curves meet. Both motions lose what is beyond.
/// `None` if the curves do not meet, or if the motion before is shorter than what its two corners cut off. If the next corner can
/// lengthen the motion after (`is_lengthened`), a line may be shorter than what this corner cuts off: that corner decides.
pub(super) fn meet(
    before: &mut Contour,
    after: &mut Contour,
    is_lengthened: bool,
) -> Option<Corner> {
    let corner = after.ends[0];
    let longest = match after.shape {
        Shape::Line if is_lengthened => f64::INFINITY,
        _ => after.extent + ROUNDING,
    };
    let reached = meetings(before, after).into_iter().filter_map(|place| {
        let cut = [before.cut_at(1, place), after.cut_at(0, place)];
        let before_length = before.extent - before.cut[0].min(0.0);
        let is_on_both = (-ROUNDING..=before_length + ROUNDING).contains(&cut[0])
            && (-ROUNDING..=longest).contains(&cut[1]);
        is_on_both.then_some((place, cut.map(|cut| cut.max(0.0))))
    });
    let (place, cut) = reached.min_by(|(first, _), (second, _)| {
        (first - corner).norm().total_cmp(&(second - corner).norm())
    })?;
    (before.cut[1], after.cut[0]) = (cut[0], cut[1]);
    before.is_kept().then(|| at(place))
}

/// Returns the points at which two offset curves meet, extended beyond their ends.
fn meetings(before: &Contour, after: &Contour) -> Vec<Vector> {
    let (end, start) = (before.beside(1), after.beside(0));
    let [direction, next] = [before.tangents[1], after.tangents[0]];
    match (before.shape, after.shape) {
        (Shape::Line, Shape::Line) => {
            // Both are as far from the corner, so that they meet on the bisector of the normals.
            let normals = left(direction) + left(next);
            let scale = 1.0 + direction.dot(&next);
            let place = after.ends[0] + normals * (after.offset / scale);
            if scale > 0.0 { vec![place] } else { Vec::new() }
        }
        (Shape::Line, Shape::Arc { centre, .. }) => {
            line_and_circle(end, direction, centre, after.radii[0])
        }
        (Shape::Arc { centre, .. }, Shape::Line) => {
            line_and_circle(start, next, centre, before.radii[1])
        }
        (Shape::Arc { centre: first, .. }, Shape::Arc { centre: second, .. }) => {
            let way = second - first;
            let distance = way.norm();
            let [radius, other] = [before.radii[1], after.radii[0]];
            if distance == 0.0 {
                return Vec::new();
            }
            let along = 0.5 * (distance + (radius - other) * (radius + other) / distance);
            let axis = way / distance;
            across(first + axis * along, left(axis), radius, along)
        }
    }
}

/// Returns the points at which a line through a point meets a circle.
fn line_and_circle(point: Vector, direction: Vector, centre: Vector, radius: f64) -> Vec<Vector> {
    let foot = point + direction * (centre - point).dot(&direction);
    across(foot, direction, radius, (foot - centre).norm())
}

/// Returns the ends of a chord of a circle by its middle and its direction, with the distance of the middle from the centre.
fn across(middle: Vector, direction: Vector, radius: f64, distance: f64) -> Vec<Vector> {
    let squared = (radius - distance) * (radius + distance);
    if squared < 0.0 {
        return Vec::new();
    }
    [-1.0, 1.0].map(|side| middle + direction * (side * squared.sqrt())).to_vec()
}

//! Force and torque by adaptive quadrature over a mesh's triangles. Pieces of the triangles that the tool reaches are
//! divided into quarters until the estimated error of the sums is small enough.
//!
//! The value of a piece is the evaluation at its centroid times its area. Its error is the difference to the sum of its
//! quarters. If all of them are inside, the error falls as the square of their size: the sum is then extrapolated by a
//! third of the difference (Richardson), and a third of it is the error. A piece whose centroid is outside may hide
//! some force. The bound for that follows from the tool's clearance, and a tenth of the bound counts as its error.
//!
//! These errors control the refinement. As an estimate for the whole sum they are far too large, since errors of
//! opposite sign do not cancel. The accuracy of a sum is its change since a quarter of the pieces had been evaluated.
//! An error inversely proportional to the number of pieces leaves a third of that change, and an error that falls
//! faster leaves less. The remainder is a reserve for errors that fluctuate.

use nalgebra::{Point3, Vector3, Vector6};
use rayon::prelude::*;
use touchoff::tool::{Evaluations, LANES, Outputs, PointBatch};
use touchoff::{Level, Mesh, Pose, Tool, TriangleId};

/// Triangles of a part with bounding balls, and the tool that reaches some of them.
pub(super) struct Quadrature<'a> {
    tool: &'a dyn Tool,
    /// A tool of the same solid whose clearance is known.
    clearance_tool: &'a dyn Tool,
    /// The tool's unit of length, in the part's unit.
    length: f64,
    faces: Vec<Face>,
}

struct Face {
    corners: [Point3<f64>; 3],
    normal: Vector3<f64>,
    centre: Point3<f64>,
    radius: f64,
}

/// Termination criteria.
#[derive(Clone, Copy, Debug)]
pub(super) struct StopCriteria {
    /// The sum of the errors, which overestimate by far, relative to force and torque at which the refinement ends.
    pub(super) relative_error: f64,
    /// The number of evaluated pieces after which the refinement ends.
    pub(super) max_pieces: usize,
}

/// The sums over the triangles at a pose, in the world frame; the torque is about the tip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sums {
    /// The force.
    pub(super) force: Vector3<f64>,
    /// The torque.
    pub(super) torque: Vector3<f64>,
    /// The changes of force and torque since a quarter of the pieces had been evaluated.
    pub(super) change: [f64; 2],
}

type Corners = [Vector3<f64>; 3];

/// A piece of a face, in the tool's frame and unit.
#[derive(Clone, Copy)]
struct Piece {
    corners: Corners,
    face: u32,
    /// Force and torque in the tool's frame.
    value: Vector6<f64>,
    inside: bool,
    /// Estimate of the force that the piece may hide.
    hidden: f64,
}

/// The quarters of a piece, their extrapolated sum, and the errors of force and torque.
struct QuarteredPiece {
    pieces: [Piece; QUARTERS],
    value: Vector6<f64>,
    error: [f64; 2],
}

const QUARTERS: usize = 4;
/// Share of the bound on a hidden force that counts as error: on average, far less than the bound is hidden.
const HIDDEN_SHARE: f64 = 0.1;
/// Minimum number of successive sums, the first over the initial pieces. Their change is the measure of accuracy.
const MIN_ROUNDS: usize = 4;
/// Largest radius of initial pieces, as a share of the tool's largest radius. Longer ones are divided before any
/// evaluation.
const MAX_PIECE_RADIUS: f64 = 0.05;
/// Lever arm, as a share of the tool's largest radius, that sets the lower limit of the torque that errors are relative
/// to.
const MIN_LEVER_ARM: f64 = 0.2;

/// Buffers for evaluations.
#[derive(Default)]
struct Buffers {
    points: PointBatch,
    evaluation: Evaluations,
    evaluated: usize,
}

impl<'a> Quadrature<'a> {
    /// Collects the faces of a mesh. `clearance_tool` is a tool of the same solid that has a profile, so that its
    /// clearance is known.
    pub(super) fn new(
        mesh: &Mesh,
        tool: &'a dyn Tool,
        clearance_tool: &'a dyn Tool,
    ) -> Quadrature<'a> {
        let face = |id: u32| {
            let (corners, normal) = (mesh.triangle(TriangleId(id)), mesh.normal(TriangleId(id))?);
            let centre = Point3::from(corners.iter().map(|c| c.coords).sum::<Vector3<f64>>() / 3.0);
            let radius =
                corners.map(|corner| (corner - centre).norm()).into_iter().fold(0.0, f64::max);
            Some(Face { corners, normal, centre, radius })
        };
        let faces = (0..mesh.triangles().len() as u32).filter_map(face).collect();
        Quadrature { tool, clearance_tool, length: tool.info().unit.factor_to(mesh.unit()), faces }
    }

    /// Returns the sums at several poses, computed in parallel.
    pub(super) fn sums_at_all_poses(&self, poses: &[Pose], criteria: StopCriteria) -> Vec<Sums> {
        poses.par_iter().map(|pose| self.sums(pose, criteria)).collect()
    }

    /// Returns the sums at a pose.
    pub(super) fn sums(&self, pose: &Pose, criteria: StopCriteria) -> Sums {
        let mut buffers = Buffers::default();
        let mut active = self.pieces_near(pose);
        self.evaluate(pose, &mut active, &mut buffers);
        let (mut settled, mut error) = (Vector6::zeros(), [0.0; 2]);
        let coarse = active.iter().map(|piece| piece.value).sum::<Vector6<f64>>();
        let mut history = vec![(buffers.evaluated, coarse)];
        while !active.is_empty() {
            let groups = self.quarter(pose, &active, &mut buffers);
            let total = settled + groups.iter().map(|group| group.value).sum::<Vector6<f64>>();
            history.push((buffers.evaluated, total));
            let [force, torque] = parts(&total).map(|vector| vector.norm());
            let sizes = [force, torque.max(force * MIN_LEVER_ARM * self.tool.info().radius())];
            let share = |error: &[f64; 2]| (error[0] / sizes[0]).max(error[1] / sizes[1]);
            // Groups are large, so only their indices are sorted.
            let shares = groups.iter().map(|group| share(&group.error));
            let mut shares: Vec<(f64, usize)> = shares.zip(0..).collect();
            shares.sort_by(|a, b| a.0.total_cmp(&b.0));
            let open_error: f64 = shares.iter().map(|(share, _)| share).sum();
            let allowance = criteria.relative_error - share(&error);
            let is_done = history.len() >= MIN_ROUNDS
                && (open_error <= allowance || buffers.evaluated > criteria.max_pieces);
            // Half of the allowed error is kept for later rounds: pieces with much to gain are still large now.
            let mut remaining = allowance / 2.0;
            active.clear();
            for (own_share, index) in shares {
                let group = &groups[index];
                if is_done || own_share <= remaining {
                    remaining -= own_share;
                    settled += group.value;
                    error = [error[0] + group.error[0], error[1] + group.error[1]];
                } else {
                    remaining = 0.0;
                    active.extend(group.pieces.iter().filter(|piece| piece.is_open()));
                }
            }
        }
        // The last round is never compared with itself, however many pieces it evaluated.
        let previous = &history[..history.len().saturating_sub(1)];
        let quarter_entry = previous
            .iter()
            .rfind(|(evaluated, _)| *evaluated <= buffers.evaluated / 4)
            .or(previous.first());
        let earlier = quarter_entry.map_or(Vector6::zeros(), |(_, sums)| *sums);
        let change = parts(&(settled - earlier)).map(|vector| vector.norm());
        let [force, torque] = parts(&settled).map(|vector| pose.rotation() * vector);
        Sums { force, torque, change }
    }

    /// Returns the pieces of faces that the tool may reach, divided until they are short compared with the tool.
    fn pieces_near(&self, pose: &Pose) -> Vec<Piece> {
        let max_radius = MAX_PIECE_RADIUS * self.tool.info().radius();
        let mut pieces = Vec::new();
        for (face, bounds) in (0..).zip(&self.faces) {
            let distance = self.clearance_tool.clearance(self.to_tool(pose, &bounds.centre).into());
            if distance * self.length > bounds.radius {
                continue;
            }
            let mut pending = vec![bounds.corners.map(|corner| self.to_tool(pose, &corner))];
            while let Some(corners) = pending.pop() {
                let (centre, radius) = ball(&corners);
                if self.clearance_tool.clearance(centre.into()) > radius {
                    continue;
                }
                if radius > max_radius {
                    pending.extend(divide_long(&corners));
                } else {
                    pieces.push(Piece::new(corners, face));
                }
            }
        }
        pieces
    }

    fn to_tool(&self, pose: &Pose, point: &Point3<f64>) -> Vector3<f64> {
        pose.rotation().tr_mul(&(point - pose.tip())) / self.length
    }

    /// Divides pieces into quarters and evaluates these.
    fn quarter(&self, pose: &Pose, pieces: &[Piece], buffers: &mut Buffers) -> Vec<QuarteredPiece> {
        let quarters = |piece: &Piece| {
            let [first, second] = bisect(&piece.corners);
            let [[a, b], [c, d]] = [bisect(&first), bisect(&second)];
            [a, b, c, d].map(|corners| Piece::new(corners, piece.face))
        };
        let mut quarters_of_all: Vec<Piece> = pieces.iter().flat_map(quarters).collect();
        self.evaluate(pose, &mut quarters_of_all, buffers);
        let groups = pieces.iter().zip(quarters_of_all.chunks_exact(QUARTERS));
        groups.map(|(piece, quarters)| QuarteredPiece::new(piece, quarters, self.length)).collect()
    }

    /// Evaluates the tool at the centroids of pieces.
    fn evaluate(&self, pose: &Pose, pieces: &mut [Piece], buffers: &mut Buffers) {
        let Buffers { points, evaluation, evaluated } = buffers;
        *evaluated += pieces.len();
        points.clear();
        pieces.iter().for_each(|piece| points.push(centroid(&piece.corners).into()));
        if points.is_empty() {
            return;
        }
        self.tool.evaluate(Level::new(), Outputs::DIRECTION, points, self.length, evaluation);
        for (index, piece) in pieces.iter_mut().enumerate() {
            let [a, b, c] = piece.corners;
            let area = (b - a).cross(&(c - a)).norm() / 2.0 * self.length * self.length;
            let (centre, radius) = ball(&piece.corners);
            if evaluation.inside[index / LANES] >> (index % LANES) & 1 == 0 {
                let hidden_depth = (radius - self.clearance_tool.clearance(centre.into())).max(0.0);
                // Normal and direction are unit vectors, so their difference is at most 2.
                piece.hidden = HIDDEN_SHARE * 2.0 * area * hidden_depth * self.length;
                continue;
            }
            let direction =
                Vector3::from([0, 1, 2].map(|axis: usize| evaluation.direction[axis][index]));
            let normal = pose.rotation().tr_mul(&self.faces[piece.face as usize].normal);
            let force = (normal - direction) * (area * evaluation.magnitude[index]);
            let torque = (centre * self.length).cross(&force);
            piece.inside = true;
            piece.value = Vector6::new(force.x, force.y, force.z, torque.x, torque.y, torque.z);
        }
    }
}

impl Piece {
    fn new(corners: Corners, face: u32) -> Piece {
        Piece { corners, face, value: Vector6::zeros(), inside: false, hidden: 0.0 }
    }

    /// Returns whether the piece may contribute to the sums.
    fn is_open(&self) -> bool {
        self.inside || self.hidden > 0.0
    }
}

impl QuarteredPiece {
    fn new(whole: &Piece, quarters: &[Piece], length: f64) -> QuarteredPiece {
        let pieces: [Piece; QUARTERS] = std::array::from_fn(|k| quarters[k]);
        let sum: Vector6<f64> = pieces.iter().map(|piece| piece.value).sum();
        let change = sum - whole.value;
        let third = if whole.inside && pieces.iter().all(|p| p.inside) { 1.0 / 3.0 } else { 0.0 };
        let hidden: f64 = pieces.iter().map(|piece| piece.hidden).sum();
        let arm = centroid(&whole.corners).norm();
        let [force, torque] = parts(&change).map(|vector| vector.norm());
        let factor = if third > 0.0 { third } else { 1.0 };
        let error = [factor * force + hidden, factor * torque + hidden * arm * length];
        QuarteredPiece { pieces, value: sum + third * change, error }
    }
}

/// Splits a vector into force and torque.
fn parts(sums: &Vector6<f64>) -> [Vector3<f64>; 2] {
    [0, 3].map(|row| sums.fixed_rows::<3>(row).into_owned())
}

fn centroid([a, b, c]: &Corners) -> Vector3<f64> {
    (a + b + c) / 3.0
}

/// Returns the bounding ball about the centroid.
fn ball(corners: &Corners) -> (Vector3<f64>, f64) {
    let centre = centroid(corners);
    let squares = corners.map(|corner| (corner - centre).norm_squared());
    (centre, squares.into_iter().fold(0.0, f64::max).sqrt())
}

/// Divides a triangle into shorter ones. Repeated bisection of a slender triangle leaves it slender, since its quarters
/// are similar to it. A slender triangle is therefore cut perpendicularly to its longest edge at the midpoint.
fn divide_long(corners: &Corners) -> Vec<Corners> {
    const SLENDER_RATIO: f64 = 3.0;
    let [a, b, c] = rotate_to_longest_edge(corners);
    let edge = b - a;
    let height = edge.cross(&(c - a)).norm() / edge.norm();
    if edge.norm() < SLENDER_RATIO * height {
        return bisect(corners).to_vec();
    }
    let m = (a + b) / 2.0;
    let foot = (c - a).dot(&edge) / edge.norm_squared();
    if foot >= 0.5 {
        let p = a + (c - a) * (0.5 / foot);
        vec![[a, m, p], [m, b, c], [m, c, p]]
    } else {
        let p = b + (c - b) * (0.5 / (1.0 - foot));
        vec![[m, b, p], [a, m, c], [m, p, c]]
    }
}

/// Returns the corners in cyclic order, starting with the longest edge.
fn rotate_to_longest_edge(corners: &Corners) -> Corners {
    let length = |k: usize| (corners[(k + 1) % 3] - corners[k]).norm_squared();
    let k = (1..3).fold(0, |best, k| if length(k) > length(best) { k } else { best });
    [0, 1, 2].map(|i| corners[(k + i) % 3])
}

/// Returns both halves of a triangle, bisected at the midpoint of its longest edge.
fn bisect(corners: &Corners) -> [Corners; 2] {
    let [a, b, c] = rotate_to_longest_edge(corners);
    let m = (a + b) / 2.0;
    [[a, m, c], [m, b, c]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::work_precision::contact::Contact;
    use touchoff_tests::oracle::rng::Rng;
    use touchoff_tools::Fig73Exact;

    #[test]
    fn division_shortens_triangles_and_keeps_their_area() {
        let area = |[a, b, c]: &Corners| (b - a).cross(&(c - a)).norm() / 2.0;
        let longest = |corners: &Corners| {
            let [a, b, _] = rotate_to_longest_edge(corners);
            (b - a).norm()
        };
        for apex in [0.0, 1.0, 6.0, 9.0, 13.0] {
            let slender = [[0.0, 0.0, 0.0], [13.0, 0.0, 0.0], [apex, 0.0, 0.02]].map(Vector3::from);
            let pieces = divide_long(&slender);
            let whole: f64 = pieces.iter().map(area).sum();
            assert!((whole / area(&slender) - 1.0).abs() < 1e-12, "{apex}");
            assert!(pieces.iter().all(|piece| longest(piece) < 7.0), "{apex} {pieces:?}");
        }
    }

    #[test]
    fn sums_agree_with_the_closed_forms() {
        let criteria = StopCriteria { relative_error: 1e-5, max_pieces: 1 << 18 };
        for contact in [Contact::BallInPlane, Contact::SideInPlane] {
            let mesh = contact.mesh();
            let quadrature = Quadrature::new(&mesh, &Fig73Exact, &Fig73Exact);
            let mut rng = Rng::new(3);
            for _ in 0..5 {
                let placed = contact.random_placement(&mut rng);
                let sums = quadrature.sums(&placed.pose, criteria);
                let error = (sums.force - placed.force).norm();
                assert!(
                    error < 2e-5 * placed.force.norm(),
                    "{contact:?} {error} {:?}",
                    sums.change
                );
                assert!(error < sums.change[0], "{contact:?} {error} {:?}", sums.change);
                assert!(sums.change[0] < 1e-3 * placed.force.norm(), "{:?}", sums.change);
                let error = (sums.torque - placed.torque).norm();
                assert!(error < sums.change[1], "{contact:?} {error} {:?}", sums.change);
            }
        }
    }
}

//! One thread of a sweep.

use super::{PostureDecision, PostureSweep, SweepError, SweepStats};
use crate::holder::{Holder, LeastStickout};
use crate::placement::{CandidatePosture, SurfacePoint, ToolPlacement};
use crate::record::merge;
use crate::{Accessibility, MapRow, Piece, PostureRecord, Validator};
use nalgebra::{Point3, Vector3};
use touchoff::cancellation;
use touchoff::certify::{ContactVerdict, Containment, Location};
use touchoff::{Mesh, Pose, Tool};

/// Number of recent obstructions that are kept per direction, the latest first.
const MAX_OBSTRUCTIONS: usize = 8;

/// One thread's tools, each with its caches.
pub(super) struct Worker<'a> {
    sweep: &'a PostureSweep<'a>,
    tools: Vec<CandidateTool<'a>>,
}

/// A tool to try, with its caches.
struct CandidateTool<'a> {
    index: u16,
    placement: ToolPlacement<'a>,
    /// The search for stick-outs, if the tool has a holder.
    stickout: Option<LeastStickout<'a>>,
    validator: Validator<'a>,
    /// Set if the points of the tool that may not be in the part are connected. If one of them is outside the
    /// part and no triangle touches them, then all of them are outside.
    one_piece: bool,
    /// Points of the part that were in the way, per direction.
    obstructions: Vec<Vec<Point3<f64>>>,
    postures: Vec<CandidatePosture>,
}

impl<'a> Worker<'a> {
    pub(super) fn new(sweep: &'a PostureSweep<'a>) -> Result<Worker<'a>, SweepError> {
        let tools = sweep.tools.iter().zip(0..);
        let tools = tools
            .map(|(tool, index)| CandidateTool::new(sweep, *tool, index))
            .collect::<Result<_, _>>()?;
        Ok(Worker { sweep, tools })
    }

    /// Computes the rows of some pieces of triangles, each at its centroid.
    pub(super) fn rows(
        &mut self,
        pieces: impl ExactSizeIterator<Item = Piece>,
    ) -> (Vec<MapRow>, SweepStats) {
        let mesh = self.sweep.mesh;
        let mut rows = vec![MapRow::default(); pieces.len()];
        let points: Vec<_> = pieces.map(|piece| surface_point(mesh, piece)).collect();
        let mut stats = SweepStats::default();
        for candidate in &mut self.tools {
            candidate.clear_caches();
            for (surface_point, row) in points.iter().zip(&mut rows) {
                stats.triangles += 1;
                cancellation::check();
                let access =
                    candidate.access(self.sweep, *surface_point, &mut row.best, &mut stats);
                row.access.push(access);
            }
        }
        // Each tool has appended its own best; only the best of all are kept.
        for row in &mut rows {
            merge(&mut row.best, &[], self.sweep.keep);
        }
        (rows, stats)
    }
}

impl<'a> CandidateTool<'a> {
    fn new(
        sweep: &PostureSweep<'a>,
        tool: &'a dyn Tool,
        index: u16,
    ) -> Result<CandidateTool<'a>, SweepError> {
        let (info, unit) = (tool.info(), sweep.bvh.unit());
        let mut validator = Validator::new(sweep.bvh, tool, &sweep.rules)?;
        Ok(CandidateTool {
            index,
            placement: ToolPlacement::new(tool, unit),
            stickout: Holder::new(info, info.unit.factor_to(unit))
                .map(|holder| LeastStickout::new(holder, sweep.bvh)),
            one_piece: validator.certifier.is_one_piece(),
            validator,
            obstructions: vec![Vec::new(); sweep.directions.list().len()],
            postures: Vec::new(),
        })
    }

    /// Clears the caches, so that a batch does not depend on the one before.
    fn clear_caches(&mut self) {
        self.validator.certifier.clear_caches();
        self.obstructions.iter_mut().for_each(Vec::clear);
    }

    /// Returns the directions from which the tool reaches a point, and appends the best postures to `best`.
    fn access(
        &mut self,
        sweep: &PostureSweep<'a>,
        surface_point: Option<SurfacePoint>,
        best: &mut Vec<PostureRecord>,
        stats: &mut SweepStats,
    ) -> Accessibility {
        let mut directions = vec![0; sweep.directions.words()];
        // Every direction counts as not facing until a contact in it is decided.
        stats.not_facing += sweep.directions.list().len() as u64;
        let Some(surface_point) = surface_point else {
            return Accessibility { tool: self.index, directions, stickout: None };
        };
        let mut reached: Vec<CandidatePosture> = Vec::new();
        let mut location = None;
        let mut postures = std::mem::take(&mut self.postures);
        let axes = sweep.directions.list().iter().map(|axis| Vector3::from(*axis));
        self.placement.list(surface_point, axes, &mut postures);
        // A tool can have several contacts in one direction; the nicest acceptable one counts.
        for contacts in postures.chunk_by(|a, b| a.direction == b.direction) {
            let mut decision = PostureDecision::BelowNiceness;
            for posture in contacts.iter().filter(|contact| contact.niceness > sweep.rules.niceness)
            {
                decision = self.decide(sweep, posture, surface_point, &mut location);
                if decision == PostureDecision::Acceptable {
                    directions[posture.direction / 64] |= 1 << (posture.direction % 64);
                    reached.push(*posture);
                    break;
                }
            }
            stats.not_facing -= 1;
            *stats.count_of(decision) += 1;
        }
        self.postures = postures;
        let stickout = self.stickout.as_mut().and_then(|stickout| {
            stickout.of(reached
                .iter()
                .map(|posture| (posture.tip, sweep.directions.list()[posture.direction].into())))
        });
        // Comparing niceness in `f32` ignores rounding errors; ties go to the middle of the cone, where the margin's angle
        // is largest and its cosine least.
        let mut ranked: Vec<(f64, &CandidatePosture)> = reached
            .iter()
            .map(|posture| (sweep.directions.margin(&directions, posture.direction), posture))
            .collect();
        ranked.sort_by(|(cosine, one), (other_cosine, other)| {
            let nicer = (other.niceness as f32).total_cmp(&(one.niceness as f32));
            nicer.then(cosine.total_cmp(other_cosine))
        });
        for (_, posture) in ranked.into_iter().take(sweep.keep.get().into()) {
            let axis = sweep.directions.list()[posture.direction];
            if let Ok(pose) = Pose::from_axis(posture.tip, axis.into()) {
                best.push(self.record(axis, &pose, posture.niceness));
            }
        }
        Accessibility { tool: self.index, directions, stickout }
    }

    /// Decides a posture: by known obstructions, then by a search of the triangles, then by containment.
    fn decide(
        &mut self,
        sweep: &PostureSweep<'a>,
        posture: &CandidatePosture,
        surface_point: SurfacePoint,
        location: &mut Option<Location>,
    ) -> PostureDecision {
        let axis = Vector3::from(sweep.directions.list()[posture.direction]);
        let obstructions = &mut self.obstructions[posture.direction];
        let certifier = &mut self.validator.certifier;
        if let Some(at) =
            obstructions.iter().position(|point| certifier.is_too_deep(&posture.tip, &axis, point))
        {
            // In front it is tried first at the next triangle, where it is likely to be in the way, too.
            obstructions[..=at].rotate_right(1);
            return PostureDecision::CachedObstruction;
        }
        let Ok(pose) = Pose::from_axis(posture.tip, axis) else {
            return PostureDecision::Undecided;
        };
        match certifier.touches(&pose) {
            ContactVerdict::Yes(witness) => {
                obstructions.truncate(MAX_OBSTRUCTIONS - 1);
                obstructions.insert(0, witness.point);
                PostureDecision::Obstructed
            }
            ContactVerdict::Undecided(_) => PostureDecision::Undecided,
            ContactVerdict::No => {
                // A point before the triangle and deep in the tool: if it is outside the part, so is the tool. It is located
                // once for all directions.
                let point =
                    surface_point.point + surface_point.normal * (2.0 * sweep.rules.tolerance);
                if self.one_piece && certifier.is_too_deep(&posture.tip, &axis, &point) {
                    return match location.get_or_insert_with(|| sweep.bvh.locate(point)) {
                        Location::Inside => PostureDecision::Obstructed,
                        Location::Outside | Location::Unknown => PostureDecision::Acceptable,
                        Location::Undecided => PostureDecision::Undecided,
                    };
                }
                match certifier.containment(&pose) {
                    Containment::Inside(_) => PostureDecision::Obstructed,
                    Containment::Outside | Containment::Unknown => PostureDecision::Acceptable,
                    Containment::Undecided => PostureDecision::Undecided,
                }
            }
        }
    }

    /// Returns the record of a posture with its proved bounds. The axis is stored as it was given: normalised,
    /// it could give another pose.
    fn record(&mut self, axis: [f64; 3], pose: &Pose, niceness: f64) -> PostureRecord {
        let tip = pose.tip().into();
        let mut record =
            PostureRecord { tool: self.index, tip, axis, niceness, depth: 0.0, clearance: 0.0 };
        self.validator.measure(&mut record, pose);
        record
    }
}

/// Returns the centroid of a piece with its normal; `None` for a triangle without an area, which has no normal and is not
/// touched.
fn surface_point(mesh: &Mesh, piece: Piece) -> Option<SurfacePoint> {
    let [a, b, c] = piece.corners(mesh);
    let point = Point3::from((a.coords + b.coords + c.coords) / 3.0);
    mesh.normal(piece.triangle()).map(|normal| SurfacePoint { point, normal })
}

#[cfg(test)]
mod costs;

//! One thread of a sweep.

use super::stats::PostureDecision;
use super::{Batch, PostureSweep, SweepError, SweepStats};
use crate::certify::{ContactVerdict, Containment, Location};
use crate::id::TriangleId;
use crate::pose::Pose;
use crate::postures::holder::Holder;
use crate::postures::map::merge;
use crate::postures::placement::{CandidatePosture, SurfacePoint, ToolPlacement};
use crate::postures::{Accessibility, MapRow, PostureRecord, Validator};
use crate::tool::Tool;
use nalgebra::{Point3, Vector3};

/// Number of recent obstructions that are kept per direction, the latest first.
const KNOWN: usize = 8;

/// One thread's tools, each with its caches.
pub(super) struct Worker<'a> {
    of: &'a PostureSweep<'a>,
    tools: Vec<CandidateTool<'a>>,
}

/// A tool to try, with its caches.
struct CandidateTool<'a> {
    index: u16,
    touching: ToolPlacement<'a>,
    holder: Option<Holder>,
    judge: Validator<'a>,
    /// Set if the points of the tool that may not be in the part are connected. If one of them is outside the
    /// part and no triangle touches them, then all of them are outside.
    one_piece: bool,
    /// Points of the part that were in the way, per direction.
    known: Vec<Vec<Point3<f64>>>,
    postures: Vec<CandidatePosture>,
}

impl<'a> Worker<'a> {
    pub(super) fn new(of: &'a PostureSweep<'a>) -> Result<Worker<'a>, SweepError> {
        let tools = of.tools.iter().zip(0..);
        let tools = tools
            .map(|(tool, index)| CandidateTool::new(of, *tool, index))
            .collect::<Result<_, _>>()?;
        Ok(Worker { of, tools })
    }

    /// Computes the rows of some triangles.
    pub(super) fn batch(&mut self, triangles: &[u32]) -> Batch {
        let mut tally = SweepStats::default();
        let mut rows: Vec<(u32, MapRow)> =
            triangles.iter().map(|id| (*id, MapRow::default())).collect();
        for tried in &mut self.tools {
            tried.forget();
            for (id, row) in &mut rows {
                tally.triangles += 1;
                let mesh = self.of.mesh;
                let [a, b, c] = mesh.triangle(TriangleId(*id));
                let point = Point3::from((a.coords + b.coords + c.coords) / 3.0);
                // A triangle without an area has no normal.
                let spot =
                    mesh.normal(TriangleId(*id)).map(|normal| SurfacePoint { point, normal });
                let access = tried.triangle(self.of, spot, (&mut row.best, &mut tally));
                row.access.push(access);
            }
        }
        for (_, row) in &mut rows {
            merge(&mut row.best, &[], self.of.keep);
        }
        Batch { rows, stats: tally }
    }
}

impl<'a> CandidateTool<'a> {
    fn new(
        of: &PostureSweep<'a>,
        tool: &'a dyn Tool,
        index: u16,
    ) -> Result<CandidateTool<'a>, SweepError> {
        let (info, unit) = (tool.info(), of.bvh.unit());
        let mut judge = Validator::new(of.bvh, tool, &of.rules)?;
        Ok(CandidateTool {
            index,
            touching: ToolPlacement::new(tool, unit),
            holder: Holder::new(info, info.unit.factor_to(unit)),
            one_piece: judge.certifier.is_one_piece(),
            judge,
            known: vec![Vec::new(); of.directions.list().len()],
            postures: Vec::new(),
        })
    }

    /// Clears the caches, so that a batch does not depend on the one before.
    fn forget(&mut self) {
        self.judge.certifier.forget();
        self.known.iter_mut().for_each(Vec::clear);
    }

    /// Returns the directions from which the tool reaches a triangle, and appends the best postures to `best`.
    fn triangle(
        &mut self,
        of: &PostureSweep<'a>,
        spot: Option<SurfacePoint>,
        (best, tally): (&mut Vec<PostureRecord>, &mut SweepStats),
    ) -> Accessibility {
        let mut directions = vec![0; of.directions.words()];
        tally.not_facing += of.directions.list().len() as u64;
        let Some(spot) = spot else {
            return Accessibility { tool: self.index, directions, stickout: None };
        };
        let mut reached: Vec<CandidatePosture> = Vec::new();
        let mut before = None;
        let mut postures = std::mem::take(&mut self.postures);
        let axes = of.directions.list().iter().map(|axis| Vector3::from(*axis));
        self.touching.list(spot, axes, &mut postures);
        // A tool can have several contacts in one direction; the nicest acceptable one counts.
        for contacts in postures.chunk_by(|a, b| a.direction == b.direction) {
            let mut decided = PostureDecision::BelowNiceness;
            for posture in contacts.iter().filter(|contact| contact.niceness > of.rules.niceness) {
                decided = self.decide(of, posture, spot, &mut before);
                if decided == PostureDecision::Acceptable {
                    directions[posture.direction / 64] |= 1 << (posture.direction % 64);
                    reached.push(*posture);
                    break;
                }
            }
            tally.not_facing -= 1;
            *tally.of(decided) += 1;
        }
        self.postures = postures;
        let stickout = self.stickout(of, &reached);
        let rank = |posture: &CandidatePosture| {
            // Comparing niceness in `f32` ignores rounding errors; ties go to the middle of the cone.
            (posture.niceness as f32, -of.directions.margin(&directions, posture.direction))
        };
        let mut ranked: Vec<_> = reached.iter().map(|posture| (rank(posture), posture)).collect();
        ranked.sort_by(|((nice, margin), _), ((other, wide), _)| {
            other.total_cmp(nice).then(wide.total_cmp(margin))
        });
        for (_, posture) in ranked.into_iter().take(of.keep.get().into()) {
            let axis = of.directions.list()[posture.direction];
            if let Ok(pose) = Pose::from_axis(posture.tip, axis.into()) {
                best.push(self.record(axis, &pose, posture.niceness));
            }
        }
        Accessibility { tool: self.index, directions, stickout }
    }

    /// Decides a posture: by known obstructions, then by a search of the triangles, then by containment.
    fn decide(
        &mut self,
        of: &PostureSweep<'a>,
        posture: &CandidatePosture,
        spot: SurfacePoint,
        before: &mut Option<Location>,
    ) -> PostureDecision {
        let axis = Vector3::from(of.directions.list()[posture.direction]);
        let known = &mut self.known[posture.direction];
        let certifier = &mut self.judge.certifier;
        let stands = (&posture.tip, &axis);
        if let Some(at) = known.iter().position(|place| certifier.is_too_deep(stands, place)) {
            known[..=at].rotate_right(1);
            return PostureDecision::CachedObstruction;
        }
        let Ok(pose) = Pose::from_axis(posture.tip, axis) else {
            return PostureDecision::Undecided;
        };
        match certifier.touches(&pose) {
            ContactVerdict::Yes(witness) => {
                known.truncate(KNOWN - 1);
                known.insert(0, witness.point);
                PostureDecision::Obstructed
            }
            ContactVerdict::Undecided(_) => PostureDecision::Undecided,
            ContactVerdict::No => {
                // A point before the triangle and deep in the tool: if it is outside the part, so is the tool.
                let place = spot.point + spot.normal * (2.0 * of.rules.tolerance);
                if self.one_piece && certifier.is_too_deep(stands, &place) {
                    return match before.get_or_insert_with(|| of.bvh.locate(place)) {
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
        self.judge.measure(&mut record, pose);
        record
    }

    /// Returns the least stick-out over all postures, at most that of the tool as it is, which was validated.
    fn stickout(&self, of: &PostureSweep<'a>, reached: &[CandidatePosture]) -> Option<f64> {
        let holder = self.holder.as_ref()?;
        let mut least: Option<f64> = None;
        for posture in reached {
            let axis = Vector3::from(of.directions.list()[posture.direction]);
            if let Some(needed) = holder.least(of.bvh, (&posture.tip, &axis), least) {
                least = Some(needed);
            }
        }
        least.map(|least| least.min(holder.own))
    }
}

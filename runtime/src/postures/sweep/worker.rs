//! One thread of a sweep.

use super::tally::Decided;
use super::{Batch, Sweep, SweepError, Tally};
use crate::certify::{Containment, Location, Touch};
use crate::pose::Pose;
use crate::postures::holder::Holder;
use crate::postures::map::merge;
use crate::postures::touching::{Posture, Spot, Touching};
use crate::postures::{Access, Judge, Record, Row};
use crate::tool::Tool;
use nalgebra::{Point3, Vector3};

/// Of each direction the places that were last in the way are kept, the last first.
const KNOWN: usize = 8;

/// All tools, each with what it knows.
pub(super) struct Worker<'a> {
    of: &'a Sweep<'a>,
    tools: Vec<Tried<'a>>,
}

/// A tool that is tried.
struct Tried<'a> {
    index: u16,
    touching: Touching<'a>,
    holder: Option<Holder>,
    judge: Judge<'a>,
    /// Whether what of it may not be in the part is one piece: if one place of it is outside the part, and no
    /// triangle touches it, all of it is.
    one_piece: bool,
    /// Of each direction, places of the part that were in the way.
    known: Vec<Vec<Point3<f64>>>,
    postures: Vec<Posture>,
}

impl<'a> Worker<'a> {
    pub(super) fn new(of: &'a Sweep<'a>) -> Result<Worker<'a>, SweepError> {
        let tools = of.tools.iter().zip(0..);
        let tools =
            tools.map(|(tool, index)| Tried::new(of, *tool, index)).collect::<Result<_, _>>()?;
        Ok(Worker { of, tools })
    }

    /// The rows of some triangles.
    pub(super) fn batch(&mut self, triangles: &[u32]) -> Batch {
        let mut tally = Tally::default();
        let mut rows: Vec<(u32, Row)> = triangles.iter().map(|id| (*id, Row::default())).collect();
        for tried in &mut self.tools {
            tried.forget();
            for (id, row) in &mut rows {
                tally.triangles += 1;
                let mesh = self.of.mesh;
                let [a, b, c] = mesh.triangle(*id);
                let point = Point3::from((a.coords + b.coords + c.coords) / 3.0);
                // What has no area faces nowhere.
                let spot = mesh.normal(*id).map(|normal| Spot { point, normal });
                let access = tried.triangle(self.of, spot, (&mut row.best, &mut tally));
                row.access.push(access);
            }
        }
        for (_, row) in &mut rows {
            merge(&mut row.best, &[], self.of.keep);
        }
        Batch { rows, tally }
    }
}

impl<'a> Tried<'a> {
    fn new(of: &Sweep<'a>, tool: &'a dyn Tool, index: u16) -> Result<Tried<'a>, SweepError> {
        let (card, unit) = (tool.card(), of.facets.unit());
        let mut judge = Judge::new(of.facets, tool, &of.rules)?;
        Ok(Tried {
            index,
            touching: Touching::new(tool, unit),
            holder: Holder::new(card, card.unit.to(unit)),
            one_piece: judge.certifier.is_one_piece(),
            judge,
            known: vec![Vec::new(); of.directions.list().len()],
            postures: Vec::new(),
        })
    }

    /// Begins anew, so that a batch does not depend on the one before.
    fn forget(&mut self) {
        self.judge.certifier.forget();
        self.known.iter_mut().for_each(Vec::clear);
    }

    /// From where the tool reaches a triangle; adds the best postures.
    fn triangle(
        &mut self,
        of: &Sweep<'a>,
        spot: Option<Spot>,
        (best, tally): (&mut Vec<Record>, &mut Tally),
    ) -> Access {
        let mut directions = vec![0; of.directions.words()];
        tally.facing += of.directions.list().len() as u64;
        let Some(spot) = spot else {
            return Access { tool: self.index, directions, stickout: None };
        };
        let mut reached: Vec<Posture> = Vec::new();
        let mut before = None;
        let mut postures = std::mem::take(&mut self.postures);
        let axes = of.directions.list().iter().map(|axis| Vector3::from(*axis));
        self.touching.list(spot, axes, &mut postures);
        // A tool can have several contacts in one direction; the nicest that is acceptable counts.
        for contacts in postures.chunk_by(|a, b| a.direction == b.direction) {
            let mut decided = Decided::Plain;
            for posture in contacts.iter().filter(|contact| contact.niceness > of.rules.niceness) {
                decided = self.decide(of, posture, spot, &mut before);
                if decided == Decided::Acceptable {
                    directions[posture.direction / 64] |= 1 << (posture.direction % 64);
                    reached.push(*posture);
                    break;
                }
            }
            tally.facing -= 1;
            *tally.of(decided) += 1;
        }
        self.postures = postures;
        let stickout = self.stickout(of, &reached);
        let rank = |posture: &Posture| {
            // What differs by rounding alone is as nice; then it is the middle of the cone that counts.
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
        Access { tool: self.index, directions, stickout }
    }

    fn decide(
        &mut self,
        of: &Sweep<'a>,
        posture: &Posture,
        spot: Spot,
        before: &mut Option<Location>,
    ) -> Decided {
        let axis = Vector3::from(of.directions.list()[posture.direction]);
        let known = &mut self.known[posture.direction];
        let certifier = &mut self.judge.certifier;
        let stands = (&posture.tip, &axis);
        if let Some(at) = known.iter().position(|place| certifier.is_too_deep(stands, place)) {
            known[..=at].rotate_right(1);
            return Decided::Known;
        }
        let Ok(pose) = Pose::from_axis(posture.tip, axis) else { return Decided::Undecided };
        match certifier.touches(&pose) {
            Touch::Yes(witness) => {
                known.truncate(KNOWN - 1);
                known.insert(0, witness.point);
                Decided::Found
            }
            Touch::Undecided(_) => Decided::Undecided,
            Touch::No => {
                // A place before the triangle, deep in the tool: if that is outside the part, so is the tool.
                let place = spot.point + spot.normal * (2.0 * of.rules.tolerance);
                if self.one_piece && certifier.is_too_deep(stands, &place) {
                    return match before.get_or_insert_with(|| of.facets.locate(place)) {
                        Location::Inside => Decided::Found,
                        Location::Outside | Location::Unknown => Decided::Acceptable,
                        Location::Undecided => Decided::Undecided,
                    };
                }
                match certifier.containment(&pose) {
                    Containment::Inside(_) => Decided::Found,
                    Containment::Outside | Containment::Unknown => Decided::Acceptable,
                    Containment::Undecided => Decided::Undecided,
                }
            }
        }
    }

    /// What is proved of a posture. The axis is told as it was given: normalised, it could give another pose.
    fn record(&mut self, axis: [f64; 3], pose: &Pose, niceness: f64) -> Record {
        let tip = pose.tip().into();
        let mut record =
            Record { tool: self.index, tip, axis, niceness, depth: 0.0, clearance: 0.0 };
        self.judge.measure(&mut record, pose);
        record
    }

    /// The least stick-out of all postures: no more than that of the tool as it is, which was judged.
    fn stickout(&self, of: &Sweep<'a>, reached: &[Posture]) -> Option<f64> {
        let holder = self.holder.as_ref()?;
        let mut least: Option<f64> = None;
        for posture in reached {
            let axis = Vector3::from(of.directions.list()[posture.direction]);
            if let Some(needed) = holder.least(of.facets, (&posture.tip, &axis), least) {
                least = Some(needed);
            }
        }
        least.map(|least| least.min(holder.own))
    }
}

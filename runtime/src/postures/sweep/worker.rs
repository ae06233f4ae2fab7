//! One thread of a sweep.

use super::tally::Decided;
use super::{Batch, Sweep, SweepError, Tally};
use crate::certify::Touch;
use crate::pose::Pose;
use crate::postures::contact::Sites;
use crate::postures::holder::Holder;
use crate::postures::map::merge;
use crate::postures::{Access, Judge, Record, Row};
use crate::tool::{Ask, Felt, Points};
use crate::{Level, Tool};
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
    tool: &'a dyn Tool,
    index: u16,
    length: f64,
    sites: Sites,
    holder: Option<Holder>,
    judge: Judge<'a>,
    /// Whether what of it may not be in the part is one piece: if one place of it is outside the part, and no
    /// triangle touches it, all of it is.
    one_piece: bool,
    /// Of each direction, places of the part that were in the way.
    known: Vec<Vec<Point3<f64>>>,
    postures: Vec<Posture>,
    points: Points,
    felt: Felt,
}

/// A posture that is to be judged.
#[derive(Clone, Copy)]
struct Posture {
    direction: usize,
    tip: Point3<f64>,
    niceness: f64,
}

/// Where a triangle is touched.
#[derive(Clone, Copy)]
struct Spot {
    point: Point3<f64>,
    normal: Vector3<f64>,
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
        let (card, length) = (tool.card(), tool.card().unit.to(of.facets.unit()));
        let judge = Judge::new(of.facets, tool, &of.rules)?;
        Ok(Tried {
            tool,
            index,
            length,
            sites: Sites::new(card, length),
            holder: Holder::new(card, length),
            one_piece: judge.certifier.is_one_piece(),
            judge,
            known: vec![Vec::new(); of.directions.list().len()],
            postures: Vec::new(),
            points: Points::default(),
            felt: Felt::default(),
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
        self.postures.clear();
        let Some(spot) = spot else {
            tally.facing += of.directions.list().len() as u64;
            return Access { tool: self.index, directions, stickout: None };
        };
        self.place(of, spot, tally);
        let mut reached: Vec<Posture> = Vec::new();
        let mut outside = None;
        let postures = std::mem::take(&mut self.postures);
        // A tool can have several contacts in one direction; the nicest that is acceptable counts.
        for contacts in postures.chunk_by(|a, b| a.direction == b.direction) {
            let mut decided = Decided::Plain;
            for posture in contacts.iter().filter(|contact| contact.niceness > of.rules.niceness) {
                decided = self.decide(of, posture, spot, &mut outside);
                if decided == Decided::Acceptable {
                    directions[posture.direction / 64] |= 1 << (posture.direction % 64);
                    reached.push(*posture);
                    break;
                }
            }
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

    /// The postures in which the tool touches a triangle.
    fn place(&mut self, of: &Sweep<'a>, spot: Spot, tally: &mut Tally) {
        self.points.clear();
        for (direction, axis) in of.directions.list().iter().enumerate() {
            let before = self.postures.len();
            for contact in self.sites.contacts(spot.point, spot.normal, Vector3::from(*axis)) {
                let [d, z] = contact.within;
                self.points.push([d / self.length, 0.0, z / self.length]);
                self.postures.push(Posture { direction, tip: contact.tip, niceness: 0.0 });
            }
            tally.facing += u64::from(self.postures.len() == before);
        }
        let ask = Ask { niceness: true, ..Ask::INSIDE };
        self.tool.evaluate(Level::new(), ask, &self.points, self.length, &mut self.felt);
        for place in self.felt.places() {
            self.postures[place].niceness = self.felt.niceness[place];
        }
        // The nicest first, where one direction has several.
        self.postures
            .sort_by(|a, b| a.direction.cmp(&b.direction).then(b.niceness.total_cmp(&a.niceness)));
    }

    fn decide(
        &mut self,
        of: &Sweep<'a>,
        posture: &Posture,
        spot: Spot,
        outside: &mut Option<bool>,
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
                let before = spot.point + spot.normal * (2.0 * of.rules.tolerance);
                let inside = if self.one_piece && certifier.is_too_deep(stands, &before) {
                    *outside.get_or_insert_with(|| of.facets.contains(before) == Some(true))
                } else {
                    certifier.is_inside(&pose)
                };
                if inside { Decided::Found } else { Decided::Acceptable }
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

    /// The least stick-out of all postures.
    fn stickout(&self, of: &Sweep<'a>, reached: &[Posture]) -> Option<f64> {
        let holder = self.holder.as_ref()?;
        let mut least: Option<f64> = None;
        for posture in reached {
            let axis = Vector3::from(of.directions.list()[posture.direction]);
            if let Some(needed) = holder.least(of.facets, (&posture.tip, &axis), least) {
                least = Some(needed);
            }
        }
        least
    }
}

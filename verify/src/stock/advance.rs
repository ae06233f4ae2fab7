//! Motions of a tool through the stock, and its contacts from one motion to the next.
//!
//! ```text
//! motion ──halve while the widened tool reaches a point──▶ samples in order of time
//! sample ──query──▶ points inside ──▶ cut: removed    in contact: recorded
//! ```

use super::lattice::BitSet;
use super::{Stock, StockError};
use nalgebra::Point3;
use touchoff::cancellation;
use touchoff::certify::Trajectory;
use touchoff::tool::{Symmetry, Tool};
use touchoff::{InsidePoint, Motion, Pose, SurfaceId, ToolEnvelope};

/// The mode of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionMode {
    /// Feed: cutting surfaces remove material, others must not touch it.
    Feed,
    /// Rapid traverse: no surface may touch material.
    Rapid,
}

/// The greatest number of intervals between the samples of a motion: some minutes of work if all of them cut.
const MAX_INTERVALS: f64 = 67_108_864.0;

/// The number of intervals from which on a range of samples is tested as a whole. For fewer, the test costs
/// as much as the samples.
const MIN_TESTED_INTERVALS: u64 = 4;

/// The factor by which widened tools are larger than needed, for the rounding of poses and times.
const WIDENING: f64 = 1.0 + 1e-9;

impl Stock {
    /// Returns an upper bound on the travel of any point of a tool over a motion, in the stock's unit, as
    /// [`Stock::advance`] needs it: the length of the tip's path, plus the angle times the largest distance
    /// of the tool's points from the tip.
    pub fn max_travel(&self, tool: &dyn Tool, motion: &Motion) -> f64 {
        let lever = tool.info().max_distance_from_tip(self.unit);
        motion.max_speed(lever) * WIDENING
    }

    /// Moves a tool through the stock: removes the points that it cuts, and returns its contacts, at most one
    /// per surface, in the order of surfaces.
    ///
    /// `motion` returns the pose at a time from 0 to 1, in the stock's frame and unit. `max_travel` is an
    /// upper bound on the speed of the tool's points: between the times s and t, none travels farther than
    /// `max_travel · |t − s|`. For a [`Motion`], [`Stock::max_travel`] returns it. Points no deeper than
    /// `tolerance` in a surface that must not touch are no contact. The module's page states what is proved,
    /// and what becomes of points in contact.
    ///
    /// Ranges of the motion are skipped if the tool, widened by half its travel over the range, reaches no
    /// point. A motion farther from all points than half its travel thus costs a single test.
    ///
    /// # Errors
    /// If `max_travel` or `tolerance` is not a finite length of 0 or more, if the travel has more than 2²⁶
    /// steps, or if the tool is a solid without an axis and a pose has no spin. In the last case, the motion
    /// ends before that pose, and its contacts are lost.
    pub fn advance(
        &mut self,
        tool: &dyn Tool,
        motion: &dyn Fn(f64) -> Pose,
        max_travel: f64,
        mode: MotionMode,
        tolerance: f64,
    ) -> Result<Vec<StockContact>, StockError> {
        if !(0.0..f64::INFINITY).contains(&tolerance) {
            return Err(StockError::Tolerance { tolerance });
        }
        let limit = MAX_INTERVALS * self.step();
        if !(0.0..=limit).contains(&max_travel) {
            return Err(StockError::Travel { max_travel, limit });
        }
        let ended = self.contacts.begin(tool.info().digest);
        self.tree.remove(ended);
        let mut sampler = Sampler {
            envelope: ToolEnvelope::new(&self.tree, tool.info(), self.unit),
            stock: self,
            tool,
            mode,
            tolerance,
            still_inside: Vec::new(),
        };
        let is_complete = sampler.run(motion, max_travel);
        let still_inside = sampler.still_inside;
        let (contacts, ended) = self.contacts.finish(&still_inside);
        self.tree.remove(ended);
        is_complete.map(|()| contacts)
    }
}

/// The samples of a motion.
struct Sampler<'a> {
    stock: &'a mut Stock,
    tool: &'a dyn Tool,
    envelope: ToolEnvelope,
    mode: MotionMode,
    tolerance: f64,
    /// The slots in contact inside the tool at the motion's last sample, in ascending order.
    still_inside: Vec<usize>,
}

impl Sampler<'_> {
    /// Samples the motion, in order of time.
    fn run(&mut self, motion: &dyn Fn(f64) -> Pose, max_travel: f64) -> Result<(), StockError> {
        let info = self.tool.info();
        let needs_spin = matches!(info.symmetry, Symmetry::Solid { .. });
        let pose_at = |time: f64| {
            let pose = motion(time);
            if needs_spin && !pose.has_spin() {
                return Err(StockError::NoSpin { solid: info.name.to_string() });
            }
            Ok(pose)
        };
        let intervals = (max_travel / self.stock.step()).ceil() as u64;
        let time = |sample: f64| if intervals == 0 { 0.0 } else { sample / intervals as f64 };
        // The envelope of each level: its tool is widened by half the travel over the longest range of the
        // level.
        let mut levels: Vec<ToolEnvelope> = Vec::new();
        let mut ranges = vec![(0, intervals, 0)];
        while let Some((first, last, level)) = ranges.pop() {
            cancellation::check();
            let span = last - first;
            if span < MIN_TESTED_INTERVALS {
                for sample in first..=last {
                    let time = time(sample as f64);
                    self.sample(time, &pose_at(time)?, sample == intervals);
                }
                continue;
            }
            if levels.len() == level {
                // A range of `n` intervals is divided into two of at most `n/2` each, rounded down.
                let travel = max_travel * ((intervals >> level) as f64 / intervals as f64);
                let distance = 0.5 * travel * WIDENING;
                let Stock { tree, unit, .. } = &*self.stock;
                levels.push(ToolEnvelope::widened(tree, info, *unit, distance));
            }
            let pose = pose_at(time(first as f64 + 0.5 * span as f64))?;
            let Stock { query, tree, .. } = &mut *self.stock;
            if !query.is_out_of_reach(tree, &levels[level], &pose) {
                let middle = first + span / 2;
                // The earlier half is taken first: what it cuts is not there for the later one.
                ranges.push((middle + 1, last, level + 1));
                ranges.push((first, middle, level + 1));
            }
        }
        Ok(())
    }

    /// Removes the points in cutting surfaces at a pose, and records those in contact.
    fn sample(&mut self, time: f64, pose: &Pose, is_last: bool) {
        let info = self.tool.info();
        let Stock { tree, query, contacts, inside, .. } = &mut *self.stock;
        query.inside(tree, self.tool, &self.envelope, pose, inside);
        if inside.is_empty() {
            return;
        }
        let cuts = |point: &InsidePoint| {
            self.mode == MotionMode::Feed && info.surface_of(point.region).cutting
        };
        for point in inside.iter().filter(|point| !cuts(point)) {
            if point.depth > self.tolerance {
                let surface = info.regions[point.region].surface;
                let place = || tree.point(point.slot);
                contacts.record(surface, point.slot, tree.slots(), time, point.depth, place);
            }
        }
        // Points that are still inside at the end keep their contact, all others end theirs.
        if is_last && !contacts.is_empty() {
            let slots = inside.iter().filter(|point| !cuts(point)).map(|point| point.slot);
            self.still_inside = slots.filter(|slot| contacts.contains(*slot)).collect();
            self.still_inside.sort_unstable();
        }
        tree.remove(inside.iter().filter(|point| cuts(point)).map(|point| point.slot));
    }
}

/// A surface of the tool that touches material on a motion where it must not: one that does not cut, or any
/// surface in rapid traverse.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct StockContact {
    /// The tool's surface, the nearest one to the point.
    pub surface: SurfaceId,
    /// The fraction of the motion, from 0 to 1, at which the deepest point was found.
    pub time: f64,
    /// The depth of that point in the tool, in the stock's unit.
    pub depth: f64,
    /// The point: a point of material, in the part's frame and the stock's unit.
    pub point: Point3<f64>,
    /// The number of points that the surface touches for the first time since the contact began; 0 if it only
    /// went deeper.
    pub points: usize,
    /// True if the surface was already in contact at the end of the motion before.
    pub continued: bool,
}

/// The contacts of the current tool that have not ended: points stay in the stock while the tool is around
/// them.
#[derive(Debug, Default)]
pub(super) struct OpenContacts {
    /// The digest of the tool.
    tool: Option<u64>,
    surfaces: Vec<OpenContact>,
}

/// A contact of a surface.
#[derive(Debug)]
struct OpenContact {
    surface: SurfaceId,
    /// The slots of the points in contact.
    slots: BitSet,
    /// The greatest depth on the motions before; 0 if there are none.
    depth: f64,
    /// The contact on this motion.
    current: Option<StockContact>,
}

impl OpenContacts {
    /// Begins a motion of a tool, given by its digest. Returns the slots in contact with another tool, whose
    /// contacts end.
    fn begin(&mut self, tool: u64) -> Vec<usize> {
        if self.tool == Some(tool) {
            return Vec::new();
        }
        self.tool = Some(tool);
        self.surfaces.drain(..).flat_map(|open| open.slots.iter().collect::<Vec<_>>()).collect()
    }

    fn is_empty(&self) -> bool {
        self.surfaces.is_empty()
    }

    /// Returns whether the point of a slot is in contact.
    fn contains(&self, slot: usize) -> bool {
        self.surfaces.iter().any(|open| open.slots.contains(slot))
    }

    /// Records a point in contact at a time of the motion. `slots` is the number of slots, `point` returns
    /// its place.
    fn record(
        &mut self,
        surface: SurfaceId,
        slot: usize,
        slots: usize,
        time: f64,
        depth: f64,
        point: impl FnOnce() -> Point3<f64>,
    ) {
        let position = self.surfaces.iter().position(|open| open.surface == surface);
        let position = position.unwrap_or_else(|| {
            let slots = BitSet::new(slots);
            self.surfaces.push(OpenContact { surface, slots, depth: 0.0, current: None });
            self.surfaces.len() - 1
        });
        let open = &mut self.surfaces[position];
        let is_new = open.slots.insert(slot);
        let continued = open.depth > 0.0;
        let points = open.current.map_or(0, |current| current.points) + usize::from(is_new);
        let deepest = match open.current {
            Some(current) if current.depth >= depth => current,
            _ => StockContact { surface, time, depth, point: point(), points, continued },
        };
        open.current = Some(StockContact { points, ..deepest });
    }

    /// Ends a motion. Returns its contacts in the order of surfaces, and the slots that are in contact no
    /// more. `still_inside` are the slots inside the tool at the motion's end, in ascending order.
    fn finish(&mut self, still_inside: &[usize]) -> (Vec<StockContact>, Vec<usize>) {
        let (mut contacts, mut ended) = (Vec::new(), Vec::new());
        self.surfaces.retain_mut(|open| {
            if let Some(current) = open.current.take() {
                if current.points > 0 || current.depth > open.depth {
                    contacts.push(current);
                }
                open.depth = open.depth.max(current.depth);
            }
            let left: Vec<usize> = open
                .slots
                .iter()
                .filter(|slot| still_inside.binary_search(slot).is_err())
                .collect();
            left.iter().for_each(|slot| open.slots.remove(*slot));
            ended.extend(left);
            // Without a point the contact has ended.
            open.slots.iter().next().is_some()
        });
        contacts.sort_unstable_by_key(|contact| contact.surface);
        (contacts, ended)
    }
}

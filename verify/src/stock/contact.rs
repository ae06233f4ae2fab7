//! Contacts of a tool with the stock, from motion to motion.

use super::bits::BitSet;
use nalgebra::Point3;
use touchoff::SurfaceId;

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
    pub(super) fn begin(&mut self, tool: u64) -> Vec<usize> {
        if self.tool == Some(tool) {
            return Vec::new();
        }
        self.tool = Some(tool);
        self.surfaces.drain(..).flat_map(|open| open.slots.iter().collect::<Vec<_>>()).collect()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.surfaces.is_empty()
    }

    /// Returns whether the point of a slot is in contact.
    pub(super) fn contains(&self, slot: usize) -> bool {
        self.surfaces.iter().any(|open| open.slots.contains(slot))
    }

    /// Records a point in contact at a time of the motion. `slots` is the number of slots, `point` returns
    /// its place.
    pub(super) fn record(
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
    pub(super) fn finish(&mut self, still_inside: &[usize]) -> (Vec<StockContact>, Vec<usize>) {
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
            open.slots.iter().next().is_some()
        });
        contacts.sort_unstable_by_key(|contact| contact.surface);
        (contacts, ended)
    }
}

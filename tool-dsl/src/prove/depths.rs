//! Depths that are the smaller or the larger of others, as `min(r - d, z)` is: what is known of the parts decides how
//! such a depth compares with another.

use crate::expr::Id;
use crate::model::Model;

/// The largest number of depths, parts included, of a region. A sum of `abs` has twice as many with each term.
const MAX_PARTS: usize = 64;

/// The depths of a tool's regions, and the parts of those with a `min`, `max` or `abs`.
#[derive(Clone, Debug)]
pub(super) struct Depths {
    /// The depths of [`Model::depths`], followed by parts.
    pub(super) ids: Vec<Id>,
    /// For each depth, whether it is the larger or the smaller of two others, and their indices.
    pub(super) corners: Vec<Option<DepthCorner>>,
}

/// A depth that is the larger or the smaller of two others.
#[derive(Clone, Copy, Debug)]
pub(super) struct DepthCorner {
    pub(super) is_larger: bool,
    pub(super) parts: [usize; 2],
}

impl Depths {
    /// Collects the depths of a model, whose graph receives the parts.
    pub(super) fn of(model: &mut Model) -> Depths {
        let mut ids: Vec<Id> = model.regions.iter().map(|region| region.depth).collect();
        let mut corners = vec![None; ids.len()];
        for region in 0..ids.len() {
            let first = ids.len();
            let mut pending = vec![region];
            while let Some(index) = pending.pop() {
                if ids.len() - first >= MAX_PARTS {
                    break;
                }
                let Some(corner) = model.graph.corner(ids[index]) else { continue };
                let parts = corner.parts.map(|part| {
                    ids.iter().position(|known| *known == part).unwrap_or_else(|| {
                        ids.push(part);
                        corners.push(None);
                        pending.push(ids.len() - 1);
                        ids.len() - 1
                    })
                });
                corners[index] = Some(DepthCorner { is_larger: corner.is_larger, parts });
            }
        }
        Depths { ids, corners }
    }
}

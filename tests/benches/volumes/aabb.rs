//! Boxes along the part's axes: centre and half extents. What is called a 6-DOP is the same.

use crate::split::{Bounds, Item};
use crate::volume::{Frame, Place, Volume, dot};

pub(crate) struct Aabb;

pub(crate) struct Seen {
    frame: Frame,
    /// The rotation without signs: how far half extents reach.
    reach: [[f32; 3]; 3],
}

impl Volume<6> for Aabb {
    type Seen = Seen;

    fn about(items: &[Item]) -> [f32; 6] {
        let bounds = Bounds::of(items);
        let [x, y, z] = [0, 1, 2].map(|axis| bounds.middle(axis) as f32);
        let [w, h, d] = [0, 1, 2].map(|axis| (bounds.side(axis) / 2.0) as f32);
        [x, y, z, w, h, d]
    }

    fn seen(frame: &Frame) -> Seen {
        Seen { frame: *frame, reach: frame.rows.map(|row| row.map(f32::abs)) }
    }

    #[inline(always)]
    fn may_touch<const W: usize>(seen: &Seen, volumes: &[[f32; W]; 6], lane: usize) -> bool {
        let centre = [volumes[0][lane], volumes[1][lane], volumes[2][lane]];
        let half = [volumes[3][lane], volumes[4][lane], volumes[5][lane]];
        let Frame { rows, origin } = &seen.frame;
        Place::of_box(
            [
                dot(rows[0], centre) + origin[0],
                dot(rows[1], centre) + origin[1],
                dot(rows[2], centre) + origin[2],
            ],
            [dot(seen.reach[0], half), dot(seen.reach[1], half), dot(seen.reach[2], half)],
        )
        .may_touch()
    }
}

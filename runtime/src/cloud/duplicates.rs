//! Coincident triangles: the same three vertices in the same cyclic order.

use crate::mesh::Mesh;
use crate::parallel;

/// The number of coincident triangles that each triangle of a mesh represents; `None` if all triangles
/// are distinct.
pub(super) struct Copies(Option<Vec<u32>>);

impl Copies {
    pub(super) fn of(mesh: &Mesh) -> Copies {
        let mut keyed: Vec<([u32; 3], u32)> = mesh
            .triangles()
            .iter()
            .zip(0..)
            .map(|(&[a, b, c], id)| {
                let rotations = [[a, b, c], [b, c, a], [c, a, b]];
                (rotations.into_iter().min().unwrap_or_default(), id)
            })
            .collect();
        parallel::sort(&mut keyed);
        if keyed.windows(2).all(|pair| pair[0].0 != pair[1].0) {
            return Copies(None);
        }
        let mut counts = vec![0; keyed.len()];
        for same in keyed.chunk_by(|a, b| a.0 == b.0) {
            counts[same[0].1 as usize] = same.len() as u32;
        }
        Copies(Some(counts))
    }

    /// Returns the number of copies of a triangle, including itself, or 0 if one with a lower id
    /// represents it.
    pub(super) fn count(&self, triangle: u32) -> u32 {
        self.0.as_ref().map_or(1, |counts| counts[triangle as usize])
    }
}

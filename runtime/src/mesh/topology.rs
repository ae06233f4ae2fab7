//! The connections of a mesh's triangles: edges and their uses, neighbours, shells.

use crate::cancellation;
use crate::mesh::{Mesh, area_and_normal, bounds};
use nalgebra::{Point3, Vector3};

/// Numbers of edges by their uses.
pub(super) struct Edges {
    /// Edges with an odd number of uses.
    pub(super) open: usize,
    /// Edges with an even number of uses that are not equally many in both directions.
    pub(super) crossed: usize,
    /// Edges used by more than two triangles.
    pub(super) shared: usize,
}

impl Edges {
    /// Counts edges by their uses.
    pub(super) fn of(mesh: &Mesh) -> Edges {
        let uses = edge_uses(mesh).map(|[from, to]| ([from, to], from < to));
        let mut edges = Edges { open: 0, crossed: 0, shared: 0 };
        for_each_edge(uses, mesh.vertices().len(), |uses| {
            let upward = uses.iter().filter(|(_, upward)| *upward).count();
            edges.open += usize::from(uses.len() % 2 == 1);
            edges.crossed += usize::from(uses.len() % 2 == 0 && 2 * upward != uses.len());
            edges.shared += usize::from(uses.len() > 2);
        });
        edges
    }
}

/// Passes the uses of each edge to a function: those of an edge together, each with its higher vertex and what it was given.
/// Vertices are less than `vertices`.
///
/// All uses of an edge go into the bucket of its lower vertex; each bucket, with a handful of entries, is sorted by the higher
/// vertex.
fn for_each_edge<T: Copy + Default + Ord>(
    uses: impl Iterator<Item = ([u32; 2], T)> + Clone,
    vertices: usize,
    mut each: impl FnMut(&[(u32, T)]),
) {
    let mut starts = vec![0usize; vertices + 1];
    for ([from, to], _) in uses.clone() {
        starts[from.min(to) as usize + 1] += 1;
    }
    for vertex in 1..starts.len() {
        starts[vertex] += starts[vertex - 1];
    }
    let mut sorted = vec![(0, T::default()); starts[vertices]];
    // Counting sort: the starts themselves stay, as the bounds of the buckets.
    let mut next_slots = starts.clone();
    for ([from, to], given) in uses {
        let slot = &mut next_slots[from.min(to) as usize];
        sorted[*slot] = (from.max(to), given);
        *slot += 1;
    }
    for bucket in starts.windows(2) {
        let bucket = &mut sorted[bucket[0]..bucket[1]];
        bucket.sort_unstable();
        bucket.chunk_by(|a, b| a.0 == b.0).for_each(&mut each);
    }
}

/// Iterates over the directed edges of all triangles, except triangles that name a vertex twice. These
/// have collapsed into an edge or a point, and their contributions would cancel.
fn edge_uses(mesh: &Mesh) -> impl Iterator<Item = [u32; 2]> + Clone {
    mesh.triangles()
        .iter()
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
}

/// The number that stands for no triangle.
pub(crate) const NO_TRIANGLE: u32 = u32::MAX;

/// Returns the neighbours of each triangle across its sides, from its first corner on, where exactly two triangles share the
/// edge; elsewhere [`NO_TRIANGLE`]. Triangles are given by their vertices, which are fewer than `vertices`.
pub(crate) fn neighbours(triangles: &[[u32; 3]], vertices: usize) -> Vec<[u32; 3]> {
    let uses = (0u32..).zip(triangles).flat_map(|(index, &[a, b, c])| {
        [([a, b], (index, 0u8)), ([b, c], (index, 1)), ([c, a], (index, 2))]
    });
    let mut neighbours = vec![[NO_TRIANGLE; 3]; triangles.len()];
    for_each_edge(uses, vertices, |uses| {
        if let [(_, (first, side)), (_, (second, other))] = *uses {
            neighbours[first as usize][usize::from(side)] = second;
            neighbours[second as usize][usize::from(other)] = first;
        }
    });
    neighbours
}

/// Returns the triangles of pieces with a negative volume: voids, or pieces that are inside out. Triangles are given by
/// their corners and their [`neighbours`]. A piece continues only to neighbours, so pieces that touch in a vertex or along
/// an edge of more triangles are separate.
pub(crate) fn inverted(corners: &[[Point3<f64>; 3]], neighbours: &[[u32; 3]]) -> Vec<u32> {
    let [low, high] = bounds(corners.iter().flatten().copied());
    let origin = nalgebra::center(&low, &high);
    let mut pieces = DisjointSets::new(corners.len());
    for (index, others) in (0..).zip(neighbours) {
        for other in others.iter().copied().filter(|other| *other < index) {
            pieces.join([index, other]);
        }
    }
    let mut volumes = vec![0.0; corners.len()];
    for (index, corners) in (0..).zip(corners) {
        if let Some((area, normal)) = area_and_normal(corners) {
            volumes[pieces.root(index) as usize] += cone_volume(corners, area, &normal, &origin);
        }
    }
    let is_inverted = |index: &u32| volumes[pieces.root(*index) as usize] < 0.0;
    (0..corners.len() as u32).filter(is_inverted).collect()
}

/// Returns the signed volume of the cone from a point to a triangle, of which area and normal are known.
pub(super) fn cone_volume(
    corners: &[Point3<f64>; 3],
    area: f64,
    normal: &Vector3<f64>,
    apex: &Point3<f64>,
) -> f64 {
    normal.dot(&(corners[0] - apex)) * area / 3.0
}

/// Returns the shell index of each vertex and the number of shells, by union-find. The entry of a vertex
/// that no triangle uses is meaningless.
pub(super) fn shells(mesh: &Mesh) -> (Vec<u32>, usize) {
    let mut is_used = vec![false; mesh.vertices().len()];
    let mut sets = DisjointSets::new(is_used.len());
    for triangle in mesh.triangles() {
        cancellation::check();
        triangle.iter().for_each(|vertex| is_used[*vertex as usize] = true);
        sets.join(*triangle);
    }
    // The root is the lowest vertex of its shell, so it is numbered before the others.
    let mut count = 0;
    let mut shell_of = vec![0; is_used.len()];
    for vertex in (0..is_used.len()).filter(|vertex| is_used[*vertex]) {
        let root = sets.root(vertex as u32) as usize;
        if root == vertex {
            shell_of[vertex] = count;
            count += 1;
        } else {
            shell_of[vertex] = shell_of[root];
        }
    }
    (shell_of, count as usize)
}

/// Sets of the numbers from 0 on, which can be joined. The root of a set is its lowest number.
struct DisjointSets {
    /// A lower number of the same set, or the number itself for a root.
    parent: Vec<u32>,
}

impl DisjointSets {
    /// Creates a set of each number.
    fn new(count: usize) -> DisjointSets {
        DisjointSets { parent: (0..count as u32).collect() }
    }

    /// Returns the root of a number's set.
    fn root(&mut self, mut number: u32) -> u32 {
        while self.parent[number as usize] != number {
            let next = self.parent[number as usize];
            // Halves the path on the way, which keeps all paths short.
            self.parent[number as usize] = self.parent[next as usize];
            number = next;
        }
        number
    }

    /// Joins the sets of some numbers.
    fn join<const N: usize>(&mut self, numbers: [u32; N]) {
        let roots = numbers.map(|number| self.root(number));
        let lowest = roots.into_iter().min().unwrap_or_default();
        for root in roots {
            self.parent[root as usize] = lowest;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::shapes;
    use super::*;
    use crate::unit::Unit;

    #[test]
    fn neighbours_share_an_edge_with_no_third_triangle() {
        let [low, high] = [0.0, 1.0].map(|c| Point3::new(c, c, c));
        let cube = shapes::cuboid(low, high, Unit::Millimetre).expect("a cube");
        let mut triangles = cube.triangles().to_vec();
        // A fin on the edge from 0 to 4, and a triangle that names a vertex twice.
        triangles.extend([[0, 4, 7], [5, 5, 6]]);
        let found = neighbours(&triangles, cube.vertices().len());
        let uses = |from: u32, to: u32| {
            let has = |[a, b, c]: &[u32; 3]| {
                let sides = [[*a, *b], [*b, *c], [*c, *a]];
                sides
                    .into_iter()
                    .filter(|[x, y]| [*x, *y] == [from, to] || [*y, *x] == [from, to])
                    .count()
            };
            let users = (0..).zip(&triangles).flat_map(|(id, triangle)| vec![id; has(triangle)]);
            users.collect::<Vec<u32>>()
        };
        let mut alone = 0;
        for (id, [a, b, c]) in (0..).zip(&triangles) {
            for (side, [from, to]) in [[*a, *b], [*b, *c], [*c, *a]].into_iter().enumerate() {
                let expected = match uses(from, to)[..] {
                    [first, second] => first + second - id,
                    _ => NO_TRIANGLE,
                };
                alone += usize::from(expected == NO_TRIANGLE);
                assert_eq!(found[id as usize][side], expected, "triangle {id}, side {side}");
            }
        }
        assert!(alone > 3 && alone < 15, "{alone}");
    }
}

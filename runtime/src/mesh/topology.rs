//! Edges and shells of a mesh: uses of each edge, connected pieces, and pieces that are inside out.

use super::{Mesh, area_and_normal};

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
    /// Counts edges by sorting. All uses of an edge go into the bucket of its lower vertex; each bucket,
    /// with a handful of entries, is sorted by the higher vertex.
    pub(super) fn of(mesh: &Mesh) -> Edges {
        let mut starts = vec![0usize; mesh.vertices().len() + 1];
        for [from, to] in edge_uses(mesh) {
            starts[from.min(to) as usize + 1] += 1;
        }
        for vertex in 1..starts.len() {
            starts[vertex] += starts[vertex - 1];
        }
        let mut uses = vec![0u64; starts[starts.len() - 1]];
        let mut next_slots = starts.clone();
        for [from, to] in edge_uses(mesh) {
            let slot = &mut next_slots[from.min(to) as usize];
            uses[*slot] = u64::from(from.max(to)) << 1 | u64::from(from < to);
            *slot += 1;
        }
        let mut edges = Edges { open: 0, crossed: 0, shared: 0 };
        for bucket in starts.windows(2) {
            let bucket = &mut uses[bucket[0]..bucket[1]];
            bucket.sort_unstable();
            for edge in bucket.chunk_by(|a, b| a >> 1 == b >> 1) {
                let upward = edge.iter().filter(|&&entry| entry & 1 == 1).count();
                edges.open += usize::from(edge.len() % 2 == 1);
                edges.crossed += usize::from(edge.len() % 2 == 0 && 2 * upward != edge.len());
                edges.shared += usize::from(edge.len() > 2);
            }
        }
        edges
    }
}

/// Iterates over the directed edges of all triangles, except triangles that name a vertex twice. These
/// have collapsed into an edge or a point, and their contributions would cancel.
fn edge_uses(mesh: &Mesh) -> impl Iterator<Item = [u32; 2]> {
    let has_distinct_corners = |[a, b, c]: &&[u32; 3]| a != b && b != c && c != a;
    mesh.triangles()
        .iter()
        .filter(has_distinct_corners)
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
}

/// Returns the triangles of pieces with a negative volume: voids, or pieces that are inside out. A piece
/// continues only across edges of exactly two triangles, so pieces that touch in a vertex or along an
/// edge are separate.
pub(crate) fn inverted(mesh: &Mesh) -> Vec<u32> {
    let [low, high] = mesh.bounds();
    let origin = nalgebra::center(&low, &high);
    let mut parent: Vec<u32> = (0..mesh.triangles().len() as u32).collect();
    let mut uses: Vec<([u32; 2], u32)> = (0..)
        .zip(mesh.triangles())
        .flat_map(|(id, [a, b, c])| {
            [[a, b], [b, c], [c, a]].map(|[x, y]| ([*x.min(y), *x.max(y)], id))
        })
        .collect();
    uses.sort_unstable();
    for edge in uses.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, first), (_, second)] = edge {
            let [first, second] = [first, second].map(|id| root(&mut parent, *id));
            parent[first.max(second) as usize] = first.min(second);
        }
    }
    let mut volumes = vec![0.0; parent.len()];
    for (id, corners) in (0..).zip(mesh.corners()) {
        if let Some((area, normal)) = area_and_normal(&corners) {
            let component = root(&mut parent, id) as usize;
            volumes[component] += normal.dot(&(corners[0] - origin)) * area / 3.0;
        }
    }
    (0..parent.len() as u32).filter(|id| volumes[root(&mut parent, *id) as usize] < 0.0).collect()
}

/// Returns the shell index of each vertex and the number of shells, by union-find. The entry of a vertex
/// that no triangle uses is meaningless.
pub(super) fn shells(mesh: &Mesh) -> (Vec<u32>, usize) {
    const UNUSED: u32 = u32::MAX;
    let mut parent = vec![UNUSED; mesh.vertices().len()];
    for triangle in mesh.triangles() {
        for &vertex in triangle {
            if parent[vertex as usize] == UNUSED {
                parent[vertex as usize] = vertex;
            }
        }
        let [a, b, c] = triangle.map(|vertex| root(&mut parent, vertex));
        let lowest = a.min(b).min(c);
        for vertex in [a, b, c] {
            parent[vertex as usize] = lowest;
        }
    }
    // The root is the lowest vertex of its shell, so it is numbered before the others.
    let mut count = 0;
    let mut shell_of = vec![0; parent.len()];
    for vertex in 0..parent.len() {
        if parent[vertex] == UNUSED {
            continue;
        }
        let root_vertex = root(&mut parent, vertex as u32) as usize;
        if root_vertex == vertex {
            shell_of[vertex] = count;
            count += 1;
        } else {
            shell_of[vertex] = shell_of[root_vertex];
        }
    }
    (shell_of, count as usize)
}

fn root(parent: &mut [u32], mut vertex: u32) -> u32 {
    while parent[vertex as usize] != vertex {
        let next = parent[vertex as usize];
        parent[vertex as usize] = parent[next as usize];
        vertex = next;
    }
    vertex
}

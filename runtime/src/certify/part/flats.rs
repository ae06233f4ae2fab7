//! Flat faces of many triangles: what is as deep in all of them is asked once.
//!
//! A tool in a bore, or flat on a plate, is as deep in a great many triangles, and no box of them is known
//! closely enough to tell. The rectangle that a flat face is within is: what bounds it bounds all its
//! triangles.

use crate::bvh::WIDTH;
use crate::certify::space::{Point, cross, dot, minus, norm};
use crate::mesh::Mesh;

/// Fewer triangles are no face.
const FEW: usize = 8;

/// How many faces the triangles of a node are of at most, for it to be left by them.
const FACES: usize = 16;

/// No face.
const NONE: u32 = u32::MAX;

/// A part's flat faces. Triangles are by their places in the tree's order.
#[derive(Clone, Debug)]
pub(crate) struct Flats {
    pub(crate) faces: Vec<Face>,
    /// Of each triangle.
    of: Vec<u32>,
    /// Those that all triangles of a node are of, if these are few; leaves stand behind the last level.
    nodes: Vec<Vec<[u32; FACES]>>,
}

/// The rectangle that a flat face is within.
#[derive(Clone, Debug)]
pub(crate) struct Face {
    /// A corner of one of its triangles.
    pub(crate) from: Point,
    /// The rectangle's corners from there.
    pub(crate) corners: [Point; 4],
}

fn unit(a: Point) -> Option<Point> {
    let size = norm(a);
    (size > 0.0).then(|| a.map(|part| part / size))
}

impl Flats {
    /// The faces of a mesh, whose triangles are in that order. What is no farther than `flat` from a
    /// triangle's plane is in it.
    pub(crate) fn new(mesh: &Mesh, ids: &[u32], corners: &[[Point; 3]], flat: f64) -> Flats {
        let beside = beside(mesh, ids);
        let (mut of, mut faces) = (vec![NONE; ids.len()], Vec::new());
        let mut taken = vec![false; ids.len()];
        let mut face = Vec::new();
        for seed in 0..ids.len() {
            let [a, b, c] = corners[seed];
            let Some(normal) = unit(cross(minus(b, a), minus(c, a))).filter(|_| !taken[seed])
            else {
                continue;
            };
            let lies = |k: u32| {
                corners[k as usize].iter().all(|p| dot(normal, minus(*p, a)).abs() <= flat)
            };
            if !lies(seed as u32) {
                continue;
            }
            face.clear();
            face.push(seed as u32);
            taken[seed] = true;
            let mut next = 0;
            while next < face.len() {
                for other in beside[face[next] as usize] {
                    if other != NONE && !taken[other as usize] && lies(other) {
                        taken[other as usize] = true;
                        face.push(other);
                    }
                }
                next += 1;
            }
            if face.len() < FEW {
                // They may be of a face that is seen from another.
                face[1..].iter().for_each(|k| taken[*k as usize] = false);
                continue;
            }
            face.iter().for_each(|k| of[*k as usize] = faces.len() as u32);
            faces.push(Face::around(&face, corners, normal));
        }
        let mut nodes = vec![of.chunks(WIDTH).map(|some| few(some.iter().copied())).collect()];
        while let Some(last) = nodes.last().filter(|last: &&Vec<_>| last.len() > 1) {
            nodes
                .push(last.chunks(WIDTH).map(|some| few(some.iter().flatten().copied())).collect());
        }
        nodes.reverse();
        Flats { faces, of, nodes }
    }

    /// The faces that all triangles of a node of a level are of; `None` if there are others, or many.
    pub(crate) fn of_node(&self, level: usize, index: usize) -> Option<&[u32]> {
        let faces = &self.nodes.get(level)?[index];
        let count = faces.iter().take_while(|face| **face != NONE).count();
        (count > 0).then_some(&faces[..count])
    }

    /// The face of a triangle.
    pub(crate) fn of_triangle(&self, index: u32) -> Option<u32> {
        Some(self.of[index as usize]).filter(|face| *face != NONE)
    }
}

/// What some faces are, if they are few and none is missing: first those that there are.
fn few(some: impl Iterator<Item = u32>) -> [u32; FACES] {
    let (mut faces, mut count) = ([NONE; FACES], 0);
    for face in some {
        if faces[..count].contains(&face) {
            continue;
        }
        if face == NONE || count == FACES {
            return [NONE; FACES];
        }
        faces[count] = face;
        count += 1;
    }
    faces
}

/// The triangles beside each, across edges that two have.
fn beside(mesh: &Mesh, ids: &[u32]) -> Vec<[u32; 3]> {
    let mut edges: Vec<([u32; 2], u32, usize)> = Vec::with_capacity(3 * ids.len());
    for (index, id) in (0u32..).zip(ids) {
        let [a, b, c] = mesh.triangles()[*id as usize];
        for (side, [p, q]) in [[a, b], [b, c], [c, a]].into_iter().enumerate() {
            edges.push(([p.min(q), p.max(q)], index, side));
        }
    }
    edges.sort_unstable();
    let mut beside = vec![[NONE; 3]; ids.len()];
    for group in edges.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, first, side), (_, second, other)] = group {
            beside[*first as usize][*side] = *second;
            beside[*second as usize][*other] = *first;
        }
    }
    beside
}

impl Face {
    /// The smallest rectangle along a side of its first triangle.
    fn around(face: &[u32], corners: &[[Point; 3]], normal: Point) -> Face {
        let [a, b, c] = corners[face[0] as usize];
        let places = || face.iter().flat_map(|k| corners[*k as usize]).map(|p| minus(p, a));
        let along = |side: Point| {
            let out = dot(side, normal);
            let u = unit([0, 1, 2].map(|k| side[k] - out * normal[k]))?;
            let v = unit(cross(normal, u))?;
            let ends = |way: Point| {
                places()
                    .map(|p| dot(way, p))
                    .fold([0.0f64; 2], |[low, high], at| [low.min(at), high.max(at)])
            };
            let ([u0, u1], [v0, v1]) = (ends(u), ends(v));
            let corner = |x: f64, y: f64| [0, 1, 2].map(|k| x * u[k] + y * v[k]);
            let corners = [corner(u0, v0), corner(u1, v0), corner(u1, v1), corner(u0, v1)];
            Some(((u1 - u0) * (v1 - v0), corners))
        };
        let sides = [minus(b, a), minus(c, b), minus(a, c)];
        let least = sides.into_iter().filter_map(along).min_by(|p, q| p.0.total_cmp(&q.0));
        Face { from: a, corners: least.expect("a triangle with a normal has sides").1 }
    }
}

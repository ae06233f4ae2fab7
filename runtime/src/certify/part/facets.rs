//! A part's triangles in a tree.

use super::flat::Plane;
use super::flats::Flats;
use crate::bvh::{Bounds, Boxes, Frame, Item, WIDTH, levels, order};
use crate::mesh::Mesh;
use crate::mesh::{self, inverted};
use crate::unit::Unit;
use nalgebra::Point3;

/// The triangles of a part, arranged for being asked how deep a tool is in them: a 16-wide tree of boxes
/// like that of a cloud, whose leaves hold 16 triangles.
///
/// Corners are kept as they were given, in the part's frame and unit. Triangles without area stay: they
/// are edges, and are as deep as their points.
#[derive(Clone, Debug)]
pub struct Facets {
    pub(crate) frame: Frame,
    /// From the root's children down to the leaves' boxes.
    pub(crate) levels: Vec<Vec<Boxes>>,
    /// Of each node of a level, and of each leaf behind the last.
    pub(crate) planes: Vec<Vec<Plane>>,
    pub(crate) flats: Flats,
    /// The corners of 16 triangles.
    pub(crate) leaves: Vec<Corners>,
    /// Of each triangle, in the tree's order.
    pub(crate) corners: Vec<[[f64; 3]; 3]>,
    /// Their ids in the mesh.
    pub(crate) ids: Vec<u32>,
    unit: Unit,
    /// Whether it can be known what is inside.
    pub(crate) solid: bool,
}

/// The first, second and third corners of 16 triangles from the middle of their box, coordinate by
/// coordinate; what is not there is NaN.
#[derive(Clone, Debug)]
pub(crate) struct Corners(pub(crate) [[[f32; WIDTH]; 3]; 3]);

/// What is no farther from a plane is in it, in the part's unit. It adds to the depth of a face, so that any number would
/// be right; with `32 u` of the part's extent (`u = ε/2`) triangles of a plane whose corners were rounded once are of one
/// face. Telling that itself errs by less than `10 u` of a face's extent, which [`rounding`](crate::certify::rounding) has room
/// for: a face is asked for a bound only, and not for the `41 uM` of meridians and ways.
pub(crate) fn flat(frame: &Frame) -> f64 {
    16.0 * f64::EPSILON * f64::from(frame.size) * frame.scale
}

impl Facets {
    /// The triangles of a mesh.
    pub fn new(mesh: &Mesh) -> Facets {
        let corners: Vec<[[f64; 3]; 3]> =
            mesh.corners().map(|corners| corners.map(|p| [p.x, p.y, p.z])).collect();
        let frame = Frame::around(corners.iter().flatten().copied());
        let bounds = |corners: &[[f64; 3]; 3]| Bounds::of(corners.map(|place| frame.inside(place)));
        let mut items: Vec<Item> = corners
            .iter()
            .zip(0u32..)
            .map(|(corners, index)| {
                let bounds = bounds(corners);
                Item { at: [0, 1, 2].map(|axis| bounds.middle(axis)), index }
            })
            .collect();
        order(&mut items);
        let corners: Vec<_> = items.iter().map(|item| corners[item.index as usize]).collect();
        let boxes: Vec<Bounds> = corners
            .chunks(WIDTH)
            .map(|leaf| Bounds::of(leaf.iter().flatten().map(|corner| frame.inside(*corner))))
            .collect();
        let levels = levels(boxes);
        let above = &levels[levels.len() - 1];
        let leaves = corners.chunks(WIDTH).enumerate().map(|(leaf, triangles)| {
            let mut corners = Corners([[[f32::NAN; WIDTH]; 3]; 3]);
            let boxes = &above[leaf / WIDTH];
            for (lane, triangle) in triangles.iter().enumerate() {
                for (list, corner) in corners.0.iter_mut().zip(triangle) {
                    let place = frame.inside(*corner);
                    for axis in 0..3 {
                        let middle = f64::from(boxes.centre[axis][leaf % WIDTH]);
                        list[axis][lane] = (place[axis] - middle) as f32;
                    }
                }
            }
            corners
        });
        let inside: Vec<_> =
            corners.iter().map(|triangle| triangle.map(|corner| frame.inside(corner))).collect();
        let depth = levels.len() as u32;
        let planes = (0..=depth).map(|level| {
            let below = WIDTH.pow(depth + 1 - level);
            inside.chunks(below).map(Plane::of).collect()
        });
        let ids: Vec<u32> = items.iter().map(|item| item.index).collect();
        let survey = mesh.survey();
        let mut facets = Facets {
            flats: Flats::new(mesh, &ids, &corners, flat(&frame)),
            planes: planes.collect(),
            leaves: leaves.collect(),
            levels,
            corners,
            ids,
            frame,
            unit: mesh.unit(),
            solid: survey.solid(),
        };
        facets.solid = facets.solid && facets.voids_are_voids(mesh);
        facets
    }

    /// Returns whether pieces that face inward are voids in the material: beside none of their triangles does the
    /// surface go around a point less than 0 times, as it does inside a piece that is inside out.
    fn voids_are_voids(&self, mesh: &Mesh) -> bool {
        let inverted = inverted(mesh);
        let mut places = vec![0; if inverted.is_empty() { 0 } else { self.len() }];
        if !inverted.is_empty() {
            self.ids.iter().enumerate().for_each(|(place, id)| places[*id as usize] = place);
        }
        let is_void = |id: u32| !self.is_negative_beside(places[id as usize]);
        inverted.into_iter().all(|id| mesh.normal(id).is_none() || is_void(id))
    }

    /// The lowest and the highest corner of the box about the triangles.
    pub fn bounds(&self) -> [Point3<f64>; 2] {
        mesh::bounds(self.corners.iter().flatten().map(|corner| Point3::from(*corner)))
    }

    /// How many triangles there are.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Whether there is none; a [`Mesh`] always has some.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Returns whether it is known what is inside: the mesh is closed, consistently oriented, and not inside out.
    pub fn has_inside(&self) -> bool {
        self.solid
    }

    /// The unit of its lengths.
    pub fn unit(&self) -> Unit {
        self.unit
    }

    /// How many children a node of a level has; behind the last level are leaves.
    pub(crate) fn children(&self, level: usize, node: usize) -> usize {
        let below = match self.levels.len() - level.min(self.levels.len()) {
            0 => self.len(),
            1 => self.leaves.len(),
            _ => self.levels[level + 1].len(),
        };
        (below - WIDTH * node).min(WIDTH)
    }
}

//! The side that the normals of points face: out of the material or into it, as far as the points tell.

use super::PointBvh;
use crate::parallel;
use nalgebra::{Point3, Vector3};
use std::f64::consts::TAU;

/// Number of points at which the surface around is looked at, and of points that stand for the surface: some 0.1 s.
const SITES: usize = 256;
const MAX_SOURCES: usize = 200_000;
/// Sites per parallel task.
const SITES_PER_TASK: usize = 16;

/// Enclosure from which normals count as facing inward. A sphere of which a third is missing has -0.75.
const INWARD: f64 = -0.75;
/// Enclosure from which that is likely. A hollow half sphere has -0.63, a bowl of a third of that depth -0.35.
const LIKELY_INWARD: f64 = -0.35;

/// Degree to which a surface closes around the side that its normals face away from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Enclosure {
    /// 1 for a closed surface whose normals face outward, -1 if they face inward, 0 for a plane; in between for an open surface,
    /// and where normals disagree.
    pub(crate) mean: f64,
    /// The fraction of the surface where it closes around the side that the normals face.
    pub(crate) inward: f64,
}

/// A point of the surface, its normal and its area.
struct Source {
    at: Point3<f64>,
    normal: Vector3<f64>,
    weight: f64,
}

impl Enclosure {
    /// Computes the enclosure of a tree's points: the mean, over the surface, of twice the winding number on it (the solid angle under
    /// which a place of the surface sees the inner sides of the rest, divided by 2π).
    pub(crate) fn of(tree: &PointBvh) -> Enclosure {
        let slots: Vec<usize> = (0..tree.slots()).filter(|slot| tree.has_point(*slot)).collect();
        let spread = |count: usize| slots.iter().step_by(slots.len().div_ceil(count).max(1));
        // Points are in the order of the tree, so that each stride is spread over the part.
        let source = |slot: &usize| Source {
            at: tree.point(*slot),
            normal: tree.normal(*slot).into(),
            weight: tree.weight(*slot),
        };
        let sources: Vec<Source> = spread(MAX_SOURCES).map(source).collect();
        let sites: Vec<Source> = spread(SITES).map(source).collect();
        // Each source stands for those that were left out.
        let total: f64 = slots.iter().map(|slot| tree.weight(*slot)).sum();
        let share = total / sources.iter().map(|source| source.weight).sum::<f64>();
        let windings = parallel::ranges(sites.len(), SITES_PER_TASK, |range| {
            let windings =
                sites[range].iter().map(|site| share * solid_angle(&sources, site) / TAU);
            // Points that nearly coincide may see each other under any angle.
            windings.map(|winding| winding.clamp(-1.0, 1.0)).collect::<Vec<f64>>()
        });
        let (mut area, mut sum, mut inward) = (0.0, 0.0, 0.0);
        for (site, winding) in sites.iter().zip(windings.into_iter().flatten()) {
            area += site.weight;
            sum += site.weight * winding;
            inward += if winding < 0.0 { site.weight } else { 0.0 };
        }
        match area > 0.0 {
            true => Enclosure { mean: sum / area, inward: inward / area },
            false => Enclosure { mean: 0.0, inward: 0.0 },
        }
    }

    /// Returns the finding about normals that face inward, or may do so.
    pub(crate) fn finding(&self) -> Option<String> {
        let percent = (100.0 * self.inward).round();
        match self.mean {
            mean if mean <= INWARD => Some(format!(
                "the normals face into the material: at {percent} % of the points the surface closes around the side that they face, \
                 so that the part would pull the tool in; flip them where they were made, unless this is the wall of a closed cavity"
            )),
            mean if mean <= LIKELY_INWARD => Some(format!(
                "the normals may face into the material: the surface is open, and at {percent} % of the points it bends around the side \
                 that they face, as a hollow does, or a body whose normals are wrong; if it is a body, flip them where they were made"
            )),
            _ => None,
        }
    }
}

/// Returns the solid angle under which a site sees the inner sides of the sources, less that of their outer sides.
fn solid_angle(sources: &[Source], site: &Source) -> f64 {
    let seen = sources.iter().map(|source| {
        let to_source = source.at - site.at;
        let squared = to_source.norm_squared();
        // The site itself, and points that coincide with it.
        let is_apart = squared > 0.0;
        if is_apart {
            source.weight * source.normal.dot(&to_source) / (squared * squared.sqrt())
        } else {
            0.0
        }
    });
    seen.sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{OrientedPoints, shapes};
    use crate::{Cloud, Mesh, Part, Sampling, Unit};

    const UNIT: Unit = Unit::Millimetre;

    /// Returns the findings about points of a mesh, without those for which `keep` fails, with normals multiplied by `sign`.
    fn findings(mesh: &Mesh, sign: f64, keep: impl Fn(&Point3<f64>) -> bool) -> Vec<String> {
        let cloud = Cloud::sample(mesh, Sampling::new(3_000)).expect("a cloud");
        let kept = cloud.points().iter().zip(cloud.normals()).filter(|(point, _)| keep(point));
        let (points, normals) = kept.map(|(point, normal)| (*point, normal * sign)).unzip();
        let points = OrientedPoints { points, normals, ..OrientedPoints::default() };
        Part::from_cloud(&Cloud::from_points(points, UNIT).expect("a cloud")).findings()
    }

    fn sphere() -> Mesh {
        shapes::sphere(10.0, 4, UNIT).expect("a sphere")
    }

    fn box_of(height: f64) -> Mesh {
        let [low, high] = [Point3::new(-10.0, -10.0, -height), Point3::new(10.0, 10.0, 0.0)];
        shapes::cuboid(low, high, UNIT).expect("a box")
    }

    #[test]
    fn outward_normals_have_no_finding() {
        for mesh in [sphere(), box_of(20.0), box_of(0.5), crate::scenes::tube()] {
            assert_eq!(findings(&mesh, 1.0, |_| true), Vec::<String>::new());
        }
        // Scans from one side: a body without its base, and a plane.
        assert_eq!(findings(&sphere(), 1.0, |point| point.z > -7.0), Vec::<String>::new());
        assert_eq!(findings(&box_of(20.0), 1.0, |point| point.z > -0.01), Vec::<String>::new());
    }

    #[test]
    fn inward_normals_are_named() {
        for mesh in [sphere(), box_of(20.0), box_of(0.5), crate::scenes::tube()] {
            let found = findings(&mesh, -1.0, |_| true).concat();
            assert!(found.contains("the normals face into the material: at 100 %"), "{found}");
        }
        // Open, but not wide open.
        let found = findings(&sphere(), -1.0, |point| point.z > -7.0).concat();
        assert!(found.contains("the normals face into the material"), "{found}");
    }

    /// A half sphere with inward normals has the points of a hollow with outward ones, and a plane has no side.
    #[test]
    fn what_cannot_be_known_is_not_claimed() {
        let found = findings(&sphere(), -1.0, |point| point.z > 0.0).concat();
        assert!(found.contains("the normals may face into the material"), "{found}");
        for sign in [1.0, -1.0] {
            let plane = findings(&box_of(20.0), sign, |point| point.z > -0.01);
            assert_eq!(plane, Vec::<String>::new());
        }
    }

    /// A mesh is judged by its own diagnostics.
    #[test]
    fn a_part_of_a_mesh_has_the_findings_of_the_mesh() {
        let mesh = sphere();
        let part = Part::from_mesh(&mesh, Sampling::new(100)).expect("a part");
        assert_eq!(part.findings(), mesh.diagnostics().findings());
    }
}

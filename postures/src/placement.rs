//! Placement of a tool at a point of a part: the points of its cutting profile that can touch a face, the position of its
//! tip, and the niceness of the contact.

use nalgebra::{Point3, Vector3};
use std::f64::consts::PI;
use touchoff::tool::{Circle, Evaluations, Outputs, PointBatch, ToolInfo};
use touchoff::{Level, Tool, Unit};
use touchoff_plane::angle_between;

/// A point of contact on the part's surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfacePoint {
    pub(super) point: Point3<f64>,
    /// Outward normal.
    pub(super) normal: Vector3<f64>,
}

/// A posture in which a tool touches a surface point, regardless of other interference.
#[derive(Clone, Copy, Debug)]
pub(super) struct CandidatePosture {
    /// Index of the axis in the list that was given.
    pub(super) direction: usize,
    pub(super) tip: Point3<f64>,
    /// Least niceness of the touching surfaces; NaN where the tool gives none.
    pub(super) niceness: f64,
}

/// Computes the postures in which a tool touches a surface point.
pub(super) struct ToolPlacement<'a> {
    tool: &'a dyn Tool,
    /// Factor from the tool's unit of length to the part's.
    length: f64,
    sites: ContactSites,
    points: PointBatch,
    evaluations: Evaluations,
}

impl<'a> ToolPlacement<'a> {
    /// Creates the placement of a tool at a part in the given unit of length.
    pub(super) fn new(tool: &'a dyn Tool, unit: Unit) -> ToolPlacement<'a> {
        let length = tool.info().unit.factor_to(unit);
        ToolPlacement {
            tool,
            length,
            sites: ContactSites::new(tool.info(), length),
            points: PointBatch::default(),
            evaluations: Evaluations::default(),
        }
    }

    /// Returns the largest distance between the tip and a point of contact, in the part's unit.
    pub(super) fn reach(&self) -> f64 {
        self.sites.reach()
    }

    /// Replaces `postures` by those in which the tool touches a surface point, axis by axis. Several of one
    /// axis are in descending order of niceness.
    pub(super) fn list(
        &mut self,
        target: SurfacePoint,
        axes: impl IntoIterator<Item = Vector3<f64>>,
        postures: &mut Vec<CandidatePosture>,
    ) {
        self.points.clear();
        postures.clear();
        for (direction, axis) in axes.into_iter().enumerate() {
            for contact in self.sites.contacts(target.point, target.normal, axis) {
                for [d, z] in contact.within {
                    self.points.push([d / self.length, 0.0, z / self.length]);
                }
                postures.push(CandidatePosture { direction, tip: contact.tip, niceness: f64::NAN });
            }
        }
        let outputs = Outputs { niceness: true, ..Outputs::INSIDE };
        self.tool.evaluate(Level::new(), outputs, &self.points, self.length, &mut self.evaluations);
        // Each contact has two points, one per surface that touches; the less nice of them counts.
        for index in self.evaluations.inside_indices() {
            let niceness = &mut postures[index / 2].niceness;
            *niceness = niceness.min(self.evaluations.niceness[index]);
        }
        postures
            .sort_by(|a, b| a.direction.cmp(&b.direction).then(b.niceness.total_cmp(&a.niceness)));
    }
}

/// Sites of the profile where a cutting surface is convex: arcs with their normals, and corners with the
/// normals along which they may be touched.
#[derive(Clone, Debug)]
struct ContactSites {
    sites: Vec<ContactSite>,
    /// Size of the tool, in the part's unit.
    size: f64,
}

/// A contact of a tool with a face.
struct Contact {
    /// Position of the tip.
    tip: Point3<f64>,
    /// The touching point in the tool's half plane as `[d, z]`, moved slightly into the surface on either side
    /// of it. Both surfaces touch, so the niceness of the contact is the lesser of the two.
    within: [[f64; 2]; 2],
}

/// An arc, or a corner as an arc of radius 0. Lengths are in the part's unit.
#[derive(Clone, Copy, Debug)]
struct ContactSite {
    centre: [f64; 2],
    radius: f64,
    /// Range of its normals' angles in the half plane, from d toward z, in radians.
    angles: [f64; 2],
    /// Two directions into a corner's material, nearer to the surface before it and to the surface after it. An
    /// arc has `None`: its inward direction is the opposite of the normal.
    inward: Option<[[f64; 2]; 2]>,
}

/// Tolerance of angles in radians, and of lengths relative to the circle or the tool; far above rounding
/// errors.
const TOLERANCE: f64 = 1e-9;

impl ContactSites {
    /// Collects the sites of a tool. `length` is the factor from the tool's unit of length to the part's.
    fn new(info: &ToolInfo, length: f64) -> ContactSites {
        let mut sites = Vec::new();
        // The profile continues beyond the axis as its mirror image.
        let mut previous = info.outline.first().map(|first| {
            let [d, z] = first.geometry().tangent(0);
            Previous { tangent: [d, -z], is_cutting: info.surface(first.surface).cutting }
        });
        for segment in info.outline.iter() {
            let geometry = segment.geometry();
            let tangents = [0, 1].map(|end| geometry.tangent(end));
            let is_cutting = info.surface(segment.surface).cutting;
            if is_cutting {
                if let Some(Previous { tangent, is_cutting: true }) = previous {
                    let corner = [tangent, tangents[0]];
                    sites.extend(ContactSite::corner(segment.from, corner, length));
                }
                if let Some(circle) = segment.circle.filter(|circle| circle.convex) {
                    sites.push(ContactSite::arc(circle, tangents, length));
                }
            }
            previous = Some(Previous { tangent: tangents[1], is_cutting });
        }
        ContactSites { sites, size: info.size() * length }
    }

    /// Returns the largest distance between the tip and a site, in the part's unit.
    fn reach(&self) -> f64 {
        let distances =
            self.sites.iter().map(|site| site.centre[0].hypot(site.centre[1]) + site.radius);
        distances.fold(0.0, f64::max)
    }

    /// Returns the contacts between a tool with the given axis and a face. The face has a point `point` and an
    /// outward normal; the tool's outward normal at the contact is the opposite. `normal` and `axis` are unit vectors.
    fn contacts(
        &self,
        point: Point3<f64>,
        normal: Vector3<f64>,
        axis: Vector3<f64>,
    ) -> impl Iterator<Item = Contact> {
        // The tool's outward normal is [out, up] in the half plane. No `out` is below 0: the angle is from -π/2 to π/2.
        let up = -normal.dot(&axis);
        let across = -normal - axis * up;
        let out = across.norm();
        let angle = up.atan2(out);
        self.sites.iter().filter_map(move |site| {
            let [from, to] = site.angles;
            // The angles of a site begin anywhere from -π to π and may end a turn later, so they are compared modulo a turn.
            let offset = (angle - from + TOLERANCE).rem_euclid(2.0 * PI) - TOLERANCE;
            if offset > to - from + TOLERANCE {
                return None;
            }
            let touched = [site.centre[0] + site.radius * out, site.centre[1] + site.radius * up];
            // A face perpendicular to the axis leaves the radial direction undefined; only a site on the axis needs none.
            if out < TOLERANCE && touched[0] > TOLERANCE * self.size {
                return None;
            }
            let radial = if out > 0.0 { across / out } else { across };
            let inward = site.inward.unwrap_or([[-out, -up]; 2]);
            Some(Contact {
                tip: point - radial * touched[0] - axis * touched[1],
                within: inward.map(|direction| {
                    [0, 1].map(|k| touched[k] + TOLERANCE * self.size * direction[k])
                }),
            })
        })
    }
}

impl ContactSite {
    /// Returns the site of a corner of the profile between two unit tangents; `None` if it is not convex. `length` is
    /// the factor from the tool's unit of length to the part's.
    fn corner(
        corner: [f64; 2],
        [before, after]: [[f64; 2]; 2],
        length: f64,
    ) -> Option<ContactSite> {
        let turn = angle_between(before, after);
        let from = normal_angle(before);
        // The corner's material spans an angle of π less `turn` about the opposite of the mean normal. Halfway from there to
        // a surface, a point is nearer to that surface than to the other.
        let inward = [1.0, -1.0].map(|side| {
            let (sine, cosine) = (from + 0.5 * turn + side * 0.25 * (PI - turn)).sin_cos();
            [-cosine, -sine]
        });
        // A corner that turns the other way is concave, and no plane face touches it.
        (turn > TOLERANCE).then(|| ContactSite {
            centre: corner.map(|component| component * length),
            radius: 0.0,
            angles: [from, from + turn],
            inward: Some(inward),
        })
    }

    /// Returns the site of a convex arc with these unit tangents at its ends. `length` is the factor from the tool's unit
    /// of length to the part's.
    fn arc(circle: Circle, tangents: [[f64; 2]; 2], length: f64) -> ContactSite {
        let [from, to] = tangents.map(normal_angle);
        ContactSite {
            centre: circle.centre.map(|component| component * length),
            radius: circle.radius * length,
            angles: [from, from + (to - from).rem_euclid(2.0 * PI)],
            inward: None,
        }
    }
}

/// The end of the profile's segment before the one that is examined.
struct Previous {
    /// Unit tangent.
    tangent: [f64; 2],
    is_cutting: bool,
}

/// Returns the angle of the outward normal for a direction of travel with the material on its left, from -π to π.
fn normal_angle([d, z]: [f64; 2]) -> f64 {
    (-d).atan2(z)
}

#[cfg(test)]
mod tests;

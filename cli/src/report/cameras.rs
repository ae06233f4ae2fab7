//! The camera on each finding.

use super::shapes::{Shown, ToolShape};
use crate::picture::render::Camera;
use crate::verify::Inputs;
use nalgebra::{Point3, Vector3};
use touchoff::Pose;
use touchoff_verify::job::{FindingDetail, JobFinding};
use touchoff_verify::{FindingKind, JobReport};

/// The place of a finding, and how to look at it.
pub(super) struct Place {
    /// The body that the tool touches; `None` for the stock.
    pub(super) body: Option<usize>,
    /// The index of the tool, if its pose is known.
    pub(super) tool: Option<(usize, Pose)>,
    /// The point to look at.
    pub(super) target: Point3<f64>,
    /// Direction from there to the eye, of length 1.
    pub(super) toward: Vector3<f64>,
    /// The length that the picture shows.
    pub(super) extent: f64,
}

/// Pitch of cameras above which the direction would be parallel to the upward one, as its sine.
const MAX_RISE: f64 = 0.97;

impl Place {
    /// Returns the place of a finding; `None` if it has none, such as a limit of an axis.
    pub(super) fn of(
        finding: &JobFinding,
        inputs: &Inputs,
        checked: &JobReport<'_>,
        shown: &[Shown],
        shapes: &[ToolShape],
    ) -> Option<Place> {
        match &finding.detail {
            FindingDetail::Machine(_) => None,
            FindingDetail::Stock(finding) => {
                let tools = &checked.job.tools;
                let tool = tools.iter().position(|tool| tool.number() == finding.tool_number);
                let shape = shapes.get(tool?)?;
                let toward = above_horizon(Vector3::new(1.0, -1.5, 1.3));
                let extent = extent(&shown[0], shape);
                let target = finding.point;
                Some(Place { body: None, tool: None, target, toward, extent })
            }
            FindingDetail::Surface { pair, group, .. } => {
                let (finding, pair) = (&group.worst, &checked.pairs[*pair]);
                let (tool, body) = (pair.tool, pair.body);
                let witness = match finding.kind {
                    FindingKind::Deep { witness, .. } | FindingKind::Near { witness, .. } => {
                        Some(witness)
                    }
                    FindingKind::Inside { .. }
                    | FindingKind::Undecided { .. }
                    | FindingKind::Ambiguous(_) => None,
                };
                let axis = finding.pose.axis();
                let mesh = &inputs.bodies[body].mesh;
                let normal = witness.and_then(|witness| mesh.normal(witness.triangle));
                let normal = normal.unwrap_or(axis);
                // From the side of the tool, a little from above, and more from outside the material.
                let side = axis.cross(&normal).try_normalize(1e-3);
                let side = side.unwrap_or_else(|| axis.cross(&Vector3::x()));
                let toward = above_horizon(normal + 0.7 * side + 0.35 * axis);
                let target = witness.map_or(finding.pose.tip(), |witness| witness.point);
                let extent = extent(&shown[body], &shapes[tool]);
                let tool = Some((tool, finding.pose));
                Some(Place { body: Some(body), tool, target, toward, extent })
            }
        }
    }

    /// Returns whether the picture of this place also shows another one.
    pub(super) fn shows(&self, other: &Place) -> bool {
        let near = (other.target - self.target).norm() < 0.15 * self.extent;
        self.body == other.body && near
    }

    /// Returns the camera. What stands in front of the place is cut away.
    pub(super) fn camera(&self) -> Camera {
        // `toward` is nowhere parallel to z.
        let directions = [self.toward, Vector3::z()];
        Camera::new(self.target, directions, self.extent).with_cut(self.cut())
    }

    /// Returns the distance in front of the place beyond which nothing is shown.
    pub(super) fn cut(&self) -> f64 {
        0.6 * self.extent
    }
}

/// Returns the length that a picture of a place shows: some diameters of the tool, and no more than the body.
fn extent(body: &Shown, shape: &ToolShape) -> f64 {
    let whole = body.extent();
    let near = 10.0 * shape.radius();
    if near > 0.0 { near.clamp(0.02 * whole, 1.2 * whole) } else { whole }
}

/// Returns a direction of length 1 that is not parallel to z.
fn above_horizon(toward: Vector3<f64>) -> Vector3<f64> {
    let toward = toward.try_normalize(0.0).unwrap_or_else(Vector3::x);
    if toward.z.abs() <= MAX_RISE {
        return toward;
    }
    let aside = Vector3::new(toward.x, toward.y, 0.0).try_normalize(1e-9);
    let aside = aside.unwrap_or_else(|| Vector3::new(0.6, -0.8, 0.0));
    let rise = MAX_RISE.copysign(toward.z);
    aside * (1.0 - rise * rise).sqrt() + Vector3::z() * rise
}

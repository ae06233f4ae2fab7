//! Findings as JSON objects.

use super::finding::rule;
use super::report::{JobReport, PairReport, Remedy};
use crate::{FindingGroup, FindingKind};
use serde::Serialize;
use touchoff::certify::Witness;
use touchoff::tool::Symmetry;

/// The findings of consecutive motions.
#[derive(Serialize)]
pub(super) struct SurfaceRow<'a> {
    file: &'a str,
    /// The line of the worst motion, and of the first and the last one.
    line: usize,
    first_line: usize,
    last_line: usize,
    /// Number of motions.
    motions: usize,
    /// The line at which the worst motion begins.
    from_line: Option<usize>,
    /// The index of the position at which it ends, from 0.
    location: usize,
    rapid: bool,
    /// On some dog-leg of axes whose rates are not known, and not on the straight line.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    any_rates: bool,
    /// The fraction of the motion at which the tool is at `tip` and `axis`, from 0 to 1.
    fraction: f64,
    /// Unit of lengths.
    unit: &'static str,
    tip: [f64; 3],
    axis: [f64; 3],
    /// For a solid without an axis, whose pose needs the spin: `qx, qy, qz, qw`.
    #[serde(skip_serializing_if = "Option::is_none")]
    quaternion: Option<[f64; 4]>,
    /// The part or the fixture.
    body: &'a str,
    tool: &'a str,
    tool_number: Option<u32>,
    kind: &'static str,
    surface: Option<&'a str>,
    cutting: Option<bool>,
    #[serde(flatten)]
    measurement: Option<Measurement>,
    #[serde(flatten)]
    point: Option<BodyPoint>,
    /// The least travel along the tool's axis that clears the surface at this pose.
    #[serde(skip_serializing_if = "Option::is_none")]
    lift: Option<f64>,
    /// The least tilt about the tip that clears the tool at this pose.
    #[serde(skip_serializing_if = "Option::is_none")]
    tilt: Option<TiltRow>,
}

/// A tilt of the axis about the tip.
#[derive(Serialize)]
struct TiltRow {
    degrees: f64,
    /// The tilted axis.
    axis: [f64; 3],
}

/// The measurements of a finding.
#[derive(Serialize)]
#[serde(untagged)]
enum Measurement {
    Deep { allowed_depth: f64, depth: [f64; 2], depth_bound: f64, through: bool },
    Near { margin: f64, distance: [f64; 2], distance_bound: f64 },
}

/// A point on the part or the fixture.
#[derive(Serialize)]
struct BodyPoint {
    triangle: u32,
    point: [f64; 3],
}

impl BodyPoint {
    fn of(witness: &Witness) -> BodyPoint {
        BodyPoint { triangle: witness.triangle.0, point: witness.point.into() }
    }
}

impl<'a> SurfaceRow<'a> {
    pub(super) fn of(
        report: &'a JobReport<'_>,
        pair: &PairReport,
        group: &FindingGroup,
        remedy: Remedy,
    ) -> SurfaceRow<'a> {
        let info = report.info(pair);
        let finding = &group.worst;
        let (measurement, point) = match finding.kind {
            FindingKind::Deep { allowed, depth, max_depth, through, witness, .. } => {
                let deep = Measurement::Deep {
                    allowed_depth: allowed,
                    depth: depth.into(),
                    depth_bound: max_depth,
                    through,
                };
                (Some(deep), Some(BodyPoint::of(&witness)))
            }
            FindingKind::Near { margin, distance, min_distance, witness, .. } => {
                let near = Measurement::Near {
                    margin,
                    distance: distance.into(),
                    distance_bound: min_distance,
                };
                (Some(near), Some(BodyPoint::of(&witness)))
            }
            FindingKind::Inside { .. }
            | FindingKind::Undecided { .. }
            | FindingKind::Ambiguous(_) => (None, None),
        };
        let surface = finding.kind.surface().map(|surface| &info.surfaces[surface.0]);
        let quaternion = match info.symmetry {
            Symmetry::Revolved => None,
            Symmetry::Solid { .. } => Some(finding.pose.to_isometry().rotation.coords.into()),
        };
        SurfaceRow {
            file: report.job.program.name(),
            line: finding.line,
            first_line: group.first.line,
            last_line: group.last.line,
            motions: group.motions,
            from_line: finding.from,
            location: finding.location,
            rapid: finding.rapid,
            any_rates: finding.any_rates,
            fraction: finding.time,
            unit: report.job.unit().symbol(),
            tip: finding.pose.tip().into(),
            axis: finding.pose.axis().into(),
            quaternion,
            body: &report.body(pair).name,
            tool: &info.name,
            tool_number: report.tool(pair).number(),
            kind: rule(&finding.kind),
            surface: surface.map(|surface| &*surface.name),
            cutting: surface.map(|surface| surface.cutting),
            measurement,
            point,
            lift: remedy.lift,
            tilt: remedy
                .tilt
                .map(|tilt| TiltRow { degrees: tilt.angle.to_degrees(), axis: tilt.axis.into() }),
        }
    }
}

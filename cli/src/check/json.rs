//! The certificate for programs.

use super::niceness;
use serde::Serialize;
use tool_dsl::CheckedTool;
use tool_dsl::expr::interval::{Cell, Interval};
use tool_dsl::prove::{Border, Certificate, RegionFacts};

/// The certificate for programs.
#[derive(Serialize)]
pub(super) struct CertificateRow<'t> {
    tool: &'t str,
    unit: &'static str,
    /// `depth ≤ L · distance`
    lipschitz: Option<f64>,
    /// `depth ≥ c · distance`
    lower_slope: Option<f64>,
    exact: bool,
    continuous: bool,
    tolerance: f64,
    /// Amount by which all bounds may be off
    slack: f64,
    boxes: usize,
    regions: Vec<RegionRow<'t>>,
    borders: Vec<BorderRow<'t>>,
    undecided: Vec<OpenProofRow>,
}

#[derive(Serialize)]
struct RegionRow<'t> {
    name: &'t str,
    /// Estimated fraction of the section's area, or of a solid's volume
    fraction: f64,
    depth: [f64; 2],
    steepness: [f64; 2],
    is_distance: bool,
    niceness: [f64; 2],
    niceness_never_rises: bool,
    /// Bound on the error of the computed depth, in the file's unit
    rounding_error: f64,
    /// Angle between the direction and the steepest descent of depth, if it is known
    direction_error_degrees: Option<[f64; 2]>,
    /// The largest such angle that is certain at a point, and the point in the tool's frame
    oblique_degrees: Option<f64>,
    oblique_point: Option<[f64; 3]>,
    /// A point in the tool's frame where niceness rises with depth
    niceness_rises_point: Option<[f64; 3]>,
    /// Middles of the boxes where the direction vanishes, in the tool's frame
    singular_points: Vec<[f64; 3]>,
    /// True if the direction turns on the axis
    turns_on_axis: bool,
}

#[derive(Serialize)]
struct BorderRow<'t> {
    between: [&'t str; 2],
    depth_jump: [f64; 2],
    magnitude_jump: [f64; 2],
    /// A point where depth jumps, in the tool's frame
    jump_point: Option<[f64; 3]>,
    turn_degrees: [f64; 2],
    turn_on_surface_degrees: Option<[f64; 2]>,
    depth: [f64; 2],
}

#[derive(Serialize)]
struct OpenProofRow {
    statement: String,
    /// Middle of the box, in the tool's frame
    point: [f64; 3],
}

impl<'t> CertificateRow<'t> {
    pub(super) fn of(tool: &'t CheckedTool, certificate: &'t Certificate) -> CertificateRow<'t> {
        let model = &tool.model;
        let ends = |value: Interval| [value.low, value.high];
        let turned = |value: Interval| ends(value).map(f64::to_degrees);
        let region = |(region, facts): (&'t tool_dsl::model::Region, &RegionFacts)| RegionRow {
            name: &region.name,
            fraction: facts.share,
            depth: ends(facts.depth),
            steepness: ends(facts.gradient_length),
            is_distance: facts.is_distance,
            niceness: ends(niceness(facts)),
            niceness_never_rises: facts.niceness_never_rises,
            rounding_error: facts.rounding_error,
            direction_error_degrees: facts.direction_error.map(turned),
            oblique_degrees: facts.oblique_witness.map(|(angle, _)| angle.to_degrees()),
            oblique_point: facts.oblique_witness.map(|(_, point)| point),
            niceness_rises_point: facts.rising_witness.map(|(_, point)| point),
            singular_points: facts.singular_cells.iter().map(Cell::middle).collect(),
            turns_on_axis: facts.turns_on_axis,
        };
        let name = |owner: Option<usize>| {
            owner.map_or("outside", |owner| model.regions[owner].name.as_str())
        };
        let border = |border: &Border| BorderRow {
            between: [name(Some(border.sides.0)), name(border.sides.1)],
            depth_jump: ends(border.depth_jump),
            magnitude_jump: ends(border.magnitude_jump),
            jump_point: border.jump_point.map(|(point, _)| point),
            turn_degrees: turned(border.direction_angle),
            turn_on_surface_degrees: border.direction_angle_on_surface.map(turned),
            depth: ends(border.depth),
        };
        CertificateRow {
            tool: &model.name,
            unit: model.unit.symbol(),
            lipschitz: certificate.lipschitz(),
            lower_slope: certificate.lower_slope(),
            exact: certificate.is_exact(),
            continuous: certificate.is_continuous(),
            tolerance: certificate.tolerance,
            slack: certificate.slack,
            boxes: certificate.examined_boxes,
            regions: model.regions.iter().zip(&certificate.regions).map(region).collect(),
            borders: certificate.borders.iter().map(border).collect(),
            undecided: certificate
                .undecided
                .iter()
                .map(|not| OpenProofRow {
                    statement: not.statement.to_string(),
                    point: not.cell.middle(),
                })
                .collect(),
        }
    }
}

//! The certificate for programs.

use super::niceness;
use serde::Serialize;
use tool_dsl::CheckedTool;
use tool_dsl::expr::interval::{Cell, Interval};
use tool_dsl::prove::{Border, Certificate, RegionFacts};

/// The certificate for programs.
#[derive(Serialize)]
pub(super) struct Proved<'t> {
    tool: &'t str,
    unit: &'static str,
    /// `depth ≤ L · distance`
    lipschitz: Option<f64>,
    /// `depth ≥ c · distance`
    least: Option<f64>,
    exact: bool,
    continuous: bool,
    tolerance: f64,
    /// Amount by which all bounds may be off
    slack: f64,
    boxes: usize,
    regions: Vec<ProvedRegion<'t>>,
    borders: Vec<ProvedBorder<'t>>,
    undecided: Vec<ProvedNot>,
}

#[derive(Serialize)]
struct ProvedRegion<'t> {
    name: &'t str,
    share: f64,
    depth: [f64; 2],
    steepness: [f64; 2],
    distance: bool,
    niceness: [f64; 2],
    falls: bool,
    /// Bound on the error of the computed depth, in the file's unit
    rounding: f64,
    /// Angle between the direction and the way straight down the depth, if it is known
    aside_degrees: Option<[f64; 2]>,
    /// The largest such angle that is certain at a point, and the point in the tool's frame
    oblique_degrees: Option<f64>,
    oblique_at: Option<[f64; 3]>,
    /// A point in the tool's frame where niceness rises with depth
    rises_at: Option<[f64; 3]>,
    /// Middles of the boxes where the direction vanishes, in the tool's frame
    singular: Vec<[f64; 3]>,
    /// True if the direction turns on the axis
    on_axis: bool,
}

#[derive(Serialize)]
struct ProvedBorder<'t> {
    between: [&'t str; 2],
    jump: [f64; 2],
    /// Jump of the magnitude
    step: [f64; 2],
    /// A point where depth jumps, in the tool's frame
    seen: Option<[f64; 3]>,
    turn_degrees: [f64; 2],
    turn_on_surface_degrees: Option<[f64; 2]>,
    depth: [f64; 2],
}

#[derive(Serialize)]
struct ProvedNot {
    what: String,
    near: [f64; 3],
}

impl<'t> Proved<'t> {
    pub(super) fn of(tool: &'t CheckedTool, certificate: &'t Certificate) -> Proved<'t> {
        let model = &tool.model;
        let ends = |value: Interval| [value.low, value.high];
        let turned = |value: Interval| ends(value).map(f64::to_degrees);
        let region = |(region, facts): (&'t tool_dsl::model::Region, &RegionFacts)| ProvedRegion {
            name: &region.name,
            share: facts.share,
            depth: ends(facts.depth),
            steepness: ends(facts.steepness),
            distance: facts.distance,
            niceness: ends(niceness(facts)),
            falls: facts.falls,
            rounding: facts.rounding,
            aside_degrees: facts.direction_error.map(turned),
            oblique_degrees: facts.oblique.map(|(angle, _)| angle.to_degrees()),
            oblique_at: facts.oblique.map(|(_, point)| point),
            rises_at: facts.rises.map(|(_, point)| point),
            singular: facts.singular.iter().map(Cell::middle).collect(),
            on_axis: facts.on_axis,
        };
        let name = |owner: Option<usize>| {
            owner.map_or("outside", |owner| model.regions[owner].name.as_str())
        };
        let border = |border: &Border| ProvedBorder {
            between: [name(Some(border.between.0)), name(border.between.1)],
            jump: ends(border.jump),
            step: ends(border.step),
            seen: border.seen.map(|(point, _)| point),
            turn_degrees: turned(border.turn),
            turn_on_surface_degrees: border.turn_on_surface.map(turned),
            depth: ends(border.depth),
        };
        Proved {
            tool: &model.name,
            unit: model.unit.symbol(),
            lipschitz: certificate.lipschitz(),
            least: certificate.lower_slope(),
            exact: certificate.is_exact(),
            continuous: certificate.is_continuous(),
            tolerance: certificate.tolerance,
            slack: certificate.slack,
            boxes: certificate.boxes,
            regions: model.regions.iter().zip(&certificate.regions).map(region).collect(),
            borders: certificate.borders.iter().map(border).collect(),
            undecided: certificate
                .undecided
                .iter()
                .map(|not| ProvedNot { what: not.statement.to_string(), near: not.cell.middle() })
                .collect(),
        }
    }
}

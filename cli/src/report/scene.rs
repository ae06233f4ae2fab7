//! The 3-D view: the place of each finding with its camera, and the data of the view, as JSON in the page.

use super::colouring::{ColouredBodies, Layer};
use super::path::{ToolPath, Way};
use super::shapes::{Shown, ToolShape, bounds};
use crate::picture::render::Camera;
use crate::verify::Inputs;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use nalgebra::{Point3, Vector3};
use serde::Serialize;
use touchoff::{Escaped, Pose, Unit};
use touchoff_postures::colormap;
use touchoff_verify::job::{FindingDetail, JobFinding, Moving};
use touchoff_verify::{FindingKind, JobReport};

/// The place of a finding, and how to look at it.
pub(super) struct Place {
    /// The body that the tool touches; `None` for the stock.
    pub(super) body: Option<usize>,
    /// The index of the shape of the tool, or of the machine's body, if its pose is known.
    pub(super) tool: Option<(usize, Pose)>,
    /// The point to look at.
    target: Point3<f64>,
    /// Direction from there to the eye, of length 1.
    toward: Vector3<f64>,
    /// The length that the picture shows.
    extent: f64,
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
                // From above, as the first view of a sheet: a point of the stock has no normal.
                let toward = above_horizon(Vector3::new(1.0, -1.5, 1.3));
                let extent = extent(&shown[0], shape);
                let target = finding.point;
                Some(Place { body: None, tool: None, target, toward, extent })
            }
            FindingDetail::Surface { pair, groups, .. } => {
                let (finding, pair) = (&groups[0].worst, &checked.pairs[*pair]);
                let body = pair.body;
                // The shapes of the machine's bodies come after those of the tools.
                let tool = match pair.moving {
                    Moving::Tool(index) => index,
                    Moving::Revolved(index) => checked.job.tools.len() + index,
                };
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
                // The axis is the normal where the end of the tool touches, and any side will do.
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
    fn cut(&self) -> f64 {
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

/// Number of triangles above which there is no 3-D view, so that the file stays below 15 MB.
const MAX_TRIANGLES: usize = 500_000;
/// The colour of the part and of the stock where they have no value, red, green and blue.
const PLAIN: [u8; 3] = [205; 3];
/// The colours of other bodies, one after the other: apart from the scale of values, and from the tool.
const COLOURS_OF_OTHERS: [[u8; 3]; 5] =
    [[138, 176, 217], [222, 160, 166], [199, 180, 128], [180, 164, 214], [150, 190, 186]];
/// The colours of the tools' paths, one after the other (Okabe and Ito, darkened).
const COLOURS_OF_PATHS: [[u8; 3]; 6] =
    [[0, 114, 178], [200, 84, 0], [176, 74, 134], [0, 120, 90], [70, 70, 70], [140, 110, 0]];
/// Largest value of a rounded coordinate.
const COORDINATE_STEPS: f64 = u16::MAX as f64;
/// Largest value of a colour; 0 stands for none.
const COLOUR_STEPS: f64 = 254.0;

#[derive(Serialize)]
pub(super) struct Scene<'a> {
    /// The part, the program, the tools and the unit.
    title: &'a str,
    unit: &'static str,
    bodies: Vec<Body<'a>>,
    layers: Vec<LayerRow<'a>>,
    tools: Vec<Tool>,
    /// The camera on each finding, in the order of the table; null without a place.
    places: Vec<Option<PlaceRow>>,
    /// The path of the tips; null without a motion.
    path: Option<PathRow>,
    /// Colours of values from the lowest to the greatest, red, green and blue.
    colours: Vec<[u8; 3]>,
}

#[derive(Serialize)]
struct Body<'a> {
    name: &'a str,
    /// Set for a fixture or another part.
    fixture: bool,
    /// Its colour where it has no value.
    colour: [u8; 3],
    /// Set if the tool's poses at it are in a frame of its own.
    own_frame: bool,
    /// Lowest corner of its box, and the lengths of the steps of rounded coordinates.
    low: [f64; 3],
    step: [f64; 3],
    /// Rounded coordinates of vertices, 16 bits each, little-endian, in base64.
    vertices: String,
    /// Vertices of triangles, 32 bits each.
    triangles: String,
}

#[derive(Serialize)]
struct PathRow {
    /// As of a body.
    low: [f64; 3],
    step: [f64; 3],
    vertices: String,
    /// One byte per vertex: 0 where a path begins, else 1 + 2 times the index of the colour, and 1 more in rapid traverse.
    ways: String,
    colours: [[u8; 3]; COLOURS_OF_PATHS.len()],
    /// Number and name of each tool that has a path.
    tools: Vec<PathTool>,
}

#[derive(Serialize)]
struct PathTool {
    name: String,
    /// The index of its colour.
    colour: usize,
}

#[derive(Serialize)]
struct LayerRow<'a> {
    body: usize,
    quantity: &'a str,
    ends: Option<&'a [String; 2]>,
    nothing: &'a str,
    /// One byte per triangle: 0 without a value, else 1 to 255 along the scale.
    values: String,
}

#[derive(Serialize)]
struct Tool {
    /// Lines of the profile: `d, z` of both ends, and 1 if it cuts.
    lines: Vec<[f64; 5]>,
}

#[derive(Serialize)]
struct PlaceRow {
    body: Option<usize>,
    tool: Option<usize>,
    tip: Option<[f64; 3]>,
    axis: Option<[f64; 3]>,
    target: [f64; 3],
    toward: [f64; 3],
    extent: f64,
    cut: f64,
}

impl<'a> Scene<'a> {
    /// Returns the data of the view; `None` if there are too many triangles for one.
    pub(super) fn new(
        title: &'a str,
        unit: Unit,
        shown: &'a ColouredBodies,
        shapes: &[ToolShape],
        places: &[Option<Place>],
        path: &ToolPath,
        tool_names: &[String],
    ) -> Option<Scene<'a>> {
        let ColouredBodies { bodies, layers } = shown;
        if bodies.iter().map(|body| body.triangles.len()).sum::<usize>() > MAX_TRIANGLES {
            return None;
        }
        const COLOURS: usize = 33;
        Some(Scene {
            title,
            unit: unit.symbol(),
            bodies: bodies.iter().enumerate().map(|(index, body)| Body::new(index, body)).collect(),
            layers: layers.iter().map(LayerRow::new).collect(),
            tools: shapes.iter().map(Tool::new).collect(),
            places: places.iter().map(|known| known.as_ref().map(PlaceRow::new)).collect(),
            path: PathRow::new(path, tool_names),
            colours: (0..COLOURS).map(|k| colormap(k as f64 / (COLOURS - 1) as f64)).collect(),
        })
    }

    /// Returns the greatest difference of a shown coordinate from the one of the file.
    pub(super) fn rounding_error(&self) -> f64 {
        let path = self.path.iter().flat_map(|path| path.step);
        let steps = self.bodies.iter().flat_map(|body| body.step).chain(path);
        0.5 * steps.fold(0.0, f64::max)
    }
}

impl<'a> Body<'a> {
    fn new(index: usize, shown: &'a Shown) -> Body<'a> {
        let Rounded { low, step, vertices } = Rounded::new(shown.vertices.iter().copied());
        let triangles = shown.triangles.iter().flatten();
        Body {
            name: &shown.name,
            fixture: shown.is_fixture,
            colour: match index.checked_sub(1) {
                Some(other) if shown.is_fixture || shown.has_own_frame => {
                    COLOURS_OF_OTHERS[other % COLOURS_OF_OTHERS.len()]
                }
                _ => PLAIN,
            },
            own_frame: shown.has_own_frame,
            low,
            step,
            vertices,
            triangles: base64(triangles.flat_map(|vertex| vertex.to_le_bytes())),
        }
    }
}

/// Coordinates rounded to steps of the extent along each axis.
struct Rounded {
    low: [f64; 3],
    step: [f64; 3],
    /// 16 bits per coordinate, little-endian, in base64.
    vertices: String,
}

impl Rounded {
    fn new(vertices: impl Iterator<Item = Point3<f64>> + Clone) -> Rounded {
        let [low, high] = bounds(vertices.clone());
        let step = (high - low) / COORDINATE_STEPS;
        let steps = vertices.flat_map(|vertex| {
            [0, 1, 2].map(|k| {
                // Flat shapes have no extent along one axis.
                let steps = if step[k] > 0.0 { (vertex[k] - low[k]) / step[k] } else { 0.0 };
                steps.round() as u16
            })
        });
        let vertices = base64(steps.flat_map(u16::to_le_bytes));
        Rounded { low: low.into(), step: step.into(), vertices }
    }
}

impl PathRow {
    /// Returns the row of a path, with the name of each tool of the job.
    fn new(path: &ToolPath, names: &[String]) -> Option<PathRow> {
        if path.vertices.is_empty() {
            return None;
        }
        let tips = path.vertices.iter().map(|vertex| vertex.tip);
        let Rounded { low, step, vertices } = Rounded::new(tips);
        let colour = |tool: usize| tool % COLOURS_OF_PATHS.len();
        let ways = path.vertices.iter().map(|vertex| match vertex.way {
            Way::Begins => 0,
            Way::Feed => 1 + 2 * colour(vertex.tool) as u8,
            Way::Rapid => 2 + 2 * colour(vertex.tool) as u8,
        });
        let has_path = |tool: &usize| path.vertices.iter().any(|vertex| vertex.tool == *tool);
        let tools = (0..names.len()).filter(has_path);
        let tools = tools.map(|tool| PathTool { name: names[tool].clone(), colour: colour(tool) });
        Some(PathRow {
            low,
            step,
            vertices,
            ways: base64(ways),
            colours: COLOURS_OF_PATHS,
            tools: tools.collect(),
        })
    }
}

impl<'a> LayerRow<'a> {
    fn new(layer: &'a Layer) -> LayerRow<'a> {
        let scale = &layer.scale;
        let values = layer.values.iter().map(|value| {
            value.map_or(0, |value| 1 + (scale.share(value) * COLOUR_STEPS).round() as u8)
        });
        LayerRow {
            body: layer.body,
            quantity: &scale.quantity,
            ends: scale.has_values.then_some(&scale.ends),
            nothing: scale.nothing,
            values: base64(values),
        }
    }
}

impl Tool {
    fn new(shape: &ToolShape) -> Tool {
        let lines = shape.lines.iter().map(|line| {
            let ([d, z], [to_d, to_z]) = (line.from, line.to);
            [d, z, to_d, to_z, f64::from(u8::from(line.cuts))]
        });
        Tool { lines: lines.collect() }
    }
}

impl PlaceRow {
    fn new(place: &Place) -> PlaceRow {
        let (tool, pose) = place.tool.unzip();
        PlaceRow {
            body: place.body,
            tool,
            tip: pose.map(|pose| pose.tip().into()),
            axis: pose.map(|pose| pose.axis().into()),
            target: place.target.into(),
            toward: place.toward.into(),
            extent: place.extent,
            cut: place.cut(),
        }
    }
}

/// Returns bytes as base64.
pub(super) fn base64(bytes: impl Iterator<Item = u8>) -> String {
    STANDARD.encode(bytes.collect::<Vec<u8>>())
}

/// Returns a value as JSON that may stand in a script element: `<` is written as its code, so that no text ends it, and so
/// are characters that a display interprets.
///
/// # Errors
/// If the value has no JSON form.
pub(super) fn json(value: &impl Serialize) -> Result<String, serde_json::Error> {
    Ok(Escaped(&serde_json::to_string(value)?).to_string().replace('<', "\\u003c"))
}

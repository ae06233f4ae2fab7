//! The data of the 3-D view, as JSON in the page.

use super::cameras::Place;
use super::colouring::{ColouredBodies, Layer};
use super::shapes::{Shown, ToolShape};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use touchoff::{Escaped, Unit};
use touchoff_postures::colormap;

/// Number of triangles above which there is no 3-D view, so that the file stays below 15 MB.
const MAX_TRIANGLES: usize = 500_000;
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
    /// Colours of values from the lowest to the greatest, red, green and blue.
    colours: Vec<[u8; 3]>,
}

#[derive(Serialize)]
struct Body<'a> {
    name: &'a str,
    /// Set for a fixture.
    fixture: bool,
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
    ) -> Option<Scene<'a>> {
        let ColouredBodies { bodies, layers } = shown;
        if bodies.iter().map(|body| body.triangles.len()).sum::<usize>() > MAX_TRIANGLES {
            return None;
        }
        const COLOURS: usize = 33;
        Some(Scene {
            title,
            unit: unit.symbol(),
            bodies: bodies.iter().map(Body::new).collect(),
            layers: layers.iter().map(LayerRow::new).collect(),
            tools: shapes.iter().map(Tool::new).collect(),
            places: places.iter().map(|known| known.as_ref().map(PlaceRow::new)).collect(),
            colours: (0..COLOURS).map(|k| colormap(k as f64 / (COLOURS - 1) as f64)).collect(),
        })
    }

    /// Returns the greatest difference of a shown coordinate from the one of the file.
    pub(super) fn rounding_error(&self) -> f64 {
        let steps = self.bodies.iter().flat_map(|body| body.step);
        0.5 * steps.fold(0.0, f64::max)
    }
}

impl<'a> Body<'a> {
    fn new(shown: &'a Shown) -> Body<'a> {
        let [low, high] = shown.bounds();
        let step = (high - low) / COORDINATE_STEPS;
        let vertices = shown.vertices.iter().flat_map(|vertex| {
            [0, 1, 2].map(|k| {
                // A flat body has no extent along one axis.
                let steps = if step[k] > 0.0 { (vertex[k] - low[k]) / step[k] } else { 0.0 };
                steps.round() as u16
            })
        });
        let triangles = shown.triangles.iter().flatten();
        Body {
            name: &shown.name,
            fixture: shown.is_fixture,
            own_frame: shown.has_own_frame,
            low: low.into(),
            step: step.into(),
            vertices: base64(vertices.flat_map(u16::to_le_bytes)),
            triangles: base64(triangles.flat_map(|vertex| vertex.to_le_bytes())),
        }
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

//! `touchoff draw`: a tool's drawing as SVG or PNG.

use crate::arguments::ParamArguments;
use crate::failure::Failure;
use crate::files;
use crate::output::{Output, refuse_inputs, write_file};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use std::io::Write;
use std::path::Path;
use tool_dsl::draw::{Lettering, svg};

/// Pixels per unit of the drawing, fine enough to print; fewer if the image would have more pixels than `MOST`.
const PIXELS: f32 = 2.0;
const MOST: f32 = 5e7;

/// Draws a file's tool into another file, or on standard output.
pub(crate) fn draw(
    file: &Path,
    output: Option<&Path>,
    given: &ParamArguments,
) -> Result<(), Failure> {
    let Some(output) = output else {
        let mut out = Output::bytes();
        writeln!(out, "{}", drawing(file, given)?)?;
        out.flush()?;
        return Ok(());
    };
    refuse_inputs([output], [file])?;
    let bytes = match files::ending(output).as_deref() {
        Some("svg") => drawing(file, given)?.into_bytes(),
        Some("png") => png(&drawing(file, given)?)?,
        _ => {
            let better = output.with_extension("svg");
            return Err(Failure::Form { file: output.display().to_string(), better });
        }
    };
    write_file(output, bytes)
}

fn drawing(file: &Path, given: &ParamArguments) -> Result<String, Failure> {
    let tool = files::checked(file, given)?;
    svg(&tool, Lettering::Strokes).ok_or_else(|| Failure::NoAxis(tool.model.name.clone()))
}

/// Renders an SVG without text elements as a PNG.
fn png(svg: &str) -> Result<Vec<u8>, Failure> {
    let pixels = |reason: &dyn std::fmt::Display| Failure::Pixels(reason.to_string());
    let tree = Tree::from_str(svg, &Options::default()).map_err(|error| pixels(&error))?;
    let size = tree.size();
    let scale = PIXELS.min((MOST / (size.width() * size.height())).sqrt());
    let [wide, tall] = [size.width(), size.height()].map(|side| (side * scale).ceil() as u32);
    let mut map = Pixmap::new(wide, tall).ok_or_else(|| pixels(&"it has no size"))?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut map.as_mut());
    map.encode_png().map_err(|error| pixels(&error))
}

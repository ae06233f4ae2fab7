//! `touchoff draw`: a tool's drawing as SVG or PNG.

use crate::arguments::Draw;
use crate::failure::Failure;
use crate::loaded_tool::compile_file;
use crate::output::{Output, extension, files_of, refuse_inputs, write_file};
use crate::picture::pixels;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use std::io::Write;
use touchoff_drawing::{Content, TextRendering, svg};

/// Pixels per unit of the drawing, fine enough to print; fewer if the image would have more pixels than `MAX_PIXELS`.
const PIXELS: f32 = 2.0;
const MAX_PIXELS: f32 = 5e7;

/// Draws a file's tool into another file, or on standard output.
pub(crate) fn draw(arguments: &Draw) -> Result<(), Failure> {
    let Draw { file, output, .. } = arguments;
    let Some(output) = output else {
        let mut out = Output::bytes();
        writeln!(out, "{}", drawing(arguments)?)?;
        out.flush()?;
        return Ok(());
    };
    refuse_inputs([&**output], [&**file])?;
    let bytes = match extension(output).as_deref() {
        Some("svg") => drawing(arguments)?.into_bytes(),
        Some("png") => png(&drawing(arguments)?)?,
        _ => {
            let better = output.with_extension("svg");
            return Err(Failure::DrawingFormat { file: output.display().to_string(), better });
        }
    };
    write_file(output, bytes)
}

/// Returns the drawing of a file's tool as SVG.
///
/// # Errors
/// If the file has no tool, or if the output is a file that it is read from.
fn drawing(arguments: &Draw) -> Result<String, Failure> {
    let compiled = compile_file(&arguments.file, &arguments.params)?;
    // A file without the ending `.tool` mounts others, too.
    refuse_inputs(arguments.output.as_deref(), files_of(&compiled.sources))?;
    let tool = compiled.into_tool().ok_or(Failure::Files { wrong: 1, all: 1 })?;
    let content = if arguments.regions { Content::Regions } else { Content::Outline };
    Ok(svg(&tool, content, TextRendering::Strokes))
}

/// Renders an SVG without text elements as a PNG.
fn png(svg: &str) -> Result<Vec<u8>, Failure> {
    let tree = Tree::from_str(svg, &Options::default()).map_err(pixels)?;
    let size = tree.size();
    // The smaller scale of both, so that a long drawing does not exhaust memory.
    let scale = PIXELS.min((MAX_PIXELS / (size.width() * size.height())).sqrt());
    let [width, height] = [size.width(), size.height()].map(|side| (side * scale).ceil() as u32);
    let mut map = Pixmap::new(width, height).ok_or_else(|| pixels("it has no size"))?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut map.as_mut());
    map.encode_png().map_err(pixels)
}

//! The legend below the views, which explains their lines, areas and symbols.

use super::lettering::width;
use super::regions::{Marks, head};
use super::sheet::{Anchor, DEFAULT_COLOUR, Look, Sheet, lines};
use super::{Content, paint};
use touchoff_dsl::model::Model;
use touchoff_dsl::vector::Point;

/// The height of capitals; `LINE_HEIGHT` is the height of a line. Sheet units.
const TEXT_SIZE: f64 = 7.5;
const LINE_HEIGHT: f64 = 16.0;
/// The length of a sample line, in sheet units.
const SAMPLE_LENGTH: f64 = 24.0;

/// A symbol that the legend explains.
pub(super) enum Sign {
    Surface { colour: &'static str, cutting: bool },
    Region { colour: &'static str },
    Split,
    Singular,
    Arrow,
    Axis,
    Break,
}

/// An entry of the legend: a symbol and its meaning.
pub(super) type Entry = (Sign, String);

/// Draws the legend below everything drawn so far. Each group of entries begins a line.
pub(super) fn draw(groups: &[Vec<Entry>], sheet: &mut Sheet) {
    let [low, high] = sheet.frame();
    let available_width = (high[0] - low[0]).max(300.0);
    let mut at = [low[0], high[1] + 24.0];
    for entries in groups {
        for (sign, text) in entries {
            let wide = SAMPLE_LENGTH + 7.0 + width(text, TEXT_SIZE);
            if at[0] > low[0] && at[0] + wide > low[0] + available_width {
                at = [low[0], at[1] + LINE_HEIGHT];
            }
            sample(sign, at, sheet);
            sheet.text(
                text,
                [at[0] + SAMPLE_LENGTH + 7.0, at[1]],
                Look::plain(TEXT_SIZE, Anchor::Left),
            );
            at[0] += wide + 18.0;
        }
        at = [low[0], at[1] + LINE_HEIGHT];
    }
}

/// Returns the entries of a model's surfaces.
pub(super) fn surfaces(model: &Model) -> Vec<Entry> {
    let surfaces = model.surfaces.iter().zip(paint::surface_colours(model));
    surfaces
        .map(|(surface, colour)| {
            let cutting = surface.cutting;
            let text =
                if cutting { format!("{}, cutting", surface.name) } else { surface.name.clone() };
            (Sign::Surface { colour, cutting }, text)
        })
        .collect()
}

/// Returns the entries of the symbols in a tool's section.
pub(super) fn signs(content: Content, marks: &Marks) -> Vec<Entry> {
    let mut signs = Vec::new();
    if content == Content::Regions {
        signs.push((Sign::Arrow, "direction to the surface"));
        if marks.splits {
            signs.push((Sign::Split, "border of regions"));
        }
        if !marks.singular.is_empty() {
            signs.push((Sign::Singular, "no direction here"));
        }
        let axis = if marks.axis { "axis: radial directions are +x on it" } else { "axis" };
        signs.push((Sign::Axis, axis));
    }
    if marks.shortened {
        signs.push((Sign::Break, "shortened"));
    }
    signs.into_iter().map(|(sign, text)| (sign, text.to_owned())).collect()
}

fn sample(sign: &Sign, [x, y]: Point, sheet: &mut Sheet) {
    let row = [[x, y], [x + SAMPLE_LENGTH, y]];
    let line = |sheet: &mut Sheet, look: &str| {
        sheet.path(&format!("fill=\"none\" {look}"), &lines([&row]));
    };
    match sign {
        Sign::Surface { colour, cutting } => {
            let wide = if *cutting { 3.0 } else { 2.0 };
            line(sheet, &format!("stroke=\"{colour}\" stroke-width=\"{wide}\""));
        }
        Sign::Region { colour } => {
            let [low, high] = [[x, y - 4.5], [x + SAMPLE_LENGTH, y + 4.5]];
            let corners = [low, [high[0], low[1]], high, [low[0], high[1]], low];
            let look = "stroke=\"#3f4650\" stroke-width=\".6\" fill-opacity=\".62\"";
            sheet.path(&format!("fill=\"{colour}\" {look}"), &lines([&corners]));
        }
        Sign::Split => {
            line(sheet, "stroke=\"#3f4650\" stroke-width=\".9\" stroke-dasharray=\"5 3\"");
        }
        Sign::Axis => {
            line(sheet, "stroke=\"#22272e\" stroke-width=\".8\" stroke-dasharray=\"12 3 2 3\"");
        }
        Sign::Singular => {
            let middle = [x + SAMPLE_LENGTH / 2.0, y];
            sheet.group(&format!("fill=\"#fff\" stroke=\"{DEFAULT_COLOUR}\""), |sheet| {
                sheet.ring(middle, 4.0);
            });
            sheet.group(&format!("fill=\"{DEFAULT_COLOUR}\""), |sheet| sheet.ring(middle, 1.1));
        }
        Sign::Arrow => {
            line(sheet, "stroke=\"#2b3440\"");
            let [a, b, c] = head(row, 5.0);
            sheet.path("fill=\"#2b3440\"", &lines([&[a, b, c, a]]));
        }
        Sign::Break => {
            let wave = |shift: f64| -> Vec<Point> {
                let points = (0..=8).map(|k| {
                    let turn = (f64::from(k) / 4.0 * std::f64::consts::PI).sin();
                    [x + f64::from(k) * 3.0, y + shift + 2.5 * turn]
                });
                points.collect()
            };
            sheet.path("fill=\"none\" stroke=\"#6b7280\"", &lines([wave(-2.5), wave(2.5)]));
        }
    }
}

//! The legend below the views, which explains their lines, areas and symbols.

use super::lettering::width;
use super::regions::{Marks, draw_arrows, singular_points};
use super::sheet::{Anchor, Look, Sheet, lines};
use super::{Content, paint};
use touchoff_dsl::model::Model;
use touchoff_plane::Point;

/// The height of capitals; `LINE_HEIGHT` is the height of a line. Sheet units.
const TEXT_SIZE: f64 = 7.5;
const LINE_HEIGHT: f64 = 16.0;
/// The length of a sample line, in sheet units.
const SAMPLE_LENGTH: f64 = 24.0;

/// A symbol that the legend explains.
pub(super) enum Sign {
    /// A line of this look.
    Line(String),
    /// An area of this colour.
    Area(&'static str),
    Singular,
    Arrow,
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
            let from = [at[0] + SAMPLE_LENGTH + 7.0, at[1]];
            sheet.text(text, from, Look::plain(TEXT_SIZE, Anchor::Left));
            at[0] += wide + 18.0;
        }
        at = [low[0], at[1] + LINE_HEIGHT];
    }
}

/// Returns the entries of a model's surfaces.
pub(super) fn surfaces(model: &Model) -> Vec<Entry> {
    let mut entries = Vec::new();
    for (surface, look) in model.surfaces.iter().zip(paint::surface_looks(model)) {
        let suffix = if surface.cutting { ", cutting" } else { "" };
        entries.push((Sign::Line(look), format!("{}{suffix}", surface.name)));
    }
    entries
}

/// Returns the entries of the symbols in a tool's section.
pub(super) fn signs(content: Content, marks: &Marks) -> Vec<Entry> {
    let has_regions = content == Content::Regions;
    let signs = [
        (has_regions, Sign::Arrow, "direction to the surface"),
        (has_regions && marks.splits, Sign::Line(paint::SPLIT.to_owned()), "border of regions"),
        (!marks.singular.is_empty(), Sign::Singular, "no direction here"),
        (has_regions, Sign::Line(paint::AXIS.to_owned()), "axis: radial directions are +x on it"),
        (marks.shortened, Sign::Break, "shortened"),
    ];
    let drawn = signs.into_iter().filter(|(is_drawn, ..)| *is_drawn);
    drawn.map(|(_, sign, text)| (sign, text.to_owned())).collect()
}

/// Draws a symbol to the right of a point.
fn sample(sign: &Sign, [x, y]: Point, sheet: &mut Sheet) {
    let (right, middle) = (x + SAMPLE_LENGTH, x + SAMPLE_LENGTH / 2.0);
    let row = [[x, y], [right, y]];
    match sign {
        Sign::Line(look) => sheet.path(&format!("fill=\"none\" {look}"), &lines([&row])),
        Sign::Arrow => draw_arrows(&[row], sheet),
        Sign::Singular => singular_points(&[[middle, y]], sheet),
        Sign::Area(colour) => {
            let [low, high] = [y - 4.5, y + 4.5];
            let corners = [[x, low], [right, low], [right, high], [x, high], [x, low]];
            let look = "stroke=\"#3f4650\" stroke-width=\".6\" fill-opacity=\".62\"";
            sheet.path(&format!("fill=\"{colour}\" {look}"), &lines([&corners]));
        }
        Sign::Break => {
            let waves = [-2.5, 2.5].map(|away| paint::wave(middle, SAMPLE_LENGTH / 2.0, y + away));
            sheet.path("fill=\"none\" stroke=\"#6b7280\"", &lines(waves));
        }
    }
}

//! Colours that can be told apart with colour vision deficiency: Paul Tol's "light" scheme for areas with dark text on
//! them, and his "bright" scheme for more (SRON/EPS/TN/09-002, 2021), reds for cutting surfaces, dark colours for the
//! others.

use super::borders::{Border, Side};
use tool_dsl::model::Model;

const REGION_FILLS: [&str; 9] = [
    "#77aadd", "#eedd88", "#ffaabb", "#99ddff", "#44bb99", "#ee8866", "#bbcc33", "#dddddd",
    "#aaaa00",
];
const MORE_REGION_FILLS: [&str; 7] =
    ["#4477aa", "#ccbb44", "#ee6677", "#66ccee", "#228833", "#aa3377", "#bbbbbb"];
const CUTTING_STROKES: [&str; 4] = ["#c1121f", "#e8590c", "#a61e6b", "#ff5d5d"];
const NON_CUTTING_STROKES: [&str; 8] =
    ["#1f2933", "#1d5fa8", "#6b4a1f", "#2f6f4f", "#6d4aa5", "#0e8a93", "#8a7a00", "#7f8794"];

/// Returns a colour for each region, different for neighbours as far as the palette allows.
pub(super) fn areas(regions: usize, borders: &[Border]) -> Vec<&'static str> {
    let mut chosen: Vec<usize> = Vec::new();
    let mut used = [0; REGION_FILLS.len()];
    for region in 0..regions {
        let is_neighbour_colour = |colour: usize| {
            borders.iter().any(|border| match border.sides {
                [Side::Region(a), Side::Region(b)] => {
                    let other = if a == region { b } else { a };
                    (a == region || b == region) && chosen.get(other) == Some(&colour)
                }
                _ => false,
            })
        };
        let colour = (0..REGION_FILLS.len())
            .filter(|colour| !is_neighbour_colour(*colour))
            .min_by_key(|colour| used[*colour])
            .unwrap_or(region % REGION_FILLS.len());
        used[colour] += 1;
        chosen.push(colour);
    }
    chosen.into_iter().map(|colour| REGION_FILLS[colour]).collect()
}

/// Returns a colour for each region, different for all as far as both palettes allow.
pub(super) fn distinct_areas(regions: usize) -> Vec<&'static str> {
    REGION_FILLS.into_iter().chain(MORE_REGION_FILLS).cycle().take(regions).collect()
}

/// Returns the colour of each surface.
pub(super) fn surfaces(model: &Model) -> Vec<&'static str> {
    let (mut cutting, mut other) =
        (CUTTING_STROKES.iter().cycle(), NON_CUTTING_STROKES.iter().cycle());
    let next = |cuts: bool| if cuts { cutting.next() } else { other.next() };
    model
        .surfaces
        .iter()
        .map(|s| s.cutting)
        .map(next)
        .map(|c| c.copied().unwrap_or("#000"))
        .collect()
}

//! Cutters whose forms are arcs.

use super::super::big::Big;
use super::Restated;

pub(super) fn all() -> Vec<Restated> {
    vec![lollipop(), barrel(), lens(), oval(), corner_rounding(), woodruff()]
}

/// The ball's upper half ends on the neck, by the right triangle 3, 4, 5.
fn lollipop() -> Restated {
    Restated::new("Lollipop", 0.0)
        .arc("ball", [5.0, 5.0], [0.0, 5.0])
        .arc("ball", [3.0, 9.0], [0.0, 5.0])
        .line("neck", 3.0, 40.0)
        .lines("shank", &[[5.0, 43.0], [5.0, 75.0], [0.0, 75.0]])
        .cuts(&["ball"], |_, depth, _| 1.0 - depth / 5.0)
}

/// The flank's centre is (-80, 8), 85 from the flank and 84 from the corner's centre, which is 1 above the tip.
fn barrel() -> Restated {
    let inner = Big::decimal(84.0 * 84.0 - 49.0).sqrt();
    let touch = [inner.clone() * 85.0 / 84.0 - 80.0, -&(Big::decimal(7.0 * 85.0) / 84.0 - 8.0)];
    let top = Big::decimal(85.0 * 85.0 - 49.0).sqrt() - 80.0;
    Restated::new("Barrel", 0.0)
        .line("face", inner.clone() - 80.0, 0.0)
        .arc("corner", touch, [inner - 80.0, Big::decimal(1.0)])
        .arc("flank", [top, Big::decimal(15.0)], [-80.0, 8.0])
        .lines("neck", &[[4.0, 16.0], [4.0, 45.0]])
        .lines("shank", &[[5.0, 46.0], [5.0, 80.0], [0.0, 80.0]])
        .cuts(&["face", "corner", "flank"], |_, depth, _| 1.0 - depth)
}

/// The face's centre is 20 above the tip and 19 from the corner's centre, which is 5 from the axis.
fn lens() -> Restated {
    let rise = Big::decimal(19.0 * 19.0 - 25.0).sqrt();
    let touch = [Big::decimal(100.0) / 19.0, -&(rise.clone() * 20.0 / 19.0 - 20.0)];
    let height = -&(rise - 20.0);
    Restated::new("Lens", 0.0)
        .arc("face", touch, [0.0, 20.0])
        .arc("corner", [Big::decimal(6.0), height.clone()], [Big::decimal(5.0), height])
        .line("flute", 6.0, 10.0)
        .lines("neck", &[[5.6, 10.4], [5.6, 40.0]])
        .lines("shank", &[[6.0, 40.4], [6.0, 83.0], [0.0, 83.0]])
        .cuts(&["face", "corner", "flute"], |_, depth, _| 1.0 - depth)
}

/// The flank's centre is 80 beyond the axis, 83 from the tip's centre, which is 2 above the tip.
fn oval() -> Restated {
    let high = Big::decimal(83.0 * 83.0 - 80.0 * 80.0).sqrt();
    let level = high.clone() + 2.0;
    let touch = [Big::decimal(80.0 * 85.0) / 83.0 - 80.0, -&(high * 85.0 / 83.0 - level.clone())];
    Restated::new("Oval", 0.0)
        .arc("tip", touch, [0.0, 2.0])
        .arc("flank", [Big::decimal(5.0), level.clone()], [Big::decimal(-80.0), level])
        .lines("shank", &[[5.0, 75.0], [0.0, 75.0]])
        .cuts(&["tip", "flank"], |_, depth, _| 1.0 - depth / 2.0)
}

fn corner_rounding() -> Restated {
    Restated::new("CornerRounding", 0.0)
        .line("face", 3.0, 0.0)
        .line("pilot", 3.0, 0.5)
        .arc("fillet", [6.0, 3.5], [6.0, 0.5])
        .line("rim", 6.5, 3.5)
        .line("head", 6.5, 10.0)
        .lines("shank", &[[6.0, 10.5], [6.0, 60.0], [0.0, 60.0]])
        .cuts(&["pilot", "fillet", "rim"], |surface, depth, _| {
            if surface == "fillet" { 1.0 - depth / 3.0 } else { 0.2 }
        })
}

fn woodruff() -> Restated {
    Restated::new("Woodruff", 0.0)
        .line("face", 8.25, 0.0)
        .line("flute", 8.25, 3.0)
        .line("back", 3.0, 3.0)
        .line("neck", 3.0, 12.0)
        .arc("neck", [5.0, 14.0], [5.0, 12.0])
        .lines("shank", &[[5.0, 56.0], [0.0, 56.0]])
        .cuts(
            &["face", "flute", "back"],
            |surface, depth, _| {
                if surface == "flute" { 1.0 - depth } else { 0.3 }
            },
        )
}

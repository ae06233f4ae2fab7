//! End mills and cutters of straight lines.

use super::super::big::Big;
use super::Restated;

pub(super) fn all() -> Vec<Restated> {
    vec![
        ball(),
        flat(),
        bull_nose(),
        tapered_ball(),
        chamfer_mill(),
        dovetail(),
        t_slot(),
        face_mill(),
        engraver(),
        deburrer(),
        quarter_inch_flat(),
    ]
}

fn ball() -> Restated {
    Restated::new("Ball", 0.0)
        .arc("ball", [5.0, 5.0], [0.0, 5.0])
        .line("flute", 5.0, 22.0)
        .lines("shank", &[[5.0, 72.0], [0.0, 72.0]])
        .cuts(&["ball", "flute"], |_, depth, _| 1.0 - depth / 5.0)
}

fn flat() -> Restated {
    Restated::new("Flat", 0.0)
        .line("face", 6.0, 0.0)
        .line("flute", 6.0, 26.0)
        .lines("shank", &[[6.0, 83.0], [0.0, 83.0]])
        .cuts(&["face", "flute"], |surface, depth, _| {
            if surface == "flute" { 1.0 - depth / 6.0 } else { 0.5 - depth / 6.0 }
        })
}

fn bull_nose() -> Restated {
    Restated::new("BullNose", 0.0)
        .line("face", 4.0, 0.0)
        .arc("corner", [6.0, 2.0], [4.0, 2.0])
        .line("flute", 6.0, 14.0)
        .lines("neck", &[[5.6, 14.4], [5.6, 40.0]])
        .lines("shank", &[[6.0, 40.4], [6.0, 83.0], [0.0, 83.0]])
        .cuts(&["face", "corner", "flute"], |_, depth, _| 1.0 - depth / 2.0)
}

/// A ball of radius 1 that touches a cone of 3° from the axis, up to 6 mm.
fn tapered_ball() -> Restated {
    let (sin, cos) = (Big::sin_deg(3.0), Big::cos_deg(3.0));
    // The point where ball and cone touch, and the height at which the cone ends at a radius of 3.
    let touch = [cos.clone(), -&(sin - 1.0)];
    let end = (-&(cos - 3.0)) / Big::tan_deg(3.0) + touch[1].clone();
    Restated::new("TaperedBall", 0.0)
        .arc("ball", touch, [Big::zero(), Big::decimal(1.0)])
        .line("cone", 3.0, end)
        .lines("shank", &[[3.0, 75.0], [0.0, 75.0]])
        .cuts(&["ball", "cone"], |_, depth, _| 1.0 - depth)
}

fn chamfer_mill() -> Restated {
    Restated::new("ChamferMill", 0.0)
        .line("tip", 0.5, 0.0)
        .line("edge", 5.0, 4.5)
        .line("flute", 5.0, 14.0)
        .lines("shank", &[[5.0, 70.0], [0.0, 70.0]])
        .cuts(
            &["edge", "flute"],
            |surface, depth, _| {
                if surface == "edge" { 1.0 - depth / 2.0 } else { 0.2 }
            },
        )
}

fn dovetail() -> Restated {
    // 6.3 up at 60°: tan 60° = √3.
    let waist = -&(Big::decimal(6.3) / Big::decimal(3.0).sqrt() - 10.0);
    Restated::new("Dovetail", 0.0)
        .line("face", 10.0, 0.0)
        .line("flank", waist, 6.3)
        .lines("neck", &[[5.0, 6.3], [5.0, 25.0]])
        .lines("shank", &[[6.0, 25.0], [6.0, 63.0], [0.0, 63.0]])
        .cuts(
            &["face", "flank"],
            |surface, depth, _| {
                if surface == "face" { 0.5 } else { 1.0 - depth / 2.0 }
            },
        )
}

fn t_slot() -> Restated {
    Restated::new("TSlot", 0.0)
        .line("face", 10.5, 0.0)
        .line("flute", 10.5, 9.0)
        .line("back", 5.0, 9.0)
        .line("neck", 5.0, 27.0)
        .lines("shank", &[[6.0, 28.0], [6.0, 74.0], [0.0, 74.0]])
        .cuts(
            &["face", "flute", "back"],
            |surface, depth, _| {
                if surface == "flute" { 1.0 - depth / 3.0 } else { 0.4 }
            },
        )
}

fn face_mill() -> Restated {
    Restated::new("FaceMill", 3.0)
        .lines("body", &[[17.0, 3.0], [19.0, 0.0]])
        .line("face", 25.0, 0.0)
        .line("edge", 31.0, 6.0)
        .lines("body", &[[24.0, 13.0], [20.0, 20.0], [20.0, 40.0], [0.0, 40.0]])
        .cuts(
            &["face", "edge"],
            |surface, depth, _| {
                if surface == "edge" { 1.0 - depth / 6.0 } else { 0.5 }
            },
        )
}

fn engraver() -> Restated {
    // From a radius of 0.05 to 3.175/2 at 15° from the axis.
    let high = Big::decimal(1.5375) / Big::tan_deg(15.0);
    Restated::new("Engraver", 0.0)
        .line("tip", 0.05, 0.0)
        .line("edge", 1.5875, high)
        .lines("shank", &[[1.5875, 38.0], [0.0, 38.0]])
        .cuts(
            &["tip", "edge"],
            |surface, depth, _| {
                if surface == "tip" { 1.0 } else { 1.0 - depth / 0.2 }
            },
        )
}

fn deburrer() -> Restated {
    Restated::new("Deburrer", 0.0)
        .line("tip", 2.0, 0.0)
        .line("front", 6.0, 4.0)
        .line("land", 6.0, 5.0)
        .line("back", 3.0, 8.0)
        .line("neck", 3.0, 40.0)
        .lines("shank", &[[4.0, 41.0], [4.0, 80.0], [0.0, 80.0]])
        .cuts(&["front", "back"], |_, depth, _| 1.0 - depth / 2.0)
}

/// In inches.
fn quarter_inch_flat() -> Restated {
    Restated::new("QuarterInchFlat", 0.0)
        .line("face", 0.11, 0.0)
        .arc("corner", [0.125, 0.015], [0.11, 0.015])
        .line("flute", 0.125, 0.75)
        .lines("shank", &[[0.125, 2.5], [0.0, 2.5]])
        .cuts(&["face", "corner", "flute"], |surface, depth, _| match surface {
            "flute" => 1.0 - depth / 0.125,
            "corner" => 0.8,
            _ => 0.5,
        })
}

//! Cutters in holders: one profile, from the cutter's tip to the spindle's face.

use super::Restated;

pub(super) fn all() -> Vec<Restated> {
    vec![ball_er16(), bull_nose_hsk63(), drill_bt40(), half_inch_ball_cat40()]
}

/// The ring under a nut belongs to the nut; nothing above it belongs to the cutter.
fn ball_er16() -> Restated {
    Restated::new("BallEr16", 0.0)
        .arc("cutter.ball", [3.0, 3.0], [0.0, 3.0])
        .line("cutter.flute", 3.0, 18.0)
        .line("cutter.shank", 3.0, 30.0)
        .lines("nut.nut", &[[12.9, 30.0], [14.0, 31.1], [14.0, 47.5], [0.0, 47.5]])
        .cuts(&["cutter.ball", "cutter.flute"], |_, depth, _| 1.0 - depth / 3.0)
}

fn bull_nose_hsk63() -> Restated {
    Restated::new("BullNoseHsk63", 0.0)
        .line("cutter.face", 4.0, 0.0)
        .arc("cutter.corner", [6.0, 2.0], [4.0, 2.0])
        .line("cutter.flute", 6.0, 14.0)
        .lines("cutter.neck", &[[5.6, 14.4], [5.6, 40.0]])
        .lines("cutter.shank", &[[6.0, 40.4], [6.0, 45.0]])
        .lines("nut.nut", &[[20.0, 45.0], [22.0, 48.0], [25.0, 48.0], [25.0, 67.5], [23.0, 67.5]])
        .lines("holder.body", &[[23.0, 97.5], [26.5, 105.5], [31.0, 105.5], [31.5, 106.0]])
        .line("holder.flange", 31.5, 112.5)
        .lines("holder.groove", &[[26.5, 115.4], [26.5, 118.6], [31.5, 121.5]])
        .lines("holder.flange", &[[31.5, 131.5], [0.0, 131.5]])
        .cuts(&["cutter.face", "cutter.corner", "cutter.flute"], |_, depth, _| 1.0 - depth / 2.0)
}

fn drill_bt40() -> Restated {
    let cutter = super::hole_making::drill().segments.swap_remove(0).to;
    let [d, z] = cutter;
    Restated::new("DrillBt40", 0.0)
        .line("cutter.point", d, z)
        .line("cutter.flute", 4.25, 75.0)
        .line("cutter.shank", 4.25, 85.0)
        .lines("nut.nut", &[[12.9, 85.0], [14.0, 86.1], [14.0, 102.5]])
        .lines("holder.body", &[[14.0, 122.5], [20.0, 145.5]])
        .arc("holder.body", [22.0, 147.5], [22.0, 145.5])
        .lines("holder.flange", &[[31.5, 147.5], [31.5, 153.5]])
        .lines("holder.groove", &[[26.5, 156.5], [26.5, 158.5], [31.5, 161.5]])
        .lines("holder.flange", &[[31.5, 174.5], [0.0, 174.5]])
        .cuts(&["cutter.point"], |_, _, _| 1.0)
}

/// In inches.
fn half_inch_ball_cat40() -> Restated {
    Restated::new("HalfInchBallCat40", 0.0)
        .arc("cutter.ball", [0.25, 0.25], [0.0, 0.25])
        .line("cutter.flute", 0.25, 1.0)
        .line("cutter.shank", 0.25, 2.0)
        .lines("holder.body", &[[0.815, 2.0], [0.875, 2.06], [0.875, 4.25], [1.25, 4.25]])
        .line("holder.flange", 1.25, 4.45)
        .lines("holder.groove", &[[1.05, 4.57], [1.05, 4.67], [1.25, 4.79]])
        .lines("holder.flange", &[[1.25, 5.0], [0.0, 5.0]])
        .cuts(&["cutter.ball", "cutter.flute"], |_, depth, _| 1.0 - depth / 0.25)
}

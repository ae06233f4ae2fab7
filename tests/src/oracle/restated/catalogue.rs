//! Cutters with a catalogue's dimensions: end mills, cutters whose forms are arcs, tools for holes and threads, and
//! cutters in holders, which are one profile from the cutter's tip to the spindle's face.

use super::Restated;
use crate::oracle::big::Big;

pub(super) fn all() -> Vec<Restated> {
    [plain(), form(), hole_making(), threading(), assemblies()].concat()
}

fn drawn(name: &'static str, drawing: &'static str) -> Restated {
    Restated::drawn(name, drawing, &[])
}

fn decimal(value: f64) -> Big {
    Big::decimal(value)
}

/// Returns the square root of an exact number.
fn root(value: f64) -> Big {
    Big::decimal(value).sqrt()
}

/// End mills and cutters of straight lines.
fn plain() -> Vec<Restated> {
    vec![
        drawn("Ball", "0 0; ball 5 5 about 0 5; flute 5 22; shank 5 72, 0 72")
            .cuts("ball flute", |_, depth, _| 1.0 - depth / 5.0),
        drawn("Flat", "0 0; face 6 0; flute 6 26; shank 6 83, 0 83").cuts(
            "face flute",
            |surface, depth, _| {
                if surface == "flute" { 1.0 - depth / 6.0 } else { 0.5 - depth / 6.0 }
            },
        ),
        drawn(
            "BullNose",
            "0 0; face 4 0; corner 6 2 about 4 2; flute 6 14; neck 5.6 14.4, 5.6 40;
             shank 6 40.4, 6 83, 0 83",
        )
        .cuts("face corner flute", |_, depth, _| 1.0 - depth / 2.0),
        tapered_ball(),
        drawn("ChamferMill", "0 0; tip 0.5 0; edge 5 4.5; flute 5 14; shank 5 70, 0 70").cuts(
            "edge flute",
            |surface, depth, _| {
                if surface == "edge" { 1.0 - depth / 2.0 } else { 0.2 }
            },
        ),
        // 6.3 up at 60°: tan 60° = √3.
        Restated::drawn(
            "Dovetail",
            "0 0; face 10 0; flank waist 6.3; neck 5 6.3, 5 25; shank 6 25, 6 63, 0 63",
            &[("waist", decimal(10.0) - decimal(6.3) / root(3.0))],
        )
        .cuts(
            "face flank",
            |surface, depth, _| {
                if surface == "face" { 0.5 } else { 1.0 - depth / 2.0 }
            },
        ),
        drawn(
            "TSlot",
            "0 0; face 10.5 0; flute 10.5 9; back 5 9; neck 5 27; shank 6 28, 6 74, 0 74",
        )
        .cuts(
            "face flute back",
            |surface, depth, _| {
                if surface == "flute" { 1.0 - depth / 3.0 } else { 0.4 }
            },
        ),
        drawn(
            "FaceMill",
            "0 3; body 17 3, 19 0; face 25 0; edge 31 6; body 24 13, 20 20, 20 40, 0 40",
        )
        .cuts(
            "face edge",
            |surface, depth, _| {
                if surface == "edge" { 1.0 - depth / 6.0 } else { 0.5 }
            },
        ),
        // From a radius of 0.05 to 3.175/2 at 15° from the axis.
        Restated::drawn(
            "Engraver",
            "0 0; tip 0.05 0; edge 1.5875 high; shank 1.5875 38, 0 38",
            &[("high", decimal(1.5375) / Big::tan_deg(15.0))],
        )
        .cuts(
            "tip edge",
            |surface, depth, _| {
                if surface == "tip" { 1.0 } else { 1.0 - depth / 0.2 }
            },
        ),
        drawn(
            "Deburrer",
            "0 0; tip 2 0; front 6 4; land 6 5; back 3 8; neck 3 40; shank 4 41, 4 80, 0 80",
        )
        .cuts("front back", |_, depth, _| 1.0 - depth / 2.0),
        // In inches.
        drawn(
            "QuarterInchFlat",
            "0 0; face 0.11 0; corner 0.125 0.015 about 0.11 0.015; flute 0.125 0.75;
             shank 0.125 2.5, 0 2.5",
        )
        .cuts("face corner flute", |surface, depth, _| match surface {
            "flute" => 1.0 - depth / 0.125,
            "corner" => 0.8,
            _ => 0.5,
        }),
    ]
}

/// A ball of radius 1 that touches a cone of 3° from the axis, up to 6 mm.
fn tapered_ball() -> Restated {
    let (sin, cos) = (Big::sin_deg(3.0), Big::cos_deg(3.0));
    // The height at which ball and cone touch, and the one at which the cone ends at a radius of 3.
    let touch = decimal(1.0) - sin;
    let end = (decimal(3.0) - cos.clone()) / Big::tan_deg(3.0) + touch.clone();
    Restated::drawn(
        "TaperedBall",
        "0 0; ball cos touch about 0 1; cone 3 end; shank 3 75, 0 75",
        &[("cos", cos), ("touch", touch), ("end", end)],
    )
    .cuts("ball cone", |_, depth, _| 1.0 - depth)
}

/// Cutters whose forms are arcs.
fn form() -> Vec<Restated> {
    vec![
        // The ball's upper half ends on the neck, by the right triangle 3, 4, 5.
        drawn(
            "Lollipop",
            "0 0; ball 5 5 about 0 5, 3 9 about 0 5; neck 3 40; shank 5 43, 5 75, 0 75",
        )
        .cuts("ball", |_, depth, _| 1.0 - depth / 5.0),
        barrel(),
        lens(),
        oval(),
        drawn(
            "CornerRounding",
            "0 0; face 3 0; pilot 3 0.5; fillet 6 3.5 about 6 0.5; rim 6.5 3.5; head 6.5 10;
             shank 6 10.5, 6 60, 0 60",
        )
        .cuts("pilot fillet rim", |surface, depth, _| {
            if surface == "fillet" { 1.0 - depth / 3.0 } else { 0.2 }
        }),
        drawn(
            "Woodruff",
            "0 0; face 8.25 0; flute 8.25 3; back 3 3; neck 3 12, 5 14 about 5 12;
             shank 5 56, 0 56",
        )
        .cuts(
            "face flute back",
            |surface, depth, _| {
                if surface == "flute" { 1.0 - depth } else { 0.3 }
            },
        ),
    ]
}

/// The flank's centre is (-80, 8), 85 from the flank and 84 from the corner's centre, which is 1 above the tip.
fn barrel() -> Restated {
    let inner = root(84.0 * 84.0 - 49.0);
    Restated::drawn(
        "Barrel",
        "0 0; face face 0; corner touch low about face 1; flank top 15 about -80 8;
         neck 4 16, 4 45; shank 5 46, 5 80, 0 80",
        &[
            ("face", inner.clone() - 80.0),
            ("touch", inner * 85.0 / 84.0 - 80.0),
            ("low", decimal(8.0) - decimal(7.0 * 85.0) / 84.0),
            ("top", root(85.0 * 85.0 - 49.0) - 80.0),
        ],
    )
    .cuts("face corner flank", |_, depth, _| 1.0 - depth)
}

/// The face's centre is 20 above the tip and 19 from the corner's centre, which is 5 from the axis.
fn lens() -> Restated {
    let rise = root(19.0 * 19.0 - 25.0);
    Restated::drawn(
        "Lens",
        "0 0; face touch low about 0 20; corner 6 height about 5 height; flute 6 10;
         neck 5.6 10.4, 5.6 40; shank 6 40.4, 6 83, 0 83",
        &[
            ("touch", decimal(100.0) / 19.0),
            ("low", decimal(20.0) - rise.clone() * 20.0 / 19.0),
            ("height", decimal(20.0) - rise),
        ],
    )
    .cuts("face corner flute", |_, depth, _| 1.0 - depth)
}

/// The flank's centre is 80 beyond the axis, 83 from the tip's centre, which is 2 above the tip.
fn oval() -> Restated {
    let high = root(83.0 * 83.0 - 80.0 * 80.0);
    let level = high.clone() + 2.0;
    Restated::drawn(
        "Oval",
        "0 0; tip touch low about 0 2; flank 5 level about -80 level; shank 5 75, 0 75",
        &[
            ("touch", decimal(80.0 * 85.0) / 83.0 - 80.0),
            ("low", level.clone() - high * 85.0 / 83.0),
            ("level", level),
        ],
    )
    .cuts("tip flank", |_, depth, _| 1.0 - depth / 2.0)
}

/// Returns the height of a drill's point of 118°, 59° from the axis, at a radius of 4.25.
fn drill_point() -> Big {
    decimal(4.25) / Big::tan_deg(59.0)
}

/// Tools for holes.
fn hole_making() -> Vec<Restated> {
    vec![
        Restated::drawn(
            "Drill",
            "0 0; point 4.25 high; flute 4.25 75; shank 4.25 117, 0 117",
            &[("high", drill_point())],
        )
        .cuts("point", |_, _, _| 1.0),
        drawn("SpotDrill", "0 0; point 4 4; flute 4 25; shank 4 79, 0 79")
            .cuts("point", |_, depth, _| 1.0 - depth / 4.0),
        drawn(
            "Countersink",
            "0 0; tip 1.6 0; cone 8.25 6.65; land 8.25 7.5; shank 5 12, 5 60, 0 60",
        )
        .cuts("cone", |_, depth, _| 1.0 - depth / 3.0),
        drawn(
            "Reamer",
            "0 0; face 3 0; lead 4 1; land 4 33; neck 3.6 34, 3.6 75; shank 4 76, 4 117, 0 117",
        )
        .cuts("lead land", |surface, depth, _| {
            1.0 - depth / if surface == "lead" { 0.2 } else { 0.05 }
        }),
        drawn(
            "BoringBar",
            "0 0.6; front 14 0.6, 15.6 0; nose 16 0.4 about 15.6 0.4; relief 15 9;
             bar 12.5 9, 12.5 150, 0 150",
        )
        .cuts("nose", |_, depth, _| 1.0 - depth / 0.4),
    ]
}

/// Tools for threads, whose flanks of 30° rise over 0.9.
fn threading() -> Vec<Restated> {
    let flank = decimal(0.9) / root(3.0);
    let [crest, end] = [flank.clone() + 0.1, flank.clone() * 2.0 + 0.1];
    let tooth = [("flank", flank.clone()), ("crest", crest), ("end", end)];
    let single = Restated::drawn(
        "SingleTooth",
        "0 0; face 2.05 0; tooth 2.95 flank, 2.95 crest, 2.05 end; neck 2.05 20;
         shank 3 21, 3 58, 0 58",
        &tooth,
    );
    // Five teeth from each of these heights: up its flank, along its crest, and down to its end.
    let names =
        ["a0", "b0", "c0", "a1", "b1", "c1", "a2", "b2", "c2", "a3", "b3", "c3", "a4", "b4", "c4"];
    let heights = [0.0, 1.5, 3.0, 4.5, 6.0].map(|z| {
        let crest = z + 0.1875;
        [flank.clone() + z, flank.clone() + crest, flank.clone() * 2.0 + crest]
    });
    let teeth: Vec<_> = names.into_iter().zip(heights.into_iter().flatten()).collect();
    let many = Restated::drawn(
        "ThreadMill",
        "0 0; face 3 0; tooth 3.9 a0, 3.9 b0, 3 c0; groove 3 1.5; tooth 3.9 a1, 3.9 b1, 3 c1;
         groove 3 3; tooth 3.9 a2, 3.9 b2, 3 c2; groove 3 4.5; tooth 3.9 a3, 3.9 b3, 3 c3;
         groove 3 6; tooth 3.9 a4, 3.9 b4, 3 c4; neck 3 24; shank 4 25, 4 63, 0 63",
        &teeth,
    );
    [single, many].map(|tool| tool.cuts("tooth", |_, depth, _| 1.0 - depth)).into()
}

/// Cutters in holders. The ring under a nut belongs to the nut; nothing above it belongs to the cutter.
fn assemblies() -> Vec<Restated> {
    vec![
        drawn(
            "BallEr16",
            "0 0; cutter.ball 3 3 about 0 3; cutter.flute 3 18; cutter.shank 3 30;
             nut.nut 12.9 30, 14 31.1, 14 47.5, 0 47.5",
        )
        .cuts("cutter.ball cutter.flute", |_, depth, _| 1.0 - depth / 3.0),
        drawn(
            "BullNoseHsk63",
            "0 0; cutter.face 4 0; cutter.corner 6 2 about 4 2; cutter.flute 6 14;
             cutter.neck 5.6 14.4, 5.6 40; cutter.shank 6 40.4, 6 45;
             nut.nut 20 45, 22 48, 25 48, 25 67.5, 23 67.5;
             holder.body 23 97.5, 26.5 105.5, 31 105.5, 31.5 106; holder.flange 31.5 112.5;
             holder.groove 26.5 115.4, 26.5 118.6, 31.5 121.5; holder.flange 31.5 131.5, 0 131.5",
        )
        .cuts("cutter.face cutter.corner cutter.flute", |_, depth, _| 1.0 - depth / 2.0),
        Restated::drawn(
            "DrillBt40",
            "0 0; cutter.point 4.25 high; cutter.flute 4.25 75; cutter.shank 4.25 85;
             nut.nut 12.9 85, 14 86.1, 14 102.5;
             holder.body 14 122.5, 20 145.5, 22 147.5 about 22 145.5; holder.flange 31.5 147.5, 31.5 153.5;
             holder.groove 26.5 156.5, 26.5 158.5, 31.5 161.5; holder.flange 31.5 174.5, 0 174.5",
            &[("high", drill_point())],
        )
        .cuts("cutter.point", |_, _, _| 1.0),
        // In inches.
        drawn(
            "HalfInchBallCat40",
            "0 0; cutter.ball 0.25 0.25 about 0 0.25; cutter.flute 0.25 1; cutter.shank 0.25 2;
             holder.body 0.815 2, 0.875 2.06, 0.875 4.25, 1.25 4.25; holder.flange 1.25 4.45;
             holder.groove 1.05 4.57, 1.05 4.67, 1.25 4.79; holder.flange 1.25 5, 0 5",
        )
        .cuts("cutter.ball cutter.flute", |_, depth, _| 1.0 - depth / 0.25),
    ]
}

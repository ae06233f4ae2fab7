//! The tools: a row for each with its name, its [drawing][Restated::drawn], and the [laws][Restated::laws] of the
//! surfaces that cut.

use super::Restated;
use crate::oracle::big::Big;

/// Solids of Ho 1999 (fig. 4.2; fig. 2.2 and 2.3; fig. 7.3), and a plain 2 mm ball end mill beside them.
pub(super) const THESIS: &str = "\
UnitSphere | 0 0; ball 0 2 about 0 1 |
Cylinder | 0 0; bottom 2 0; side 2 6; top 0 6 |
HalfSphereCylinder | 0 0; ball 2 2 about 0 2; step 1 2; stem 1 8, 0 8 |
Fig73Exact | 0 0; nose 1 1 about 0 1; flute 1 5; spindle 3 7, 3 9; housing 5 9, 5 20, 0 20 |
D2Ball | 0 0; ball 1 1 about 0 1; flute 1 5; shank 1 40, 0 40 | ball flute: 1 - depth";

/// Cutters with a catalogue's dimensions: end mills; cutters whose forms are arcs; tools for holes; tools for threads,
/// whose flanks of 30° rise over 0.9; and cutters in holders, which are one profile from the cutter's tip to the
/// spindle's face. The ring under a nut belongs to the nut; nothing above it belongs to the cutter. `QuarterInchFlat` and
/// `HalfInchBallCat40` are in inches.
pub(super) const CATALOGUE: &str = "\
Ball | 0 0; ball 5 5 about 0 5; flute 5 22; shank 5 72, 0 72 | ball flute: 1 - depth/5
Flat | 0 0; face 6 0; flute 6 26; shank 6 83, 0 83 | flute: 1 - depth/6; face: 0.5 - depth/6
BullNose | 0 0; face 4 0; corner 6 2 about 4 2; flute 6 14; neck 5.6 14.4, 5.6 40; shank 6 40.4, 6 83, 0 83 \
    | face corner flute: 1 - depth/2
TaperedBall | 0 0; ball cos touch about 0 1; cone 3 end; shank 3 75, 0 75 | ball cone: 1 - depth
ChamferMill | 0 0; tip 0.5 0; edge 5 4.5; flute 5 14; shank 5 70, 0 70 | edge: 1 - depth/2; flute: 0.2
Dovetail | 0 0; face 10 0; flank waist 6.3; neck 5 6.3, 5 25; shank 6 25, 6 63, 0 63 \
    | face: 0.5; flank: 1 - depth/2
TSlot | 0 0; face 10.5 0; flute 10.5 9; back 5 9; neck 5 27; shank 6 28, 6 74, 0 74 \
    | flute: 1 - depth/3; face back: 0.4
FaceMill | 0 3; body 17 3, 19 0; face 25 0; edge 31 6; body 24 13, 20 20, 20 40, 0 40 \
    | edge: 1 - depth/6; face: 0.5
Engraver | 0 0; tip 0.05 0; edge 1.5875 engraved; shank 1.5875 38, 0 38 | tip: 1; edge: 1 - depth/0.2
Deburrer | 0 0; tip 2 0; front 6 4; land 6 5; back 3 8; neck 3 40; shank 4 41, 4 80, 0 80 \
    | front back: 1 - depth/2
QuarterInchFlat | 0 0; face 0.11 0; corner 0.125 0.015 about 0.11 0.015; flute 0.125 0.75; shank 0.125 2.5, 0 2.5 \
    | flute: 1 - depth/0.125; corner: 0.8; face: 0.5
Lollipop | 0 0; ball 5 5 about 0 5, 3 9 about 0 5; neck 3 40; shank 5 43, 5 75, 0 75 | ball: 1 - depth/5
Barrel | 0 0; face b0 0; corner b1 b2 about b0 1; flank b3 15 about -80 8; neck 4 16, 4 45; shank 5 46, 5 80, 0 80 \
    | face corner flank: 1 - depth
Lens | 0 0; face l0 l1 about 0 20; corner 6 l2 about 5 l2; flute 6 10; neck 5.6 10.4, 5.6 40; \
    shank 6 40.4, 6 83, 0 83 | face corner flute: 1 - depth
Oval | 0 0; tip o0 o1 about 0 2; flank 5 o2 about -80 o2; shank 5 75, 0 75 | tip flank: 1 - depth/2
CornerRounding | 0 0; face 3 0; pilot 3 0.5; fillet 6 3.5 about 6 0.5; rim 6.5 3.5; head 6.5 10; \
    shank 6 10.5, 6 60, 0 60 | fillet: 1 - depth/3; pilot rim: 0.2
Woodruff | 0 0; face 8.25 0; flute 8.25 3; back 3 3; neck 3 12, 5 14 about 5 12; shank 5 56, 0 56 \
    | flute: 1 - depth; face back: 0.3
Drill | 0 0; point 4.25 drilled; flute 4.25 75; shank 4.25 117, 0 117 | point: 1
SpotDrill | 0 0; point 4 4; flute 4 25; shank 4 79, 0 79 | point: 1 - depth/4
Countersink | 0 0; tip 1.6 0; cone 8.25 6.65; land 8.25 7.5; shank 5 12, 5 60, 0 60 | cone: 1 - depth/3
Reamer | 0 0; face 3 0; lead 4 1; land 4 33; neck 3.6 34, 3.6 75; shank 4 76, 4 117, 0 117 \
    | lead: 1 - depth/0.2; land: 1 - depth/0.05
BoringBar | 0 0.6; front 14 0.6, 15.6 0; nose 16 0.4 about 15.6 0.4; relief 15 9; bar 12.5 9, 12.5 150, 0 150 \
    | nose: 1 - depth/0.4
SingleTooth | 0 0; face 2.05 0; tooth 2.95 t0, 2.95 t1, 2.05 t2; neck 2.05 20; shank 3 21, 3 58, 0 58 \
    | tooth: 1 - depth
ThreadMill | 0 0; face 3 0; tooth 3.9 u0, 3.9 v0, 3 w0; groove 3 1.5; tooth 3.9 u1, 3.9 v1, 3 w1; \
    groove 3 3; tooth 3.9 u2, 3.9 v2, 3 w2; groove 3 4.5; tooth 3.9 u3, 3.9 v3, 3 w3; \
    groove 3 6; tooth 3.9 u4, 3.9 v4, 3 w4; neck 3 24; shank 4 25, 4 63, 0 63 | tooth: 1 - depth
BallEr16 | 0 0; cutter.ball 3 3 about 0 3; cutter.flute 3 18; cutter.shank 3 30; \
    nut.nut 12.9 30, 14 31.1, 14 47.5, 0 47.5 | cutter.ball cutter.flute: 1 - depth/3
BullNoseHsk63 | 0 0; cutter.face 4 0; cutter.corner 6 2 about 4 2; cutter.flute 6 14; \
    cutter.neck 5.6 14.4, 5.6 40; cutter.shank 6 40.4, 6 45; nut.nut 20 45, 22 48, 25 48, 25 67.5, 23 67.5; \
    holder.body 23 97.5, 26.5 105.5, 31 105.5, 31.5 106; holder.flange 31.5 112.5; \
    holder.groove 26.5 115.4, 26.5 118.6, 31.5 121.5; holder.flange 31.5 131.5, 0 131.5 \
    | cutter.face cutter.corner cutter.flute: 1 - depth/2
DrillBt40 | 0 0; cutter.point 4.25 drilled; cutter.flute 4.25 75; cutter.shank 4.25 85; \
    nut.nut 12.9 85, 14 86.1, 14 102.5; holder.body 14 122.5, 20 145.5, 22 147.5 about 22 145.5; \
    holder.flange 31.5 147.5, 31.5 153.5; holder.groove 26.5 156.5, 26.5 158.5, 31.5 161.5; \
    holder.flange 31.5 174.5, 0 174.5 | cutter.point: 1
HalfInchBallCat40 | 0 0; cutter.ball 0.25 0.25 about 0 0.25; cutter.flute 0.25 1; cutter.shank 0.25 2; \
    holder.body 0.815 2, 0.875 2.06, 0.875 4.25, 1.25 4.25; holder.flange 1.25 4.45; \
    holder.groove 1.05 4.57, 1.05 4.67, 1.25 4.79; holder.flange 1.25 5, 0 5 | cutter.ball cutter.flute: 1 - depth/0.25";

/// Returns the tools of rows.
pub(super) fn read(rows: &'static str) -> Vec<Restated> {
    let lengths = lengths();
    let tool = |row: &'static str| {
        let parts: Vec<&str> = row.split('|').map(str::trim).collect();
        let [name, drawing, laws] = parts[..] else { panic!("not a row: {row}") };
        Restated::drawn(name, drawing, &lengths).laws(laws)
    };
    rows.lines().map(tool).collect()
}

/// Returns the lengths that follow from the numbers on the drawings, by the words that stand for them.
fn lengths() -> Vec<(&'static str, Big)> {
    let (decimal, root) = (Big::decimal, |square: f64| Big::decimal(square).sqrt());
    // `TaperedBall`: a ball of radius 1 touches a cone of 3° from the axis, which ends at a radius of 3.
    let (cos, touch) = (Big::cos_deg(3.0), decimal(1.0) - Big::sin_deg(3.0));
    let end = (decimal(3.0) - cos.clone()) / Big::tan_deg(3.0) + touch.clone();
    // `Barrel`: the flank's centre is (-80, 8), 85 from the flank and 84 from the corner's centre, 1 above the tip.
    let inner = root(84.0 * 84.0 - 49.0);
    // `Lens`: the face's centre is 20 above the tip and 19 from the corner's centre, which is 5 from the axis.
    let rise = root(19.0 * 19.0 - 25.0);
    // `Oval`: the flank's centre is 80 beyond the axis, 83 from the tip's centre, which is 2 above the tip.
    let high = root(83.0 * 83.0 - 80.0 * 80.0);
    let level = high.clone() + 2.0;
    let flank = decimal(0.9) / root(3.0);
    let mut lengths = vec![
        ("cos", cos),
        ("touch", touch),
        ("end", end),
        // `Dovetail`: 6.3 up at 60°, and tan 60° = √3.
        ("waist", decimal(10.0) - decimal(6.3) / root(3.0)),
        // `Engraver`: from a radius of 0.05 to 3.175/2 at 15° from the axis.
        ("engraved", decimal(1.5375) / Big::tan_deg(15.0)),
        // Points of drills of 118°, 59° from the axis, at a radius of 4.25.
        ("drilled", decimal(4.25) / Big::tan_deg(59.0)),
        ("b0", inner.clone() - 80.0),
        ("b1", inner * 85.0 / 84.0 - 80.0),
        ("b2", decimal(8.0) - decimal(7.0 * 85.0) / 84.0),
        ("b3", root(85.0 * 85.0 - 49.0) - 80.0),
        ("l0", decimal(100.0) / 19.0),
        ("l1", decimal(20.0) - rise.clone() * 20.0 / 19.0),
        ("l2", decimal(20.0) - rise),
        ("o0", decimal(80.0 * 85.0) / 83.0 - 80.0),
        ("o1", level.clone() - high * 85.0 / 83.0),
        ("o2", level),
        ("t0", flank.clone()),
        ("t1", flank.clone() + 0.1),
        ("t2", flank.clone() * 2.0 + 0.1),
    ];
    // Five teeth from each of these heights: up its flank, along its crest, and down to its end.
    let words =
        ["u0", "v0", "w0", "u1", "v1", "w1", "u2", "v2", "w2", "u3", "v3", "w3", "u4", "v4", "w4"];
    let teeth = [0.0, 1.5, 3.0, 4.5, 6.0].into_iter().flat_map(|z| {
        let crest = z + 0.1875;
        [flank.clone() + z, flank.clone() + crest, flank.clone() * 2.0 + crest]
    });
    lengths.extend(words.into_iter().zip(teeth));
    lengths
}

//! Tools whose coordinates are all short dyadic numbers, so that scaling by a power of two does not round them.
//!
//! Tangent points come from Pythagorean triples. The reference for a tool is its list of coordinates in this module,
//! evaluated in doubles and in 256 bits. The tool under test is compiled from text with the same numbers.

use std::fmt::Write;
use touchoff::tool::{Interpreted, ToolError};
use touchoff_dsl::source::Source;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::outline::{MeridianPoint, Outline, Segment};
use touchoff_tests::oracle::reference::Reference;
use touchoff_tests::oracle::restated::{self, Restated};

/// A tool at one scale.
pub(crate) struct Cutter {
    /// The name and the scale.
    pub(crate) name: String,
    /// The compiled tool.
    pub(crate) tool: Interpreted,
    /// The profile in doubles.
    pub(crate) outline: Outline,
    /// The profile in 256 bits.
    pub(crate) reference: Reference,
    /// The largest distance from the axis, and the height, mm.
    pub(crate) extent: [f64; 2],
    /// The largest distance from the tip to which the circles of its arcs extend, or the tool's extent if that is
    /// larger, mm.
    pub(crate) reach: f64,
}

/// A profile: the name, and the end points of its segments with the centre if the segment is an arc.
type ProfilePoints = (&'static str, &'static [(MeridianPoint, Option<MeridianPoint>)]);

/// The profiles at scale 1, mm; each begins at the origin.
const PROFILES: [ProfilePoints; 11] = [
    ("Ball", &[([5., 5.], Some([0., 5.])), ([5., 22.], None), ([0., 22.], None)]),
    ("Flat", &[([6., 0.], None), ([6., 26.], None), ([0., 26.], None)]),
    (
        "BullNose",
        &[
            ([4., 0.], None),
            ([6., 2.], Some([4., 2.])),
            ([6., 14.], None),
            ([5.5, 14.5], None),
            ([5.5, 40.], None),
            ([6., 40.5], None),
            ([6., 83.], None),
            ([0., 83.], None),
        ],
    ),
    // Triple 7, 24, 25: the cone is tangent to the ball at (3, 2.25).
    (
        "Taper",
        &[
            ([3., 2.25], Some([0., 3.125])),
            ([6.5, 14.25], None),
            ([6.5, 30.], None),
            ([0., 30.], None),
        ],
    ),
    // Triple 3, 4, 5: the ball meets the neck at (3, 9), a reflex corner.
    (
        "Lollipop",
        &[
            ([5., 5.], Some([0., 5.])),
            ([3., 9.], Some([0., 5.])),
            ([3., 40.], None),
            ([5., 43.], None),
            ([5., 75.], None),
            ([0., 75.], None),
        ],
    ),
    // A concave arc.
    (
        "Rounding",
        &[
            ([3., 0.], None),
            ([3., 0.5], None),
            ([6., 3.5], Some([6., 0.5])),
            ([6.5, 3.5], None),
            ([6.5, 10.], None),
            ([6., 10.5], None),
            ([6., 60.], None),
            ([0., 60.], None),
        ],
    ),
    (
        "TSlot",
        &[
            ([10.5, 0.], None),
            ([10.5, 9.], None),
            ([5., 9.], None),
            ([5., 27.], None),
            ([6., 28.], None),
            ([6., 74.], None),
            ([0., 74.], None),
        ],
    ),
    // Triple 13, 84, 85: an arc whose centre lies far beyond the axis.
    (
        "Barrel",
        &[
            ([4., 0.], None),
            ([4., 26.], Some([-80., 13.])),
            ([3.5, 26.5], None),
            ([3.5, 50.], None),
            ([0., 50.], None),
        ],
    ),
    // An arc of radius 4096.00390625, a hundred times the tool's size.
    (
        "Bowed",
        &[
            ([6., 0.], None),
            ([6., 16.], Some([-4089.99609375, 8.])),
            ([5.5, 16.5], None),
            ([5.5, 40.], None),
            ([0., 40.], None),
        ],
    ),
    // A pointed tip: the depth has a kink on the axis.
    ("Point", &[([6., 6.], None), ([6., 20.], None), ([0., 20.], None)]),
    // A tool a hundred times as long as it is thick.
    ("Needle", &[([0.5, 0.5], Some([0., 0.5])), ([0.5, 64.], None), ([0., 64.], None)]),
];

/// Exponents of two by which each profile is scaled: from about 1e-6 to 1e6.
const SCALES: [i32; 5] = [-20, -10, 0, 10, 20];

/// The number of tools that [`cutter`] can make.
pub(crate) const COUNT: usize = PROFILES.len() * SCALES.len();

/// Returns the tool with a number below [`COUNT`].
///
/// # Errors
/// If the compiler rejects the tool.
pub(crate) fn cutter(number: usize) -> Result<Cutter, ToolError> {
    let (name, points) = PROFILES[number % PROFILES.len()];
    let exponent = SCALES[number / PROFILES.len()];
    let scale = 2f64.powi(exponent);
    let scaled = |point: MeridianPoint| point.map(|coordinate| coordinate * scale);
    let mut segments = Vec::new();
    let mut from = [0.0, 0.0];
    for &(to, centre) in points {
        segments.push(Segment { from, to: scaled(to), centre: centre.map(scaled) });
        from = scaled(to);
    }
    let max_coordinate =
        |axis: usize| segments.iter().fold(0.0f64, |max, segment| max.max(segment.to[axis]));
    let farthest_point = |segment: &Segment| {
        let [x, y] = segment.centre?;
        Some(x.hypot(y) + (segment.to[0] - x).hypot(segment.to[1] - y))
    };
    let reach = segments
        .iter()
        .filter_map(farthest_point)
        .fold(max_coordinate(0).max(max_coordinate(1)), f64::max);
    Ok(Cutter {
        reach,
        name: format!("{name}·2^{exponent}"),
        tool: Interpreted::parse(&Source::new("cutter.tool", &*source_text(name, &segments)))?,
        reference: Reference::new(&restated(name, &segments)),
        extent: [max_coordinate(0), max_coordinate(1)],
        outline: Outline::new(segments),
    })
}

/// Returns the source text of the tool.
fn source_text(name: &str, segments: &[Segment]) -> String {
    let mut text = format!("tool {name} {{ units mm; profile {{ start (0, 0);");
    for (k, segment) in segments.iter().enumerate() {
        let [d, z] = segment.to;
        let result = match segment.centre {
            Some([x, y]) => {
                let concave = if segment.is_concave() { " concave" } else { "" };
                write!(text, " arc to ({d}, {z}) center ({x}, {y}){concave} as s{k} cutting;")
            }
            None => write!(text, " line to ({d}, {z}) as s{k} cutting;"),
        };
        result.expect("a text has room");
    }
    text + " } niceness cutting: 1; }"
}

/// Returns the tool as the 256-bit reference reads it.
fn restated(name: &'static str, segments: &[Segment]) -> Restated {
    let exact = |point: MeridianPoint| point.map(Big::exactly);
    let exact_segment = |segment: &Segment| restated::Segment {
        to: exact(segment.to),
        centre: segment.centre.map(exact),
        surface: "all",
    };
    Restated {
        name,
        start: exact([0.0, 0.0]),
        segments: segments.iter().map(exact_segment).collect(),
        cutting: Vec::new(),
        niceness: |_, _, _| 1.0,
    }
}

mod tests {
    use super::*;
    use touchoff_tests::oracle::reference::QueryPoint;
    use touchoff_tests::oracle::rng::Rng;

    #[test]
    fn doubles_and_256_bits_agree() {
        let mut rng = Rng::new(1);
        for number in 0..COUNT {
            let cutter = cutter(number).expect("a tool");
            let [radius, height] = cutter.extent;
            for _ in 0..200 {
                let (d, z) = (rng.between(0.0, 1.2 * radius), rng.between(-0.1, 1.1) * height);
                let exact = cutter.reference.depth(&QueryPoint::new([d, 0.0, z])).to_f64();
                let difference = (cutter.outline.depth([d, z]) - exact).abs();
                assert!(
                    difference < 1e-13 * (radius + height),
                    "{} {d} {z}: {difference:e}",
                    cutter.name
                );
            }
        }
    }
}

//! Tools whose coordinates are all short dyadic numbers, so that scaling by a power of two does not round them.
//!
//! Tangent points come from Pythagorean triples. The reference for a tool is its list of coordinates in this module,
//! evaluated in doubles and in 256 bits. The tool under test is compiled from text with the same numbers.

use touchoff::tool::{Interpreted, ToolError};
use touchoff_dsl::source::Source;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::profile::Profile;
use touchoff_tests::oracle::reference::Reference;
use touchoff_tests::oracle::restated::Restated;

/// A tool at one scale.
pub(crate) struct Cutter {
    /// The name and the scale.
    pub(crate) name: String,
    pub(crate) tool: Interpreted,
    pub(crate) profile: Profile<f64>,
    pub(crate) reference: Reference,
    /// The largest distance from the axis, and the height, mm.
    pub(crate) extent: [f64; 2],
    /// The largest distance from the tip to which the circles of its arcs extend, or the tool's extent if that is
    /// larger, mm.
    pub(crate) reach: f64,
}

/// Names and vertices of the profiles at scale 1, mm. An arc has its centre after `about`.
const PROFILES: [(&str, &str); 12] = [
    ("Ball", "0 0, 5 5 about 0 5, 5 22, 0 22"),
    ("Flat", "0 0, 6 0, 6 26, 0 26"),
    ("BullNose", "0 0, 4 0, 6 2 about 4 2, 6 14, 5.5 14.5, 5.5 40, 6 40.5, 6 83, 0 83"),
    // Triple 7, 24, 25: the cone is tangent to the ball at (3, 2.25).
    ("Taper", "0 0, 3 2.25 about 0 3.125, 6.5 14.25, 6.5 30, 0 30"),
    // Triple 3, 4, 5: the ball meets the neck at (3, 9), a reflex corner.
    ("Lollipop", "0 0, 5 5 about 0 5, 3 9 about 0 5, 3 40, 5 43, 5 75, 0 75"),
    // A concave arc.
    ("Rounding", "0 0, 3 0, 3 0.5, 6 3.5 about 6 0.5, 6.5 3.5, 6.5 10, 6 10.5, 6 60, 0 60"),
    ("TSlot", "0 0, 10.5 0, 10.5 9, 5 9, 5 27, 6 28, 6 74, 0 74"),
    // Triple 13, 84, 85: an arc whose centre lies far beyond the axis.
    ("Barrel", "0 0, 4 0, 4 26 about -80 13, 3.5 26.5, 3.5 50, 0 50"),
    // An arc of radius 4096.00390625, a hundred times the tool's size.
    ("Bowed", "0 0, 6 0, 6 16 about -4089.99609375 8, 5.5 16.5, 5.5 40, 0 40"),
    // The same with a radius of 2^17 + 2^-13.
    ("Arched", "0 0, 6 0, 6 16 about -131065.9998779296875 8, 5.5 16.5, 5.5 40, 0 40"),
    // A pointed tip: the depth has a kink on the axis.
    ("Point", "0 0, 6 6, 6 20, 0 20"),
    // A tool a hundred times as long as it is thick.
    ("Needle", "0 0, 0.5 0.5 about 0 0.5, 0.5 64, 0 64"),
];

/// Exponents of two by which each profile is scaled: from about 1e-6 to 1e6.
const SCALES: [i32; 5] = [-20, -10, 0, 10, 20];

/// The number of tools that [`cutter`] can make.
pub(crate) const COUNT: usize = PROFILES.len() * SCALES.len();

/// Returns the tool with a number below [`COUNT`].
pub(crate) fn cutter(number: usize) -> Result<Cutter, ToolError> {
    let (name, vertices) = PROFILES[number % PROFILES.len()];
    let exponent = SCALES[number / PROFILES.len()];
    let scale = 2f64.powi(exponent);
    let profile = Profile::<f64>::parse(vertices).map(|coordinate| coordinate * scale);
    let extent = [0, 1].map(|axis| {
        let ends = profile.segments().iter().map(|segment| segment.to[axis]);
        ends.fold(0.0, f64::max)
    });
    let circles = profile.segments().iter().filter_map(|segment| segment.circle.as_ref());
    let farthest = circles.map(|circle| circle.centre[0].hypot(circle.centre[1]) + circle.radius);
    let drawn = profile.text(f64::to_string, |k| format!("s{k} cutting"));
    let text = format!("tool {name} {{ units mm; {drawn} niceness cutting: 1; }}");
    Ok(Cutter {
        reach: farthest.fold(extent[0].max(extent[1]), f64::max),
        name: format!("{name}·2^{exponent}"),
        tool: Interpreted::parse(&Source::new("cutter.tool", text))?,
        reference: Reference::new(&Restated::of_profile(
            name,
            profile.map(|coordinate| Big::exactly(*coordinate)),
        )),
        extent,
        profile,
    })
}

//! Profiles as the tests draw them, in their files' frames.

use touchoff_tests::oracle::profile::{Feature, Profile};
use touchoff_tests::oracle::segment::Segment;
use touchoff_tests::oracle::vector::Point;

pub(crate) type P2 = Point<f64>;

#[derive(Clone, Debug)]
pub(crate) struct Outline {
    pub(crate) profile: Profile<f64>,
    /// True if the spindle lies toward smaller z.
    pub(crate) down: bool,
}

impl Outline {
    /// Returns the profile of segments whose spindle lies toward larger z.
    pub(crate) fn up(segments: Vec<Segment<f64>>) -> Outline {
        Outline { profile: Profile::new(segments), down: false }
    }

    /// Returns the profile of [these vertices][Profile::parse].
    pub(crate) fn parse(vertices: &str) -> Outline {
        Outline { profile: Profile::parse(vertices), down: false }
    }

    pub(crate) fn segments(&self) -> &[Segment<f64>] {
        self.profile.segments()
    }

    pub(crate) fn size(&self) -> f64 {
        let ends = self.segments().iter().flat_map(|segment| [segment.from, segment.to]);
        ends.flatten().fold(0.0, |largest, part| part.abs().max(largest))
    }

    pub(crate) fn tip(&self) -> f64 {
        self.profile.extent()[usize::from(self.down)][1]
    }

    /// Transforms a point from the file's frame to the tool's.
    pub(crate) fn turned(&self, [d, z]: P2) -> P2 {
        if self.down { [d, self.tip() - z] } else { [d, z - self.tip()] }
    }

    /// Transforms a point from the tool's frame to the file's.
    pub(crate) fn back(&self, [d, z]: P2) -> P2 {
        if self.down { [d, self.tip() - z] } else { [d, z + self.tip()] }
    }

    /// Returns the `.tool` file; each segment is a surface of its own, `s0` and so on.
    pub(crate) fn text(&self) -> String {
        let frame = if self.down { " spindle -z;" } else { "" };
        let profile = self.profile.text(f64::to_string, |k| format!("s{k}"));
        format!("tool T {{ units mm; tip z = {};{frame} {profile} }}", self.tip())
    }

    /// Returns how much farther than the nearest a feature is, at most; infinite for one that owns nothing.
    pub(crate) fn excess(&self, feature: Feature, p: P2) -> f64 {
        let excess = self.profile.distance(feature, &p) - self.profile.depth(&p).abs();
        match feature {
            Feature::Segment(k) => {
                let whole = self.segments()[k].inward(&p).abs() - self.profile.depth(&p).abs();
                whole.abs().max(excess)
            }
            Feature::Corner(k) if self.profile.turn(k) < 0.0 => excess,
            Feature::Corner(_) => f64::INFINITY,
        }
    }
}

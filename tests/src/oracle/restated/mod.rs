//! The library's tools restated: each profile in the tool's frame and the file's unit, from its drawing's numbers
//! and not from its file. Points are exact to 256 bits, so that no part of an error comes from the restatement.

mod assemblies;
mod form;
mod hole_making;
mod plain;
mod thesis;

use super::big::Big;
use super::plane::Point;
use super::profile::Profile;
use super::segment::Segment;

/// Niceness of a surface that cuts, from its name, the depth and `[d, z]`; below 0 counts as 0.
pub type Niceness = fn(&str, f64, [f64; 2]) -> f64;

/// A tool by its profile, from the tip up, with the material on the left.
#[derive(Clone, Debug)]
pub struct Restated {
    /// The tool's name.
    pub name: &'static str,
    /// The end of the profile so far.
    end: Point<Big>,
    /// The segments of the profile; arcs are of less than 180°.
    pub segments: Vec<Segment<Big>>,
    /// The surface that each segment belongs to.
    pub surfaces: Vec<&'static str>,
    /// Surfaces that cut.
    pub cutting: Vec<&'static str>,
    /// Niceness of a contact where the tool cuts.
    pub niceness: Niceness,
}

impl Restated {
    /// Creates a tool whose profile begins on the axis at `z`.
    pub fn new(name: &'static str, z: f64) -> Restated {
        let end = [Big::zero(), Big::decimal(z)];
        let (segments, surfaces, cutting) = (Vec::new(), Vec::new(), Vec::new());
        Restated { name, end, segments, surfaces, cutting, niceness: |_, _, _| 1.0 }
    }

    /// Creates a tool of one surface that does not cut.
    pub fn of_profile(name: &'static str, profile: &Profile<Big>) -> Restated {
        let segments = profile.segments().iter().cloned();
        segments.fold(Restated::new(name, 0.0), |tool, segment| tool.segment("side", segment))
    }

    /// Returns the profile.
    pub fn profile(&self) -> Profile<Big> {
        Profile::new(self.segments.clone())
    }

    fn segment(mut self, surface: &'static str, segment: Segment<Big>) -> Restated {
        self.end = segment.to.clone();
        self.segments.push(segment);
        self.surfaces.push(surface);
        self
    }

    /// Adds a line to a point.
    pub fn line(self, surface: &'static str, d: impl Into<Big>, z: impl Into<Big>) -> Restated {
        let line = Segment::line(self.end.clone(), [d.into(), z.into()]);
        self.segment(surface, line)
    }

    /// Adds lines to points, one after the other.
    pub fn lines(mut self, surface: &'static str, points: &[[f64; 2]]) -> Restated {
        for [d, z] in points {
            self = self.line(surface, *d, *z);
        }
        self
    }

    /// Adds an arc to a point about a centre.
    pub fn arc(
        self,
        surface: &'static str,
        [d, z]: [impl Into<Big>; 2],
        [cd, cz]: [impl Into<Big>; 2],
    ) -> Restated {
        let arc = Segment::arc(self.end.clone(), [d.into(), z.into()], [cd.into(), cz.into()]);
        self.segment(surface, arc)
    }

    /// Sets the surfaces that cut, and their niceness.
    pub fn cuts(mut self, surfaces: &[&'static str], niceness: Niceness) -> Restated {
        self.cutting = surfaces.to_vec();
        self.niceness = niceness;
        self
    }
}

/// Returns every tool of the library but the thesis's own, whose magnitudes are no distances.
pub fn all() -> Vec<Restated> {
    let mut all = thesis();
    all.extend(catalogue());
    all
}

/// Returns the thesis's solids.
pub fn thesis() -> Vec<Restated> {
    thesis::all()
}

/// Returns the cutters with a catalogue's dimensions.
pub fn catalogue() -> Vec<Restated> {
    [plain::all(), form::all(), hole_making::all(), assemblies::all()].concat()
}

/// Returns the restated tool of a name.
pub fn of(name: &str) -> Option<Restated> {
    all().into_iter().find(|tool| tool.name == name)
}

//! The library's tools restated: each profile in the tool's frame and the file's unit, from its drawing's numbers
//! and not from its file. Points are exact to 256 bits, so that no part of an error comes from the restatement.

mod assemblies;
mod form;
mod hole_making;
mod plain;
mod thesis;

use super::big::Big;

/// A point `[d, z]`.
pub type Point = [Big; 2];

/// Niceness of a surface that cuts, from its name, the depth and `[d, z]`; below 0 counts as 0.
pub type Niceness = fn(&str, f64, [f64; 2]) -> f64;

/// A line, or an arc of less than 180°, to a point.
#[derive(Clone, Debug)]
pub struct Segment {
    /// Its end.
    pub to: Point,
    /// The centre if it is an arc.
    pub centre: Option<Point>,
    /// The surface that it belongs to.
    pub surface: &'static str,
}

/// A tool by its profile, from the tip up, with the material on the left.
#[derive(Clone, Debug)]
pub struct Restated {
    /// The tool's name.
    pub name: &'static str,
    /// The start of the profile.
    pub start: Point,
    /// Its pieces.
    pub segments: Vec<Segment>,
    /// Surfaces that cut.
    pub cutting: Vec<&'static str>,
    /// Niceness of a contact where the tool cuts.
    pub niceness: Niceness,
}

impl Restated {
    /// Creates a tool whose profile begins on the axis at `z`.
    pub fn new(name: &'static str, z: f64) -> Restated {
        let start = [Big::zero(), Big::decimal(z)];
        Restated { name, start, segments: Vec::new(), cutting: Vec::new(), niceness: |_, _, _| 1.0 }
    }

    /// Adds a line to a point.
    pub fn line(mut self, surface: &'static str, d: impl Into<Big>, z: impl Into<Big>) -> Restated {
        self.segments.push(Segment { to: [d.into(), z.into()], centre: None, surface });
        self
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
        mut self,
        surface: &'static str,
        [d, z]: [impl Into<Big>; 2],
        [cd, cz]: [impl Into<Big>; 2],
    ) -> Restated {
        let centre = Some([cd.into(), cz.into()]);
        self.segments.push(Segment { to: [d.into(), z.into()], centre, surface });
        self
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

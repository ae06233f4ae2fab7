//! The library's tools restated: each profile in the tool's frame and the file's unit, from its drawing's numbers
//! and not from its file. Points are exact to 256 bits, so that no part of an error comes from the restatement.

mod catalogue;
mod thesis;

use super::big::Big;
use super::profile::Profile;
use super::real::Real;

/// Niceness of a surface that cuts, from its name, the depth and `[d, z]`; below 0 counts as 0.
pub type Niceness = fn(&str, f64, [f64; 2]) -> f64;

/// A tool by its profile, from the tip up, with the material on the left.
#[derive(Clone, Debug)]
pub struct Restated {
    /// The tool's name.
    pub name: &'static str,
    /// The profile; arcs are of at most 180°.
    pub profile: Profile<Big>,
    /// The surface that each segment belongs to.
    pub surfaces: Vec<&'static str>,
    /// Surfaces that cut.
    pub cutting: Vec<&'static str>,
    /// Niceness of a contact where the tool cuts.
    pub niceness: Niceness,
}

impl Restated {
    /// Creates a tool of one surface that does not cut.
    pub fn of_profile(name: &'static str, profile: Profile<Big>) -> Restated {
        let surfaces = vec!["side"; profile.segments().len()];
        Restated { name, profile, surfaces, cutting: Vec::new(), niceness: |_, _, _| 1.0 }
    }

    /// Reads a tool that does not cut: the start of its profile, and behind semicolons each surface with its
    /// [vertices][Profile::parse]. A word stands for one of `lengths`.
    ///
    /// # Panics
    /// If the text is none.
    pub fn drawn(name: &'static str, drawing: &'static str, lengths: &[(&str, Big)]) -> Restated {
        let mut parts = drawing.split(';').map(str::trim);
        let mut vertices = parts.next().unwrap_or_default().to_owned();
        let mut surfaces = Vec::new();
        for part in parts {
            let (surface, points) = part.split_once(' ').expect("a surface and its vertices");
            surfaces.extend(points.split(',').map(|_| surface));
            vertices += &format!(", {points}");
        }
        let length = |word: &str| {
            let known = lengths.iter().find(|(known, _)| *known == word);
            known.map_or_else(|| Real::decimal(word.parse().expect("a number")), |(_, l)| l.clone())
        };
        let profile = Profile::read(&vertices, length);
        Restated { surfaces, ..Restated::of_profile(name, profile) }
    }

    /// Sets the surfaces that cut, separated by spaces, and their niceness.
    pub fn cuts(mut self, surfaces: &'static str, niceness: Niceness) -> Restated {
        self.cutting = surfaces.split_whitespace().collect();
        self.niceness = niceness;
        self
    }

    /// Returns the commands of a `.tool` file that draw the profile, with the words for each number.
    pub fn text(&self, number: impl Fn(&Big) -> String) -> String {
        let surface = |k: usize| {
            let cutting = if self.cutting.contains(&self.surfaces[k]) { " cutting" } else { "" };
            format!("{}{cutting}", self.surfaces[k])
        };
        self.profile.text(number, surface)
    }
}

/// Returns every tool of the library but the thesis's own, whose magnitudes are no distances.
pub fn all() -> Vec<Restated> {
    [thesis(), catalogue()].concat()
}

/// Returns the thesis's solids.
pub fn thesis() -> Vec<Restated> {
    thesis::all()
}

/// Returns the cutters with a catalogue's dimensions.
pub fn catalogue() -> Vec<Restated> {
    catalogue::all()
}

/// Returns the restated tool of a name.
pub fn of(name: &str) -> Option<Restated> {
    all().into_iter().find(|tool| tool.name == name)
}

//! The library's tools restated: each profile in the tool's frame and the file's unit, from its drawing's numbers
//! and not from its file. Points are exact to 256 bits, so that no part of an error comes from the restatement.

mod catalogue;

use super::big::Big;
use super::profile::Profile;
use super::real::Real;

/// Niceness of the surfaces that cut; below 0 counts as 0.
#[derive(Clone, Debug)]
pub enum Niceness {
    /// Its formula, from the surface's name, the depth and `[d, z]`.
    Formula(fn(&str, f64, [f64; 2]) -> f64),
    /// For each surface what it is there, and the depth over which it falls by 1.
    Linear(Vec<(&'static str, [f64; 2])>),
}

impl Niceness {
    /// Returns the niceness of a contact with a surface that cuts.
    pub fn at(&self, surface: &str, depth: f64, dz: [f64; 2]) -> f64 {
        match self {
            Niceness::Formula(formula) => formula(surface, depth, dz),
            Niceness::Linear(laws) => {
                let law = laws.iter().find(|(name, _)| *name == surface);
                law.map_or(f64::NAN, |(_, [most, fall])| most - depth / fall)
            }
        }
    }
}

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
        let niceness = Niceness::Linear(Vec::new());
        Restated { name, profile, surfaces, cutting: Vec::new(), niceness }
    }

    /// Reads a tool that does not cut: the start of its profile, and behind semicolons each surface with its
    /// [vertices][Profile::parse]. A word stands for one of `lengths`.
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

    /// Sets the surfaces that cut, separated by spaces, with a niceness of 1.
    pub fn cuts(mut self, surfaces: &'static str) -> Restated {
        self.cutting = surfaces.split_whitespace().collect();
        self.niceness = Niceness::Formula(|_, _, _| 1.0);
        self
    }

    /// Sets the surfaces that cut and their niceness: before each colon some surfaces, behind it their law, which is a
    /// number, `number - depth` or `number - depth/number`.
    fn laws(mut self, laws: &'static str) -> Restated {
        let number = |word: &str| word.parse::<f64>().expect("a number");
        let mut all = Vec::new();
        for part in laws.split("; ").filter(|part| !part.is_empty()) {
            let (surfaces, law) = part.split_once(": ").expect("surfaces and a law");
            let (most, fall) = law.split_once(" - depth").unwrap_or((law, "/inf"));
            let law = [number(most), fall.strip_prefix('/').map_or(1.0, number)];
            all.extend(surfaces.split(' ').map(|surface| (surface, law)));
        }
        self.cutting = all.iter().map(|(surface, _)| *surface).collect();
        self.niceness = Niceness::Linear(all);
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

/// Returns the thesis's solids; the niceness of fig. 7.3 is that of eq. 7.3.
fn thesis() -> Vec<Restated> {
    let formula = |surface: &str, _, [d, z]: [f64; 2]| match surface {
        "flute" => 2.0 * d * d,
        _ => 2.0 * d * d + (z - 1.0) * (z - 1.0),
    };
    let fig_7_3 = |tool: Restated| match tool.name {
        "Fig73Exact" => {
            Restated { niceness: Niceness::Formula(formula), ..tool.cuts("nose flute") }
        }
        _ => tool,
    };
    catalogue::read(catalogue::THESIS).into_iter().map(fig_7_3).collect()
}

/// Returns the cutters with a catalogue's dimensions.
pub fn catalogue() -> Vec<Restated> {
    catalogue::read(catalogue::CATALOGUE)
}

/// Returns the restated tool of a name.
pub fn of(name: &str) -> Option<Restated> {
    all().into_iter().find(|tool| tool.name == name)
}

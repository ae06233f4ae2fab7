//! What is true at a point, in 256 bits, of every tool of the library: of profiles by their restatements, of the thesis's tool and of
//! the two solids by their equations written out again.

mod fig73;
mod profile;
mod solids;

pub use profile::Profiled;

use touchoff::Tool;
use touchoff_tests::accuracy;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::{Block, Fig73, LBracket, Nearest, Oracle, restated};

/// A point of the tool's frame.
pub type Place = [Big; 3];

/// What a region has at a point, whether it owns it or not.
pub struct Claim {
    /// The depth by the region's own formula, or the magnitude of a tool whose depth that is.
    pub depth: Big,
    /// How far the point is from being the region's: how much farther its surface is than the nearest, or how far its conditions are
    /// missed.
    pub behind: f64,
    /// The unit vector to its surface.
    pub direction: Place,
    /// How far the nearest point is at which that does not exist.
    pub singular: f64,
}

/// A tool's truth.
pub trait Truth: Send + Sync {
    /// S, the next power of two above the tool's largest coordinate.
    fn scale(&self) -> f64;

    /// The depth of a point inside, 0 on the surface; outside minus the distance from it.
    fn depth(&self, p: &Place) -> Big;

    /// The region, by its place in the card's list, that owns a point; of a border any of its neighbours.
    fn owner(&self, p: &Place) -> Option<usize>;

    /// What a region has at a point. `None` if there is no such region.
    fn claim(&self, p: &Place, region: usize) -> Option<Claim>;
}

/// A tool of the library, its truth, and the same in doubles for finding points.
pub struct Subject {
    /// The compiled tool.
    pub tool: &'static dyn Tool,
    /// What is true of it.
    pub truth: Box<dyn Truth>,
    /// The same in doubles.
    pub oracle: Box<dyn Oracle + Send + Sync>,
}

impl Subject {
    /// The tool's name.
    pub fn name(&self) -> &'static str {
        self.oracle.name()
    }

    /// S.
    pub fn scale(&self) -> f64 {
        self.truth.scale()
    }

    /// 1 ulp(S).
    pub fn ulp(&self) -> f64 {
        f64::EPSILON * self.scale()
    }
}

/// A double's point, as it is.
pub fn place(p: [f64; 3]) -> Place {
    p.map(Big::exactly)
}

/// Every tool of the library, by name.
///
/// # Panics
/// If the library has not all tools that are restated.
pub fn subjects() -> Vec<Subject> {
    let find = |name: &str| tools_library::find(name).expect("a tool of the library");
    let mut all: Vec<Subject> = accuracy::tools()
        .into_iter()
        .map(|(tool, restated)| Subject {
            tool,
            truth: Box::new(Profiled::new(tool, &restated)),
            oracle: Box::new(Nearest::new(&restated)),
        })
        .collect();
    let exact = restated::of("Fig73Exact").expect("it is restated");
    all.push(Subject {
        tool: find("Fig73"),
        truth: Box::new(fig73::Magnitudes::new(find("Fig73"), &exact)),
        oracle: Box::new(Fig73::default()),
    });
    all.push(Subject {
        tool: find("Block"),
        truth: Box::new(solids::Faces::block(find("Block"))),
        oracle: Box::new(Block),
    });
    all.push(Subject {
        tool: find("LBracket"),
        truth: Box::new(solids::Faces::bracket(find("LBracket"))),
        oracle: Box::new(LBracket),
    });
    all.sort_by_key(Subject::name);
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchoff_tests::oracle::draw::Draw;

    /// The truths agree with the oracles in doubles, which are written independently of them.
    #[test]
    fn doubles_say_the_same() {
        let subjects = subjects();
        assert_eq!(subjects.len(), tools_library::TOOLS.len());
        for subject in &subjects {
            let (oracle, scale) = (&subject.oracle, subject.scale());
            let [radius, height] = oracle.extent();
            let mut draw = Draw::new(3);
            for _ in 0..400 {
                let [x, y] = [0; 2].map(|_| draw.between(-1.1 * radius, 1.1 * radius));
                let p = [x, y, draw.between(-0.1 * height, 1.1 * height)];
                let name = subject.name();
                let depth = subject.truth.depth(&place(p)).to_f64();
                let sense = oracle.sense(p);
                let expected = sense.map_or_else(|| -oracle.signed_distance(p), |s| s.magnitude);
                assert!((depth - expected).abs() < 1e-13 * scale, "{name} {p:?}");
                let owner = subject.truth.owner(&place(p));
                assert_eq!(owner.is_some(), sense.is_some(), "{name} {p:?}");
                let (Some(owner), Some(sense)) = (owner, sense) else { continue };
                let claim = subject.truth.claim(&place(p), owner).expect("it owns the point");
                assert_eq!(claim.behind, 0.0, "{name} {p:?}");
                assert!((claim.depth.to_f64() - expected).abs() < 1e-13 * scale, "{name} {p:?}");
                let singular = oracle.singular(p).min(claim.singular);
                for (u, v) in claim.direction.iter().zip(sense.direction) {
                    let blur = 1e-13 * (1.0 + scale / singular);
                    assert!((u.to_f64() - v).abs() < blur, "{name} {p:?}");
                }
            }
        }
    }
}

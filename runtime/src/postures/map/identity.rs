//! To what a map belongs.

use crate::escape::Escaped;
use crate::mesh::Mesh;
use crate::postures::{Access, Directions, Record, Rules, RulesError};
use crate::tool::Card;
use crate::tool::Tool;
use crate::unit::Unit;
use serde::{Deserialize, Serialize};
use siphasher::sip::SipHasher24;
use std::collections::BTreeSet;
use std::fmt;
use std::hash::Hasher;
use std::num::NonZeroU16;

/// A part, told by what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PartStamp {
    /// SipHash-2-4, without a key, of its unit's word and its corners' coordinates, triangle by triangle.
    pub digest: u64,
    /// How many triangles it has.
    pub triangles: u32,
    /// Its unit of length.
    pub unit: Unit,
}

impl PartStamp {
    /// That of a mesh. One corner moved by one bit, or two triangles in another order, make another part.
    pub fn of(mesh: &Mesh) -> PartStamp {
        let mut hasher = SipHasher24::new();
        hasher.write(mesh.unit().word().as_bytes());
        let triangles = mesh.triangles().len() as u32;
        for corner in (0..triangles).flat_map(|id| mesh.triangle(id)) {
            for coordinate in corner.coords.iter() {
                hasher.write(&coordinate.to_bits().to_le_bytes());
            }
        }
        PartStamp { digest: hasher.finish(), triangles, unit: mesh.unit() }
    }
}

impl fmt::Display for PartStamp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let PartStamp { digest, triangles, unit } = self;
        write!(f, "{triangles} triangles in {unit} with the digest {digest:016x}")
    }
}

/// A tool, told by what it answers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ToolStamp {
    /// Its name.
    pub name: String,
    /// Its [digest](Card::digest).
    pub digest: u64,
}

impl ToolStamp {
    /// That of a tool's card.
    pub fn of(card: &Card) -> ToolStamp {
        ToolStamp { name: card.name.to_string(), digest: card.digest }
    }
}

/// To what a map belongs: a part, tools and rules. A file has one, and is not opened for another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    /// The part.
    pub part: PartStamp,
    /// The tools: records and accesses name them by their places here.
    pub tools: Vec<ToolStamp>,
    /// The directions that a sweep tries, unit vectors from the tip to the spindle in the part's frame; none
    /// if the map is only recorded into.
    pub directions: Vec<[f64; 3]>,
    /// By which rules postures are taken in.
    pub rules: Rules,
    /// How many postures are kept of a triangle.
    pub keep: NonZeroU16,
}

impl Identity {
    /// That of a map without directions that keeps one posture of each triangle.
    ///
    /// # Errors
    /// If rules mean nothing; see [`Rules::check`].
    pub fn new(mesh: &Mesh, tools: &[&dyn Tool], rules: Rules) -> Result<Identity, RulesError> {
        rules.check(tools)?;
        Ok(Identity {
            part: PartStamp::of(mesh),
            tools: tools.iter().map(|tool| ToolStamp::of(tool.card())).collect(),
            directions: Vec::new(),
            rules,
            keep: NonZeroU16::MIN,
        })
    }

    /// With directions.
    #[must_use]
    pub fn directions(mut self, directions: Vec<[f64; 3]>) -> Identity {
        self.directions = directions;
        self
    }

    /// With so many postures of a triangle.
    #[must_use]
    pub fn keeping(mut self, keep: NonZeroU16) -> Identity {
        self.keep = keep;
        self
    }

    /// A tool's place in the list.
    pub fn tool(&self, card: &Card) -> Option<u16> {
        let same = |tool: &ToolStamp| tool.name == card.name && tool.digest == card.digest;
        self.tools.iter().position(same).map(|place| place as u16)
    }

    /// Why something has no place in a map of this identity, if it has none.
    pub(super) fn refuses(
        &self,
        triangle: u32,
        best: &[Record],
        access: &[Access],
    ) -> Option<&'static str> {
        if triangle >= self.part.triangles {
            return Some("the part has no such triangle");
        }
        let tools = best.iter().map(|record| record.tool);
        let mut tools = tools.chain(access.iter().map(|access| access.tool));
        if tools.any(|tool| usize::from(tool) >= self.tools.len()) {
            return Some("the map has no such tool");
        }
        if best.iter().any(|record| record.pose().is_err()) {
            return Some("its tip and axis are no pose");
        }
        // What has nothing but cutting surfaces clears by infinitely much.
        let numbers =
            |r: &Record| r.niceness.is_finite() && r.depth.is_finite() && r.clearance >= 0.0;
        if !best.iter().all(numbers) {
            return Some("its niceness, depth or clearance is no number that they can be");
        }
        let ascending = access.is_sorted_by(|one, next| one.tool < next.tool);
        let distinct = || access.iter().map(|access| access.tool).collect::<BTreeSet<u16>>().len();
        if !ascending && distinct() < access.len() {
            return Some("a tool has two accesses");
        }
        let count = self.directions.len();
        let stray = |access: &Access| {
            let last = access.directions.last().copied().unwrap_or(0);
            access.directions.len() != count.div_ceil(64)
                || (!count.is_multiple_of(64) && last >> (count % 64) != 0)
        };
        access.iter().any(stray).then_some("it has other directions than the map")
    }

    /// Returns what a map has no place for so many of, if there are: tools are told by 16 bits, and between directions there
    /// are tables that grow with the square of their number.
    pub(super) fn oversized(&self) -> Option<String> {
        let (tools, directions) = (self.tools.len(), self.directions.len());
        let (most_tools, most) = (usize::from(u16::MAX) + 1, 2 * Directions::MOST);
        if tools > most_tools {
            return Some(format!("it has {tools} tools, and there may be {most_tools}"));
        }
        (directions > most)
            .then(|| format!("it has {directions} directions, and there may be {most}"))
    }

    /// In what a file, of which this is the identity, differs from what is asked for.
    pub(super) fn differs(&self, asked: &Identity) -> Option<Difference> {
        if self.part != asked.part {
            return Some(Difference::Part { has: self.part, asked: asked.part });
        }
        let names = |of: &Identity| -> Vec<String> {
            of.tools.iter().map(|tool| format!("`{}`", Escaped(&tool.name))).collect()
        };
        let (has, others) = (names(self), names(asked));
        if has != others {
            let [has, asked] = [has, others].map(|names| names.join(", "));
            return Some(Difference::Tools { has, asked });
        }
        let mut tools = self.tools.iter().zip(&asked.tools);
        if let Some((tool, _)) = tools.find(|(tool, asked)| tool.digest != asked.digest) {
            return Some(Difference::Tool { tool: Escaped(&tool.name).to_string() });
        }
        if self.rules != asked.rules || self.keep != asked.keep {
            let [has, asked] =
                [self, asked].map(|of| format!("{}, {} kept of each triangle", of.rules, of.keep));
            return Some(Difference::Rules { has, asked });
        }
        let (has, others) = (&self.directions, &asked.directions);
        let first = has.iter().zip(others).position(|(has, asked)| has != asked);
        (has != others).then(|| Difference::Directions {
            has: has.len(),
            asked: others.len(),
            first: first.unwrap_or(has.len().min(others.len())),
        })
    }
}

/// In what a map's file differs from what it is opened for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Difference {
    /// The part.
    #[error("it is of another part, {has}, and this one has {asked}")]
    Part {
        /// The file's.
        has: PartStamp,
        /// The one that is asked for.
        asked: PartStamp,
    },
    /// The tools, or their order.
    #[error("it was begun with the tools {has}, in this order, and now they are {asked}")]
    Tools {
        /// The file's.
        has: String,
        /// Those that are asked for.
        asked: String,
    },
    /// What a tool of the same name answers.
    #[error("it was begun with another version of `{tool}`")]
    Tool {
        /// Its name.
        tool: String,
    },
    /// The rules.
    #[error("it was begun with other rules ({has}) than now ({asked})")]
    Rules {
        /// The file's.
        has: String,
        /// Those that are asked for.
        asked: String,
    },
    /// The directions.
    #[error(
        "it was begun with other directions: it has {has}, now there are {asked}, and number {first} \
         from 0 is the first that differs"
    )]
    Directions {
        /// How many the file has.
        has: usize,
        /// How many are asked for.
        asked: usize,
        /// The first that is not the same.
        first: usize,
    },
}

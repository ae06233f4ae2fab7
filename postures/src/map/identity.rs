//! Identity of a map: the part, the tools and the rules that it belongs to.

use crate::{Accessibility, Directions, PostureRecord, Rules, RulesError};
use serde::{Deserialize, Serialize};
use siphasher::sip::SipHasher24;
use std::collections::BTreeSet;
use std::fmt;
use std::hash::Hasher;
use std::num::NonZeroU16;
use touchoff::tool::ToolInfo;
use touchoff::{Escaped, Mesh, Tool, TriangleId, Unit};

/// Fingerprint of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PartFingerprint {
    /// SipHash-2-4, without a key, of the unit's symbol and the corners' coordinates, triangle by triangle.
    pub digest: u64,
    /// Number of triangles.
    pub triangles: u32,
    /// Unit of length.
    pub unit: Unit,
}

impl PartFingerprint {
    /// Computes the fingerprint of a mesh. It changes if a corner moves by one bit, or if two triangles are
    /// swapped.
    pub fn of(mesh: &Mesh) -> PartFingerprint {
        let mut hasher = SipHasher24::new();
        hasher.write(mesh.unit().symbol().as_bytes());
        let triangles = mesh.triangles().len() as u32;
        for corner in mesh.ids().flat_map(|id| mesh.triangle(id)) {
            for coordinate in corner.coords.iter() {
                hasher.write(&coordinate.to_bits().to_le_bytes());
            }
        }
        PartFingerprint { digest: hasher.finish(), triangles, unit: mesh.unit() }
    }
}

impl fmt::Display for PartFingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let PartFingerprint { digest, triangles, unit } = self;
        write!(f, "{triangles} triangles in {unit} with the digest {digest:016x}")
    }
}

/// Fingerprint of a tool: its name, and the digest of its results.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ToolFingerprint {
    /// The tool's name.
    pub name: String,
    /// The tool's [digest](ToolInfo::digest).
    pub digest: u64,
}

impl ToolFingerprint {
    /// Returns the fingerprint of a tool.
    pub fn of(info: &ToolInfo) -> ToolFingerprint {
        ToolFingerprint { name: info.name.to_string(), digest: info.digest }
    }
}

/// The part, the tools and the rules that a map belongs to. A file has one identity, and is not opened for
/// another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MapIdentity {
    /// The part.
    pub part: PartFingerprint,
    /// The tools. Records and accessibility entries refer to them by index.
    pub tools: Vec<ToolFingerprint>,
    /// Directions that a sweep tries, as unit vectors from the tip to the spindle in the part's frame; empty if
    /// the map is only recorded into.
    pub directions: Vec<[f64; 3]>,
    /// Rules by which postures are accepted.
    pub rules: Rules,
    /// Number of postures kept per triangle.
    pub keep: NonZeroU16,
}

impl MapIdentity {
    /// Creates the identity of a map without directions that keeps one posture per triangle.
    ///
    /// # Errors
    /// If the rules are invalid; see [`Rules::check`].
    pub fn new(mesh: &Mesh, tools: &[&dyn Tool], rules: Rules) -> Result<MapIdentity, RulesError> {
        rules.check(tools)?;
        Ok(MapIdentity {
            part: PartFingerprint::of(mesh),
            tools: tools.iter().map(|tool| ToolFingerprint::of(tool.info())).collect(),
            directions: Vec::new(),
            rules,
            keep: NonZeroU16::MIN,
        })
    }

    /// Sets the directions.
    #[must_use]
    pub fn with_directions(mut self, directions: Vec<[f64; 3]>) -> MapIdentity {
        self.directions = directions;
        self
    }

    /// Sets the number of postures kept per triangle.
    #[must_use]
    pub fn with_keep(mut self, keep: NonZeroU16) -> MapIdentity {
        self.keep = keep;
        self
    }

    /// Returns a tool's index in the list; `None` if no entry has its name and digest.
    pub fn tool(&self, info: &ToolInfo) -> Option<u16> {
        let fingerprint = ToolFingerprint::of(info);
        self.tools.iter().position(|tool| *tool == fingerprint).map(|index| index as u16)
    }

    /// Returns the names of the tools, for messages.
    pub(crate) fn tool_names(&self) -> String {
        let names = self.tools.iter().map(|tool| format!("`{}`", Escaped(&tool.name)));
        names.collect::<Vec<String>>().join(", ")
    }

    /// Returns the reason for which data do not fit a map of this identity; `None` if they fit.
    pub(crate) fn row_error(
        &self,
        triangle: TriangleId,
        best: &[PostureRecord],
        access: &[Accessibility],
    ) -> Option<&'static str> {
        if triangle.0 >= self.part.triangles {
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
        // A tool with nothing but cutting surfaces has infinite clearance.
        if !best.iter().all(|r| r.niceness.is_finite() && r.depth.is_finite() && r.clearance >= 0.0)
        {
            return Some("its niceness, depth or clearance is no number that they can be");
        }
        let ascending = access.is_sorted_by(|one, next| one.tool < next.tool);
        // A sweep writes them in order, so that a set is rarely made.
        if !ascending
            && access.iter().map(|access| access.tool).collect::<BTreeSet<u16>>().len()
                < access.len()
        {
            return Some("a tool has two accesses");
        }
        let count = self.directions.len();
        let has_others = access.iter().any(|access| {
            let last = access.directions.last().copied().unwrap_or(0);
            access.directions.len() != count.div_ceil(64)
                || (!count.is_multiple_of(64) && last >> (count % 64) != 0)
        });
        has_others.then_some("it has other directions than the map")
    }

    /// Returns a message if there are too many tools or directions: tools are numbered by 16 bits, and there
    /// are tables between directions that grow with the square of their number.
    pub(super) fn oversized(&self) -> Option<String> {
        let (tools, directions) = (self.tools.len(), self.directions.len());
        let (max_tools, max_directions) =
            (usize::from(u16::MAX) + 1, 2 * Directions::MAX_HEMISPHERE);
        if tools > max_tools {
            return Some(format!("it has {tools} tools, and there may be {max_tools}"));
        }
        (directions > max_directions)
            .then(|| format!("it has {directions} directions, and there may be {max_directions}"))
    }

    /// Returns the difference between this identity, which a file has, and the requested one.
    pub(crate) fn difference(&self, requested: &MapIdentity) -> Option<Difference> {
        if self.part != requested.part {
            return Some(Difference::Part { stored: self.part, requested: requested.part });
        }
        let (stored, other) = (self.tool_names(), requested.tool_names());
        if stored != other {
            return Some(Difference::Tools { stored, requested: other });
        }
        let mut tools = self.tools.iter().zip(&requested.tools);
        if let Some((tool, _)) = tools.find(|(tool, requested)| tool.digest != requested.digest) {
            return Some(Difference::Tool { tool: Escaped(&tool.name).to_string() });
        }
        if self.rules != requested.rules || self.keep != requested.keep {
            let [stored, requested] = [self, requested]
                .map(|of| format!("{}, {} kept of each triangle", of.rules, of.keep));
            return Some(Difference::Rules { stored, requested });
        }
        let (stored, requested) = (&self.directions, &requested.directions);
        let first =
            stored.iter().zip(requested).position(|(stored, requested)| stored != requested);
        (stored != requested).then(|| Difference::Directions {
            stored: stored.len(),
            requested: requested.len(),
            // One list is the beginning of the other.
            first: first.unwrap_or(stored.len().min(requested.len())),
        })
    }
}

/// A difference between a map's file and the identity that it is opened for.
#[derive(Clone, PartialEq, thiserror::Error)]
pub enum Difference {
    /// Another part.
    #[error("it is of another part, {stored}, and this one has {requested}")]
    Part {
        /// The file's part.
        stored: PartFingerprint,
        /// The requested part.
        requested: PartFingerprint,
    },
    /// Other tools, or another order.
    #[error("it was begun with the tools {stored}, in this order, and now they are {requested}")]
    Tools {
        /// The file's tools.
        stored: String,
        /// The requested tools.
        requested: String,
    },
    /// A tool of the same name with another digest.
    #[error("it was begun with another version of `{tool}`")]
    Tool {
        /// The tool's name.
        tool: String,
    },
    /// Other rules, or another number of postures kept.
    #[error("it was begun with other rules ({stored}) than now ({requested})")]
    Rules {
        /// The file's rules.
        stored: String,
        /// The requested rules.
        requested: String,
    },
    /// Other directions.
    #[error(
        "it was begun with other directions: it has {stored}, now there are {requested}, and number {first} \
         from 0 is the first that differs"
    )]
    Directions {
        /// Number of directions in the file.
        stored: usize,
        /// Number of requested directions.
        requested: usize,
        /// Index of the first direction that differs.
        first: usize,
    },
}

touchoff::debug_as_sentence!(Difference);

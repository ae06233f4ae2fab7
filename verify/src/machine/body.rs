//! Bodies of a machine, as its file states them, and the pairs in which they are checked.

use super::chain::is_within;
use super::{Letter, Link, MAX_LENGTH, MAX_NAME, Machine, Side, is_name};
use crate::codes::faults;
use nalgebra::{Point3, Vector3};
use serde::Deserialize;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use toml::Spanned;
use touchoff::Pose;

/// A body of a machine. Lengths are in mm, in machine coordinates with all axes at 0.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MachineBody {
    /// Its name in findings.
    pub name: String,
    /// The link that it moves with.
    pub link: Link,
    /// Its shape.
    pub shape: BodyShape,
    /// Distance that it keeps from everything it is checked against, 0 or more; at 0 they may touch.
    pub margin: f64,
    /// Opponents that it is checked against.
    pub against: Vec<Opponent>,
}

/// The shape of a body of a machine.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BodyShape {
    /// A mesh in a file.
    Mesh {
        /// The file.
        file: PathBuf,
        /// The place of the mesh's origin.
        position: Point3<f64>,
    },
    /// A box, by its lowest and its highest corner.
    Box([Point3<f64>; 2]),
    /// A cylinder.
    Cylinder {
        /// The middle of its lower end, with the direction to its upper end as axis.
        place: Pose,
        /// Its radius.
        radius: f64,
        /// Its height.
        height: f64,
    },
    /// A solid of revolution in the tool language.
    Tool {
        /// A `.tool` file, or a built-in tool.
        name: OsString,
        /// The pose of its frame.
        place: Pose,
    },
}

/// An opponent that a body of a machine is checked against.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Opponent {
    /// The tools of the program.
    Tool,
    /// The part.
    Part,
    /// The fixtures that move with other links.
    Fixtures,
    /// Another body, by its name.
    Body(String),
}

impl Opponent {
    /// Returns its word in the file: the name of a body, `tool`, `part` or `fixtures`.
    pub fn word(&self) -> &str {
        match self {
            Opponent::Tool => "tool",
            Opponent::Part => "part",
            Opponent::Fixtures => "fixtures",
            Opponent::Body(name) => name,
        }
    }
}

/// The keys of a `[[body]]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BodyEntry {
    pub(super) name: Spanned<String>,
    moves_with: String,
    mesh: Option<PathBuf>,
    #[serde(rename = "box")]
    corners: Option<[[f64; 3]; 2]>,
    cylinder: Option<CylinderEntry>,
    tool: Option<String>,
    position: Option<[f64; 3]>,
    axis: Option<[f64; 3]>,
    #[serde(default)]
    margin: f64,
    #[serde(default)]
    against: Vec<String>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
struct CylinderEntry {
    radius: f64,
    height: f64,
}

faults! {
    #[family("K03", "Machines: bodies")]
    /// A reason for which a body of a machine is refused.
    #[derive(Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum BodyFault {
        /// The name is empty, is long, stands for something else, or has a control character.
        #[code = K0301]
        #[error(
            "give it another name of one line, of up to {MAX_NAME} characters: `tool`, `part` and `fixtures` stand for those of the job"
        )]
        Name,
        /// Another body has the same name.
        #[code = K0302]
        #[error("another body has this name: rename one of them")]
        Repeated,
        /// It moves with no link of the machine.
        #[code = K0303]
        #[error("it moves with `{link}`: name an axis of the machine, `base`, or `spindle`")]
        Link {
            /// The given link.
            link: String,
        },
        /// It has no shape, or several.
        #[code = K0304]
        #[error("give it one shape: `mesh`, `box`, `cylinder` or `tool`")]
        Shape,
        /// A key that its shape does not have.
        #[code = K0305]
        #[error("`{key}` is none of its shape: {remedy}")]
        Key {
            /// The key.
            key: &'static str,
            /// The remedy.
            remedy: &'static str,
        },
        /// A number that is not finite, too large, or no length.
        #[code = K0306]
        #[error("`{key}` is wrong: {remedy}")]
        Number {
            /// The key.
            key: &'static str,
            /// The remedy.
            remedy: &'static str,
        },
        /// A name in `against` is none.
        #[code = K0307]
        #[error("it is checked against `{name}`: name another body, `tool`, `part` or `fixtures`")]
        Against {
            /// The name.
            name: String,
        },
        /// No pair has the body.
        #[code = K0308]
        #[error(
            "it is checked against nothing: add `against = [\"tool\"]`, for instance, or remove it"
        )]
        Unused,
        /// Both bodies of a pair move as one.
        #[code = K0309]
        #[error("it moves as one with {other}, and never against it: remove this from `against`")]
        SameLink {
            /// The other body.
            other: String,
        },
        /// Two meshes, of which no distance is proved.
        #[code = K0310]
        #[error(
            "its shape and that of {other} are meshes, of which no pair is proved: give one of both as a `tool`, a solid of revolution \
             that contains it"
        )]
        TwoMeshes {
            /// The other body.
            other: String,
        },
        /// Two solids of revolution, of which no distance is proved.
        #[code = K0311]
        #[error(
            "it and {other} are solids of revolution, of which no pair is proved: give the body as a `mesh`, a `box` or a `cylinder`, \
             also in addition to this one"
        )]
        TwoTools {
            /// The other body.
            other: String,
        },
    }
}

impl MachineBody {
    /// Returns whether it is given as a solid of revolution in the tool language, and not as a mesh.
    pub fn is_revolved(&self) -> bool {
        matches!(self.shape, BodyShape::Tool { .. })
    }

    /// Returns whether its file, or that of another body, states that both are checked against each other.
    pub(crate) fn meets(&self, other: &MachineBody) -> bool {
        let names = |one: &MachineBody, other: &MachineBody| {
            one.against.contains(&Opponent::Body(other.name.clone()))
        };
        names(self, other) || names(other, self)
    }
}

/// Reads the bodies of a machine. `file` is the machine's file, beside which theirs are.
///
/// # Errors
/// The index of the body that is refused, and the reason.
pub(super) fn bodies(
    entries: Vec<BodyEntry>,
    machine: &Machine,
    file: &Path,
) -> Result<Vec<MachineBody>, (usize, BodyFault)> {
    let mut bodies: Vec<MachineBody> = Vec::new();
    for (index, entry) in entries.into_iter().enumerate() {
        let body = body(entry, machine, file).map_err(|fault| (index, fault))?;
        if bodies.iter().any(|known| known.name == body.name) {
            return Err((index, BodyFault::Repeated));
        }
        bodies.push(body);
    }
    for (index, body) in bodies.iter().enumerate() {
        check_pairs(body, &bodies, machine).map_err(|fault| (index, fault))?;
    }
    Ok(bodies)
}

fn body(entry: BodyEntry, machine: &Machine, file: &Path) -> Result<MachineBody, BodyFault> {
    let name = entry.name.into_inner();
    let is_reserved = ["tool", "part", "fixtures"].contains(&&*name);
    if !is_name(&name) || is_reserved {
        return Err(BodyFault::Name);
    }
    let link = match &*entry.moves_with {
        "base" => Link::Base,
        "spindle" => machine.last_link(Side::Tool),
        letter => {
            let known = Letter::ALL.into_iter().find(|known| known.to_string() == letter);
            let known = known.filter(|known| machine.axis(*known).is_some());
            Link::Axis(known.ok_or_else(|| BodyFault::Link { link: letter.to_owned() })?)
        }
    };
    let position = entry.position.unwrap_or_default();
    let corners = entry.corners.iter().flatten().flatten();
    if !position.iter().chain(corners).all(|value| is_within(*value, MAX_LENGTH)) {
        let remedy = "give finite coordinates in mm";
        return Err(BodyFault::Number { key: "position", remedy });
    }
    // NaN is in no range.
    if !(0.0..=MAX_LENGTH).contains(&entry.margin) {
        return Err(BodyFault::Number { key: "margin", remedy: "give a length of 0 or more" });
    }
    let position = Point3::from(position);
    let place = || {
        let axis = Vector3::from(entry.axis.unwrap_or([0.0, 0.0, 1.0]));
        let axis = (axis / axis.amax()).normalize();
        let fault = BodyFault::Number { key: "axis", remedy: "give a vector such as [0, 0, 1]" };
        Pose::from_axis(position, axis).map_err(|_| fault)
    };
    let beside = |name: &Path| file.parent().unwrap_or(Path::new("")).join(name);
    let refuse = |is_given: bool, key, remedy| match is_given {
        true => Err(BodyFault::Key { key, remedy }),
        false => Ok(()),
    };
    let shape = match (entry.mesh, entry.corners, entry.cylinder, entry.tool) {
        (Some(mesh), None, None, None) => {
            refuse(entry.axis.is_some(), "axis", "turn the mesh in its file")?;
            BodyShape::Mesh { file: beside(&mesh), position }
        }
        (None, Some(corners), None, None) => {
            let remedy = "its corners have the place of a box";
            refuse(entry.axis.is_some(), "axis", remedy)?;
            refuse(entry.position.is_some(), "position", remedy)?;
            let [low, high] = corners.map(Point3::from);
            if !(0..3).all(|axis| low[axis] < high[axis]) {
                let remedy = "give its lowest corner, then its highest";
                return Err(BodyFault::Number { key: "box", remedy });
            }
            BodyShape::Box([low, high])
        }
        (None, None, Some(CylinderEntry { radius, height }), None) => {
            let is_length = |value: f64| value > 0.0 && value <= MAX_LENGTH;
            if !is_length(radius) || !is_length(height) {
                let remedy = "give a `radius` and a `height` in mm, above 0";
                return Err(BodyFault::Number { key: "cylinder", remedy });
            }
            BodyShape::Cylinder { place: place()?, radius, height }
        }
        (None, None, None, Some(tool)) => {
            let is_file = tool.ends_with(".tool");
            let name = if is_file { beside(Path::new(&tool)).into() } else { tool.into() };
            BodyShape::Tool { name, place: place()? }
        }
        _ => return Err(BodyFault::Shape),
    };
    let against = entry.against.into_iter().map(|name| match &*name {
        "tool" => Opponent::Tool,
        "part" => Opponent::Part,
        "fixtures" => Opponent::Fixtures,
        _ => Opponent::Body(name),
    });
    Ok(MachineBody { name, link, shape, margin: entry.margin, against: against.collect() })
}

/// Checks that every pair of a body is of a mesh and a solid of revolution that move against each other.
fn check_pairs(
    body: &MachineBody,
    bodies: &[MachineBody],
    machine: &Machine,
) -> Result<(), BodyFault> {
    if body.against.is_empty() && !bodies.iter().any(|other| other.meets(body)) {
        return Err(BodyFault::Unused);
    }
    for opponent in &body.against {
        let (other, link, is_revolved) = match opponent {
            Opponent::Tool => ("the tool".to_owned(), Some(machine.last_link(Side::Tool)), true),
            Opponent::Part => ("the part".to_owned(), Some(machine.last_link(Side::Table)), false),
            Opponent::Fixtures => ("a fixture".to_owned(), None, false),
            Opponent::Body(name) => match bodies.iter().find(|known| known.name == *name) {
                Some(known) => (name.clone(), Some(known.link), known.is_revolved()),
                None => return Err(BodyFault::Against { name: name.clone() }),
            },
        };
        if link == Some(body.link) {
            return Err(BodyFault::SameLink { other });
        }
        match (body.is_revolved(), is_revolved) {
            (true, true) => return Err(BodyFault::TwoTools { other }),
            (false, false) => return Err(BodyFault::TwoMeshes { other }),
            _ => {}
        }
    }
    Ok(())
}

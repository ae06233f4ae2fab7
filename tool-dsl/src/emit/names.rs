//! Names for the values and masks of generated code, which say what they are.

use super::OUTPUTS;
use super::alike::{Group, Groups};
use crate::expr::{Coord, Graph, Id, Node};
use crate::model::{Model, Region};
use std::collections::{BTreeMap, BTreeSet};

/// The names of a tool's generated code.
pub(super) struct Names {
    values: BTreeMap<Id, String>,
    /// The mask of the lanes in each region.
    masks: Vec<String>,
}

/// The names that the code uses otherwise.
const RESERVED: [&str; 12] = [
    "per_length",
    "present",
    "outputs",
    "point",
    "result",
    "lanes",
    "depth",
    "magnitude",
    "niceness",
    "along_x",
    "along_y",
    "along_z",
];

impl Names {
    pub(super) fn new(model: &Model, groups: &Groups) -> Names {
        let mut choice = Choice {
            graph: &groups.graph,
            taken: RESERVED.iter().map(|name| (*name).to_owned()).collect(),
            values: BTreeMap::new(),
        };
        let masks = model
            .regions
            .iter()
            .map(|region| choice.free(&format!("in_{}", identifier(&region.name))))
            .collect();
        for region in &model.regions {
            choice.name_region(region);
        }
        for curve in &model.curves {
            if let Some(name) = &curve.name {
                choice.name(curve.value, &format!("{}_value", identifier(name)));
            }
        }
        for group in groups.groups.iter().filter(|group| !group.parameters.is_empty()) {
            choice.name_group(group);
        }
        Names { values: choice.values, masks }
    }

    /// Returns the name of a value.
    pub(super) fn value(&self, id: Id) -> String {
        self.values.get(&id).cloned().unwrap_or_else(|| format!("t{}", id.index()))
    }

    /// Returns the name of the mask of the lanes in a region.
    pub(super) fn mask(&self, region: usize) -> &str {
        &self.masks[region]
    }
}

/// Returns a name of the language as a name of Rust, apart from a prefix that keeps it from being a keyword.
fn identifier(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { '_' }).collect()
}

/// The names chosen so far.
struct Choice<'m> {
    graph: &'m Graph,
    taken: BTreeSet<String>,
    values: BTreeMap<Id, String>,
}

impl Choice<'_> {
    /// Returns a name that is not taken: the wish, or the wish with a number.
    fn free(&mut self, wish: &str) -> String {
        let numbered = (2..).map(|number| format!("{wish}_{number}"));
        let mut names = std::iter::once(wish.to_owned()).chain(numbered);
        let name = names.find(|name| !self.taken.contains(name)).unwrap_or_default();
        self.taken.insert(name.clone());
        name
    }

    /// Names a value, unless it has a name.
    fn name(&mut self, id: Id, wish: &str) {
        if self.graph.height(id) > 0 && !self.values.contains_key(&id) {
            let name = self.free(wish);
            self.values.insert(id, name);
        }
    }

    fn name_region(&mut self, region: &Region) {
        let outputs = OUTPUTS.each_ref().map(|output| (output.name, (output.of)(&region.outputs)));
        self.name_outputs(&identifier(&region.name), region.depth, &outputs);
    }

    /// Names the values of a group of regions that differ in constants: after the feature of the profile, which differs too.
    fn name_group(&mut self, group: &Group) {
        let outputs = OUTPUTS.iter().zip(&group.outputs);
        let outputs =
            outputs.filter_map(|(output, values)| Some((output.name, values.first()?.ids.clone())));
        let outputs: Vec<_> = outputs.collect();
        let depth = outputs.first().map(|(_, ids)| ids[0]);
        // Without the larger of it and 0.
        let signed = depth.map(|depth| match *self.graph.node(depth) {
            Node::Max(a, b) => {
                if self.graph.height(a) > 0 {
                    a
                } else {
                    b
                }
            }
            _ => depth,
        });
        for parameter in &group.parameters {
            let name = self.free(self.role(group, *parameter));
            self.values.insert(*parameter, name);
        }
        if let Some(signed) = signed {
            self.name_outputs("feature", signed, &outputs);
        }
    }

    /// Returns what a parameter is, by the first operation that uses it: a coordinate of the feature, or a component of its normal.
    fn role(&self, group: &Group, parameter: Id) -> &'static str {
        let is_own = |id: Id| id == parameter || *self.graph.node(id) == Node::Neg(parameter);
        let reads = |id: Id, coord: Coord| {
            self.graph
                .dependencies([id])
                .iter()
                .any(|id| *self.graph.node(*id) == Node::Coord(coord))
        };
        let users = self.graph.dependencies(group.roots()).into_iter().filter_map(|id| {
            let (a, b, [along, across]) = match *self.graph.node(id) {
                Node::Add(a, b) | Node::Sub(a, b) => (a, b, ["feature_z", "feature_d"]),
                Node::Mul(a, b) => (a, b, ["normal_z", "normal_d"]),
                _ => return None,
            };
            let other = [(a, b), (b, a)].into_iter().find(|(own, _)| is_own(*own))?.1;
            Some(if reads(other, Coord::Z) { along } else { across })
        });
        users.into_iter().next().unwrap_or("feature_value")
    }

    fn name_outputs(&mut self, label: &str, signed_depth: Id, outputs: &[(&str, Vec<Id>)]) {
        for (output, ids) in outputs {
            match ids[..] {
                [x, y, z] => {
                    for (id, axis) in [(x, 'x'), (y, 'y'), (z, 'z')] {
                        self.name_radial(id);
                        self.name(id, &format!("{label}_{output}_{axis}"));
                    }
                }
                _ => ids.iter().for_each(|id| self.name(*id, &format!("{label}_{output}"))),
            }
            if *output == "depth" {
                self.name_distance(signed_depth, label);
            }
        }
    }

    /// Names the parts of a depth: the distance from the centre of an arc or from a corner, and what it is the root of.
    fn name_distance(&mut self, depth: Id, label: &str) {
        let root = match *self.graph.node(depth) {
            Node::Sub(a, b) | Node::Add(a, b) => {
                [a, b].into_iter().find(|part| self.is_root(*part))
            }
            _ => Some(depth).filter(|depth| self.is_root(*depth)),
        };
        let Some(root) = root else {
            self.name(depth, &format!("{label}_signed_depth"));
            return;
        };
        self.name(root, &format!("{label}_distance"));
        let Node::Sqrt(square) = *self.graph.node(root) else { return };
        self.name(square, &format!("{label}_square"));
        let Node::Add(a, b) = *self.graph.node(square) else { return };
        for part in [a, b] {
            let Node::Mul(offset, other) = *self.graph.node(part) else { continue };
            let reads_z = self
                .graph
                .dependencies([offset])
                .into_iter()
                .any(|id| matches!(self.graph.node(id), Node::Coord(Coord::Z)));
            if offset == other {
                self.name(offset, &format!("{label}_{}", if reads_z { "up" } else { "out" }));
            }
        }
    }

    fn is_root(&self, id: Id) -> bool {
        matches!(self.graph.node(id), Node::Sqrt(_))
    }

    /// Names the components of the unit vector away from the axis in a component of a direction, and their opposites.
    fn name_radial(&mut self, direction: Id) {
        if let Node::Neg(opposite) = *self.graph.node(direction)
            && let Some(axis) =
                self.values.get(&opposite).and_then(|name| name.strip_prefix("radial"))
        {
            self.name(direction, &format!("inward{axis}"));
        }
        for id in self.graph.dependencies([direction]) {
            let Node::Select { other, .. } = *self.graph.node(id) else { continue };
            let Node::Div(part, whole) = *self.graph.node(other) else { continue };
            if *self.graph.node(whole) != Node::Coord(Coord::D) {
                continue;
            }
            match self.graph.node(part) {
                Node::Coord(Coord::X) => self.name(id, "radial_x"),
                Node::Coord(Coord::Y) => self.name(id, "radial_y"),
                _ => {}
            }
        }
    }
}

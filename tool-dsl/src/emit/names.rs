//! Names for the values and masks of generated code, which say what they are.

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
    pub(super) fn new(model: &Model) -> Names {
        let mut choice = Choice {
            graph: &model.graph,
            taken: RESERVED.iter().map(|name| (*name).to_owned()).collect(),
            values: BTreeMap::new(),
        };
        let masks = model
            .regions
            .iter()
            .map(|region| choice.free(&format!("in_{}", identifier(&region.name))))
            .collect();
        for region in &model.regions {
            choice.name_outputs(region);
        }
        for curve in &model.curves {
            if let Some(name) = &curve.name {
                choice.name(curve.value, &format!("{}_value", identifier(name)));
            }
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

    fn name_outputs(&mut self, region: &Region) {
        let label = identifier(&region.name);
        self.name(region.outputs.depth, &format!("{label}_depth"));
        self.name_distance(region.depth, &label);
        for (id, axis) in region.outputs.direction.into_iter().zip(['x', 'y', 'z']) {
            self.name_radial(id);
            self.name(id, &format!("{label}_direction_{axis}"));
        }
        for (id, axis) in region.outputs.gradient.into_iter().zip(['x', 'y', 'z']) {
            if let Node::Neg(opposite) = *self.graph.node(id)
                && self.values.get(&opposite).is_some_and(|name| name.starts_with("radial"))
            {
                self.name(id, &format!("inward_{axis}"));
            }
            self.name(id, &format!("{label}_gradient_{axis}"));
        }
        self.name(region.outputs.magnitude, &format!("{label}_magnitude"));
        self.name(region.outputs.niceness, &format!("{label}_niceness"));
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

    /// Names the components of the unit vector away from the axis in a direction.
    fn name_radial(&mut self, direction: Id) {
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

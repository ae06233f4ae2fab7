//! Regions whose outputs are computed together: those in which they are the same, such as flute and shank of a mill, and those
//! in which they are the same operations on other constants, such as the grooves of a thread mill. A constant that differs is a
//! *parameter*, selected for each lane by the masks of the regions.

use super::{OUTPUTS, Output};
use crate::expr::{Coord, Graph, Id, Node};
use crate::model::{Model, RegionOutputs};
use crate::number::Number;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::mem::discriminant;

/// The number of groups, the latest ones, with which another one may be merged: the time grows with their number.
const MAX_CANDIDATES: usize = 32;

/// Regions that are computed together.
#[derive(Default)]
pub(super) struct Group {
    pub(super) regions: Vec<usize>,
    /// The distinct values of each of [`OUTPUTS`].
    pub(super) outputs: [Vec<Values>; OUTPUTS.len()],
    /// The parameters of these values.
    pub(super) parameters: Vec<Id>,
}

/// The values of one output in some regions of a group.
pub(super) struct Values {
    pub(super) ids: Vec<Id>,
    pub(super) regions: Vec<usize>,
}

impl Group {
    /// Returns all values of all outputs.
    pub(super) fn roots(&self) -> impl Iterator<Item = Id> {
        self.outputs.iter().flatten().flat_map(|values| values.ids.iter().copied())
    }

    /// Adds an output of a region, which has no values where it is 0.
    fn add(&mut self, output: usize, ids: Vec<Id>, region: usize) {
        match self.outputs[output].iter_mut().find(|known| known.ids == ids) {
            Some(known) => known.regions.push(region),
            None if ids.is_empty() => {}
            None => self.outputs[output].push(Values { ids, regions: vec![region] }),
        }
    }

    /// Returns whether each output has the same values in all regions.
    fn is_uniform(&self) -> bool {
        self.outputs.iter().all(|values| match &values[..] {
            [] => true,
            [only] => only.regions.len() == self.regions.len(),
            _ => false,
        })
    }
}

/// A value of a parameter, by its bits as generated code rounds it, and the regions that have it.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(super) struct Choice {
    bits: u64,
    pub(super) regions: Vec<usize>,
}

impl Choice {
    pub(super) fn value(&self) -> f64 {
        f64::from_bits(self.bits)
    }
}

/// The values of a parameter, which differ.
pub(super) type Choices = Vec<Choice>;

/// Takes the opposite of each value.
fn negate(choices: &mut [Choice]) {
    choices.iter_mut().for_each(|choice| choice.bits = (-choice.value()).to_bits());
}

/// The groups of a tool.
pub(super) struct Groups {
    /// The tool's graph, and the values of groups.
    pub(super) graph: Graph,
    pub(super) groups: Vec<Group>,
    /// The choices of each parameter, which stands in the graph as a constant of its own.
    pub(super) parameters: BTreeMap<Id, Choices>,
    known: HashMap<Choices, Id>,
    /// True if the magnitude is the depth in all regions, so that it is computed once for all of them.
    pub(super) magnitude_is_depth: bool,
}

impl Groups {
    /// Groups the regions that own points.
    pub(super) fn new(model: &Model, owners: &BTreeSet<usize>) -> Groups {
        let outputs = |region: usize| &model.regions[region].outputs;
        let mut groups = Groups {
            graph: model.graph.clone(),
            groups: Vec::new(),
            parameters: BTreeMap::new(),
            known: HashMap::new(),
            magnitude_is_depth: owners.iter().all(|owner| is_depth(&model.graph, outputs(*owner))),
        };
        let place = |region: usize| (outputs(region).depth, outputs(region).direction);
        for owner in owners {
            // Enclosures tell regions written by hand apart by the mask of each, so that these are groups of their own.
            let is_same =
                |group: &Group| model.profile.is_some() && place(group.regions[0]) == place(*owner);
            let known = groups.groups.iter().position(is_same);
            let mut group =
                known.map_or_else(Group::default, |index| groups.groups.swap_remove(index));
            group.regions.push(*owner);
            for (index, output) in OUTPUTS.iter().enumerate() {
                group.add(index, groups.values(output, outputs(*owner)), *owner);
            }
            groups.groups.push(group);
        }
        // In the order of their first regions.
        groups.groups.sort_by_key(|group| group.regions[0]);
        if model.profile.is_some() {
            groups.merge();
        }
        groups
    }

    /// Returns the values of an output that are computed in a region. There are none where the output is 0, as it is before
    /// anything is computed, or follows from another one.
    fn values(&self, output: &Output, outputs: &RegionOutputs) -> Vec<Id> {
        let values = (output.of)(outputs);
        let is_zero = |id: &Id| self.graph.constant(*id).is_some_and(Number::is_zero);
        let follows = self.magnitude_is_depth && output.name == "magnitude";
        if follows || values.iter().all(is_zero) { Vec::new() } else { values }
    }

    /// Merges groups that differ in few constants, each with the one before it that needs the fewest selections. There are no more
    /// selections than regions: one takes about as long as the test for lanes in a region, which it replaces.
    fn merge(&mut self) {
        let mut merged: Vec<Group> = Vec::new();
        for next in std::mem::take(&mut self.groups) {
            let latest = merged.iter().enumerate().rev().take(MAX_CANDIDATES);
            let candidates = latest.filter_map(|(index, group)| {
                let both = Merger { groups: self, own: group, other: &next, known: HashMap::new() }
                    .merge()?;
                let selections: usize =
                    both.parameters.iter().map(|id| self.parameters[id].len() - 1).sum();
                (selections <= both.regions.len()).then_some((selections, index, both))
            });
            match candidates.min_by_key(|(selections, index, _)| (*selections, *index)) {
                Some((_, index, both)) => merged[index] = both,
                None => merged.push(next),
            }
        }
        self.groups = merged;
    }

    /// Returns the parameter with some choices, or the opposite of the one with the opposite choices: what is subtracted in one
    /// place is often added in another.
    fn parameter(&mut self, mut choices: Choices) -> Id {
        let is_opposite = choices[0].value() < 0.0;
        if is_opposite {
            negate(&mut choices);
        }
        let graph = &mut self.graph;
        let id = *self.known.entry(choices).or_insert_with_key(|choices| {
            let id = graph.parameter(choices[0].value());
            self.parameters.insert(id, choices.clone());
            id
        });
        if is_opposite { self.graph.opposite(id) } else { id }
    }
}

/// Returns whether the magnitude of a region is its depth, in the part's unit.
fn is_depth(graph: &Graph, outputs: &RegionOutputs) -> bool {
    let is_length = |id: Id| *graph.node(id) == Node::Coord(Coord::Length);
    match *graph.node(outputs.magnitude) {
        Node::Mul(a, b) => [a, b].contains(&outputs.depth) && (is_length(a) || is_length(b)),
        _ => false,
    }
}

/// The attempt to merge two groups.
struct Merger<'g> {
    groups: &'g mut Groups,
    own: &'g Group,
    other: &'g Group,
    known: HashMap<[Id; 2], Option<Id>>,
}

impl Merger<'_> {
    /// Returns both groups as one, if all their outputs are the same operations.
    fn merge(mut self) -> Option<Group> {
        if !self.own.is_uniform() || !self.other.is_uniform() {
            return None;
        }
        let regions = [&self.own.regions[..], &self.other.regions].concat();
        let mut group = Group { regions, ..Group::default() };
        for (index, pair) in self.own.outputs.iter().zip(&self.other.outputs).enumerate() {
            match (&pair.0[..], &pair.1[..]) {
                ([], []) => {}
                ([own], [other]) => {
                    let ids = self.all(&own.ids, &other.ids)?;
                    group.outputs[index].push(Values { ids, regions: group.regions.clone() });
                }
                _ => return None,
            }
        }
        let needed = self.groups.graph.dependencies(group.roots()).into_iter();
        group.parameters = needed.filter(|id| self.groups.parameters.contains_key(id)).collect();
        Some(group)
    }

    /// Returns a node with the value of the first of two in the first group, and of the second in the second.
    fn both(&mut self, pair: [Id; 2]) -> Option<Id> {
        if let Some(known) = self.known.get(&pair) {
            return *known;
        }
        let merged = self.merged(pair);
        self.known.insert(pair, merged);
        merged
    }

    fn merged(&mut self, [own, other]: [Id; 2]) -> Option<Id> {
        if own == other {
            return Some(own);
        }
        if let Some(choices) = self.choices(own, other) {
            // Constants that differ beyond the bits of generated code are the same there.
            return Some(if choices.len() == 1 { own } else { self.groups.parameter(choices) });
        }
        let [own_node, other_node] = [own, other].map(|id| self.groups.graph.node(id).clone());
        // Two coordinates that differ are the only nodes of one kind without operands.
        if discriminant(&own_node) != discriminant(&other_node)
            || matches!(own_node, Node::Coord(_))
        {
            return None;
        }
        let [own_operands, mut other_operands] =
            [own_node, other_node.clone()].map(|node| node.operands().collect::<Vec<Id>>());
        let mut merged = self.all(&own_operands, &other_operands);
        // Sums and products have their operands in either order.
        if merged.is_none() && matches!(other_node, Node::Add(..) | Node::Mul(..)) {
            other_operands.reverse();
            merged = self.all(&own_operands, &other_operands);
        }
        Some(self.groups.graph.with_operands(own, &merged?))
    }

    /// Merges nodes in pairs.
    fn all(&mut self, own: &[Id], other: &[Id]) -> Option<Vec<Id>> {
        own.iter().zip(other).map(|(own, other)| self.both([*own, *other])).collect()
    }

    /// Returns the choices of a parameter for two constants, of which the first may be a parameter or its opposite.
    fn choices(&self, own: Id, other: Id) -> Option<Choices> {
        let Groups { graph, parameters, .. } = &*self.groups;
        let bits = |id: Id| Some(graph.constant(id)?.to_f64().to_bits());
        let mut choices = match *graph.node(own) {
            Node::Neg(opposite) => {
                let mut choices = parameters.get(&opposite)?.clone();
                negate(&mut choices);
                choices
            }
            _ => match parameters.get(&own) {
                Some(choices) => choices.clone(),
                None => vec![Choice { bits: bits(own)?, regions: self.own.regions.clone() }],
            },
        };
        let bits = bits(other)?;
        match choices.iter_mut().find(|choice| choice.bits == bits) {
            Some(choice) => choice.regions.extend(&self.other.regions),
            None => choices.push(Choice { bits, regions: self.other.regions.clone() }),
        }
        Some(choices)
    }
}

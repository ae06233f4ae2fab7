//! Cells: rectangles of the half plane, each with its *candidates*, the features that may be the nearest to its points.
//!
//! A feature is left out only if another is proved to be nearer to every point of the cell: by more than rounding, or because it
//! comes nearer from an end that both share. A poor cut between cells costs candidates and never an answer. Features that nearly
//! coincide stay together: no border between them is computed.

use crate::certify::space::MeridianPoint;
use crate::certify::tool_model::outline::Outline;
use crate::certify::tool_model::quarter::is_above_everywhere;
use crate::certify::tool_model::rectangle::Rectangle;
use crate::certify::tool_model::section::Section;
use crate::certify::tool_model::slab::SectionSlab;

/// A rectangle and its candidates.
#[derive(Clone, Debug)]
pub(crate) struct Cell {
    pub(crate) rectangle: Rectangle,
    /// The features' indices, in the order of the profile.
    pub(crate) candidates: Vec<usize>,
}

/// A tree of cells: the rectangle about a profile, halved until few candidates are left.
#[derive(Clone, Debug, Default)]
pub(crate) struct CellTree {
    /// The rectangle about the profile.
    whole: Rectangle,
    /// The nodes, each before its halves.
    nodes: Vec<CellNode>,
}

#[derive(Clone, Debug)]
enum CellNode {
    /// The halves below and above a coordinate. The lower one is the next node.
    Halved { axis: usize, at: f64, upper: usize },
    /// The candidates of a cell.
    Undivided(Vec<usize>),
}

/// The number of candidates that a cell may have, and their share of all features: with fewer, evaluation gains less than the
/// tree costs.
const FEW: usize = 8;
const FEW_SHARE: usize = 8;

/// The least size of a cell, as a fraction of the section's. Some points are equally far from many features.
const MIN_CELL: f64 = 1.0 / (1 << 20) as f64;

/// The number of the nearest features to which others are compared.
const MAX_COMPARED: usize = 8;

impl CellTree {
    /// Divides the rectangle about a profile.
    pub(super) fn new(outline: &Outline) -> CellTree {
        let ends = outline.features.iter().flat_map(|feature| feature.segment.ends);
        let points = ends.map(|end| Rectangle { low: end, high: end });
        let whole = points.reduce(|one, other| one.widened(&other)).unwrap_or_default();
        let mut tree = CellTree { whole, nodes: Vec::new() };
        let all: Vec<usize> = (0..outline.features.len()).collect();
        tree.divide(outline, outline.cell(whole, &all, outline.owner_margin()));
        tree
    }

    fn divide(&mut self, outline: &Outline, cell: Cell) {
        let few = FEW.max(outline.features.len() / FEW_SHARE);
        if cell.candidates.len() <= few || cell.rectangle.ball().1 <= MIN_CELL * outline.size {
            self.nodes.push(CellNode::Undivided(cell.candidates));
            return;
        }
        let [lower, upper] = outline.halves(&cell, outline.owner_margin());
        let axis = usize::from(lower.rectangle.high[0] == upper.rectangle.high[0]);
        let index = self.nodes.len();
        self.nodes.push(CellNode::Halved { axis, at: upper.rectangle.low[axis], upper: 0 });
        self.divide(outline, lower);
        let next = self.nodes.len();
        if let CellNode::Halved { upper, .. } = &mut self.nodes[index] {
            *upper = next;
        }
        self.divide(outline, upper);
    }

    /// Returns whether there is more than one cell.
    #[inline]
    pub(crate) fn is_divided(&self) -> bool {
        self.nodes.len() > 1
    }

    /// Returns the candidates of a point; `None` for a point outside the rectangle about the profile.
    #[inline]
    pub(crate) fn candidates(&self, p: MeridianPoint) -> Option<&[usize]> {
        let point = Rectangle { low: p, high: p };
        self.whole.contains(&point).then(|| self.candidates_near(p))
    }

    /// Returns the candidates of a point, or of a cell near it if it is outside the rectangle about the profile.
    #[inline]
    pub(crate) fn candidates_near(&self, p: MeridianPoint) -> &[usize] {
        let mut index = 0;
        loop {
            match &self.nodes[index] {
                CellNode::Halved { axis, at, upper } => {
                    index = if p[*axis] < *at { index + 1 } else { *upper };
                }
                CellNode::Undivided(candidates) => return candidates,
            }
        }
    }

    /// Returns the cells of a rectangle: those of the tree, cut off at its sides.
    pub(super) fn within(&self, of: &Rectangle) -> Vec<Cell> {
        let mut cells = Vec::new();
        let mut stack = vec![(0, *of)];
        while let Some((index, rectangle)) = stack.pop() {
            match &self.nodes[index] {
                CellNode::Halved { axis, at, upper } => {
                    let [mut below, mut above] = [rectangle; 2];
                    below.high[*axis] = below.high[*axis].min(*at);
                    above.low[*axis] = above.low[*axis].max(*at);
                    let halves = [(index + 1, below), (*upper, above)];
                    stack.extend(
                        halves.into_iter().filter(|(_, half)| half.low[*axis] < half.high[*axis]),
                    );
                }
                CellNode::Undivided(candidates) => {
                    cells.push(Cell { rectangle, candidates: candidates.clone() });
                }
            }
        }
        cells
    }
}

impl Section {
    /// Returns the cells of a slab.
    pub(super) fn cells_of(&self, slab: &SectionSlab) -> Vec<Cell> {
        self.cells.within(&slab.rectangle())
    }
}

impl Outline {
    /// Returns the cell of a rectangle. `among` are the candidates of a rectangle about it. A feature stays if it is farther than
    /// the nearest by at most `margin`, unless a [neighbour](Outline::hidden_by_neighbours) hides it.
    pub(super) fn cell(&self, rectangle: Rectangle, among: &[usize], margin: f64) -> Cell {
        let (middle, reach) = rectangle.ball();
        let corners = rectangle.corners();
        let distances =
            among.iter().map(|index| (self.features[*index].segment.distance(middle), *index));
        let mut distances: Vec<(f64, usize)> = distances.collect();
        distances.sort_by(|one, other| one.0.total_cmp(&other.0));
        // Within the reach, a distance changes by at most the reach, and so does the least of all.
        let farthest = distances[0].0 + 2.0 * reach + margin;
        let mut candidates: Vec<usize> = Vec::new();
        let mut upper_bounds: Vec<[f64; 4]> = Vec::new();
        for (_, index) in distances.into_iter().take_while(|(distance, _)| *distance <= farthest) {
            let feature = &self.features[index];
            let lower = feature.lower_bounds(&corners);
            let is_farther =
                upper_bounds.iter().any(|upper| is_above_everywhere(lower, *upper, margin));
            if is_farther || self.hidden_by_neighbours(index, &corners) {
                continue;
            }
            candidates.push(index);
            if upper_bounds.len() < MAX_COMPARED {
                upper_bounds.push(feature.upper_bounds(&corners));
            }
        }
        candidates.sort_unstable();
        Cell { rectangle, candidates }
    }

    /// Returns both halves of a cell.
    pub(super) fn halves(&self, cell: &Cell, margin: f64) -> [Cell; 2] {
        cell.rectangle.halves().map(|half| self.cell(half, &cell.candidates, margin))
    }
}

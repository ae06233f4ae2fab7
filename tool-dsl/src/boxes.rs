//! Boxes that are halved again and again, each with the signs that curves can have in it.

use crate::expr::Id;
use crate::expr::interval::{Cell, Encloser, halves};
use crate::formula::{CurveIndex, NEGATIVE, POSITIVE, Signs, possible};
use crate::model::Model;

/// A cell, its halves, their halves and so on, as far as they were asked for. Each sign is computed once, however many queries
/// ask for it.
pub(crate) struct BoxTree<'m> {
    curves: Vec<Id>,
    encloser: Encloser<'m>,
    /// The box that the encloser was set to.
    selected: Option<usize>,
    /// The first is the whole cell.
    boxes: Vec<SignedBox>,
}

struct SignedBox {
    cell: Cell,
    /// The signs that each curve can have in it; 0 where nobody has asked.
    signs: Vec<Signs>,
    halves: Option<[usize; 2]>,
}

impl<'m> BoxTree<'m> {
    /// Makes a tree for the curves of a model, without boxes.
    pub(crate) fn new(model: &'m Model) -> BoxTree<'m> {
        let encloser = Encloser::new(&model.graph, model.curve_values());
        BoxTree {
            curves: model.curve_values().collect(),
            encloser,
            selected: None,
            boxes: Vec::new(),
        }
    }

    /// Replaces all boxes by one, whose index is 0.
    pub(crate) fn restart(&mut self, whole: Cell) {
        self.selected = None;
        self.boxes.clear();
        self.boxes.push(SignedBox { cell: whole, signs: vec![0; self.curves.len()], halves: None });
    }

    /// Returns a box.
    pub(crate) fn cell(&self, index: usize) -> &Cell {
        &self.boxes[index].cell
    }

    /// Returns the signs that a curve can have in a box.
    pub(crate) fn signs(&mut self, index: usize, curve: CurveIndex) -> Signs {
        let signed_box = &mut self.boxes[index];
        let known = signed_box.signs[curve];
        if known != 0 {
            return known;
        }
        if self.selected != Some(index) {
            self.selected = Some(index);
            self.encloser.set(signed_box.cell);
        }
        let signs = possible(self.encloser.get(self.curves[curve]));
        signed_box.signs[curve] = signs;
        signs
    }

    /// Returns the indices of a box's halves, which follow one another.
    pub(crate) fn halves(&mut self, index: usize) -> [usize; 2] {
        if let Some(halves) = self.boxes[index].halves {
            return halves;
        }
        let indices = [self.boxes.len(), self.boxes.len() + 1];
        // Enclosures over a half lie within those over the whole, so a curve keeps its only sign.
        let only_sign =
            |signs: &Signs| if matches!(*signs, NEGATIVE | POSITIVE) { *signs } else { 0 };
        let signs: Vec<Signs> = self.boxes[index].signs.iter().map(only_sign).collect();
        for cell in halves(self.boxes[index].cell) {
            self.boxes.push(SignedBox { cell, signs: signs.clone(), halves: None });
        }
        self.boxes[index].halves = Some(indices);
        indices
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library;

    /// A sign that a half inherits is the only one that it could have.
    #[test]
    fn inherited_signs_are_those_of_the_box_itself() {
        for tool in library::tools() {
            let model = &tool.model;
            let mut boxes = BoxTree::new(model);
            boxes.restart(tool.extent.cell());
            for index in 0..400 {
                let mut encloser = Encloser::new(&model.graph, model.curve_values());
                encloser.set(*boxes.cell(index));
                for (curve, value) in model.curve_values().enumerate() {
                    let own = possible(encloser.get(value));
                    assert_eq!(boxes.signs(index, curve), own, "{} {curve}", model.name);
                }
                boxes.halves(index);
            }
        }
    }
}

//! Tools with one thing changed, and all else as it is.

use touchoff::Level;
use touchoff::tool::{Ask, Card, Felt, Points, Search, Senses, Tool, Wanted};

/// A tool with another card, and its own test in single precision.
pub(crate) struct OtherCard<'a, T> {
    pub(crate) tool: &'a T,
    pub(crate) card: Card,
}

/// A tool without a test of its own: points are ruled out by the envelope alone.
pub(crate) struct Untested<'a, T>(pub(crate) &'a T);

/// A tool that computes all there is, whatever it is asked.
pub(crate) struct Thorough<'a, T>(pub(crate) &'a T);

/// All there is, as a type.
struct All;

impl Wanted for All {
    const ASK: Ask = Ask::EVERYTHING;
}

impl<T: Tool> Tool for OtherCard<'_, T> {
    fn card(&self) -> &Card {
        &self.card
    }

    fn clearance(&self, point: [f64; 3]) -> f64 {
        self.tool.clearance(point)
    }

    fn evaluate(&self, level: Level, ask: Ask, points: &Points, length: f64, felt: &mut Felt) {
        self.tool.evaluate(level, ask, points, length, felt);
    }

    fn near_bounds(&self, margin: f64) -> Vec<f32> {
        self.tool.near_bounds(margin)
    }

    fn search(&self, search: &mut Search<'_>) {
        self.tool.search(search);
    }
}

impl<T: Senses> Senses for OtherCard<'_, T> {
    fn feel<W: Wanted>(&self, level: Level, points: &Points, length: f64, felt: &mut Felt) {
        self.tool.feel::<W>(level, points, length, felt);
    }
}

impl<T: Tool> Tool for Untested<'_, T> {
    fn card(&self) -> &Card {
        self.0.card()
    }

    fn clearance(&self, point: [f64; 3]) -> f64 {
        self.0.clearance(point)
    }

    fn evaluate(&self, level: Level, ask: Ask, points: &Points, length: f64, felt: &mut Felt) {
        self.0.evaluate(level, ask, points, length, felt);
    }
}

impl<T: Senses> Senses for Untested<'_, T> {
    fn feel<W: Wanted>(&self, level: Level, points: &Points, length: f64, felt: &mut Felt) {
        self.0.feel::<W>(level, points, length, felt);
    }
}

impl<T: Tool> Tool for Thorough<'_, T> {
    fn card(&self) -> &Card {
        self.0.card()
    }

    fn clearance(&self, point: [f64; 3]) -> f64 {
        self.0.clearance(point)
    }

    fn evaluate(&self, level: Level, _: Ask, points: &Points, length: f64, felt: &mut Felt) {
        self.0.evaluate(level, Ask::EVERYTHING, points, length, felt);
    }

    fn near_bounds(&self, margin: f64) -> Vec<f32> {
        self.0.near_bounds(margin)
    }

    fn search(&self, search: &mut Search<'_>) {
        self.0.search(search);
    }
}

impl<T: Senses> Senses for Thorough<'_, T> {
    fn feel<W: Wanted>(&self, level: Level, points: &Points, length: f64, felt: &mut Felt) {
        self.0.feel::<All>(level, points, length, felt);
    }
}

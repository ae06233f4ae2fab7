//! Tools with one thing changed, and all else as it is.

use touchoff::Level;
use touchoff::tool::{Ask, Card, Felt, Points, Senses, Slopes, Tool, Wanted};

/// A tool with another card.
pub(crate) struct OtherCard<'a, T> {
    pub(crate) tool: &'a T,
    pub(crate) card: Card,
}

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

    fn slopes(&self, point: [f64; 3], length: f64, room: &mut Felt) -> Slopes {
        self.tool.slopes(point, length, room)
    }
}

impl<T: Senses> Senses for OtherCard<'_, T> {
    fn feel<W: Wanted>(&self, level: Level, points: &Points, length: f64, felt: &mut Felt) {
        self.tool.feel::<W>(level, points, length, felt);
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

    fn slopes(&self, point: [f64; 3], length: f64, room: &mut Felt) -> Slopes {
        self.0.slopes(point, length, room)
    }
}

impl<T: Senses> Senses for Thorough<'_, T> {
    fn feel<W: Wanted>(&self, level: Level, points: &Points, length: f64, felt: &mut Felt) {
        self.0.feel::<All>(level, points, length, felt);
    }
}

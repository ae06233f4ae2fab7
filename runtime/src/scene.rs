//! Several parts, fixtures and tools in one world, each where it was put last.
//!
//! A pair of which neither moved since it was asked last has its answer still; one that is far apart is left
//! after some thirty operations.

use crate::part::Part;
use crate::pose::Pose;
use crate::probe::{Deepest, Law, Probe, Weights, Wrench};
use crate::tool::Tool;
use crate::unit::Unit;

/// Parts and tools in one world.
///
/// ```
/// use touchoff::{Part, Pose, Scene, Unit, mesh::shapes};
/// use nalgebra::{Isometry3, Point3, Vector3};
///
/// touchoff::tool! {
///     tool Ball { units mm; profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; } }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let cube = shapes::cuboid(Point3::origin(), Point3::new(20., 20., 20.), Unit::Millimetre)?;
/// let part = Part::from_mesh(&cube, 10_000, 1)?;
/// let mut scene = Scene::new(Unit::Millimetre);
/// let work = scene.add_part(&part, Pose::default())?;
/// let clamp = scene.add_part(&part, Isometry3::translation(40.0, 0.0, 0.0).try_into()?)?;
/// let ball = scene.add_tool(&Ball);
///
/// scene.move_tool(ball, Pose::from_axis(Point3::new(10.0, 10.0, 19.5), Vector3::z())?);
/// assert!(scene.wrench(ball).force.z > 0.0);
/// assert_eq!(scene.between(ball, clamp).colliding, 0);
/// assert_eq!(scene.deepest(ball).map(|(part, _)| part), Some(work));
/// # Ok(()) }
/// ```
pub struct Scene<'a> {
    unit: Unit,
    law: Law,
    weights: Weights,
    parts: Vec<(&'a Part, Pose)>,
    tools: Vec<Held<'a>>,
}

/// A part of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PartId(usize);

/// A tool of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ToolId(usize);

/// A part that a scene cannot take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the part is in {part} and the scene in {scene}: convert it by `Part::to`")]
pub struct SceneError {
    /// The part's unit.
    pub part: Unit,
    /// The scene's.
    pub scene: Unit,
}

/// A tool, where it is, and what it feels of every part.
struct Held<'a> {
    tool: &'a dyn Tool,
    pose: Pose,
    beside: Vec<Pair<'a>>,
}

/// A tool beside a part, and what was felt last.
struct Pair<'a> {
    probe: Probe<'a>,
    /// Pose and answer in the part's frame.
    felt: Option<(Pose, Wrench)>,
}

impl<'a> Scene<'a> {
    /// An empty scene, whose poses and answers are in `unit`, with the thesis's law and area weights.
    pub fn new(unit: Unit) -> Scene<'a> {
        let (law, weights) = (Law::default(), Weights::default());
        Scene { unit, law, weights, parts: Vec::new(), tools: Vec::new() }
    }

    /// With another force law, for tools that are added from now on.
    #[must_use]
    pub fn law(mut self, law: Law) -> Scene<'a> {
        self.law = law;
        self
    }

    /// With other weights, for tools that are added from now on.
    #[must_use]
    pub fn weights(mut self, weights: Weights) -> Scene<'a> {
        self.weights = weights;
        self
    }

    /// Puts a part where its own frame is `place`.
    ///
    /// # Errors
    /// A part in another unit than the scene's.
    pub fn add_part(&mut self, part: &'a Part, place: Pose) -> Result<PartId, SceneError> {
        if part.unit() != self.unit {
            return Err(SceneError { part: part.unit(), scene: self.unit });
        }
        self.parts.push((part, place));
        for held in &mut self.tools {
            held.beside.push(Pair::new(part, held.tool, self.law, self.weights));
        }
        Ok(PartId(self.parts.len() - 1))
    }

    /// Adds a tool, its tip at the origin and its axis along z until it is moved. Its unit may be
    /// another than the scene's.
    pub fn add_tool(&mut self, tool: &'a dyn Tool) -> ToolId {
        let pair = |(part, _): &(&'a Part, Pose)| Pair::new(part, tool, self.law, self.weights);
        let beside = self.parts.iter().map(pair).collect();
        self.tools.push(Held { tool, pose: Pose::default(), beside });
        ToolId(self.tools.len() - 1)
    }

    /// Moves a part as a whole; its tree is not touched.
    pub fn move_part(&mut self, part: PartId, place: Pose) {
        self.parts[part.0].1 = place;
    }

    /// Moves a tool.
    pub fn move_tool(&mut self, tool: ToolId, pose: Pose) {
        self.tools[tool.0].pose = pose;
    }

    /// The first part that a tool touches.
    pub fn detect(&mut self, tool: ToolId) -> Option<PartId> {
        let held = &mut self.tools[tool.0];
        let pairs = held.beside.iter_mut().zip(&self.parts).enumerate();
        let mut touched = pairs.filter_map(|(index, (pair, (_, place)))| {
            pair.probe.detect(&held.pose.seen_from(place)).then_some(PartId(index))
        });
        touched.next()
    }

    /// What a tool feels of one part, in the world's frame.
    pub fn between(&mut self, tool: ToolId, part: PartId) -> Wrench {
        let held = &mut self.tools[tool.0];
        held.beside[part.0].wrench(&held.pose, &self.parts[part.0].1)
    }

    /// What a tool feels of all parts together, in the world's frame. The triangle of its deepest point
    /// is one of the part's that [`Scene::deepest`] names.
    pub fn wrench(&mut self, tool: ToolId) -> Wrench {
        let held = &mut self.tools[tool.0];
        let mut total = Wrench::nothing(self.law, self.weights);
        for (pair, (_, place)) in held.beside.iter_mut().zip(&self.parts) {
            total.add(&pair.wrench(&held.pose, place));
        }
        total
    }

    /// The part that a tool is deepest in, and where.
    pub fn deepest(&mut self, tool: ToolId) -> Option<(PartId, Deepest)> {
        let held = &mut self.tools[tool.0];
        let mut most: Option<(PartId, Deepest)> = None;
        for (index, (pair, (_, place))) in held.beside.iter_mut().zip(&self.parts).enumerate() {
            let Some(deepest) = pair.wrench(&held.pose, place).deepest else { continue };
            if most.is_none_or(|(_, most)| deepest.depth > most.depth) {
                most = Some((PartId(index), deepest));
            }
        }
        most
    }
}

impl<'a> Pair<'a> {
    fn new(part: &'a Part, tool: &'a dyn Tool, law: Law, weights: Weights) -> Pair<'a> {
        Pair { probe: Probe::new(part, tool).law(law).weights(weights), felt: None }
    }

    fn wrench(&mut self, pose: &Pose, place: &Pose) -> Wrench {
        let relative = pose.seen_from(place);
        match &self.felt {
            Some((last, felt)) if *last == relative => felt.turned(place),
            _ => {
                let felt = self.probe.wrench(&relative);
                self.felt = Some((relative, felt));
                felt.turned(place)
            }
        }
    }
}

//! A scene of several parts, fixtures and tools in one world.
//!
//! If neither member of a pair has moved since its last query, the stored answer is returned. A pair
//! that is far apart is rejected by the distance of the tool's tip from the part's middle.

use crate::bvh::STORED_BOX_MARGIN;
use crate::debug::debug;
use crate::part::Part;
use crate::pose::Pose;
use crate::probe::{DeepestPoint, Law, Probe, Weights, Wrench};
use crate::tool::Tool;
use crate::unit::Unit;
use nalgebra::Point3;
use std::f64::consts::SQRT_2;

/// Parts and tools in one world frame.
///
/// ```
/// use touchoff::{Part, Pose, Sampling, Scene, Unit, mesh::shapes};
/// use nalgebra::{Isometry3, Point3, Vector3};
///
/// touchoff::tool! {
///     tool Ball { units mm; profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; } }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let cube = shapes::cuboid(Point3::origin(), Point3::new(20., 20., 20.), Unit::Millimetre)?;
/// let part = Part::from_mesh(&cube, Sampling::new(10_000))?;
/// let mut scene = Scene::new(Unit::Millimetre);
/// let workpiece = scene.add_part(&part, Pose::default())?;
/// let clamp = scene.add_part(&part, Isometry3::translation(40.0, 0.0, 0.0).try_into()?)?;
/// let ball = scene.add_tool(&Ball);
///
/// scene.move_tool(ball, Pose::from_axis(Point3::new(10.0, 10.0, 19.5), Vector3::z())?);
/// assert!(scene.wrench(ball).force.z > 0.0);
/// assert_eq!(scene.pair_wrench(ball, clamp).colliding, 0);
/// assert_eq!(scene.deepest(ball).map(|(part, _)| part), Some(workpiece));
/// # Ok(()) }
/// ```
pub struct Scene<'a> {
    unit: Unit,
    law: Law,
    weights: Weights,
    parts: Vec<(&'a Part, Pose)>,
    tools: Vec<SceneTool<'a>>,
}

debug!([] Scene<'_>, "Scene", |this| { unit: this.unit, parts: this.parts.len(), tools: this.tools.len() });

/// The id of a part in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PartId(usize);

/// The id of a tool in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ToolId(usize);

/// A part whose unit differs from the scene's.
#[derive(Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the part is in {part} and the scene in {scene}: convert it by `Part::converted_to`")]
#[non_exhaustive]
pub struct SceneError {
    /// The part's unit.
    pub part: Unit,
    /// The scene's unit.
    pub scene: Unit,
}

crate::debug_as_sentence!(SceneError);

/// A tool, its pose, and its contact with every part.
struct SceneTool<'a> {
    tool: &'a dyn Tool,
    pose: Pose,
    pairs: Vec<Pair<'a>>,
}

/// A tool and a part, with the last wrench.
struct Pair<'a> {
    probe: Probe<'a>,
    /// The middle of the part, in its frame.
    middle: Point3<f64>,
    /// The distance of the tool's tip from there beyond which the tool cannot reach the part.
    reach: f64,
    /// The pose of the last query and its wrench, in the part's frame.
    last_query: Option<(Pose, Wrench)>,
}

impl<'a> Scene<'a> {
    /// Creates an empty scene whose poses and results are in `unit`, with the gradient law and area weights.
    pub fn new(unit: Unit) -> Scene<'a> {
        let (law, weights) = (Law::default(), Weights::default());
        Scene { unit, law, weights, parts: Vec::new(), tools: Vec::new() }
    }

    /// Sets the force law for tools that are added from now on.
    #[must_use]
    pub fn with_law(mut self, law: Law) -> Scene<'a> {
        self.law = law;
        self
    }

    /// Sets the weights for tools that are added from now on.
    #[must_use]
    pub fn with_weights(mut self, weights: Weights) -> Scene<'a> {
        self.weights = weights;
        self
    }

    /// Adds a part; `pose` is the pose of its frame in the world.
    ///
    /// # Errors
    /// Fails if the part's unit differs from the scene's.
    pub fn add_part(&mut self, part: &'a Part, pose: Pose) -> Result<PartId, SceneError> {
        if part.unit() != self.unit {
            return Err(SceneError { part: part.unit(), scene: self.unit });
        }
        self.parts.push((part, pose));
        for scene_tool in &mut self.tools {
            scene_tool.pairs.push(Pair::new(part, scene_tool.tool, self.law, self.weights));
        }
        Ok(PartId(self.parts.len() - 1))
    }

    /// Adds a tool, with its tip at the origin and its axis along z until it is moved. Its unit may
    /// differ from the scene's.
    pub fn add_tool(&mut self, tool: &'a dyn Tool) -> ToolId {
        let pair = |(part, _): &(&'a Part, Pose)| Pair::new(part, tool, self.law, self.weights);
        let pairs = self.parts.iter().map(pair).collect();
        self.tools.push(SceneTool { tool, pose: Pose::default(), pairs });
        ToolId(self.tools.len() - 1)
    }

    /// Moves a part as a whole; its tree is unchanged.
    pub fn move_part(&mut self, part: PartId, pose: Pose) {
        self.parts[part.0].1 = pose;
    }

    /// Moves a tool.
    pub fn move_tool(&mut self, tool: ToolId, pose: Pose) {
        self.tools[tool.0].pose = pose;
    }

    /// Returns the first part that a tool touches.
    pub fn detect(&mut self, tool: ToolId) -> Option<PartId> {
        let scene_tool = &mut self.tools[tool.0];
        let pairs = scene_tool.pairs.iter_mut().zip(&self.parts).enumerate();
        let mut touched = pairs.filter_map(|(index, (pair, (_, part_pose)))| {
            let is_touched = pair.reaches(&scene_tool.pose, part_pose)
                && pair.probe.detect(&scene_tool.pose.relative_to(part_pose));
            is_touched.then_some(PartId(index))
        });
        touched.next()
    }

    /// Returns the contact wrench between a tool and one part, in the world frame.
    pub fn pair_wrench(&mut self, tool: ToolId, part: PartId) -> Wrench {
        let scene_tool = &mut self.tools[tool.0];
        scene_tool.pairs[part.0].wrench(&scene_tool.pose, &self.parts[part.0].1)
    }

    /// Returns the contact wrench of a tool with all parts together, in the world frame. The triangle id
    /// of its deepest point belongs to the part that [`Scene::deepest`] returns.
    pub fn wrench(&mut self, tool: ToolId) -> Wrench {
        let scene_tool = &mut self.tools[tool.0];
        let mut total = Wrench::nothing(self.law, self.weights);
        for (pair, (_, part_pose)) in scene_tool.pairs.iter_mut().zip(&self.parts) {
            total.add(&pair.wrench(&scene_tool.pose, part_pose));
        }
        total
    }

    /// Returns the part that a tool is deepest in, and the deepest point.
    pub fn deepest(&mut self, tool: ToolId) -> Option<(PartId, DeepestPoint)> {
        let scene_tool = &mut self.tools[tool.0];
        let mut deepest: Option<(PartId, DeepestPoint)> = None;
        for (index, (pair, (_, part_pose))) in
            scene_tool.pairs.iter_mut().zip(&self.parts).enumerate()
        {
            // The wrench is kept with the pair, so that asking for it again costs nothing.
            let Some(candidate) = pair.wrench(&scene_tool.pose, part_pose).deepest else {
                continue;
            };
            if deepest.is_none_or(|(_, deepest)| candidate.depth > deepest.depth) {
                deepest = Some((PartId(index), candidate));
            }
        }
        deepest
    }
}

impl<'a> Pair<'a> {
    fn new(part: &'a Part, tool: &'a dyn Tool, law: Law, weights: Weights) -> Pair<'a> {
        let (frame, info) = (&part.tree().frame, tool.info());
        // No point of a tool is farther from its tip than √2 of its size; half the diagonal of a cube is √3/2 of its side.
        let size = SQRT_2 * info.size() * info.unit.factor_to(part.unit());
        let radius = 0.5 * 3f64.sqrt() * f64::from(frame.size) * frame.scale;
        Pair {
            probe: Probe::new(part, tool).with_law(law).with_weights(weights),
            middle: frame.origin,
            reach: (1.0 + STORED_BOX_MARGIN) * (size + radius),
            last_query: None,
        }
    }

    /// Returns whether the tool may reach the part. That is told without the relative pose, which costs more.
    fn reaches(&self, pose: &Pose, part_pose: &Pose) -> bool {
        let middle = part_pose.tip() + part_pose.rotation() * self.middle.coords;
        // The difference errs by a few units of roundoff of the coordinates.
        let error = 16.0 * f64::EPSILON * (pose.tip().coords.amax() + middle.coords.amax());
        (pose.tip() - middle).norm() <= self.reach + error
    }

    fn wrench(&mut self, pose: &Pose, part_pose: &Pose) -> Wrench {
        if !self.reaches(pose, part_pose) {
            return self.probe.zero_wrench();
        }
        let relative = pose.relative_to(part_pose);
        match &self.last_query {
            // Both may have moved: what counts is their relative pose, in whose frame the answer is kept.
            Some((last_pose, wrench)) if *last_pose == relative => wrench.turned(part_pose),
            _ => {
                let wrench = self.probe.wrench(&relative);
                self.last_query = Some((relative, wrench));
                wrench.turned(part_pose)
            }
        }
    }
}

//! The path of the tools' tips in the 3-D view.

use crate::failure::Failure;
use nalgebra::Point3;
use touchoff::Unit;
use touchoff_verify::{JobReport, Move, MovePath};

/// Number of vertices above which every second one is left out, again and again.
const MAX_VERTICES: usize = 100_000;
/// Greatest distance of a drawn line from a curved path, as a fraction of the part's extent.
const MAX_DEVIATION: f64 = 1e-3;
/// Number of times that a curved motion is halved at most.
const MAX_HALVINGS: u32 = 10;

/// The way to a vertex from the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// None: the path of a tool begins there, or that before is not known.
    Begins,
    Feed,
    Rapid,
}

/// A vertex of the path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    /// The tip, in the frame and unit of the part.
    pub(super) tip: Point3<f64>,
    pub(super) way: Way,
    /// The index of the tool.
    pub(super) tool: usize,
}

/// The path of the tips of all tools in the first reading: one after the other, each in the order of the program.
pub(super) struct ToolPath {
    /// At most [`MAX_VERTICES`].
    pub(super) vertices: Vec<Vertex>,
    /// One of so many vertices is kept.
    pub(super) stride: usize,
    /// Greatest distance of the lines from the path, before vertices are left out.
    max_deviation: f64,
    /// Number of vertices that were passed.
    passed: usize,
    /// Set if a path begins at a vertex that was left out, and none was kept since.
    begins: bool,
}

impl ToolPath {
    /// Follows the tools of a job. `extent` is that of the part.
    ///
    /// # Errors
    /// If the machine lacks the link of a body.
    pub(super) fn new(checked: &JobReport<'_>, extent: f64) -> Result<ToolPath, Failure> {
        let max_deviation = MAX_DEVIATION * extent;
        let (vertices, begins) = (Vec::new(), false);
        let mut path = ToolPath { vertices, stride: 1, max_deviation, passed: 0, begins };
        let (program, unit) = (checked.job.program, checked.job.unit());
        for (index, tool) in checked.job.tools.iter().enumerate() {
            let symmetry = tool.tool.info().symmetry;
            let moves = program.moves(0, tool.motions, symmetry, None, unit)?;
            for step in moves.filter(|step| !step.alternative) {
                path.add(&step, index);
            }
        }
        Ok(path)
    }

    /// Describes how the path is drawn.
    pub(super) fn caption(&self, unit: Unit) -> String {
        let deviation = unit.format(self.max_deviation);
        let kept = match self.stride {
            1 => String::new(),
            stride => format!(
                " One of {stride} vertices is drawn, evenly chosen, so that there are {MAX_VERTICES} at most."
            ),
        };
        format!("Solid in feed, dashed in rapid traverse, curves within {deviation}.{kept}")
    }

    /// Adds a motion of a tool.
    fn add(&mut self, step: &Move, tool: usize) {
        let tip = |fraction| step.path.pose(fraction).tip();
        if step.from.is_none() {
            self.push(Vertex { tip: tip(0.0), way: Way::Begins, tool });
        }
        let way = if step.rapid { Way::Rapid } else { Way::Feed };
        // The ends of the pieces that are left, the next one last.
        let mut ends = vec![(1.0, 0)];
        let mut start = 0.0;
        while let Some((end, halvings)) = ends.pop() {
            let is_curved = matches!(step.path, MovePath::Joints(_));
            if is_curved && halvings < MAX_HALVINGS && self.leaves_chord(&tip, start, end) {
                let middle = 0.5 * (start + end);
                ends.extend([(end, halvings + 1), (middle, halvings + 1)]);
            } else {
                self.push(Vertex { tip: tip(end), way, tool });
                start = end;
            }
        }
    }

    /// Returns whether a path leaves the line between two fractions of it.
    fn leaves_chord(&self, tip: &impl Fn(f64) -> Point3<f64>, start: f64, end: f64) -> bool {
        let (from, to) = (tip(start), tip(end));
        let chord = to - from;
        let direction = chord.try_normalize(0.0).unwrap_or_default();
        // Whole turns of a helix would fall on even fractions.
        [0.29, 0.5, 0.73].into_iter().any(|share| {
            let way = tip(start + share * (end - start)) - from;
            (way - direction * way.dot(&direction)).norm() > self.max_deviation
        })
    }

    /// Adds a vertex, if it is one of those that are kept.
    fn push(&mut self, vertex: Vertex) {
        let is_kept = self.passed.is_multiple_of(self.stride);
        self.passed += 1;
        self.begins |= vertex.way == Way::Begins;
        if !is_kept {
            return;
        }
        let way = if self.begins { Way::Begins } else { vertex.way };
        self.vertices.push(Vertex { way, ..vertex });
        self.begins = false;
        if self.vertices.len() > MAX_VERTICES {
            self.stride *= 2;
            let (mut index, mut begins) = (0, false);
            self.vertices.retain_mut(|vertex| {
                index += 1;
                begins |= vertex.way == Way::Begins;
                let is_kept = index % 2 == 1;
                if is_kept && std::mem::take(&mut begins) {
                    vertex.way = Way::Begins;
                }
                is_kept
            });
            self.begins = begins;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vertices of a long path are left out evenly, and no line crosses a gap.
    #[test]
    fn a_long_path_is_thinned_evenly() {
        let (vertices, begins) = (Vec::new(), false);
        let mut path = ToolPath { vertices, stride: 1, max_deviation: 0.1, passed: 0, begins };
        let gaps = [0, 100_003, 250_002];
        for index in 0..300_000 {
            let way = if gaps.contains(&index) { Way::Begins } else { Way::Feed };
            let tip = Point3::new(f64::from(index), 0.0, 0.0);
            path.push(Vertex { tip, way, tool: 0 });
        }
        assert_eq!((path.stride, path.vertices.len()), (4, 75_000));
        let kept = path.vertices.iter().map(|vertex| vertex.tip.x);
        assert!(kept.eq((0..75_000).map(|index| f64::from(4 * index))));
        let begins = path.vertices.iter().filter(|vertex| vertex.way == Way::Begins);
        let begins: Vec<f64> = begins.map(|vertex| vertex.tip.x).collect();
        assert_eq!(begins, [0.0, 100_004.0, 250_004.0]);
        assert!(path.caption(Unit::Millimetre).contains("One of 4 vertices"));
    }
}

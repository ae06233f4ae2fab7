//! The method of Ho (1999): a binary tree of k-DOPs over the cloud, with nodes behind pointers, and the tool as a tree
//! of volumes with a decision tree in each leaf.
//!
//! It follows chapters 2 to 4 and section 7.3. The cloud's tree never moves; the tool's volumes are bounded anew at
//! each pose. Where leaves of both trees overlap, the points are transformed to the tool's frame and evaluated one by
//! one. It uses k = 18, which Klosowski (1997) found best, and leaves of at most `LEAF` points. The thesis rotates the
//! vertices of a volume and bounds those; here each volume is bounded tightly by its support function, which is better.
//! An overlap test ends at the first separating direction, and the larger of two volumes is subdivided first.

use super::formula;
use super::points::{Point, points};
use crate::race::contender::{Answer, Contender, PoseTransform, Sums, dot};
use touchoff::{Cloud, Pose};

/// Maximum number of points per leaf; values from 4 to 32 were tried at 20,000 points.
const LEAF: usize = 16;

/// Number of directions of an 18-DOP: the axes, and the bisectors of each two axes and their opposites.
const DIRECTIONS: usize = 9;
const DIAGONAL: f64 = std::f64::consts::FRAC_1_SQRT_2;
const DIRECTION_VECTORS: [[f64; 3]; DIRECTIONS] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [DIAGONAL, DIAGONAL, 0.0],
    [DIAGONAL, -DIAGONAL, 0.0],
    [DIAGONAL, 0.0, DIAGONAL],
    [DIAGONAL, 0.0, -DIAGONAL],
    [0.0, DIAGONAL, DIAGONAL],
    [0.0, DIAGONAL, -DIAGONAL],
];

/// The lower and upper bound along each direction.
#[derive(Clone, Copy)]
struct Dop([[f64; 2]; DIRECTIONS]);

impl Dop {
    const EMPTY: Dop = Dop([[f64::INFINITY, f64::NEG_INFINITY]; DIRECTIONS]);

    fn include(&mut self, other: &Dop) {
        for (own, [low, high]) in self.0.iter_mut().zip(other.0) {
            *own = [own[0].min(low), own[1].max(high)];
        }
    }

    fn overlaps(&self, other: &Dop) -> bool {
        self.0.iter().zip(&other.0).all(|(a, b)| a[0] <= b[1] && b[0] <= a[1])
    }

    /// Returns the longest side along the coordinate axes, and the index of that axis.
    fn longest(&self) -> (f64, usize) {
        let side = |axis: usize| self.0[axis][1] - self.0[axis][0];
        (0..3).map(|axis| (side(axis), axis)).fold((-1.0, 0), |a, b| if b.0 > a.0 { b } else { a })
    }
}

/// A node of the cloud's tree.
struct Node {
    volume: Dop,
    size: f64,
    children: Children,
}

enum Children {
    Nodes([Box<Node>; 2]),
    Points(Vec<Point>),
}

fn build(points: &mut [Point]) -> Box<Node> {
    let mut volume = Dop::EMPTY;
    for point in &*points {
        volume
            .include(&Dop(DIRECTION_VECTORS.map(|direction| [dot(direction, point.position); 2])));
    }
    let (size, axis) = volume.longest();
    let children = if points.len() <= LEAF {
        Children::Points(points.to_vec())
    } else {
        let middle = points.len() / 2;
        points.select_nth_unstable_by(middle, |a, b| a.position[axis].total_cmp(&b.position[axis]));
        let (low, high) = points.split_at_mut(middle);
        Children::Nodes([build(low), build(high)])
    };
    Box::new(Node { volume, size, children })
}

/// A frustum about the tool's axis: the distances of its ends from the tip, and the radii there, mm.
struct Frustum {
    ends: [f64; 2],
    radii: [f64; 2],
}

const CUTTER: Frustum = Frustum { ends: [1.0, 5.0], radii: [1.0, 1.0] };
const TAPER: Frustum = Frustum { ends: [5.0, 7.0], radii: [1.0, 3.0] };
const SPINDLE: Frustum = Frustum { ends: [7.0, 9.0], radii: [3.0, 3.0] };
const HOUSING: Frustum = Frustum { ends: [9.0, 20.0], radii: [5.0, 5.0] };

/// The tip's coordinate along each direction, and the component of the tool's axis along each.
struct Projections {
    tip: [f64; DIRECTIONS],
    axis: [f64; DIRECTIONS],
}

impl Projections {
    fn bound(&self, frustum: &Frustum) -> Dop {
        Dop(std::array::from_fn(|direction| {
            let sine = (1.0 - self.axis[direction] * self.axis[direction]).max(0.0).sqrt();
            let extent =
                |end: usize| (frustum.ends[end] * self.axis[direction], frustum.radii[end] * sine);
            let ((a, a_reach), (b, b_reach)) = (extent(0), extent(1));
            let (low, high) = ((a - a_reach).min(b - b_reach), (a + a_reach).max(b + b_reach));
            [self.tip[direction] + low, self.tip[direction] + high]
        }))
    }

    /// Returns the bounds of the ball of radius 1 at the tip.
    fn ball(&self) -> Dop {
        let centre = |direction: usize| self.tip[direction] + self.axis[direction];
        Dop(std::array::from_fn(|direction| [centre(direction) - 1.0, centre(direction) + 1.0]))
    }
}

fn union(mut a: Dop, b: &Dop) -> Dop {
    a.include(b);
    a
}

/// The decision tree of a leaf of the tool, as a function of `d²` and the thesis's `z`.
type DecisionTree = fn(f64, f64) -> Option<(f64, [f64; 2])>;

/// The tool's tree: its leaves are cutter, spindle and housing; the neck combines the first two.
const LEAVES: [DecisionTree; 3] = [
    |squared, z| if z >= 15.0 { formula::cutter(squared, z) } else { None },
    |squared, z| if z > 11.0 && z < 15.0 { formula::spindle(squared, z) } else { None },
    |squared, z| if z <= 11.0 { formula::housing(squared, z) } else { None },
];
const NECK: usize = 3;
const WHOLE: usize = 4;

/// Returns the children of a volume of the tool.
fn children_of(volume: usize) -> Option<[usize; 2]> {
    match volume {
        WHOLE => Some([NECK, 2]),
        NECK => Some([0, 1]),
        _ => None,
    }
}

/// The tool at a pose.
struct Tool {
    transform: PoseTransform,
    volumes: [Dop; 5],
    sums: Sums,
}

impl Tool {
    fn at(pose: &Pose) -> Tool {
        let transform = PoseTransform::of(pose);
        let axis: [f64; 3] = pose.axis().into();
        let projections = Projections {
            tip: DIRECTION_VECTORS.map(|direction| dot(direction, transform.tip)),
            axis: DIRECTION_VECTORS.map(|direction| dot(direction, axis)),
        };
        let cutter = union(projections.ball(), &projections.bound(&CUTTER));
        let spindle = union(projections.bound(&TAPER), &projections.bound(&SPINDLE));
        let housing = projections.bound(&HOUSING);
        let neck = union(cutter, &spindle);
        let volumes = [cutter, spindle, housing, neck, union(neck, &housing)];
        Tool { transform, volumes, sums: Sums::default() }
    }

    /// Descends both trees at once.
    fn descend(&mut self, node: &Node, volume: usize) {
        if !node.volume.overlaps(&self.volumes[volume]) {
            return;
        }
        match (&node.children, children_of(volume)) {
            (Children::Points(points), None) => self.add_points(points, LEAVES[volume]),
            (Children::Nodes(nodes), parts)
                if parts.is_none() || node.size > self.volumes[volume].longest().0 =>
            {
                nodes.iter().for_each(|node| self.descend(node, volume));
            }
            (_, parts) => parts.into_iter().flatten().for_each(|part| self.descend(node, part)),
        }
    }

    fn add_points(&mut self, points: &[Point], decision_tree: DecisionTree) {
        for point in points {
            let offset = self.transform.offset_from_tip(point.position);
            let p = self.transform.to_tool_frame(offset);
            let squared = p[0] * p[0] + p[1] * p[1];
            if let Some(evaluation) = decision_tree(squared, formula::TIP - p[2]) {
                let evaluation = formula::in_space(p, squared, evaluation);
                self.sums.add([offset, p], (point.weight, point.normal), evaluation);
            }
        }
    }
}

/// The tree of the cloud.
pub struct Thesis(Box<Node>);

impl Thesis {
    /// Builds the tree of a cloud.
    pub fn new(cloud: &Cloud) -> Thesis {
        Thesis(build(&mut points(cloud)))
    }
}

impl Contender for Thesis {
    fn name(&self) -> &'static str {
        "thesis"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let mut tool = Tool::at(pose);
        tool.descend(&self.0, WHOLE);
        tool.sums.answer(&tool.transform)
    }
}

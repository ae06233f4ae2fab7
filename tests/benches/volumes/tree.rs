//! The tree: nodes of `W` children side by side, down to leaves of points.
//!
//! A node has its children's volumes number by number and a word each for what is below: another
//! node, or a leaf's first point and how many it has. All children are tested in one loop without
//! branches, which the compiler makes vectors of, for the best instructions that the machine has.
//! Nodes lie level by level, and a query walks them so: it appends what it keeps to a queue, so the
//! next node's address is known early, and leaves come after most nodes.

use crate::contender::{Answer, Contender, View, Workpiece};
use crate::leaves::{Felt, Leaves};
use crate::split::{Bounds, Half, Item, Rule};
use crate::volume::{Frame, Volume};
use crate::wide::{Nodes, widen};
use fearless_simd::{Level, dispatch};
use std::marker::PhantomData;
use touchoff::Pose;

#[repr(align(64))]
struct Node<const F: usize, const W: usize> {
    volumes: [[f32; W]; F],
    below: [u32; W],
}

/// Marks a leaf, of whose first point [`FIRST`] has the place and the bits between the number less one.
const LEAF: u32 = 1 << 31;
const FIRST: u32 = (1 << 24) - 1;
/// No child.
const NOTHING: u32 = u32::MAX;

/// First point and number of points, of a leaf.
fn points_of(below: u32) -> Option<(usize, usize)> {
    let count = ((below & !LEAF) >> 24) + 1;
    (below & LEAF != 0).then_some(((below & FIRST) as usize, count as usize))
}

pub(crate) struct Tree<V, const F: usize, const W: usize> {
    level: Level,
    middle: [f64; 3],
    nodes: Vec<Node<F, W>>,
    leaves: Leaves,
    /// How many leaves there are.
    count: usize,
    /// What the last query has reached.
    queue: Vec<u32>,
    reached: usize,
    kind: PhantomData<V>,
}

impl<V: Volume<F>, const F: usize, const W: usize> Tree<V, F, W> {
    pub(crate) fn new(piece: &Workpiece, rule: Rule) -> Self {
        let places = piece.cloud.points().iter().map(|point| point.coords.into());
        let whole = Bounds::of_places(places.clone());
        let middle = [0, 1, 2].map(|axis| whole.middle(axis));
        let mut items: Vec<Item> = places
            .zip(0..)
            .map(|(at, index)| Item { at: [0, 1, 2].map(|axis| at[axis] - middle[axis]), index })
            .collect();
        assert!(items.len() <= FIRST as usize && rule.leaf <= 128, "a leaf is written in a word");
        let root = rule.divide(&mut items, 0);
        let nodes = written::<V, F, W>(&widen(&root, W), &items);
        let queue = vec![0; nodes.len() + root.leaves + W + 1];
        let leaves = Leaves::new(&piece.cloud, &items);
        let level = Level::new();
        Tree {
            level,
            middle,
            nodes,
            leaves,
            count: root.leaves,
            queue,
            reached: 0,
            kind: PhantomData,
        }
    }

    /// Finds the points within the outline, and adds what they feel if that is wanted.
    fn ask(&mut self, pose: &Pose, wanted: bool) -> (Felt, View) {
        let view = View::of(pose);
        let seen = V::seen(&Frame::of(&view, self.middle));
        let mut felt = Felt::nothing(wanted);
        let (tree, queue) = ((&self.nodes[..], &self.leaves), &mut self.queue[..]);
        let all = (&seen, &view);
        self.reached = dispatch!(self.level, _simd => walk::<V, F, W>(tree, all, queue, &mut felt));
        (felt, view)
    }
}

/// All nodes, their children put side by side.
fn written<V: Volume<F>, const F: usize, const W: usize>(
    nodes: &Nodes,
    items: &[Item],
) -> Vec<Node<F, W>> {
    let mut next = 0;
    let mut below = |child: &Half| {
        if child.below.is_some() {
            next += 1;
            return next;
        }
        LEAF | (child.range.len() as u32 - 1) << 24 | child.range.start as u32
    };
    let node = |children: &Vec<&Half>| {
        let mut node = Node { volumes: [[f32::NAN; W]; F], below: [NOTHING; W] };
        for (lane, child) in children.iter().enumerate() {
            node.below[lane] = below(child);
            for (list, number) in node.volumes.iter_mut().zip(V::about(&items[child.range.clone()]))
            {
                list[lane] = number;
            }
        }
        node
    };
    nodes.iter().map(node).collect()
}

/// Appends the children that the tool may reach; how many.
#[inline(always)]
fn keep<const W: usize>(hits: &[u32; W], below: &[u32; W], room: &mut [u32]) -> usize {
    let mut kept = 0;
    for lane in 0..W {
        // Of two children a predicted branch was the faster: the next node need not wait for the
        // test. Of more, each is written and those that hit are kept, with no branch to mispredict.
        if W > 2 || hits[lane] != 0 {
            room[kept % W] = below[lane];
            kept += hits[lane] as usize;
        }
    }
    kept
}

/// Walks the tree; how much of the queue was used.
#[inline(always)]
fn walk<V: Volume<F>, const F: usize, const W: usize>(
    (nodes, leaves): (&[Node<F, W>], &Leaves),
    (seen, view): (&V::Seen, &View),
    queue: &mut [u32],
    felt: &mut Felt,
) -> usize {
    let (mut at, mut end) = (0, 1);
    queue[0] = 0;
    while at < end {
        let below = queue[at];
        at += 1;
        if let Some(points) = points_of(below) {
            leaves.feel(view, points, felt);
            continue;
        }
        let node = &nodes[below as usize];
        let mut hits = [0u32; W];
        for (lane, hit) in hits.iter_mut().enumerate() {
            *hit = u32::from(V::may_touch(seen, &node.volumes, lane));
        }
        end += keep(&hits, &node.below, &mut queue[end..end + W]);
    }
    end
}

impl<V: Volume<F>, const F: usize, const W: usize> Contender for Tree<V, F, W> {
    fn name(&self) -> &'static str {
        "tree"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let (felt, view) = self.ask(pose, true);
        felt.sums.answer(&view)
    }
}

/// What a query did.
#[derive(Clone, Copy, Default)]
pub(crate) struct Work {
    /// Volumes tested against the tool.
    pub(crate) tested: usize,
    pub(crate) leaves: usize,
    pub(crate) points: usize,
}

/// A tree that tells what its last query did, and how large it is.
pub(crate) trait Counted: Contender {
    fn work(&self) -> Work;

    /// How many points are within the outline: a query without what they feel.
    fn search(&mut self, pose: &Pose) -> usize;

    /// Bytes of its nodes.
    fn bytes(&self) -> usize;

    /// How many leaves it has.
    fn leaves(&self) -> usize;
}

impl<V: Volume<F>, const F: usize, const W: usize> Counted for Tree<V, F, W> {
    fn work(&self) -> Work {
        let mut work = Work::default();
        for &below in &self.queue[..self.reached] {
            if let Some((_, count)) = points_of(below) {
                work.leaves += 1;
                work.points += count;
            } else {
                let children = &self.nodes[below as usize].below;
                work.tested += children.iter().filter(|&&child| child != NOTHING).count();
            }
        }
        work
    }

    fn search(&mut self, pose: &Pose) -> usize {
        self.ask(pose, false).0.near
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..])
    }

    fn leaves(&self) -> usize {
        self.count
    }
}

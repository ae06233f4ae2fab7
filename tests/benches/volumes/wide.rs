//! From halves of halves to nodes of as many children as wanted.

use crate::split::Half;

/// Nodes from the root down, each by its children.
pub(crate) type Nodes<'a> = Vec<Vec<&'a Half>>;

/// Takes halves together, as many as a node has room for, so that there are few nodes. Trees of
/// leaves of one size come out with full nodes if a child gets no more leaves than a full tree of
/// its height has; others do better with the greatest half divided until there is no room left.
pub(crate) fn widen(root: &Half, width: usize) -> Nodes<'_> {
    let even = gather(root, width, |leaves| full(leaves, width));
    let greedy = gather(root, width, |_| 1);
    if even.len() <= greedy.len() { even } else { greedy }
}

/// The most leaves of a full tree that has fewer than so many.
fn full(leaves: usize, width: usize) -> usize {
    let mut full = 1;
    while full * width < leaves {
        full *= width;
    }
    full
}

/// Level by level; `room` is how many leaves a child may have for a node of so many.
fn gather(root: &Half, width: usize, room: impl Fn(usize) -> usize) -> Nodes<'_> {
    let mut nodes = vec![children(root, width, room(root.leaves))];
    let mut at = 0;
    while at < nodes.len() {
        for child in nodes[at].clone() {
            if child.below.is_some() {
                nodes.push(children(child, width, room(child.leaves)));
            }
        }
        at += 1;
    }
    nodes
}

/// Divides the greatest child until there is no room, or none has too many leaves.
fn children(node: &Half, width: usize, room: usize) -> Vec<&Half> {
    let mut list = vec![node];
    while list.len() < width {
        let divisible = |half: &&Half| half.leaves > room;
        let greatest = (0..list.len()).filter(|&at| divisible(&list[at]));
        let Some(at) = greatest.max_by_key(|&at| list[at].leaves) else { break };
        let Some(below) = &list[at].below else { break };
        list.splice(at..=at, below.iter());
    }
    list
}

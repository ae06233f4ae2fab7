//! What takes vectors, for each precision by itself: a generic function is compiled in every program that asks
//! it, these once.

use super::{Beside, Wrench, wrench};
use crate::pose::Pose;
use crate::probe::precision::{Double, Filtered, Precision, Single};

/// What is done with a tree and with what was felt. Nobody else has it, so that there are no other precisions.
pub trait Once: Send + Sync + Sized + 'static {
    /// Finds the candidates of the whole part, and what it has there if that is wanted.
    fn all(beside: &mut Beside<'_, Self>, skin: bool)
    where
        Self: Precision;
    /// Finds the leaves of the whole part, looking at so many nodes at most; how many it were.
    fn within(beside: &mut Beside<'_, Self>, budget: usize) -> Option<usize>
    where
        Self: Precision;
    /// Finds the candidates of the leaves that were found last.
    fn found(beside: &mut Beside<'_, Self>)
    where
        Self: Precision;
    /// Finds those of the leaf that was hit last.
    fn again(beside: &mut Beside<'_, Self>)
    where
        Self: Precision;
    /// Finds the nodes above the leaves that the tool may reach; how many there are.
    fn nodes(beside: &mut Beside<'_, Self>) -> usize
    where
        Self: Precision;
    /// Finds the candidates under one of them.
    fn under(beside: &mut Beside<'_, Self>, node: usize)
    where
        Self: Precision;
    /// Sums what was felt.
    fn sum(beside: &Beside<'_, Self>, pose: &Pose) -> Wrench
    where
        Self: Precision;
}

macro_rules! once {
    ($($precision:ident),*) => {$(
        impl Once for $precision {
            fn all(beside: &mut Beside<'_, Self>, skin: bool) {
                let Beside { search, level, tree, sight, view, .. } = beside;
                search.all(*level, (tree, sight, view), skin);
            }
            fn within(beside: &mut Beside<'_, Self>, budget: usize) -> Option<usize> {
                let Beside { search, level, tree, sight, view, .. } = beside;
                search.within(*level, (tree, sight, view), budget)
            }
            fn found(beside: &mut Beside<'_, Self>) {
                let Beside { search, level, tree, sight, view, .. } = beside;
                search.found(*level, (tree, sight, view), true);
            }
            fn again(beside: &mut Beside<'_, Self>) {
                let Beside { search, level, tree, sight, view, hit, .. } = beside;
                search.leaf(*level, (tree, sight, view), *hit);
            }
            fn nodes(beside: &mut Beside<'_, Self>) -> usize {
                let Beside { search, level, tree, sight, view, .. } = beside;
                search.nodes(*level, (tree, sight, view))
            }
            fn under(beside: &mut Beside<'_, Self>, node: usize) {
                let Beside { search, level, tree, sight, view, .. } = beside;
                search.under(*level, (tree, sight, view), node);
            }
            fn sum(beside: &Beside<'_, Self>, pose: &Pose) -> Wrench {
                wrench::sum(beside, pose)
            }
        }
    )*};
}

once!(Double, Filtered, Single);

//! What is varied, and the tree for each choice.

use crate::aabb::Aabb;
use crate::contender::Workpiece;
use crate::dop::Dop;
use crate::obb::Obb;
use crate::sphere::{ByDistance, Sphere};
use crate::split::{Axis, Point, Rule};
use crate::tree::{Counted, Tree};
use crate::volume::Volume;

/// A bounding volume.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Sphere,
    ByDistance,
    Aabb,
    Obb,
    Dop14,
    Dop18,
    Dop26,
}

impl Kind {
    pub(crate) const ALL: [Kind; 7] = [
        Kind::Sphere,
        Kind::ByDistance,
        Kind::Aabb,
        Kind::Obb,
        Kind::Dop14,
        Kind::Dop18,
        Kind::Dop26,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Kind::Sphere => "sphere",
            Kind::ByDistance => "sphere by distance",
            Kind::Aabb => "AABB",
            Kind::Obb => "OBB",
            Kind::Dop14 => "14-DOP",
            Kind::Dop18 => "18-DOP",
            Kind::Dop26 => "26-DOP",
        }
    }
}

/// Children of a node.
pub(crate) const BRANCHINGS: [usize; 4] = [2, 4, 8, 16];

/// The most points of a leaf.
pub(crate) const LEAVES: [usize; 8] = [1, 2, 4, 8, 16, 32, 64, 128];

pub(crate) const AXES: [Axis; 4] = [Axis::Longest, Axis::Variance, Axis::Volumes, Axis::Surfaces];

pub(crate) const POINTS: [Point; 4] = [Point::Full, Point::Median, Point::Mean, Point::Middle];

/// One choice of everything.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Config {
    pub(crate) kind: Kind,
    pub(crate) branching: usize,
    pub(crate) rule: Rule,
}

/// What stays as it is while one thing varies.
pub(crate) const BASE: Config = Config {
    kind: Kind::Aabb,
    branching: 4,
    rule: Rule { axis: Axis::Longest, point: Point::Full, leaf: 16 },
};

impl Config {
    pub(crate) fn of_kind(self, kind: Kind) -> Config {
        Config { kind, ..self }
    }

    pub(crate) fn of_branching(self, branching: usize) -> Config {
        Config { branching, ..self }
    }

    pub(crate) fn of_leaf(self, leaf: usize) -> Config {
        Config { rule: Rule { leaf, ..self.rule }, ..self }
    }

    pub(crate) fn of_axis(self, axis: Axis) -> Config {
        Config { rule: Rule { axis, ..self.rule }, ..self }
    }

    pub(crate) fn of_point(self, point: Point) -> Config {
        Config { rule: Rule { point, ..self.rule }, ..self }
    }

    pub(crate) fn axis(self) -> &'static str {
        match self.rule.axis {
            Axis::Longest => "longest side",
            Axis::Variance => "largest variance",
            Axis::Volumes => "least volumes",
            Axis::Surfaces => "least surfaces",
        }
    }

    pub(crate) fn point(self) -> &'static str {
        match self.rule.point {
            Point::Full => "full leaves",
            Point::Median => "median",
            Point::Mean => "mean",
            Point::Middle => "middle of the box",
        }
    }

    /// The tree over a part.
    pub(crate) fn build(self, piece: &Workpiece) -> Box<dyn Counted> {
        match self.kind {
            Kind::Sphere => self.wide::<Sphere, 4>(piece),
            Kind::ByDistance => self.wide::<ByDistance, 4>(piece),
            Kind::Aabb => self.wide::<Aabb, 6>(piece),
            Kind::Obb => self.wide::<Obb, 12>(piece),
            Kind::Dop14 => self.wide::<Dop<14>, 14>(piece),
            Kind::Dop18 => self.wide::<Dop<18>, 18>(piece),
            Kind::Dop26 => self.wide::<Dop<26>, 26>(piece),
        }
    }

    fn wide<V: Volume<F> + 'static, const F: usize>(self, piece: &Workpiece) -> Box<dyn Counted> {
        match self.branching {
            2 => Box::new(Tree::<V, F, 2>::new(piece, self.rule)),
            4 => Box::new(Tree::<V, F, 4>::new(piece, self.rule)),
            8 => Box::new(Tree::<V, F, 8>::new(piece, self.rule)),
            16 => Box::new(Tree::<V, F, 16>::new(piece, self.rule)),
            other => unreachable!("no study has {other} children"),
        }
    }
}

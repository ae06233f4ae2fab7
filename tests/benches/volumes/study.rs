//! Which trees are raced against one another.

use crate::config::{AXES, BASE, BRANCHINGS, Config, Kind, LEAVES, POINTS};

/// One thing varied, all else as in [`BASE`].
pub(crate) struct Study {
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    pub(crate) rows: Vec<(String, Config)>,
}

/// Two things varied.
pub(crate) struct Cross {
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    pub(crate) columns: Vec<String>,
    pub(crate) rows: Vec<(String, Vec<Config>)>,
}

/// A word for each choice of one thing, and what it makes of a tree.
type Choices = Vec<(String, Box<dyn Fn(Config) -> Config>)>;

fn choices<T: Copy + 'static>(
    all: &[T],
    word: impl Fn(T) -> String,
    change: fn(Config, T) -> Config,
) -> Choices {
    let choice = |&one: &T| -> (String, Box<dyn Fn(Config) -> Config>) {
        (word(one), Box::new(move |config| change(config, one)))
    };
    all.iter().map(choice).collect()
}

fn kinds() -> Choices {
    choices(&Kind::ALL, |kind| kind.name().into(), Config::of_kind)
}

fn leaves() -> Choices {
    choices(&LEAVES, |leaf| format!("{leaf} a leaf"), Config::of_leaf)
}

fn branchings() -> Choices {
    choices(&BRANCHINGS, |branching| format!("{branching} children"), Config::of_branching)
}

fn axes() -> Choices {
    choices(&AXES, |axis| BASE.of_axis(axis).axis().into(), Config::of_axis)
}

fn points() -> Choices {
    choices(&POINTS, |point| BASE.of_point(point).point().into(), Config::of_point)
}

pub(crate) fn studies() -> Vec<Study> {
    let study = |name, title, choices: Choices| {
        let rows = choices.into_iter().map(|(word, change)| (word, change(BASE))).collect();
        Study { name, title, rows }
    };
    vec![
        study("volume", "Bounding volume", kinds()),
        study("leaf", "Points of a leaf", leaves()),
        study("branching", "Branching", branchings()),
        study("axis", "Axis of a split", axes()),
        study("point", "Point of a split", points()),
    ]
}

pub(crate) fn crosses() -> Vec<Cross> {
    let cross = |name, title, down: Choices, across: Choices| {
        let row = |change: &dyn Fn(Config) -> Config| {
            across.iter().map(|(_, also)| also(change(BASE))).collect()
        };
        let rows = down.iter().map(|(word, change)| (word.clone(), row(change))).collect();
        let columns = across.iter().map(|(word, _)| word.clone()).collect();
        Cross { name, title, columns, rows }
    };
    vec![
        cross("volume-branching", "Volume and branching", kinds(), branchings()),
        cross("leaf-branching", "Leaf and branching", leaves(), branchings()),
        cross("volume-leaf", "Volume and leaf", kinds(), leaves()),
        cross("axis-leaf", "Axis of a split and leaf", axes(), leaves()),
        cross("point-leaf", "Point of a split and leaf", points(), leaves()),
    ]
}

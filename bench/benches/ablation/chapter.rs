//! The skips, each with how a query is made to do without it.

use crate::line::{Row, Setting};
use crate::{cores, outputs, reach, regions, world};

/// A skip.
pub(crate) struct Chapter {
    /// The word for it in rows.
    pub(crate) word: &'static str,
    pub(crate) title: &'static str,
    /// What is timed with it, and what without.
    pub(crate) how: &'static str,
    pub(crate) measure: fn(&Setting) -> Vec<Row>,
}

/// All of them.
pub(crate) const CHAPTERS: [Chapter; 12] = [
    Chapter {
        word: "outputs felt",
        title: "Outputs that a question does not need are not computed",
        how: "Without: a tool that computes all its outputs whatever it is asked; the question reads what it needs.",
        measure: outputs::of_everything,
    },
    Chapter {
        word: "outputs listed",
        title: "Nor listed",
        how: "Without: `contacts`, which lists everything, and the same answer made of the list.",
        measure: outputs::of_contacts,
    },
    Chapter {
        word: "first hit",
        title: "Yes or no ends at the first hit",
        how: "Without: `deepest`, and whether there is one. It also computes depths, at points inside.",
        measure: outputs::first_hit,
    },
    Chapter {
        word: "known type",
        title: "The tool's type is known",
        how: "With: `Probe<Fig73>`. Without: `Probe<dyn Tool>`.",
        measure: outputs::known_type,
    },
    Chapter {
        word: "envelope",
        title: "Boxes that the tool's radius along its axis keeps away from",
        how: "Without: a card whose envelope is one slab, the whole reach and the largest radius.",
        measure: reach::envelope,
    },
    Chapter {
        word: "axis",
        title: "Spin and turn about the axis are not looked at",
        how: "Without: the same tool said to be a solid, as far across as its largest radius, which is what boxes are held to \
              besides. It finds the same leaves, so this is only what the tests cost; what a solid's own code costs \
              more, which cannot work with the distance from the axis, is not in it.",
        measure: reach::axis,
    },
    Chapter {
        word: "far part",
        title: "A part that is far",
        how: "`Probe::wrench`. With: the ball is 200 mm from the outer wall, so that one test of the whole part answers. Without: it \
              is 0.1 mm from it, so that the part is walked and nothing is found. Other poses, since at the same ones the test \
              either answers or does not.",
        measure: world::far_part,
    },
    Chapter {
        word: "far parts",
        title: "Far parts of a scene",
        how: "Ten parts in a scene, of which the ball is 0.05 mm deep in one. With: the nine others stand 200 mm away. Without: \
              they stand in the same place as the one, their outer wall 0.1 mm from the ball, so that each is walked and \
              nothing is found. ns are those of one part: what the scene takes more than the touched part alone, by nine. \
              Besides the probe's it has the pose seen from where the part is, and the comparison with the last.",
        measure: world::far_parts,
    },
    Chapter {
        word: "still",
        title: "Frames in which nothing moved",
        how: "With: `Scene::wrench` asked again where the tool already was: 25 tools, which stand at the poses of a block and were \
              asked there before, untimed. Without: `Probe::wrench` of a `dyn Tool` at these poses. Reading the clock is some \
              1 or 2 ns of the first.",
        measure: world::still,
    },
    Chapter {
        word: "level",
        title: "Vectors of the machine",
        how: "With: the best level of this machine. Without: the next ones, as the row says, by `Probe::level`.",
        measure: outputs::levels,
    },
    Chapter {
        word: "regions",
        title: "Regions that no point of a block of eight is in",
        how: "`Tool::evaluate`, as for a wrench, of the points that collide along the path, in blocks of whole queries with 2,000 \
              points at least. With: in the tree's order, so that neighbours are evaluated together. Without: the points of each \
              block shuffled. ns a point. What a region costs that is computed for \
              nothing cannot be had by public API: this is how much of the skip hangs on neighbours being together.",
        measure: regions::order,
    },
    Chapter {
        word: "cores",
        title: "Many poses on all cores",
        how: "With: `Probe::map`. Without: `Probe::wrench` at one pose after the other, on one core. Wall time, ns a pose, in \
              blocks of 1,024 poses a core, no CPU time: what else runs on the machine takes from the first.",
        measure: cores::map,
    },
];

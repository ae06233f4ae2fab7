//! This project: the compiled `Fig73` and its query, as a user would call them.

use crate::contender::{Answer, Contender, Workpiece};
use tools_library::Fig73;
use touchoff::{Pose, Probe};

pub(crate) struct This<'a>(Probe<'a, Fig73>);

impl<'a> This<'a> {
    pub(crate) fn new(piece: &'a Workpiece) -> Self {
        This(Probe::new(&piece.part, &Fig73))
    }
}

impl Contender for This<'_> {
    fn name(&self) -> &'static str {
        "touchoff"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let felt = self.0.wrench(pose);
        let wrench = Some([felt.force, felt.torque]);
        Answer { colliding: felt.colliding, depth: felt.depth(), wrench }
    }
}

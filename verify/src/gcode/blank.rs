//! The blank that a program of Heidenhain states as a box: by BLK FORM, or by G30 and G31 in DIN/ISO.

use super::BlockLine;
use super::control::Control;

/// What a program has stated of its blank so far.
#[derive(Clone, Debug, Default)]
pub(super) struct BlankWords {
    /// The lowest and the highest corner, in millimetres.
    corners: [Option<[f64; 3]>; 2],
    /// Set by a blank of another form.
    has_other_form: bool,
    doubt: Option<(BlockLine, BlankDoubt)>,
}

/// A corner of the blank, as a program states it.
#[derive(Clone, Copy, Debug)]
pub(super) struct BlankCorner {
    /// 0 for the lowest one, 1 for the highest one.
    pub(super) corner: usize,
    /// Its coordinates in millimetres; `None` without all three.
    pub(super) position: Option<[f64; 3]>,
    /// Set in a program that another one has called.
    pub(super) is_called: bool,
    /// Set if a shift, a rotation or a mirror image moves the coordinates.
    pub(super) is_moved: bool,
}

/// The blank of a program: a box, in the coordinates of the program without a shift or a rotation, in millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blank {
    /// Its lowest and its highest corner.
    pub corners: [[f64; 3]; 2],
    /// The reason for which it may not be the material that is clamped, with the first line.
    pub doubt: Option<(BlockLine, BlankDoubt)>,
}

/// A reason for which a box of the program may not be the material that is clamped, or not where it is stated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BlankDoubt {
    /// A second blank, of which only one is clamped.
    #[error("the program states a second blank")]
    Second,
    /// A blank of a called program, which may be the window of its own picture.
    #[error("a called program states the blank")]
    Called,
    /// A blank under a shift, a rotation or a mirror image.
    #[error("the coordinates of the blank are shifted, turned or mirrored")]
    Moved,
    /// A work offset besides the first, of one of which the coordinates are.
    #[error(
        "another work offset than G54 is in force, and the coordinates of the blank are that of one of them"
    )]
    Offset,
}

impl BlankWords {
    /// Keeps a corner.
    pub(super) fn corner(&mut self, read: BlankCorner, control: &Control) {
        let known = &mut self.corners[read.corner];
        let doubt =
            if self.has_other_form || known.is_some_and(|known| Some(known) != read.position) {
                Some(BlankDoubt::Second)
            } else if read.is_moved {
                Some(BlankDoubt::Moved)
            } else if read.is_called && known.is_none() {
                Some(BlankDoubt::Called)
            } else {
                None
            };
        *known = known.or(read.position);
        if let Some(doubt) = doubt {
            self.doubt.get_or_insert((control.block(), doubt));
        }
    }

    /// Notes a blank of another form than a box.
    pub(super) fn other_form(&mut self, control: &Control) {
        self.has_other_form = true;
        self.doubt.get_or_insert((control.block(), BlankDoubt::Second));
    }

    /// Returns the box, if both of its corners are known.
    pub(super) fn blank(&self) -> Option<Blank> {
        let [Some(low), Some(high)] = self.corners else { return None };
        let is_box = (0..3).all(|axis| low[axis] < high[axis]);
        is_box.then_some(Blank { corners: [low, high], doubt: self.doubt })
    }
}

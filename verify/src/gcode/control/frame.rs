//! Frames of Sinumerik: the settable frames by their numbers, the programmable frame, and the swivelled plane of CYCLE800.
//!
//! A position p in program coordinates is at w = S P p in the settable frame, with the swivelled plane S and the programmable frame P
//! (*K2*, section on the chain of frames). `TRANS` and `ROT` replace P, `ATRANS` and `AROT` multiply it from the right. A new swivelled
//! plane replaces both, and an additional one multiplies S.
//!
//! In the terms of the [state](ControlState), a frame without a rotation is a shift, one about z is a rotated plane, and any other one is
//! a tilted plane.

use super::Control;
use crate::gcode::block::{Block, Group};
use crate::gcode::error::combination;
use crate::gcode::rules::Choice;
use crate::gcode::state::{Frame, LengthOffset, Rotation, Tcp, WorkOffset, about};
use crate::gcode::{Alignment, GcodeFault, Plane, StepPath, Z_ALONE};
use nalgebra::{Matrix3, Vector3};

/// The frames in force besides the settable one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frames {
    swivel: Option<SwivelFrame>,
    programmed: Frame,
    /// The shift of rotary axes by `TRANS`, in degrees.
    rotary: [f64; 3],
}

/// The swivelled plane.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SwivelFrame {
    frame: Frame,
    /// Set once the rotary axes were turned to it.
    aligned: bool,
}

/// A step of the programmable frame. Lengths are in the unit of the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::gcode) struct FrameStep {
    /// Set for `ATRANS` and `AROT`.
    pub(in crate::gcode) is_additive: bool,
    pub(in crate::gcode) shift: [f64; 6],
    pub(in crate::gcode) rotation: Matrix3<f64>,
    /// The rotation in the plane (`RPL`), in degrees.
    pub(in crate::gcode) in_plane: f64,
}

/// A call of CYCLE800. Lengths are in the unit of the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::gcode) struct Swivel {
    /// Set where the call only ends the plane.
    pub(in crate::gcode) is_reset: bool,
    /// Set where the plane is added to the one before.
    pub(in crate::gcode) is_additive: bool,
    /// The point about which the plane is rotated.
    pub(in crate::gcode) before: Vector3<f64>,
    pub(in crate::gcode) rotation: Matrix3<f64>,
    /// The origin in the rotated plane.
    pub(in crate::gcode) after: Vector3<f64>,
    /// The position to which the rotary axes turn, if they do.
    pub(in crate::gcode) alignment: Option<Alignment>,
    /// Set where the tip keeps its place while they turn.
    pub(in crate::gcode) follows_tip: bool,
    pub(in crate::gcode) retract: Retract,
}

/// The retract before a swivel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::gcode) enum Retract {
    None,
    /// Z of the machine, to the position of the swivel data record.
    Z,
    /// Z, then X and Y.
    All,
    /// Along the tool by a distance, or to the end of its travel.
    Tool {
        distance: Option<f64>,
    },
}

impl FrameStep {
    /// Returns a step that changes nothing, or ends the frame.
    pub(in crate::gcode) fn new(is_additive: bool) -> FrameStep {
        FrameStep { is_additive, shift: [0.0; 6], rotation: Matrix3::identity(), in_plane: 0.0 }
    }
}

impl Swivel {
    /// Returns a call that ends the plane.
    pub(in crate::gcode) fn reset() -> Swivel {
        Swivel {
            is_reset: true,
            is_additive: false,
            before: Vector3::zeros(),
            rotation: Matrix3::identity(),
            after: Vector3::zeros(),
            alignment: None,
            follows_tip: false,
            retract: Retract::None,
        }
    }
}

/// The map that changes nothing.
fn identity() -> Frame {
    Frame { rotation: Matrix3::identity(), origin: Vector3::zeros() }
}

/// Returns the map that applies `inner` first.
fn composed(outer: &Frame, inner: &Frame) -> Frame {
    Frame {
        rotation: outer.rotation * inner.rotation,
        origin: outer.rotation * inner.origin + outer.origin,
    }
}

impl Frames {
    pub(super) fn new() -> Frames {
        Frames { swivel: None, programmed: identity(), rotary: [0.0; 3] }
    }

    /// Returns the shift that a frame without a rotation makes.
    pub(super) fn shift(&self) -> [f64; 6] {
        let [a, b, c] = self.rotary;
        match self.rotation() {
            Rotation::Off => {
                let origin = self.programmed.origin;
                [origin.x, origin.y, origin.z, a, b, c]
            }
            _ => [0.0, 0.0, 0.0, a, b, c],
        }
    }

    /// Returns the rotation in the terms of the state.
    fn rotation(&self) -> Rotation {
        let Frames { swivel, programmed, .. } = self;
        match swivel {
            Some(SwivelFrame { frame, aligned }) => {
                // A programmable rotation about X or Y tilts z away from the tool.
                let keeps_z = programmed.rotation[(2, 2)] == 1.0;
                let aligned = *aligned && keeps_z;
                Rotation::Tilted { frame: composed(frame, programmed), aligned }
            }
            None if programmed.rotation == Matrix3::identity() => Rotation::Off,
            None if programmed.rotation[(2, 2)] == 1.0 => Rotation::Plane { frame: *programmed },
            None => Rotation::Tilted { frame: *programmed, aligned: false },
        }
    }

    /// Returns the word that has set them.
    pub(super) fn word(&self) -> Option<&'static str> {
        match self {
            Frames { swivel: Some(_), .. } => Some("CYCLE800"),
            frames if *frames == Frames::new() => None,
            Frames { programmed, .. } if programmed.rotation == Matrix3::identity() => {
                Some("TRANS")
            }
            _ => Some("ROT"),
        }
    }
}

impl Control {
    /// Executes `TRANS`, `ATRANS`, `ROT` or `AROT`.
    pub(in crate::gcode) fn program_frame(&mut self, step: FrameStep) -> Result<(), GcodeFault> {
        self.check_corner()?;
        self.check_uncompensated("a programmable frame")?;
        self.check_frame_change("a programmable frame")?;
        let [x, y, z, a, b, c] = step.shift;
        self.unit_of_lengths([x, y, z].iter().any(|length| *length != 0.0));
        let origin = Vector3::new(x, y, z).map(|length| self.modal.millimetres(length));
        let in_plane = about(self.modal.plane.normal(), step.in_plane);
        let frame = Frame { rotation: in_plane * step.rotation, origin };
        let before = if step.is_additive { self.frames } else { Frames::new() };
        let mut rotary = before.rotary;
        for (sum, angle) in rotary.iter_mut().zip([a, b, c]) {
            *sum += angle;
        }
        let programmed = composed(&before.programmed, &frame);
        self.set_frames(Frames { swivel: self.frames.swivel, programmed, rotary });
        self.begin_plane();
        Ok(())
    }

    /// Executes CYCLE800.
    pub(in crate::gcode) fn swivel(&mut self, swivel: &Swivel) -> Result<(), GcodeFault> {
        self.check_corner()?;
        self.check_uncompensated("CYCLE800")?;
        self.check_frame_change("CYCLE800")?;
        if self.state.tcp != Tcp::Off {
            let condition = "tool centre point control is on";
            return Err(combination("CYCLE800", condition, self.tcp_remedy()));
        }
        if self.modal.plane != Plane::Xy {
            return Err(combination("CYCLE800", "G18 or G19 is in force", "write G17 before"));
        }
        if swivel.follows_tip {
            let condition = "its tip of the tool keeps its place while the axes turn";
            let remedy = "write 0 in the tens of its third argument";
            return Err(combination("CYCLE800", condition, remedy));
        }
        self.retract_to_swivel(swivel.retract);
        if swivel.is_reset {
            self.set_frames(Frames::new());
            return Ok(());
        }
        let mut outer = identity();
        if swivel.is_additive {
            let is_plain = Frames { swivel: None, ..self.frames } == Frames::new();
            match self.frames.swivel {
                Some(before) if is_plain => outer = before.frame,
                None if is_plain => {}
                _ => {
                    let condition = "it adds a plane to a programmable frame";
                    return Err(combination("CYCLE800", condition, "write TRANS before"));
                }
            }
        }
        let is_moved = swivel.before != Vector3::zeros() || swivel.after != Vector3::zeros();
        self.unit_of_lengths(is_moved);
        let [before, after] = [swivel.before, swivel.after]
            .map(|point| point.map(|length| self.modal.millimetres(length)));
        let plane = Frame { rotation: swivel.rotation, origin: before + swivel.rotation * after };
        let frame = composed(&outer, &plane);
        let mut frames = Frames::new();
        frames.swivel = Some(SwivelFrame { frame, aligned: false });
        self.set_frames(frames);
        self.begin_plane();
        if swivel.alignment.is_some() {
            let mut end = self.position;
            end[3..].fill(None);
            let commanded = [false, false, false, true, true, true];
            self.push(true, end, commanded, StepPath::Align);
            self.pending.back_mut().expect("the step that was added").alignment = swivel.alignment;
            frames.swivel = Some(SwivelFrame { frame, aligned: true });
            self.set_frames(frames);
        }
        Ok(())
    }

    /// Retracts before a swivel. The position of the swivel data record is taken as that of G28.
    fn retract_to_swivel(&mut self, retract: Retract) {
        let home = self.home;
        match retract {
            Retract::None => return,
            Retract::Z | Retract::All => {
                self.move_machine(Z_ALONE, home, StepPath::Line);
                if retract == Retract::All {
                    self.mark_homeward();
                    let others = [true, true, false, false, false, false];
                    self.move_machine(others, home, StepPath::Line);
                }
            }
            Retract::Tool { distance } => {
                let stands = self.turns_nothing();
                let is_aligned =
                    matches!(self.state.rotation, Rotation::Tilted { aligned: true, .. });
                let is_plain =
                    matches!(self.state.rotation, Rotation::Off | Rotation::Plane { .. });
                let mut end = self.position;
                let mut commanded = Z_ALONE;
                // Along z of the plane, where the tool stands along it; else in a direction that only the machine knows.
                if is_aligned || is_plain && stands {
                    let distance = distance.map(|distance| self.modal.millimetres(distance));
                    end[2] = end[2].zip(distance).map(|(z, distance)| z + distance);
                } else {
                    end[..3].fill(None);
                    commanded[..3].fill(true);
                }
                self.push(true, end, commanded, StepPath::Line);
                // A distance can end beside the part, and a way along a tilted tool also leads sideways.
                if distance.is_some() || !(is_plain && stands) {
                    return;
                }
            }
        }
        self.mark_homeward();
    }

    fn mark_homeward(&mut self) {
        if let Some(step) = self.pending.back_mut() {
            step.is_homeward = true;
        }
    }

    fn set_frames(&mut self, frames: Frames) {
        self.frames = frames;
        let rotation = frames.rotation();
        // Both at once: between them the position would be one that the machine does not take.
        let shift = self.total_shift();
        self.change(|state| (state.rotation, state.shift) = (rotation, shift));
    }

    /// Refuses a change of frames under words of ISO mode that a frame would overwrite, and under modal cycles.
    fn check_frame_change(&self, word: &str) -> Result<(), GcodeFault> {
        match self.modal.cycle().is_some() || self.state.rotation != self.frames.rotation() {
            true => Err(combination(word, "a canned cycle or G68 is in force", "end it before")),
            false => Ok(()),
        }
    }

    /// Refuses `TRAORI` and `TRAFOOF` under a frame, which they deselect.
    pub(in crate::gcode) fn check_no_frame(&self) -> Result<(), GcodeFault> {
        match self.frames.word() {
            None => Ok(()),
            Some(word) => {
                let condition =
                    "a programmable frame or a swivelled plane is in force, which it deselects";
                let remedy = if word == "CYCLE800" {
                    "write CYCLE800() before"
                } else {
                    "write TRANS before"
                };
                Err(combination("TRAORI or TRAFOOF", condition, remedy))
            }
        }
    }

    /// Executes G500 or G505 to G599, in a block whose other words are executed after it.
    pub(in crate::gcode) fn settable_offset(
        &mut self,
        offset: WorkOffset,
        block: &Block,
    ) -> Result<(), GcodeFault> {
        if block.code_of(Group::WorkOffset).is_some() {
            let condition = "its block has another work offset";
            return Err(combination(offset.to_string(), condition, "keep one of them"));
        }
        self.check_uncompensated(offset.to_string())?;
        self.select_offset(offset);
        Ok(())
    }

    /// Returns whether no tool has been named, whose length could count.
    pub(in crate::gcode) fn is_without_tool(&self) -> bool {
        self.state.tool.is_none() && self.staged.is_none()
    }

    /// Executes D0 before the first tool: no length counts.
    pub(in crate::gcode) fn deselect_length(&mut self) {
        (self.length_cancelled, self.length_implicit) = (true, false);
        self.edge = Some(0);
        self.change(|state| state.length = LengthOffset::Off);
    }

    /// Sets the tool axis between two positions of the rotary axes, if the program states it.
    pub(in crate::gcode) fn interpolate_orientation(&mut self, choice: Option<Choice>) {
        self.change(|state| state.orientation = choice);
    }
}

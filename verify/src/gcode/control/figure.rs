//! Words that change what the coordinates of motions mean, before anything else does: polar coordinates (G16) and mirror images (G51.1).
//!
//! Both are read into plain coordinates, so that no other word knows of them (known: Fanuc, *Polar coordinate command*, *Programmable mirror
//! image*). Fanuc mirrors first, then rotates, so that a rotation and a mirror image are not read together.

use super::{AXES, Control, Motion};
use crate::gcode::block::{Block, Code, Group};
use crate::gcode::error::{combination, missing};
use crate::gcode::state::{Rotation, Tcp};
use crate::gcode::{GcodeFault, Plane};
use crate::machine::sin_cos_degrees;

/// Polar coordinates in the plane XY, about the origin of program coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Polar {
    /// The last radius, in millimetres.
    radius: Option<f64>,
    /// The last angle, in degrees.
    angle: Option<f64>,
}

/// The positions about which X, Y and Z are mirrored, in millimetres.
pub(super) type Mirror = [Option<f64>; 3];

impl Control {
    /// Returns whether the mirror image turns a plane over, so that G2 is executed as G3, and G41 as G42.
    pub(super) fn turns_over(&self, plane: Plane) -> bool {
        let [first, second] = plane.axes().map(|axis| self.mirror[axis].is_some());
        first != second
    }

    /// Returns whether a shift, a rotation or a mirror image moves the coordinates of X, Y and Z.
    pub(in crate::gcode) fn moves_coordinates(&self) -> bool {
        self.state.shift[..3] != [Some(0.0); 3]
            || self.state.rotation != Rotation::Off
            || self.mirror != [None; 3]
    }

    /// Returns whether polar coordinates or a mirror image are in force.
    fn has_figure(&self) -> bool {
        self.polar.is_some() || self.mirror != [None; 3]
    }

    /// Executes G15, G16, G50.1 and G51.1.
    pub(super) fn figure_words(&mut self, block: &mut Block) -> Result<(), GcodeFault> {
        if let Some(code) = block.code_of(Group::Polar) {
            self.polar = match code.tenths {
                160 if block.has_any("XYZIJK") => {
                    let condition = "its block has a position, which is polar on some controls";
                    return Err(combination(code, condition, "write it in a block after"));
                }
                160 => {
                    self.check_figure(code)?;
                    Some(self.polar.unwrap_or_default())
                }
                _ => None,
            };
        }
        let Some(code) = block.code_of(Group::Mirror) else { return Ok(()) };
        let axes = self.take_axes(block);
        if axes[3..].iter().any(Option::is_some) {
            let condition = "it names a rotary axis";
            return Err(combination(code, condition, "mirror X, Y and Z alone"));
        }
        let is_end = code.tenths == 501;
        if axes == [None; 6] {
            let needed = "the axes that it mirrors, or no longer mirrors";
            // The end of no mirror image is in the first lines of many programs.
            return match is_end && self.mirror == [None; 3] {
                true => Ok(()),
                false => Err(missing(code, needed)),
            };
        }
        self.check_uncompensated(code)?;
        if !is_end {
            self.check_figure(code)?;
            if self.modal.incremental {
                return Err(combination(code, "G91 is in force", "write G90 before"));
            }
        }
        for (mirror, value) in self.mirror.iter_mut().zip(axes) {
            if value.is_some() {
                *mirror = value.filter(|_| !is_end);
            }
        }
        Ok(())
    }

    /// Refuses G16 or G51.1 together with the other, with a rotation and with tool centre point control.
    fn check_figure(&self, code: Code) -> Result<(), GcodeFault> {
        let is_polar = code.tenths == 160;
        let condition = if is_polar && self.mirror != [None; 3] {
            "a mirror image is in force (G51.1)"
        } else if !is_polar && self.polar.is_some() {
            "polar coordinates are in force (G16)"
        } else if self.state.rotation != Rotation::Off {
            "a plane is rotated"
        } else if self.state.tcp != Tcp::Off {
            "tool centre point control is on"
        } else {
            return Ok(());
        };
        Err(combination(code, condition, "end that before"))
    }

    /// Maps the coordinates of a block in the unit of the program.
    pub(super) fn map_coordinates(&mut self, block: &mut Block) -> Result<(), GcodeFault> {
        if !self.has_figure() {
            return Ok(());
        }
        let groups =
            [Group::OneShot, Group::Machine, Group::WorkOffset, Group::Length, Group::Kinematics];
        let rotation = block.code_of(Group::Rotation).filter(|code| code.tenths != 690);
        let mut owners =
            groups.into_iter().filter_map(|group| block.code_of(group)).chain(rotation);
        // A length offset changes no coordinate that is mapped, but for tool centre point control.
        let is_plain = |code: &Code| matches!(code.tenths, 430 | 490 | 531);
        if let Some(code) = owners.find(|code| !is_plain(code)) {
            let condition = "polar coordinates or a mirror image are in force";
            let remedy = "end them before (G15, G50.1 with their axes)";
            return Err(combination(code, condition, remedy));
        }
        if block.keyword.is_some() {
            let condition = "polar coordinates or a mirror image are in force";
            return Err(combination("TRAORI", condition, "end them before"));
        }
        if block.owns_axis_words() {
            return Ok(());
        }
        match self.polar {
            Some(polar) => self.polar_words(polar, block),
            None => self.mirror_words(block),
        }
    }

    /// Replaces the radius X and the angle Y by coordinates.
    fn polar_words(&mut self, polar: Polar, block: &mut Block) -> Result<(), GcodeFault> {
        let word = "a position in polar coordinates (G16)";
        if block.has_any("IJ") {
            let remedy = "write R, or the arc after G15";
            return Err(combination("a centre I J", "G16 is in force", remedy));
        }
        if self.modal.plane != Plane::Xy && block.has_any("XYZ") {
            return Err(combination(word, "G18 or G19 is in force", "write G17 before"));
        }
        if !block.has_any("XY") {
            return Ok(());
        }
        let is_incremental =
            ['X', 'Y'].into_iter().any(|letter| self.is_incremental(block, letter));
        if is_incremental {
            let condition = "it is an increment, whose centre is the present position";
            return Err(combination(word, condition, "write G90"));
        }
        let radius = block.value('X').map(|radius| self.modal.millimetres(radius));
        let polar =
            Polar { radius: radius.or(polar.radius), angle: block.value('Y').or(polar.angle) };
        let (Some(radius), Some(angle)) = (polar.radius, polar.angle) else {
            return Err(missing("G16", "both the radius X and the angle Y in the first position"));
        };
        self.polar = Some(polar);
        let (sine, cosine) = sin_cos_degrees(angle);
        let radius = radius / self.modal.millimetres(1.0);
        block.set('X', radius * cosine);
        block.set('Y', radius * sine);
        Ok(())
    }

    /// Mirrors the coordinates and the centre of an arc.
    fn mirror_words(&self, block: &mut Block) -> Result<(), GcodeFault> {
        let is_cycle = matches!(self.modal.motion, Some(Motion::Cycle(_)));
        if is_cycle && self.mirror[self.modal.plane.normal()].is_some() && block.is_programmed() {
            let condition = "the axis of its holes is mirrored";
            return Err(combination("a canned cycle", condition, "end the mirror image before"));
        }
        for (axis, centre) in self.mirror.into_iter().enumerate() {
            let Some(centre) = centre else { continue };
            // In the unit of the program.
            let centre = centre / self.modal.millimetres(1.0);
            if let Some(value) = block.value(AXES[axis]) {
                let is_increment = self.is_incremental(block, AXES[axis]);
                block.set(AXES[axis], if is_increment { -value } else { 2.0 * centre - value });
            }
            let letter = ['I', 'J', 'K'][axis];
            if let (Some(value), false) = (block.value(letter), is_cycle) {
                let is_absolute = self.modal.absolute_centres == Some(true);
                block.set(letter, if is_absolute { 2.0 * centre - value } else { -value });
            }
        }
        Ok(())
    }
}

//! Motions: lines and arcs, in Cartesian and in polar coordinates, corners between lines.
//!
//! Coordinates are those of the program, before its axes are mirrored. An increment is from the last programmed position, which a
//! rounded corner does not reach. The arcs of CC, C and CP are in the plane of the two axes of the pole; angles are from X in XY,
//! from Y in YZ and from Z in ZX (TNC 640, *Klartext programming*, "Setting the pole and angle reference axis").

use super::Program;
use super::block::{Coordinate, Feed, Scale, Side, Words};
use super::flow::Ahead;
use super::line::{Cursor, expected};
use crate::gcode::block::{Code, Number};
use crate::gcode::control::{Circle, Control, Corner, CornerShape, Curve};
use crate::gcode::error::{combination, missing, not_read};
use crate::gcode::state::{Position, Rotation};
use crate::gcode::{GcodeFault, Plane, StepPath};
use crate::machine::sin_cos_degrees;
use nalgebra::Matrix3;

/// Letters of the axes.
const AXES: [char; 6] = ['X', 'Y', 'Z', 'A', 'B', 'C'];

/// Distance in millimetres below which two points are the same.
const SAME_POINT: f64 = 1e-5;

/// State that a motion leaves for the next ones.
#[derive(Clone, Debug)]
pub(super) struct Before {
    /// The pole, in millimetres, and the plane of its two axes.
    pole: [Option<f64>; 3],
    plane: Plane,
    /// Direction in X and Y at the end of the last motion, of any length.
    heading: Option<[f64; 2]>,
}

impl Before {
    pub(super) fn new() -> Before {
        Before { pole: [None; 3], plane: Plane::Xy, heading: None }
    }

    /// Forgets the motion, after which something else has moved the axes.
    pub(super) fn leave(&mut self) {
        self.heading = None;
    }

    /// Forgets what depends on the coordinates, which have changed.
    pub(super) fn forget(&mut self) {
        *self = Before::new();
    }
}

impl Program<'_> {
    /// Executes a statement of a motion after its first word.
    pub(super) fn motion(
        &mut self,
        head: &'static str,
        cursor: &mut Cursor,
        control: &mut Control,
    ) -> Result<super::Progress, GcodeFault> {
        self.codes.clear();
        let scale = Scale::new(&self.parameters, self.unit);
        let words = scale.words(cursor, &mut self.codes)?;
        words.check_used(head)?;
        // Words of an arc and polar ones move, also without a coordinate of an axis.
        let has_end = words.has_axes() || head != "L";
        self.start_words(control)?;
        if words.is_machine || words.retract.is_some() {
            control.check_corner()?;
        }
        if words.is_machine {
            if head != "L" {
                let remedy = "write L with M91";
                return Err(combination(head, "its block has M91", remedy));
            }
            if (self.is_modal_call || words.is_modal_call) && !words.is_call {
                let condition = "M89 is in force, which calls the cycle after each position";
                return Err(combination("M91", condition, "end M89 with M99 before"));
            }
            self.machine_position(&words, control)?;
        } else {
            match head {
                "L" => self.line(words, control)?,
                "LP" => {
                    let words = self.cartesian(words, control)?;
                    self.line(words, control)?;
                }
                _ if !words.has_axes() && head != "CP" && head != "CTP" => {
                    return Err(missing(head, "the coordinates of its end"));
                }
                "CT" => self.tangent_arc(head, words, control)?,
                "CTP" => {
                    let words = self.cartesian(words, control)?;
                    self.tangent_arc(head, words, control)?;
                }
                _ => self.arc(head, words, control)?,
            }
        }
        if let Some(retract) = words.retract {
            if has_end {
                let condition = "its block has coordinates, before or after which it moves";
                return Err(combination("M140", condition, "write it in a block of its own"));
            }
            control.check_uncompensated("M140")?;
            self.before.heading = None;
            control.retract(retract.distance, retract.rapid);
        }
        let is_motion = has_end && !words.is_machine;
        if words.is_modal_call {
            self.is_modal_call = true;
        }
        if words.is_call || self.is_modal_call && is_motion {
            self.is_modal_call &= !words.is_call;
            self.call_cycle(0.0, control)?;
        }
        self.end_words(control)
    }

    /// Returns the last programmed position.
    fn position(&self, control: &Control) -> Position {
        let mut position = control.position();
        for (value, sign) in position.iter_mut().zip(self.frame.mirror) {
            *value = value.map(|value| value * sign);
        }
        position
    }

    /// Executes a line to the coordinates of a block.
    pub(super) fn line(&mut self, words: Words, control: &mut Control) -> Result<(), GcodeFault> {
        self.block.clear();
        self.add_feed(&words)?;
        self.add_side(&words)?;
        if !words.has_axes() {
            return control.execute(&mut self.block);
        }
        if words.axes.contains(&Some(Coordinate::OfPlane)) {
            control.check_uncompensated("Q120")?;
            return self.turn_to_plane(&words, control);
        }
        self.check_coordinates(&words, control)?;
        self.block.corner = self.take_corner()?;
        let start = self.position(control);
        let is_open = self.add_end(&words, start)?;
        let tenths = if words.is_rapid() { 0 } else { 10 };
        self.block.add_code(Code { letter: 'G', tenths })?;
        control.execute(&mut self.block).map_err(|fault| match fault {
            GcodeFault::NoFeed { inverse, .. } => {
                GcodeFault::NoFeed { word: "L".to_owned(), inverse }
            }
            fault => fault,
        })?;
        if is_open {
            self.block.clear();
            self.block.add_code(Code { letter: 'G', tenths: 900 })?;
            control.execute(&mut self.block)?;
        }
        // The way of an axis by an increment is stated.
        if words.axes[3..].iter().any(|word| matches!(word, Some(Coordinate::Incremental(_)))) {
            control.pending.iter_mut().for_each(|step| step.absolute = false);
        }
        let end = self.position(control);
        self.before.heading = direction(start, end);
        self.positioned = true;
        Ok(())
    }

    /// Adds the coordinates of the end to the block. Returns whether they are all increments from a position that is not known.
    fn add_end(&mut self, words: &Words, start: Position) -> Result<bool, GcodeFault> {
        let mut increments = [0, 0];
        let mut unknown = None;
        for (axis, coordinate) in words.axes.iter().enumerate() {
            let Some(coordinate) = coordinate else { continue };
            let is_increment = matches!(coordinate, Coordinate::Incremental(_));
            increments[usize::from(is_increment)] += 1;
            if is_increment && start[axis].is_none() {
                unknown = Some(axis);
            }
        }
        if let Some(axis) = unknown
            && increments[0] > 0
        {
            let condition =
                "its block has an absolute coordinate and its position before is not known";
            let remedy = "write it absolute";
            return Err(combination(format!("I{}", AXES[axis]), condition, remedy));
        }
        let rotary = words.axes[3..].iter().flatten();
        let mut is_increment = rotary.map(|word| matches!(word, Coordinate::Incremental(_)));
        if let Some(first) = is_increment.next()
            && is_increment.any(|other| other != first)
        {
            let condition = "its block has another rotary axis, absolute and by an increment";
            return Err(combination("a rotary axis", condition, "write both in one way"));
        }
        let is_open = unknown.is_some();
        if is_open {
            self.block.add_code(Code { letter: 'G', tenths: 910 })?;
        }
        for (axis, coordinate) in words.axes.iter().enumerate() {
            let value = match coordinate {
                Some(Coordinate::Absolute(value)) => *value,
                Some(Coordinate::Incremental(value)) if is_open => *value,
                Some(Coordinate::Incremental(value)) => start[axis].unwrap_or_default() + value,
                Some(Coordinate::OfPlane) | None => continue,
            };
            let sign = self.frame.mirror.get(axis).copied().unwrap_or(1.0);
            self.block.add(AXES[axis], number(sign * value))?;
        }
        Ok(is_open)
    }

    /// Adds the word of cutter compensation.
    fn add_side(&mut self, words: &Words) -> Result<(), GcodeFault> {
        let Some(side) = words.side else { return Ok(()) };
        if side != Side::On && self.frame.is_mirrored() {
            let condition = "axes are mirrored (CYCL DEF 8), which can exchange the sides";
            return Err(combination(side.word(), condition, "end that before"));
        }
        self.block.add_code(side.code())
    }

    /// Refuses another side than that in force in the block of an arc: the first motion of compensation and the last are lines.
    fn check_side(&self, words: &Words, control: &Control) -> Result<(), GcodeFault> {
        let Some(side) = words.side else { return Ok(()) };
        let in_force = control.compensation_code().map_or(400, |code| code.tenths);
        match in_force == side.code().tenths {
            true => Ok(()),
            false => {
                let condition = "its block has an arc, and begins or ends cutter compensation";
                Err(combination(side.word(), condition, "write it in a block with L"))
            }
        }
    }

    /// Adds the feed of a block.
    fn add_feed(&mut self, words: &Words) -> Result<(), GcodeFault> {
        let rate = match words.feed {
            Some(Feed::Rate(rate)) => rate,
            Some(Feed::OfTool) => {
                let feed = self.tool_feed;
                feed.ok_or_else(|| missing("F AUTO", "F in the TOOL CALL before"))?
            }
            Some(Feed::Rapid) | None => return Ok(()),
        };
        self.block.add('F', number(rate))
    }

    /// Executes a motion to machine coordinates.
    fn machine_position(&mut self, words: &Words, control: &mut Control) -> Result<(), GcodeFault> {
        self.block.clear();
        self.add_feed(words)?;
        for (axis, coordinate) in words.axes.iter().enumerate() {
            match coordinate {
                Some(Coordinate::Absolute(value)) => self.block.add(AXES[axis], number(*value))?,
                Some(_) => {
                    let condition = "its block has M91, in which it is from the last such position";
                    let remedy = "write it absolute";
                    return Err(combination(format!("I{}", AXES[axis]), condition, remedy));
                }
                None => {}
            }
        }
        if !words.has_axes() {
            return Err(missing("M91", "a coordinate"));
        }
        control.check_uncompensated("M91")?;
        self.before.heading = None;
        control.machine_position(&mut self.block, words.is_rapid(), words.is_from_point)
    }

    /// Refuses coordinates whose meaning depends on what stands before them.
    fn check_coordinates(
        &mut self,
        words: &Words,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        if let Some(condition) = self.frame.doubt {
            let remedy = "write the shift anew (CYCL DEF 7) without a tilted plane";
            return Err(combination("a position", condition, remedy));
        }
        let has_linear = words.axes[..3].iter().any(Option::is_some);
        let has_rotary = words.axes[3..].iter().any(Option::is_some);
        if let Rotation::Tilted { aligned, frame } = control.rotation() {
            // A plane that keeps z needs no turn of axes at 0.
            let is_upright = frame.rotation[(2, 2)] == 1.0 && control.turns_nothing();
            if has_rotary && (aligned || has_linear) && frame.rotation != Matrix3::identity() {
                let condition = "a plane is tilted, in which the axes turn by themselves";
                let remedy =
                    "turn them in a block of its own after PLANE, or write PLANE RESET before";
                return Err(combination("a rotary axis", condition, remedy));
            }
            if !aligned && has_linear && !is_upright {
                let angles = control.position().into_iter().skip(3).zip(control.rotary_axes());
                let mut turned = angles.filter(|(_, has_axis)| *has_axis).peekable();
                // Angles that the program has stated are compared with the plane on the machine.
                if turned.peek().is_none() || turned.any(|(angle, _)| angle.is_none()) {
                    let condition = "the tool does not stand along z of the tilted plane";
                    let remedy = "write TURN in PLANE, or L A+Q120 B+Q121 C+Q122 after it";
                    return Err(combination("a position", condition, remedy));
                }
                control.stand_along_plane();
                self.frame.stand();
            }
        }
        if control.is_rotation_open() && words.axes[0].is_some() != words.axes[1].is_some() {
            let condition = "it is the first after a rotation, and not of both axes of the plane";
            return Err(combination("a position", condition, "write X and Y"));
        }
        Ok(())
    }

    /// Refuses a motion along Z whose meaning depends on what stands before it.
    pub(super) fn check_level(&mut self, control: &mut Control) -> Result<(), GcodeFault> {
        let mut words = Words::default();
        words.axes[2] = Some(Coordinate::Absolute(0.0));
        self.check_coordinates(&words, control)
    }

    /// Executes CC.
    pub(super) fn pole(
        &mut self,
        cursor: &mut Cursor,
        control: &Control,
    ) -> Result<(), GcodeFault> {
        let mut codes = Vec::new();
        let words = Scale::new(&self.parameters, self.unit).words(cursor, &mut codes)?;
        let position = self.position(control);
        let named = [0, 1, 2].map(|axis| words.axes[axis].is_some());
        let has_more =
            words.axes[3..].iter().any(Option::is_some) || !words.is_plain() || !codes.is_empty();
        if has_more || named == [true; 3] {
            return Err(expected("CC", "two coordinates of X, Y and Z after CC, or none"));
        }
        self.before.plane = match named {
            [true, true, _] | [false, false, false] => Plane::Xy,
            [_, true, true] => Plane::Yz,
            [true, _, true] => Plane::Zx,
            // One coordinate changes, the other stays.
            _ => self.before.plane,
        };
        let axes = self.before.plane.axes();
        if let Some(axis) = (0..3).find(|axis| named[*axis] && !axes.contains(axis)) {
            let needed = "both coordinates of the pole, since the one before is in another plane";
            return Err(missing(format!("CC {}", AXES[axis]), needed));
        }
        for axis in axes {
            self.before.pole[axis] = match words.axes[axis] {
                Some(Coordinate::Absolute(value)) => Some(value),
                Some(Coordinate::Incremental(value)) => position[axis].map(|base| base + value),
                _ if named == [false; 3] => position[axis],
                _ => self.before.pole[axis],
            };
        }
        Ok(())
    }

    /// Returns the pole along both axes of its plane.
    fn centre(&self, head: &'static str) -> Result<[f64; 2], GcodeFault> {
        let [first, second] = self.before.plane.axes().map(|axis| self.before.pole[axis]);
        match (first, second) {
            (Some(first), Some(second)) => Ok([first, second]),
            _ => Err(missing(head, "the pole CC before, in the coordinates that hold now")),
        }
    }

    /// Returns the last programmed position along both axes of a plane.
    fn in_plane(
        &self,
        head: &'static str,
        plane: Plane,
        control: &Control,
    ) -> Result<[f64; 2], GcodeFault> {
        let position = self.position(control);
        let [first, second] = plane.axes().map(|axis| position[axis]);
        first.zip(second).map(|(first, second)| [first, second]).ok_or_else(|| {
            let remedy = "write L with both coordinates of the plane before";
            combination(head, "the position before it is not known", remedy)
        })
    }

    /// Replaces the polar coordinates of a block by Cartesian ones.
    fn cartesian(&self, mut words: Words, control: &Control) -> Result<Words, GcodeFault> {
        let centre = self.centre("LP")?;
        let axes = self.before.plane.axes();
        if axes.iter().any(|axis| words.axes[*axis].is_some()) {
            let wanted = "PR and PA instead of coordinates in the plane of the pole";
            return Err(expected("LP", wanted));
        }
        // Coordinates that are left out stay as they are.
        let is_whole = matches!(
            (words.polar_radius, words.polar_angle),
            (Some(Coordinate::Absolute(_)), Some(Coordinate::Absolute(_)))
        );
        let (mut radius, mut angle) = (0.0, 0.0);
        if !is_whole {
            let start = self.in_plane("LP", self.before.plane, control)?;
            let [across, up] = [start[0] - centre[0], start[1] - centre[1]];
            radius = across.hypot(up);
            angle = up.atan2(across).to_degrees();
        }
        match words.polar_radius {
            Some(Coordinate::Absolute(value)) => radius = value,
            Some(Coordinate::Incremental(value)) => radius += value,
            _ => {}
        }
        match words.polar_angle {
            Some(Coordinate::Absolute(value)) => angle = value,
            Some(Coordinate::Incremental(value)) => angle += value,
            _ => {}
        }
        let (sine, cosine) = sin_cos_degrees(angle);
        words.axes[axes[0]] = Some(Coordinate::Absolute(centre[0] + radius * cosine));
        words.axes[axes[1]] = Some(Coordinate::Absolute(centre[1] + radius * sine));
        Ok(words)
    }

    /// Executes C, CR or CP.
    fn arc(
        &mut self,
        head: &'static str,
        mut words: Words,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        let clockwise = words.clockwise.ok_or_else(|| missing(head, "DR+ or DR-"))?;
        let (plane, curve) = match head {
            "C" => (self.before.plane, Curve::Centre { centre: self.centre(head)?, clockwise }),
            "CR" => {
                let radius = words.radius.ok_or_else(|| missing(head, "the radius R"))?;
                let plane = match [0, 1, 2].map(|axis| words.axes[axis].is_some()) {
                    [true, false, true] => Plane::Zx,
                    [false, true, true] => Plane::Yz,
                    _ => Plane::Xy,
                };
                (plane, Curve::Radius { radius, clockwise })
            }
            _ => (self.before.plane, self.turn(&mut words, clockwise, control)?),
        };
        self.circle(head, &words, plane, curve, control)
    }

    /// Returns the curve of CP, and adds its end to the words.
    fn turn(
        &self,
        words: &mut Words,
        clockwise: bool,
        control: &Control,
    ) -> Result<Curve, GcodeFault> {
        let centre = self.centre("CP")?;
        let axes = self.before.plane.axes();
        if axes.iter().any(|axis| words.axes[*axis].is_some()) {
            return Err(expected(
                "CP",
                "PA or IPA instead of coordinates in the plane of the pole",
            ));
        }
        let start = self.in_plane("CP", self.before.plane, control)?;
        let [across, up] = [start[0] - centre[0], start[1] - centre[1]];
        let radius = across.hypot(up);
        if radius < SAME_POINT {
            return Err(crate::gcode::ArcFault::ZeroRadius.into());
        }
        let (end, sweep) = match words.polar_angle {
            Some(Coordinate::Incremental(angle)) => {
                if angle == 0.0 || (angle < 0.0) != clockwise {
                    let condition = "DR has the other sign";
                    let remedy = "write both with one sign";
                    return Err(combination(format!("IPA{angle}"), condition, remedy));
                }
                let (sine, cosine) = sin_cos_degrees(angle);
                let end = [across * cosine - up * sine, across * sine + up * cosine];
                (end, angle.to_radians())
            }
            Some(Coordinate::Absolute(angle)) => {
                let (sine, cosine) = sin_cos_degrees(angle);
                let end = [radius * cosine, radius * sine];
                let (cross, dot) = (across * end[1] - up * end[0], across * end[0] + up * end[1]);
                let turn = cross.atan2(dot);
                let is_full = (end[0] - across).hypot(end[1] - up) < SAME_POINT;
                let sweep = match (is_full, clockwise) {
                    (true, _) => std::f64::consts::TAU,
                    (false, false) => turn.rem_euclid(std::f64::consts::TAU),
                    (false, true) => (-turn).rem_euclid(std::f64::consts::TAU),
                };
                (end, if clockwise { -sweep } else { sweep })
            }
            _ => return Err(missing("CP", "PA or IPA")),
        };
        for (k, axis) in axes.into_iter().enumerate() {
            words.axes[axis] = Some(Coordinate::Absolute(centre[k] + end[k]));
        }
        Ok(Curve::Sweep { centre, sweep })
    }

    /// Executes CT.
    fn tangent_arc(
        &mut self,
        head: &'static str,
        words: Words,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        let start = self.in_plane(head, Plane::Xy, control)?;
        let Some(heading) = self.before.heading else {
            return Err(missing(head, "a motion of X or Y in the block before"));
        };
        let mut end = start;
        for (axis, value) in end.iter_mut().enumerate() {
            match words.axes[axis] {
                Some(Coordinate::Absolute(coordinate)) => *value = coordinate,
                Some(Coordinate::Incremental(increment)) => *value += increment,
                _ => {}
            }
        }
        let length = heading[0].hypot(heading[1]);
        let ahead = heading.map(|value| value / length);
        let chord = [end[0] - start[0], end[1] - start[1]];
        let (cross, dot) =
            (ahead[0] * chord[1] - ahead[1] * chord[0], ahead[0] * chord[0] + ahead[1] * chord[1]);
        let squared = chord[0] * chord[0] + chord[1] * chord[1];
        // The height of the chord over the tangent: an arc of so large a radius is a line, or runs backwards.
        if cross.abs() < SAME_POINT {
            let condition = "its end lies on the tangent of the motion before";
            return Err(combination(head, condition, "write L"));
        }
        let radius = squared / (2.0 * cross);
        let centre = [start[0] - radius * ahead[1], start[1] + radius * ahead[0]];
        let sweep = 2.0 * cross.atan2(dot);
        self.circle(head, &words, Plane::Xy, Curve::Sweep { centre, sweep }, control)
    }

    /// Executes an arc, in mirrored axes where they are.
    fn circle(
        &mut self,
        head: &'static str,
        words: &Words,
        plane: Plane,
        curve: Curve,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        self.check_coordinates(words, control)?;
        self.check_side(words, control)?;
        self.block.clear();
        self.block.corner = self.take_corner()?;
        self.add_feed(words)?;
        let start = self.position(control);
        if self.add_end(words, start)? {
            let condition = "the position before it is not known";
            return Err(combination(head, condition, "write its end absolute"));
        }
        let [first, second] = plane.axes().map(|axis| self.frame.mirror[axis]);
        let turned = first * second < 0.0;
        let mirror = |[u, v]: [f64; 2]| [first * u, second * v];
        let curve = match curve {
            Curve::Centre { centre, clockwise } => {
                Curve::Centre { centre: mirror(centre), clockwise: clockwise != turned }
            }
            Curve::Radius { radius, clockwise } => {
                Curve::Radius { radius, clockwise: clockwise != turned }
            }
            Curve::Sweep { centre, sweep } => {
                Curve::Sweep { centre: mirror(centre), sweep: if turned { -sweep } else { sweep } }
            }
        };
        let rapid = words.is_rapid();
        let circle = Circle { word: head, plane, curve, rapid, unit: self.unit };
        let path = control.circle(&mut self.block, circle)?;
        self.before.heading = self.heading_after(path, control);
        self.positioned = true;
        Ok(())
    }

    /// Returns the direction at the end of an arc, at the present position.
    fn heading_after(&self, path: StepPath, control: &Control) -> Option<[f64; 2]> {
        let StepPath::Arc { plane: Plane::Xy, centre, sweep } = path else { return None };
        let [x, y, ..] = control.position();
        let [x, y] = [x? - centre[0], y? - centre[1]];
        let [first, second, _] = self.frame.mirror;
        Some([-y * sweep.signum() * first, x * sweep.signum() * second])
    }

    /// Returns the corner that the next block states, if it states one, and passes over the block.
    fn take_corner(&mut self) -> Result<Option<Corner>, GcodeFault> {
        let Some(Ahead { mut cursor, is_optional, after }) = self.flow.ahead(self.flow.place())
        else {
            return Ok(None);
        };
        let is_round = match cursor.peek() {
            Some(b'R') if cursor.take_word("RND") => true,
            Some(b'C') if cursor.take_word("CHF") => false,
            _ => return Ok(None),
        };
        if is_optional {
            let meaning = "a corner in an optional block";
            return Err(not_read("/", meaning, "write the corner without `/`"));
        }
        let scale = Scale::new(&self.parameters, self.unit);
        if is_round && !cursor.take(b'R') {
            return Err(cursor.unexpected("the radius R after RND"));
        }
        let length = scale.length(&mut cursor)?;
        if matches!(cursor.peek(), Some(b'F' | b'f')) {
            scale.feed(&mut cursor)?;
        }
        cursor.check_end()?;
        self.flow.go_on_at(after);
        let (word, shape) = match is_round {
            true => ("RND", CornerShape::Round),
            // At another corner the length can be that of the chamfer or of what it takes of each line.
            false => ("CHF", CornerShape::SquareChamfer),
        };
        Ok(Some(Corner { word, shape, length, is_whole: false }))
    }
}

/// Returns a number of a block.
pub(super) fn number(value: f64) -> Number {
    Number { value, is_whole: false, is_computed: false }
}

/// Returns the direction of a line in X and Y, if it moves there.
fn direction(start: Position, end: Position) -> Option<[f64; 2]> {
    let direction = [end[0]? - start[0]?, end[1]? - start[1]?];
    (direction != [0.0, 0.0]).then_some(direction)
}

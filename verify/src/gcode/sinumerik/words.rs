//! The words of a block: addresses with values, G and M words, and names.

use super::expression::{Value, expression, number, unsigned};
use super::table::{Use, use_of};
use super::text::Cursor;
use super::{OrientationFrame, Program, no_subprogram, undefined};
use crate::gcode::block::{Block, Code, Distance, Group, Keyword, Number};
use crate::gcode::control::{Control, Corner, CornerShape, FrameStep};
use crate::gcode::error::{combination, missing, not_read};
use crate::gcode::interpreter::Progress;
use crate::gcode::note::NoteKind;
use crate::gcode::rules::Choice;
use crate::gcode::state::{WorkOffset, about};
use crate::gcode::{ExpressionFault, GcodeFault, LARGEST_NUMBER, shown};
use nalgebra::Matrix3;

/// Words of a line that are no part of its block.
#[derive(Clone, Copy, Debug, Default)]
struct Words {
    assigns: bool,
    /// Set if the block has a word that the setup ignores, to which letters of the block can belong.
    ignores: bool,
    /// Components of the tool vector, after `A3=`, `B3=` and `C3=`.
    vector: [Option<f64>; 3],
    /// The number after D.
    edge: Option<f64>,
    /// The number after S, which is a time beside G4.
    speed: Option<f64>,
    /// G500 and G505 to G599.
    offset: Option<WorkOffset>,
    /// Set by G60, and false by G64 and its like.
    exact_path: Option<bool>,
    /// M17.
    returns: bool,
}

/// A value of an axis.
struct AxisValue {
    value: f64,
    /// Stated by `AC(…)`, `IC(…)` or `DC(…)`, which hold for the axis alone.
    distance: Option<Distance>,
}

impl<'a> Program<'a> {
    /// Returns the tool axis between two positions of the rotary axes, if it is that on every machine: ORIMKS and ORIWKS decide it as
    /// delivered, and ORIAXES and ORIVECT where MD21104 is set (*NC programming*, section on the reference of the orientation axes).
    fn orientation(&self) -> Option<Choice> {
        match (self.orientation_frame?, self.interpolation?) {
            (OrientationFrame::Machine, Choice::ByAxes) => Some(Choice::ByAxes),
            (OrientationFrame::Workpiece, Choice::GreatCircle) => Some(Choice::GreatCircle),
            _ => None,
        }
    }

    /// Executes a block.
    pub(super) fn words(
        &mut self,
        cursor: Cursor<'a>,
        control: &mut Control,
    ) -> Result<Progress, GcodeFault> {
        let mut block = std::mem::take(&mut self.block);
        let result = self.block(cursor, &mut block, control);
        self.block = block;
        result
    }

    fn block(
        &mut self,
        mut cursor: Cursor<'a>,
        block: &mut Block,
        control: &mut Control,
    ) -> Result<Progress, GcodeFault> {
        block.clear();
        let mut words = Words::default();
        while !cursor.is_at_end() {
            let name = { cursor }.name();
            match name.as_bytes() {
                [] => return Err(unexpected(&cursor)),
                [first] => self.address(*first, &mut cursor, block, &mut words, control)?,
                [first, second, ..] if second.is_ascii_digit() => {
                    self.address(*first, &mut cursor, block, &mut words, control)?;
                }
                _ => self.name(&mut cursor, block, &mut words, control)?,
            }
        }
        let Words { vector, edge, speed, offset, exact_path, returns, assigns, ignores } = words;
        if let Some(speed) = speed
            && block.code_of(Group::Dwell).is_none()
        {
            block.add('S', plain(speed))?;
        }
        if vector.iter().any(Option::is_some) {
            if self.orientation_frame == Some(OrientationFrame::Machine) {
                let condition = "ORIMKS is in force, under which it is in the frame of the machine";
                return Err(combination("A3=", condition, "write ORIWKS before"));
            }
            block.vector = Some(vector.map(|component| component.unwrap_or(0.0)));
        }
        let is_free_edge = edge == Some(0.0) && control.is_without_tool();
        if let Some(edge) = edge.filter(|_| !is_free_edge) {
            block.add('D', plain(edge))?;
        }
        // Assignments have a block of their own (*NC programming*, section on R parameters).
        let is_empty =
            block.is_empty() && block.vector.is_none() && !is_free_edge && offset.is_none();
        if assigns && !is_empty {
            let condition = "its block has addresses, which may be computed before or after it";
            return Err(combination("an assignment", condition, "write it in a block before"));
        }
        if is_free_edge {
            control.deselect_length();
        }
        if let Some(offset) = offset {
            control.settable_offset(offset, block)?;
        }
        if let Some(exact) = exact_path {
            control.modal.exact_path = exact;
        }
        let is_transformation = block.keyword.is_some();
        if is_transformation {
            control.check_no_frame()?;
        }
        // The centre of a full circle moves without an end.
        let is_motion = block.has_any("XYZIJK");
        if self.modal_hole.is_some()
            && !is_motion
            && (block.has_any("ABC") || block.vector.is_some())
        {
            let condition = "MCALL is in force, and its block has none of X, Y and Z";
            return Err(combination("a rotary axis", condition, "write MCALL alone before"));
        }
        // The control calls the cycle also after F, S or a motion word alone.
        let is_path = block.has_any("FS") || block.code_of(Group::Motion).is_some();
        if self.modal_hole.is_some() && !is_motion && is_path {
            let condition = "MCALL is in force, and its block has none of X, Y and Z";
            let remedy = "write it before MCALL or in the block of a position";
            return Err(combination("F, S or a motion word", condition, remedy));
        }
        if !block.is_empty() || block.vector.is_some() {
            control.execute(block)?;
            self.flow.count_steps(control.pending.len())?;
            if ignores {
                // Letters that no other word has used belong to an ignored one.
                block.drop_letters("PQLRDHE");
            }
            block.check_used()?;
        }
        if let Some(hole) = self.modal_hole.as_ref().filter(|_| is_motion) {
            control.drill(hole)?;
            self.flow.count_steps(control.pending.len())?;
        }
        match block.tenths_of(Group::Stop) {
            Some(20 | 300) => return Ok(self.leave(control)),
            Some(_) => {
                control.pause_spindle();
                control.notes.add(control.block(), NoteKind::Stop);
            }
            None => {}
        }
        Ok(if returns { self.leave(control) } else { Progress::GoesOn })
    }

    /// Reads an address of one letter with its value, or an R parameter.
    fn address(
        &mut self,
        first: u8,
        cursor: &mut Cursor<'a>,
        block: &mut Block,
        words: &mut Words,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        let begin = *cursor;
        let letter = char::from(first).to_ascii_uppercase();
        cursor.advance();
        let mut ahead = *cursor;
        let digits = ahead.take_while(|byte| byte.is_ascii_digit());
        if letter == 'R' && (!digits.is_empty() || cursor.byte() == Some(b'[')) {
            *cursor = begin;
            return self.assign(cursor, words);
        }
        if !digits.is_empty() && ahead.take_assignment() {
            *cursor = ahead;
            return self.extended(letter, digits, cursor, words, control);
        }
        match letter {
            'G' | 'M' => {
                let code = self.code(letter, cursor)?;
                if control.ignores(&code.to_string()) {
                    words.ignores = true;
                    control.ignore(code.to_string());
                    return Ok(());
                }
                if letter == 'G' { g_word(code, block, words) } else { m_word(code, block, words) }
            }
            'X' | 'Y' | 'Z' | 'A' | 'B' | 'C' | 'I' | 'J' | 'K' => {
                let AxisValue { value, distance } = self.axis_value(letter, cursor)?;
                block.add(letter, plain(value))?;
                if let Some(distance) = distance {
                    block.set_distance(letter, distance);
                }
                Ok(())
            }
            'D' => once(letter, &mut words.edge, self.value(letter, cursor)?),
            'S' => once(letter, &mut words.speed, self.value(letter, cursor)?),
            'T' => {
                let tool = self.tool(cursor, control)?;
                block.add('T', plain(tool))
            }
            // A word for the machine's logic, which moves no axis of the path.
            'H' => {
                self.value(letter, cursor)?;
                control.notes.add(control.block(), NoteKind::PassedOver { word: "H".to_owned() });
                Ok(())
            }
            'U' | 'V' | 'W' => Err(GcodeFault::Axis { word: letter }),
            'F' => block.add('F', plain(self.value(letter, cursor)?)),
            'L' => {
                Err(no_subprogram(begin.rest().split([' ', ';', '\t']).next().unwrap_or_default()))
            }
            // An argument of an ignored word.
            _ if words.ignores => self.value(letter, cursor).map(drop),
            _ => Err(GcodeFault::Unused { word: letter }),
        }
    }

    /// Reads an address with a number of its own, and a value after `=`: `A3=0.5`.
    fn extended(
        &mut self,
        letter: char,
        digits: &str,
        cursor: &mut Cursor,
        words: &mut Words,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        let word = format!("{letter}{digits}=");
        match (letter, digits) {
            ('A'..='C', "3") => {
                let component = usize::from(letter as u8 - b'A');
                once(letter, &mut words.vector[component], number(cursor, &self.variables)?)
            }
            ('A'..='C', "2" | "4" | "5" | "6" | "7") => {
                let meaning = "another form of tool orientation, or a normal of the surface";
                Err(not_read(word, meaning, "write A3= B3= C3=, or rotary axes"))
            }
            ('I' | 'J' | 'K', "1") => {
                let meaning = "a point on an arc (CIP)";
                Err(not_read(word, meaning, "post the program with lines and arcs"))
            }
            // A word for the machine's logic.
            ('H', _) => {
                number(cursor, &self.variables)?;
                control.notes.add(control.block(), NoteKind::PassedOver { word });
                Ok(())
            }
            ('S' | 'M', _) => {
                let meaning = "a word for one of several spindles";
                Err(not_read(word, meaning, "write S or M without its number"))
            }
            _ => {
                let meaning = "an address with a number of its own, such as an axis of the machine";
                Err(not_read(word, meaning, "post the program with X Y Z A B C"))
            }
        }
    }

    /// Reads a word that begins with a name of several letters.
    fn name(
        &mut self,
        cursor: &mut Cursor<'a>,
        block: &mut Block,
        words: &mut Words,
        control: &mut Control,
    ) -> Result<(), GcodeFault> {
        let mut after = *cursor;
        let name = after.name();
        if self.variables.find(name).is_some() {
            return self.assign(cursor, words);
        }
        *cursor = after;
        let upper = name.to_ascii_uppercase();
        if control.ignores(&upper) {
            words.ignores = true;
            self.pass_over(cursor)?;
            control.ignore(upper);
            return Ok(());
        }
        match upper.as_str() {
            "SUPA" => block.add_code(Code { letter: 'G', tenths: 530 }),
            "TRAORI" => transformation(cursor, block, Keyword::TransformationOn, name),
            "TRAFOOF" => transformation(cursor, block, Keyword::TransformationOff, name),
            "ORIWKS" | "ORIMKS" => {
                self.orientation_frame = Some(match upper.as_str() {
                    "ORIMKS" => OrientationFrame::Machine,
                    _ => OrientationFrame::Workpiece,
                });
                control.interpolate_orientation(self.orientation());
                Ok(())
            }
            "ORIAXES" | "ORIVECT" | "ORIPLANE" => {
                let is_by_axes = upper == "ORIAXES";
                self.interpolation =
                    Some(if is_by_axes { Choice::ByAxes } else { Choice::GreatCircle });
                control.interpolate_orientation(self.orientation());
                Ok(())
            }
            "CR" if cursor.take_assignment() => {
                block.add('R', plain(number(cursor, &self.variables)?))
            }
            "RND" | "CHR" | "CHF" if cursor.take_assignment() => {
                let (word, shape) = match upper.as_str() {
                    "RND" => ("RND", CornerShape::Round),
                    "CHR" => ("CHR", CornerShape::Chamfer),
                    _ => ("CHF", CornerShape::Chord),
                };
                let length = number(cursor, &self.variables)?;
                let corner = Corner { word, shape, length, is_whole: false };
                match block.corner.replace(corner) {
                    None => Ok(()),
                    Some(_) => Err(combination(word, "its block has another corner", "keep one")),
                }
            }
            "TURN" if cursor.take_assignment() => {
                let value = number(cursor, &self.variables)?;
                if value.fract() != 0.0 || !(0.0..=999.0).contains(&value) {
                    let expected = "a whole number from 0 to 999 after TURN";
                    return Err(GcodeFault::NotAllowed { word: 'P', value, expected });
                }
                block.full_turns = value as u32;
                Ok(())
            }
            // The spindle stops at an angle, as by M19.
            "SPOS" => {
                if cursor.peek() == Some(b'[') && cursor.bracketed([b'[', b']']).is_none() {
                    return Err(missing("SPOS", "the bracket `]` of its spindle"));
                }
                if !cursor.take_assignment() {
                    return Err(missing("SPOS", "`=` and an angle"));
                }
                self.axis_argument(cursor)?;
                block.add_code(Code { letter: 'M', tenths: 190 })
            }
            _ => match use_of(name) {
                Some(Use::PassedOver) => {
                    if upper == "CYCLE832" {
                        self.check_high_speed(*cursor)?;
                    }
                    self.pass_over(cursor)?;
                    control.notes.add(control.block(), NoteKind::PassedOver { word: upper });
                    Ok(())
                }
                Some(Use::Refused { meaning, remedy }) => Err(not_read(upper, meaning, remedy)),
                None if { *cursor }.take_assignment() || cursor.byte() == Some(b'[') => {
                    Err(undefined(name))
                }
                None => Err(no_subprogram(name)),
            },
        }
    }

    /// Refuses CYCLE832 with more in its second argument than the kind of machining: other digits of it begin or end TRAORI on
    /// controls of an older version.
    fn check_high_speed(&self, mut cursor: Cursor) -> Result<(), GcodeFault> {
        cursor.peek();
        let arguments = cursor.bracketed([b'(', b')']).unwrap_or_default();
        let kind = arguments.split(',').nth(1).unwrap_or_default().trim();
        let is_name = kind.starts_with('_') && self.variables.find(kind).is_none();
        if kind.is_empty() || is_name {
            return Ok(());
        }
        let mut kind = Cursor::new(kind);
        let value = number(&mut kind, &self.variables)?;
        // The units are the kind, the tens a tolerance of the orientation.
        let is_kind = value.fract() == 0.0 && (0.0..20.0).contains(&value) && value % 10.0 <= 4.0;
        match is_kind && kind.is_at_end() {
            true => Ok(()),
            false => {
                let meaning = "more than a kind of machining, and can begin or end TRAORI";
                let remedy = "write 0 to 4, and TRAORI or TRAFOOF in a block of its own";
                Err(not_read("argument 2 of CYCLE832", meaning, remedy))
            }
        }
    }

    /// Passes over the index, the arguments and the value of a word.
    fn pass_over(&self, cursor: &mut Cursor) -> Result<(), GcodeFault> {
        for brackets in [[b'[', b']'], [b'(', b')']] {
            if cursor.peek() == Some(brackets[0]) && cursor.bracketed(brackets).is_none() {
                return Err(ExpressionFault::OpenParenthesis.into());
            }
        }
        if cursor.take_assignment() {
            expression(cursor, &self.variables)?;
        }
        Ok(())
    }

    /// Reads an assignment `R1=5` or `NAME=5`.
    fn assign(&mut self, cursor: &mut Cursor, words: &mut Words) -> Result<(), GcodeFault> {
        let reference = self.assigned(cursor)?;
        let value = expression(cursor, &self.variables)?;
        words.assigns = true;
        self.variables.set(reference, value)
    }

    /// Reads the number of a G or M word.
    fn code(&self, letter: char, cursor: &mut Cursor) -> Result<Code, GcodeFault> {
        if cursor.peek() == Some(b'=') || cursor.byte() == Some(b'[') {
            let meaning = "a word whose number is computed";
            return Err(not_read(format!("{letter}="), meaning, "write its number"));
        }
        if !matches!(cursor.byte(), Some(b'0'..=b'9' | b'.')) {
            return Err(GcodeFault::NoNumber { word: letter });
        }
        let value = unsigned(cursor)?;
        let tenths = (10.0 * value).round();
        if (10.0 * value - tenths).abs() > 1e-9 || tenths > 99_999.0 {
            let expected = "a number with one decimal at most";
            return Err(GcodeFault::NotAllowed { word: letter, value, expected });
        }
        Ok(Code { letter, tenths: tenths as u32 })
    }

    /// Reads the value of an address: a number with a sign, or an expression after `=`.
    fn value(&self, letter: char, cursor: &mut Cursor) -> Result<f64, GcodeFault> {
        if cursor.take_assignment() {
            return bounded(letter, number(cursor, &self.variables)?);
        }
        let is_negative = cursor.peek() == Some(b'-');
        if is_negative || cursor.byte() == Some(b'+') {
            cursor.advance();
            cursor.peek();
        }
        if !matches!(cursor.byte(), Some(b'0'..=b'9' | b'.')) {
            return Err(GcodeFault::NoNumber { word: letter });
        }
        let value = unsigned(cursor)?;
        Ok(if is_negative { -value } else { value })
    }

    /// Reads the value of an axis, which can be `=AC(…)`, `=IC(…)` or `=DC(…)`.
    fn axis_value(&self, letter: char, cursor: &mut Cursor) -> Result<AxisValue, GcodeFault> {
        let mut after = *cursor;
        if after.take_assignment() {
            let name = after.name();
            let distance =
                ["AC", "IC", "DC"].iter().position(|known| name.eq_ignore_ascii_case(known));
            if ["ACP", "ACN"].iter().any(|known| name.eq_ignore_ascii_case(known))
                || distance == Some(2) && !matches!(letter, 'A' | 'B' | 'C')
            {
                let meaning = "a direction of a rotary axis";
                let remedy = "write its angle in G90, or DC";
                return Err(not_read(name.to_ascii_uppercase(), meaning, remedy));
            }
            if let Some(distance) = distance
                && after.peek() == Some(b'(')
            {
                // The bracket is that of an expression.
                *cursor = after;
                let value = bounded(letter, bracket(cursor, self)?)?;
                let distance =
                    [Distance::Absolute, Distance::Incremental, Distance::Shortest][distance];
                return Ok(AxisValue { value, distance: Some(distance) });
            }
        }
        Ok(AxisValue { value: self.value(letter, cursor)?, distance: None })
    }

    /// Reads an angle of the spindle, which can be `AC(…)` and its like.
    fn axis_argument(&self, cursor: &mut Cursor) -> Result<(), GcodeFault> {
        let mut after = *cursor;
        let is_way = ["AC", "IC", "DC", "ACP", "ACN"].iter().any(|known| after.take_name(known));
        if is_way && after.peek() == Some(b'(') {
            *cursor = after;
            return bracket(cursor, self).map(|_| ());
        }
        number(cursor, &self.variables).map(|_| ())
    }

    /// Reads the number of a tool, or its name: `T5`, `T="MILL"`. A name of digits is a number.
    fn tool(&self, cursor: &mut Cursor, control: &Control) -> Result<f64, GcodeFault> {
        if !{ *cursor }.take_assignment() {
            return self.value('T', cursor);
        }
        cursor.take_assignment();
        match expression(cursor, &self.variables)? {
            Value::Number(number) => Ok(number),
            Value::Text(name) => match control.tool_number(&name) {
                Some(number) => Ok(f64::from(number)),
                None => {
                    let meaning = "a tool by a name that the job does not state";
                    let remedy = "state `name` in its `[tool.N]`, or write its number: T5";
                    Err(not_read(format!("T={}", shown(&name)), meaning, remedy))
                }
            },
            value @ Value::Truth(_) => value.number(),
        }
    }

    /// Reads the words of a programmable frame after `TRANS`, `ATRANS`, `ROT` or `AROT`.
    pub(super) fn frame_words(
        &self,
        name: &str,
        cursor: &mut Cursor,
    ) -> Result<FrameStep, GcodeFault> {
        let upper = name.to_ascii_uppercase();
        let is_shift = upper.ends_with("TRANS");
        let mut values = [None; 6];
        let mut in_plane = None;
        while !cursor.is_at_end() {
            if cursor.take_name("RPL") && !is_shift {
                if !cursor.take_assignment() {
                    return Err(missing("RPL", "`=` and an angle"));
                }
                once('R', &mut in_plane, number(cursor, &self.variables)?)?;
                continue;
            }
            let letter = char::from(cursor.byte().unwrap_or_default()).to_ascii_uppercase();
            let axes = if is_shift { "XYZABC" } else { "XYZ" };
            let Some(axis) = axes.find(letter) else {
                let condition = "its block has other words than those of its axes";
                return Err(combination(upper, condition, "write it in a block of its own"));
            };
            cursor.advance();
            once(letter, &mut values[axis], self.value(letter, cursor)?)?;
        }
        let is_additive = upper.starts_with('A');
        let has_angles = values.iter().any(Option::is_some);
        if in_plane.is_some() && has_angles {
            let condition = "its block has RPL, too";
            return Err(combination(upper, condition, "write RPL, or the angles about X, Y and Z"));
        }
        let values = values.map(|value| value.unwrap_or(0.0));
        let [x, y, z, ..] = values;
        Ok(match (is_shift, in_plane) {
            (true, _) => FrameStep { shift: values, ..FrameStep::new(is_additive) },
            (false, Some(angle)) => FrameStep { in_plane: angle, ..FrameStep::new(is_additive) },
            // RPY angles (MD10600 = 1): about Z, then the new Y, then the new X.
            (false, None) => {
                let rotation = match has_angles {
                    true => about(2, z) * about(1, y) * about(0, x),
                    false => Matrix3::identity(),
                };
                FrameStep { rotation, ..FrameStep::new(is_additive) }
            }
        })
    }
}

/// Reads an expression in brackets, which begin here.
fn bracket(cursor: &mut Cursor, program: &Program) -> Result<f64, GcodeFault> {
    cursor.advance();
    let value = number(cursor, &program.variables)?;
    match cursor.take(b')') {
        true => Ok(value),
        false => Err(ExpressionFault::OpenParenthesis.into()),
    }
}

/// Sets a value that a block has once.
fn once(letter: char, place: &mut Option<f64>, value: f64) -> Result<(), GcodeFault> {
    match place.replace(value) {
        None => Ok(()),
        Some(_) => Err(GcodeFault::Repeated { word: letter }),
    }
}

fn bounded(letter: char, value: f64) -> Result<f64, GcodeFault> {
    match value.abs() <= LARGEST_NUMBER {
        true => Ok(value),
        false => Err(GcodeFault::TooLarge { word: letter }),
    }
}

/// Returns a number whose unit does not depend on its decimal point.
fn plain(value: f64) -> Number {
    Number { value, is_whole: false, is_computed: false }
}

/// Returns the fault of a character that begins no word.
fn unexpected(cursor: &Cursor) -> GcodeFault {
    let shown = cursor.rest().chars().take(1).flat_map(char::escape_debug).collect::<String>();
    GcodeFault::Character { shown: format!("`{shown}`") }
}

/// Adds `TRAORI` or `TRAFOOF`, whose arguments are those of the first data set without offsets.
fn transformation(
    cursor: &mut Cursor,
    block: &mut Block,
    keyword: Keyword,
    name: &str,
) -> Result<(), GcodeFault> {
    if cursor.peek() == Some(b'(') {
        let arguments = cursor.bracketed([b'(', b')']).unwrap_or("?");
        if !matches!(arguments.trim(), "" | "1") {
            let meaning = "a transformation with offsets, or of another data set than the first";
            return Err(not_read(
                format!("{name}({})", shown(arguments)),
                meaning,
                "write TRAORI alone",
            ));
        }
    }
    match block.keyword.replace(keyword) {
        None => Ok(()),
        Some(_) => Err(GcodeFault::Repeated { word: 'T' }),
    }
}

/// Adds a G word.
fn g_word(code: Code, block: &mut Block, words: &mut Words) -> Result<(), GcodeFault> {
    match code.tenths {
        0 | 10 | 20 | 30 | 40 | 170 | 180 | 190 | 400 | 410 | 420 | 530 | 540 | 550 | 560 | 570
        | 700 | 710 | 7000 | 7100 | 900 | 910 | 930 | 940 | 950 => block.add_code(code),
        // G153 suppresses the basic frames, too, which are taken as none.
        1530 => block.add_code(Code { tenths: 530, ..code }),
        5000 => settable(code, WorkOffset::Off, words),
        // The numbers of settable frames: G54 is the first, and G58 of ISO mode the fifth.
        5050 | 5060 => settable(code, WorkOffset::Standard((code.tenths / 10 - 500) as u8), words),
        5070..=5990 if code.tenths.is_multiple_of(10) => {
            let number = code.tenths / 10 - WorkOffset::FIRST_OF_SINUMERIK + 1;
            settable(code, WorkOffset::Additional(number as u16), words)
        }
        90 | 600 | 6010 | 6020 | 6030 | 640 | 6410 | 6420 | 6430 | 6440 | 6450 | 620 | 6210 => {
            match code.tenths {
                // It holds for its block alone.
                90 => {}
                tenths => words.exact_path = Some(matches!(tenths, 600 | 6010 | 6020 | 6030)),
            }
            block.passed_over.push(code);
            Ok(())
        }
        // Cutting speed, native mode; arcs at outside corners and the first motion of cutter compensation, as delivered.
        960 | 970 | 2900 | 4500 | 4600 => {
            block.passed_over.push(code);
            Ok(())
        }
        4510 => {
            let meaning = "an intersection instead of an arc at outside corners";
            Err(not_read(code, meaning, "write G450"))
        }
        tenths => Err(refused_g(code, tenths)),
    }
}

fn settable(code: Code, offset: WorkOffset, words: &mut Words) -> Result<(), GcodeFault> {
    match words.offset.replace(offset) {
        None => Ok(()),
        Some(_) => {
            let condition = "its block has another work offset";
            Err(combination(code, condition, "keep one of them"))
        }
    }
}

fn refused_g(code: Code, tenths: u32) -> GcodeFault {
    let (meaning, remedy) = match tenths {
        2910 => ("the ISO mode", "give the program in one language"),
        580 | 590 => ("a programmable shift", "write TRANS or ATRANS"),
        330..=359 | 3310 | 3320 | 630 => {
            ("threading, or tapping without a cycle", "write CYCLE84 or CYCLE840")
        }
        740 | 750 => ("a return to a point of the machine", "write SUPA with its coordinates"),
        1100 | 1110 | 1120 => ("a pole of polar coordinates", "post the program with X Y Z"),
        250 | 260 => {
            ("a limit of the working area or of the spindle", "check the program without it")
        }
        1400..=1430 | 1470 | 1480 | 2470 | 2480 | 3400 | 3410 | 3470 | 3480 => {
            ("a smooth approach", "post the program with lines and arcs")
        }
        9310..=9730 => ("another form of feed", "write G94 or G95"),
        200
        | 210
        | 280
        | 300
        | 430..=449
        | 490
        | 500
        | 510
        | 520
        | 680..=699
        | 730
        | 740..=749
        | 800..=899
        | 920..=923
        | 980
        | 990
        | 100
        | 150
        | 160 => {
            ("a word of ISO mode (G291)", "post the program in one language: native, or ISO mode")
        }
        _ => return GcodeFault::UnknownCode { word: code.to_string() },
    };
    not_read(code, meaning, remedy)
}

/// Adds an M word.
fn m_word(code: Code, block: &mut Block, words: &mut Words) -> Result<(), GcodeFault> {
    match code.tenths {
        170 => {
            words.returns = true;
            Ok(())
        }
        // Gears of the spindle.
        400..=450 if code.tenths.is_multiple_of(10) => {
            block.passed_over.push(code);
            Ok(())
        }
        980 | 990 => {
            let meaning = "a word of ISO mode (G291)";
            Err(not_read(code, meaning, "write the name of the subprogram, and M17 to end it"))
        }
        4280 | 4290 => Err(GcodeFault::UnknownCode { word: code.to_string() }),
        _ => block.add_code(code),
    }
}

//! The end of a program, and what it leaves in force.

use super::Control;
use crate::gcode::GcodeFault;
use crate::gcode::note::NoteKind;
use crate::gcode::rules::{Choice, Rule};
use crate::gcode::state::{Rotation, Tcp};

impl Control {
    /// Ends the program.
    pub(in crate::gcode) fn end(&mut self) -> Result<(), GcodeFault> {
        self.end_compensation()?;
        if let Some(block) = self.uncalled {
            self.notes.add(block, NoteKind::UncalledCycle);
        }
        let words = self.words_in_force().join(", ");
        if !words.is_empty() {
            self.notes.add(self.block(), NoteKind::LeftModes { words });
        }
        Ok(())
    }

    /// Returns words in force that change what positions mean, and that another run of the program may find in force.
    fn words_in_force(&self) -> Vec<String> {
        let dialect = self.stated(Rule::Dialect);
        let is_heidenhain = dialect == Some(Choice::Heidenhain);
        // M2 and M30 of LinuxCNC end G91 and the shift by G92 (`convert_stop`).
        let is_linuxcnc = dialect == Some(Choice::Rs274Ngc);
        let frame = self.frames.word();
        let has_shift = self.local != [0.0; 6]
            || self.preset != [Some(0.0); 6] && !is_linuxcnc
            || frame.is_some();
        let shift = match frame {
            Some(word) => word,
            None if is_heidenhain => "a datum shift",
            None if self.local == [0.0; 6] => "G92",
            None => "G52",
        };
        let rotation = match self.state.rotation {
            Rotation::Tilted { .. } if is_heidenhain => "PLANE",
            Rotation::Tilted { .. } => "G68.2",
            _ if is_heidenhain => "a rotation",
            _ => "G68",
        };
        let is_rotated = self.state.rotation != Rotation::Off && frame.is_none();
        let tcp = match self.state.tcp {
            Tcp::Transformation => "TRAORI",
            Tcp::Vector => "G43.5",
            _ if is_heidenhain => "M128",
            _ if self.transformed => "M428",
            _ => "G43.4",
        };
        let words = [
            (self.modal.incremental && !is_linuxcnc, "G91"),
            (has_shift, shift),
            (is_rotated, rotation),
            (self.polar.is_some(), "G16"),
            (self.mirror != [None; 3], "G51.1"),
            (self.is_tcp(), tcp),
        ];
        let words = words.into_iter().filter(|(is_left, _)| *is_left);
        let cycle = self.modal.cycle().map(|number| format!("G{number} without G80"));
        words.map(|(_, word)| word.to_owned()).chain(cycle).collect()
    }
}

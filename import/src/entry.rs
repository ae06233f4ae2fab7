//! The tools of a library, in one form for all formats.

use super::json::tool_number;
use super::outline::decimal;
use super::shape::{Cutter, Shape, ShapeError};
use serde_json::Value;
use std::fmt;
use touchoff::Unit;

/// A tool of a library.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Entry {
    /// The tool number, by which a program calls the tool.
    pub number: Option<u32>,
    /// The type, in the library's words.
    pub kind: String,
    /// The description; may be empty.
    pub title: String,
    /// Vendor, product and identifier, as far as the library states them.
    pub origin: Vec<(&'static str, String)>,
    /// The unit of the tool's lengths.
    pub unit: Unit,
    /// The length from the tip to the holder, in `unit`.
    pub stickout: Option<f64>,
    /// Set if it cuts while the spindle turns counter-clockwise (M4); `None` if the library does not say.
    pub left_handed: Option<bool>,
    /// Assumptions, and contradictions of the library.
    pub notes: Vec<Note>,
    pub(super) cutter: Option<Cutter>,
    pub(super) shaft: Vec<Section>,
    pub(super) holder: Option<Holder>,
}

/// A tool of a library that has no shape here.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Skipped {
    /// Its position in the library, from 1.
    pub position: usize,
    /// Its description, or its type if it has none.
    pub name: String,
    /// The number by which programs select it, if it is known.
    pub number: Option<u32>,
    /// Why it was left out.
    pub reason: String,
}

/// A conical piece of a shaft or a holder, from the tip's side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Section {
    pub(super) height: f64,
    pub(super) lower_diameter: f64,
    pub(super) upper_diameter: f64,
}

/// A holder.
#[derive(Clone, Debug)]
pub(super) struct Holder {
    pub(super) title: String,
    pub(super) origin: Vec<(&'static str, String)>,
    pub(super) unit: Unit,
    pub(super) sections: Vec<Section>,
}

/// A statement of a library.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stated {
    /// The dimension.
    pub what: &'static str,
    /// Its value, in the unit of the tool; angles in degrees.
    pub value: f64,
}

/// Something that a reader of the imported tool should know.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// The library does not state this; the second text says what the imported tool has.
    Unstated(&'static str, String),
    /// The library states a holder or a shaft without its segments.
    NotDrawn {
        /// The holder or the shaft.
        what: &'static str,
        /// The tool as it is drawn.
        drawn: &'static str,
    },
    /// A dimension of Fusion 360 differs from its expression, from which Fusion 360 computes it anew.
    OtherExpression {
        /// The dimension, which was taken.
        stated: Stated,
        /// The value of its expression.
        expression: f64,
    },
    /// The library says that the tool is left-handed. A job that selects it from the library knows that, a `.tool` file does not.
    LeftHanded,
    /// Two statements of the library contradict each other. The last text says which was taken.
    Contradiction {
        /// The first statement.
        first: Stated,
        /// The second.
        second: Stated,
        /// The one that was taken.
        taken: &'static str,
        /// Set if the tool of the other can reach beyond the one that is drawn.
        is_narrower: bool,
    },
    /// The gauge length of the assembly is not the sum of stick-out and holder, which was taken.
    GaugeLength {
        /// The gauge length.
        stated: f64,
        /// The sum.
        sum: f64,
    },
    /// The holder begins below the end of the flutes: the collet holds the flutes.
    FlutesInHolder {
        /// The length of the flutes.
        flutes: f64,
        /// The length from the tip to the holder.
        stickout: f64,
    },
    /// The shank is wider than the holder's lower end.
    ShankTooWide {
        /// The diameter of the shank.
        shank: f64,
        /// The diameter of the holder's lower end.
        nose: f64,
    },
    /// The overall length does not reach the holder. The shank was drawn up to it.
    TooShort {
        /// The overall length.
        length: f64,
        /// The length from the tip to the holder.
        stickout: f64,
    },
    /// The origin of the library's tool is this far above its tip, while the tip is the origin here.
    Origin(f64),
    /// A face mill without a taper has a largest diameter beyond its diameter, and is drawn with the latter.
    NarrowFace {
        /// The diameter.
        diameter: f64,
        /// The largest diameter.
        largest: f64,
    },
    /// The library states a taper angle, in degrees, of a shape that has none.
    NotTapered {
        /// The angle.
        angle: f64,
    },
    /// A neck is thinner than a twentieth of the cutting diameter: it would break.
    ThinNeck {
        /// The diameter of the neck.
        neck: f64,
        /// The cutting diameter.
        diameter: f64,
    },
}

impl Note {
    /// Returns whether a program that was made with the library's tool may hit where the imported tool does not.
    pub fn is_doubt(&self) -> bool {
        match self {
            Note::NotDrawn { .. }
            | Note::Origin(_)
            | Note::NarrowFace { .. }
            | Note::NotTapered { .. }
            | Note::OtherExpression { .. } => true,
            // The holder would be lower than it is drawn.
            Note::GaugeLength { stated, sum } => stated < sum,
            Note::Contradiction { is_narrower, .. } => *is_narrower,
            _ => false,
        }
    }

    /// Adds the note that a default was taken for a dimension, and returns it.
    pub(super) fn default_taken(notes: &mut Vec<Note>, name: &'static str, default: f64) -> f64 {
        notes.push(Note::Unstated(name, format!("taken: {}", decimal(default))));
        default
    }

    pub(super) fn no_shank_diameter() -> Note {
        let drawn = "the shank is as wide as the cutter below it".to_owned();
        Note::Unstated("shank diameter", drawn)
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Note::Unstated(what, taken) => {
                write!(f, "the library does not state the {what}: {taken}")
            }
            Note::NotDrawn { what, drawn } => {
                write!(f, "the library does not state the segments of the {what}: {drawn}")
            }
            Note::OtherExpression { stated: Stated { what, value }, expression } => write!(
                f,
                "the {what} is {}, but its expression is {}; taken: the former",
                decimal(*value),
                decimal(*expression)
            ),
            Note::LeftHanded => f.write_str(
                "it is left-handed: state `hand = \"left\"` in a job that names its `.tool` file",
            ),
            Note::Contradiction { first, second, taken, is_narrower: _ } => write!(
                f,
                "the {} is {}, but the {} is {}; taken: the {taken}",
                first.what,
                decimal(first.value),
                second.what,
                decimal(second.value)
            ),
            Note::GaugeLength { stated, sum } => write!(
                f,
                "the gauge length of the assembly is {}, but the sum of stick-out and holder is {}; taken: the sum",
                decimal(*stated),
                decimal(*sum)
            ),
            Note::FlutesInHolder { flutes, stickout } => write!(
                f,
                "the flutes are {} long, but the tool sticks out {}: the holder clamps the flutes; lengthen the \
                 stick-out",
                decimal(*flutes),
                decimal(*stickout)
            ),
            Note::ShankTooWide { shank, nose } => write!(
                f,
                "the shank of {} does not fit into the holder, whose lower end is {} wide: check both",
                decimal(*shank),
                decimal(*nose)
            ),
            Note::TooShort { length, stickout } => write!(
                f,
                "the tool is {} long, but its holder begins at {}: the shank was drawn up to the holder",
                decimal(*length),
                decimal(*stickout)
            ),
            Note::Origin(above) => write!(
                f,
                "programs of the library's system have the origin {} above the tip, while here the tip is the origin: \
                 shift such a program by that much",
                decimal(*above)
            ),
            Note::NarrowFace { diameter, largest } => write!(
                f,
                "the largest diameter is {}, but without a taper the face mill is drawn as wide as its diameter of {}: correct one of them",
                decimal(*largest),
                decimal(*diameter)
            ),
            Note::NotTapered { angle } => write!(
                f,
                "the taper angle is {}°, but its shape has none, and is drawn without a taper: choose a tapered shape, or remove the angle",
                decimal(*angle)
            ),
            Note::ThinNeck { neck, diameter } => write!(
                f,
                "the neck of {} under a diameter of {} is thinner than a neck can be: check the shoulder diameter",
                decimal(*neck),
                decimal(*diameter)
            ),
        }
    }
}

impl Entry {
    /// Returns a tool of which nothing else is known.
    pub(super) fn new(
        unit: Unit,
        kind: &str,
        title: &str,
        origin: Vec<(&'static str, String)>,
    ) -> Entry {
        Entry {
            number: None,
            kind: kind.to_owned(),
            title: title.to_owned(),
            origin,
            unit,
            stickout: None,
            left_handed: None,
            notes: Vec::new(),
            cutter: None,
            shaft: Vec::new(),
            holder: None,
        }
    }

    /// Sets the tool number, with a note if what the library states is none.
    pub(super) fn set_number(&mut self, stated: Option<&Value>) {
        let Some(stated) = stated.filter(|stated| !stated.is_null()) else { return };
        self.number = tool_number(stated);
        if self.number.is_none() {
            let taken =
                format!("{stated} is no whole number from 0, so no program can call the tool");
            self.notes.push(Note::Unstated("tool number", taken));
        }
    }

    /// Returns what to call the tool: its description, or its type.
    pub fn label(&self) -> &str {
        if self.title.is_empty() { &self.kind } else { &self.title }
    }

    /// Returns the diameter, as the library states it for the type; `None` for a holder.
    pub fn diameter(&self) -> Option<f64> {
        self.cutter.as_ref().map(|cutter| cutter.diameter)
    }

    /// Returns the length of the flutes; `None` for a holder.
    pub fn flute_length(&self) -> Option<f64> {
        self.cutter.as_ref().map(|cutter| cutter.flute_length)
    }

    /// Returns the overall length; `None` for a holder.
    pub fn length(&self) -> Option<f64> {
        self.cutter.as_ref().map(|cutter| cutter.length)
    }

    /// Returns the holder's description, if the tool has a holder.
    pub fn holder(&self) -> Option<&str> {
        self.holder.as_ref().map(|holder| &*holder.title)
    }

    /// Adds the notes that follow from the dimensions, whatever the format.
    pub(super) fn add_notes(&mut self) {
        let Some(cutter) = &self.cutter else { return };
        let mut notes = Vec::new();
        // Up to a holder the shank is drawn in any case.
        let reach = self.stickout.filter(|_| self.holder.is_some()).unwrap_or(0.0);
        let has_other_shank = cutter.shank_diameter.is_some_and(|shank| shank != cutter.diameter);
        if has_other_shank && cutter.flute_length == cutter.length.max(reach) {
            let drawn = "the flutes reach the overall length, so no shank is drawn".to_owned();
            notes.push(Note::Unstated("length of the shank", drawn));
        }
        if let (Some(holder), Some(stickout)) = (&self.holder, self.stickout) {
            if cutter.flute_length > stickout {
                notes.push(Note::FlutesInHolder { flutes: cutter.flute_length, stickout });
            }
            if cutter.length < stickout {
                notes.push(Note::TooShort { length: cutter.length, stickout });
            }
            let nose = holder.sections.first().map(|section| section.lower_diameter);
            let factor = holder.unit.factor_to(self.unit);
            if let (Some(nose), Some(shank)) = (nose, self.shank_diameter())
                // The conversion of units rounds.
                && shank > nose * factor * (1.0 + 1e-9)
            {
                notes.push(Note::ShankTooWide { shank, nose: nose * factor });
            }
        }
        if let Some((_, Some(neck))) = cutter.shoulder
            && neck < cutter.diameter / 20.0
        {
            notes.push(Note::ThinNeck { neck, diameter: cutter.diameter });
        }
        if let Shape::Thread { pitch, teeth, .. } = cutter.shape
            && pitch > 0.0
            && cutter.whole_pitches(pitch) < f64::from(teeth)
        {
            notes.push(Note::Contradiction {
                first: Stated { what: "number of teeth", value: f64::from(teeth) },
                second: Stated {
                    what: "number of pitches in the flute length",
                    value: cutter.whole_pitches(pitch),
                },
                taken: "teeth that fit",
                is_narrower: true,
            });
        }
        if let Shape::Face { half_angle: 0.0, max_diameter, .. } = cutter.shape
            && max_diameter > cutter.diameter
        {
            let (diameter, largest) = (cutter.diameter, max_diameter);
            notes.push(Note::NarrowFace { diameter, largest });
        }
        if let Some([wide, narrow]) = cutter.heights_of_diameter()
            && narrow > wide
        {
            let drawn = format!(
                "taken: its upper end, which gives the widest tool, of full diameter from {wide:.4}; with its lower \
                 end it would be from {narrow:.4}"
            );
            notes.push(Note::Unstated("point of the flank that has the taper angle", drawn));
        }
        if let Some(width) = cutter.width_of_short_oval() {
            notes.push(Note::Contradiction {
                first: Stated { what: "diameter", value: cutter.diameter },
                second: Stated { what: "diameter at the end of the flutes", value: width },
                taken: "radii and the flute length",
                is_narrower: width < cutter.diameter,
            });
        }
        if self.left_handed == Some(true) {
            notes.push(Note::LeftHanded);
        }
        self.notes.extend(notes);
    }

    /// Returns the notes for which a program that was made with the library's tool may hit where the imported tool does not.
    pub fn doubts(&self) -> Vec<String> {
        self.notes.iter().filter(|note| note.is_doubt()).map(Note::to_string).collect()
    }

    /// Returns the diameter that the holder clamps.
    fn shank_diameter(&self) -> Option<f64> {
        let from_shaft = self.shaft.last().map(|section| section.upper_diameter);
        from_shaft.or(self.cutter.as_ref()?.shank_diameter)
    }
}

/// Returns the sentence that says why a tool was left out.
pub(super) fn reason(error: &ShapeError) -> String {
    format!("{error}: correct it in the library and export it again")
}

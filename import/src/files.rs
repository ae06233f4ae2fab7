//! Writes imported tools as `.tool` files, each under a name of its own.

use super::entry::{Entry, Holder, Section};
use super::outline::{Outline, Term, decimal, plain, rounded};
use super::shape::{Cutter, ShapeError};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use touchoff::Unit;
use touchoff_dsl::format::format;
use touchoff_dsl::source::Source;

/// A file of an imported tool.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolFile {
    /// The path relative to the output folder, with `/`.
    pub path: String,
    /// The text.
    pub text: String,
}

/// Writes files for one library. Holders with the same sections are one file.
#[derive(Debug, Default)]
pub(super) struct Writer {
    tools: Names,
    holders: Names,
    holder_files: BTreeMap<String, ToolFile>,
}

impl Writer {
    /// Returns the name of a tool, and its files: those that it mounts, then its own.
    pub(super) fn write(
        &mut self,
        entry: &Entry,
        source: &str,
    ) -> Result<(String, Vec<ToolFile>), ShapeError> {
        let mut files = Vec::new();
        let otherwise = match entry.number {
            Some(number) => format!("{} {number}", entry.kind),
            None => entry.kind.clone(),
        };
        let Some(cutter) = &entry.cutter else {
            let Some(holder) = &entry.holder else { return Err(ShapeError::Unstated("shape")) };
            let path = self.holder(holder, source, &mut files)?;
            return Ok((path.trim_end_matches(".tool").to_owned(), files));
        };
        let name = self.tools.file(&entry.title, &otherwise);
        // It is the length to a holder: without one it says nothing.
        let stickout = entry.stickout.filter(|_| entry.holder.is_some());
        let mut cutter = cutter.clone();
        // A shank that does not reach its holder is drawn up to it, and a note says so.
        if let Some(stickout) = stickout {
            cutter.length = cutter.length.max(stickout);
        }
        let outline = cutter.outline()?;
        let heading = heading(entry, source);
        let title = quotable(&entry.title);
        if stickout.is_none() && entry.shaft.is_empty() {
            let mut text = heading;
            begin(&mut text, &type_name(&name), &title, entry.unit);
            outline.write(&mut text);
            text.push_str("}\n");
            files.push(file(format!("{name}.tool"), text));
            return Ok((name, files));
        }
        let mut text = String::new();
        begin(&mut text, &format!("{}Cutter", type_name(&name)), &title, entry.unit);
        outline.write(&mut text);
        text.push_str("}\n");
        files.push(file(format!("cutters/{name}.tool"), text));

        let mut assembly = heading;
        begin(&mut assembly, &type_name(&name), &title, entry.unit);
        if let Some(stickout) = stickout {
            let _ = writeln!(assembly, "    param stickout = {};", decimal(stickout));
        }
        let _ = write!(assembly, "\n    mount \"cutters/{name}.tool\" as cutter;\n");
        let from = rounded(shaft_start(&cutter, &outline));
        // A shaft that begins above the holder's lower end is inside the holder.
        let sections = clipped(&entry.shaft, cutter.length - from);
        if !sections.is_empty() && stickout.is_none_or(|stickout| stickout > from) {
            let outline = sections_outline(&sections, "shaft")?;
            let mut text = String::new();
            begin(&mut text, &format!("{}Shaft", type_name(&name)), &title, entry.unit);
            outline.write(&mut text);
            text.push_str("}\n");
            files.push(file(format!("shafts/{name}.tool"), text));
            let _ = writeln!(
                assembly,
                "    mount \"shafts/{name}.tool\" as shaft at z = {};",
                decimal(from)
            );
        }
        if let (Some(holder), Some(_)) = (&entry.holder, stickout) {
            let path = self.holder(holder, source, &mut files)?;
            let height: f64 = holder.sections.iter().map(|section| section.height).sum();
            let height = rounded(height * holder.unit.factor_to(entry.unit));
            let _ =
                writeln!(assembly, "    // The gauge length is stickout + {}.", decimal(height));
            let _ = writeln!(assembly, "    mount \"{path}\" as holder at z = stickout;");
        }
        assembly.push_str("}\n");
        files.push(file(format!("{name}.tool"), assembly));
        Ok((name, files))
    }

    /// Adds a holder's file, and returns its path.
    fn holder(
        &mut self,
        holder: &Holder,
        source: &str,
        files: &mut Vec<ToolFile>,
    ) -> Result<String, ShapeError> {
        let outline = sections_outline(&holder.sections, "body")?;
        let title = quotable(&holder.title);
        let mut body = String::new();
        outline.write(&mut body);
        let key = format!("{title}\n{}\n{body}", holder.unit.symbol());
        if let Some(known) = self.holder_files.get(&key) {
            files.push(known.clone());
            return Ok(known.path.clone());
        }
        let name = self.holders.file(&holder.title, "holder");
        let path = format!("holders/{name}.tool");
        let mut text = format!("// Imported from {}.\n", quotable(source));
        push_origin(&mut text, &holder.origin);
        begin(&mut text, &type_name(&name), &title, holder.unit);
        text.push_str(&body);
        text.push_str("}\n");
        let file = file(path.clone(), text);
        self.holder_files.insert(key, file.clone());
        files.push(file);
        Ok(path)
    }
}

/// Returns the height at which a shaft of sections begins: the end of the shoulder, or of the cutting part.
fn shaft_start(cutter: &Cutter, outline: &Outline) -> f64 {
    let stated = cutter.shoulder.map_or(0.0, |(length, _)| length);
    stated.max(cutter.flute_length).max(outline.cutting_end())
}

fn begin(text: &mut String, name: &str, title: &str, unit: Unit) {
    let title = if title.is_empty() { String::new() } else { format!(" \"{title}\"") };
    let _ = writeln!(text, "tool {name}{title} {{\n    units {};", unit.symbol());
}

/// Returns a file with its text in the standard layout.
fn file(path: String, text: String) -> ToolFile {
    let formatted = format(&Source::new(&path, &text));
    ToolFile { path, text: formatted.unwrap_or(text) }
}

/// Returns the comment above a tool: its source, its origin and the notes.
fn heading(entry: &Entry, source: &str) -> String {
    let number = entry.number.map_or_else(String::new, |number| format!(", T{number}"));
    let mut text =
        format!("// Imported from {}: {}{number}.\n", quotable(source), quotable(&entry.kind));
    push_origin(&mut text, &entry.origin);
    for note in &entry.notes {
        let _ = writeln!(text, "// Note: {}.", quotable(&note.to_string()));
    }
    text
}

fn push_origin(text: &mut String, origin: &[(&'static str, String)]) {
    let origin: Vec<String> = origin
        .iter()
        .map(|(what, value)| (what, quotable(value)))
        .filter(|(_, value)| !value.is_empty())
        .map(|(what, value)| format!("{what} {value}"))
        .collect();
    if !origin.is_empty() {
        let _ = writeln!(text, "// {}.", origin.join(", "));
    }
}

/// Returns sections cut off at a height, or continued to it as a cylinder.
fn clipped(sections: &[Section], height: f64) -> Vec<Section> {
    let mut clipped = Vec::new();
    let mut z = 0.0;
    for section in sections {
        if z >= height {
            break;
        }
        let rest = height - z;
        z += section.height;
        // A cone that is cut off ends at the diameter that it has there.
        if section.height > rest {
            let part = rest / section.height;
            let change = section.upper_diameter - section.lower_diameter;
            let upper_diameter = section.lower_diameter + part * change;
            clipped.push(Section { height: rest, upper_diameter, ..*section });
        } else {
            clipped.push(*section);
        }
    }
    if let Some(last) = clipped.last()
        && z < height
    {
        let diameter = last.upper_diameter;
        let height = height - z;
        clipped.push(Section { height, lower_diameter: diameter, upper_diameter: diameter });
    }
    clipped
}

/// Returns the half section of a stack of sections.
fn sections_outline(sections: &[Section], surface: &'static str) -> Result<Outline, ShapeError> {
    let mut outline = Outline::new();
    let surface = plain(surface);
    let mut z = 0.0;
    for section in sections {
        for diameter in [section.lower_diameter, section.upper_diameter] {
            if !(diameter > 0.0 && diameter.is_finite()) {
                return Err(ShapeError::OutOfRange("diameter of a section", diameter));
            }
        }
        if !(section.height >= 0.0 && section.height.is_finite()) {
            return Err(ShapeError::OutOfRange("height of a section", section.height));
        }
        let [lower, upper] = [section.lower_diameter, section.upper_diameter]
            .map(|diameter| Term::number(rounded(diameter / 2.0)));
        outline.line(&lower, &Term::number(rounded(z)), surface);
        z += section.height;
        outline.line(&upper, &Term::number(rounded(z)), surface);
    }
    if z <= 0.0 {
        return Err(ShapeError::Unstated("height of any section"));
    }
    outline.line(&Term::number(0.0), &Term::number(rounded(z)), surface);
    Ok(outline)
}

/// The longest name of an imported tool, in characters, without the number that tells equal names apart.
const MAX_NAME: usize = 48;

/// Gives each tool and file a name of its own.
#[derive(Debug, Default)]
struct Names {
    given: BTreeSet<String>,
    /// The number that tells the next of equal names apart.
    next: BTreeMap<String, usize>,
}

/// Names of devices on Windows, which no file may have, whatever its ending.
const DEVICES: [&str; 6] = ["con", "prn", "aux", "nul", "com", "lpt"];

impl Names {
    /// Returns the words of a label as a file name without ending, such as `d6_ball_er16`, different from all
    /// names given so far.
    fn file(&mut self, label: &str, otherwise: &str) -> String {
        let name = snake(label);
        let name = if name.is_empty() { snake(otherwise) } else { name };
        let name = if name.is_empty() { "tool".to_owned() } else { name };
        let name = if is_device(&name) { format!("tool_{name}") } else { name };
        let mut unique = name.clone();
        let next = self.next.entry(name.clone()).or_insert(2);
        while !self.given.insert(unique.clone()) {
            unique = format!("{name}_{next}");
            *next += 1;
        }
        unique
    }
}

/// Returns whether a name is that of a device: one of [`DEVICES`], of which the last two have a digit.
fn is_device(name: &str) -> bool {
    let (word, numbered) = match name.strip_suffix(|c: char| c.is_ascii_digit()) {
        Some(word) => (word, true),
        None => (name, false),
    };
    DEVICES.iter().position(|known| *known == word).is_some_and(|known| numbered == (known >= 4))
}

/// Returns the ASCII letters and digits of a label, in lower case and joined by `_`.
fn snake(label: &str) -> String {
    let mut name = String::new();
    let mut characters = label.chars().peekable();
    while let Some(character) = characters.next() {
        if name.len() >= MAX_NAME {
            break;
        }
        match character {
            c if c.is_ascii_alphanumeric() => name.push(c.to_ascii_lowercase()),
            // A decimal point, so that D2.5 and D25 differ.
            '.' | ','
                if name.ends_with(|c: char| c.is_ascii_digit())
                    && characters.peek().is_some_and(char::is_ascii_digit) =>
            {
                name.push('p');
            }
            _ if !name.is_empty() && !name.ends_with('_') => name.push('_'),
            _ => {}
        }
    }
    name.trim_end_matches('_').to_owned()
}

/// Returns the name of a tool's type, such as `D6BallEr16`, from the name of its file.
fn type_name(file: &str) -> String {
    let mut name = String::new();
    for word in file.split('_').filter(|word| !word.is_empty()) {
        // Two numbers must not run together.
        if name.ends_with(|c: char| c.is_ascii_digit())
            && word.starts_with(|c: char| c.is_ascii_digit())
        {
            name.push('X');
        }
        let mut letters = word.chars();
        name.extend(letters.next().map(|c| c.to_ascii_uppercase()));
        name.extend(letters);
    }
    if name.starts_with(|c: char| c.is_ascii_digit()) { format!("T{name}") } else { name }
}

/// Number of characters of a text of the library that are written.
const MAX_TEXT: usize = 500;

/// Returns a text as it may stand in quotes: without control characters, quotes and characters that reverse the
/// direction of writing, and no longer than [`MAX_TEXT`].
fn quotable(text: &str) -> String {
    let text: String = text
        .chars()
        .map(|c| match c {
            '"' => '\'',
            '\\' => '/',
            c if c.is_control() || is_bidirectional(c) => ' ',
            c => c,
        })
        .collect();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match text.char_indices().nth(MAX_TEXT) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text,
    }
}

fn is_bidirectional(c: char) -> bool {
    matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

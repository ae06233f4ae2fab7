//! Machines as TOML.

use super::body::{self, BodyEntry};
use super::chain::is_within;
use super::{
    Axis, Letter, MAX_DEGREES, MAX_LENGTH, Machine, MachineBody, MachineError, MachineFault, Side,
    is_name,
};
use nalgebra::{Point3, Vector3};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;

/// Smallest sine of the angle between two rotary axes, about 0.06°. Axes that are nearer to parallel do not
/// determine a tool axis: joint values would amplify its rounding a thousand times and more.
const SMALLEST_SINE: f64 = 1e-3;

/// The keys of a file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MachineFile {
    name: Spanned<String>,
    tool_change: Option<Spanned<ToolChangeEntry>>,
    m92: Option<Spanned<[f64; 3]>>,
    axis: Vec<Spanned<AxisEntry>>,
    #[serde(default)]
    body: Vec<BodyEntry>,
}

/// Position in which M6 leaves the axes: `"stays"`, or joint values by letter.
#[derive(Deserialize)]
#[serde(untagged)]
enum ToolChangeEntry {
    Word(String),
    Position(BTreeMap<Letter, f64>),
}

/// The keys of an `[[axis]]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AxisEntry {
    letter: Spanned<Letter>,
    kind: Spanned<Kind>,
    carries: Side,
    direction: Option<Spanned<[f64; 3]>>,
    point: Option<Spanned<[f64; 3]>>,
    limits: Option<Spanned<[f64; 2]>>,
    home: Option<Spanned<f64>>,
    rapid: Option<Spanned<f64>>,
}

#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Linear,
    Rotary,
}

/// A fault, with its span in the text.
type Located = (Range<usize>, MachineFault);

/// Parses a machine from the text of a file.
pub(super) fn parse(text: &str, file: &Path) -> Result<Machine, MachineError> {
    let parsed = toml::from_str::<MachineFile>(text).map_err(|error| {
        let message = error.message().trim().replace('\n', ", ");
        (error.span().unwrap_or(0..0), MachineFault::Syntax { message })
    });
    let assembled = parsed.and_then(|parsed| {
        let name = name(parsed.name)?;
        let axes = axes(text, &parsed.axis)?;
        let tool_change = parsed.tool_change.map(|entry| tool_change(entry, &axes)).transpose()?;
        let builder_point = parsed.m92.map(builder_point).transpose()?;
        let (none_yet, is_of_library) = (Vec::new(), false);
        let mut machine =
            Machine { name, axes, tool_change, builder_point, bodies: none_yet, is_of_library };
        machine.bodies = bodies(parsed.body, &machine, file)?;
        Ok(machine)
    });
    let machine = assembled.map_err(|(span, fault)| MachineError::Line {
        file: file.display().to_string(),
        line: line_of(text, span.start),
        fault,
    })?;
    match Letter::ALL[..3].iter().find(|letter| machine.axis(**letter).is_none()) {
        Some(&letter) => {
            Err(MachineError::MissingAxis { file: file.display().to_string(), letter })
        }
        None => Ok(machine),
    }
}

/// Returns the 1-based line of an offset in bytes.
fn line_of(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|byte| *byte == b'\n').count()
}

fn name(name: Spanned<String>) -> Result<String, Located> {
    let span = name.span();
    let name = name.into_inner();
    if !is_name(&name) {
        return Err((span, MachineFault::Name));
    }
    Ok(name)
}

/// Returns the bodies of a machine.
fn bodies(
    entries: Vec<BodyEntry>,
    machine: &Machine,
    file: &Path,
) -> Result<Vec<MachineBody>, Located> {
    let names: Vec<_> = entries.iter().map(|entry| entry.name.clone()).collect();
    body::bodies(entries, machine, file).map_err(|(index, fault)| {
        let name = names[index].get_ref().clone();
        (names[index].span(), MachineFault::Body { name, fault })
    })
}

/// Returns the point from which M92 counts.
fn builder_point(entry: Spanned<[f64; 3]>) -> Result<[f64; 6], Located> {
    let span = entry.span();
    let [x, y, z] = entry.into_inner();
    match [x, y, z].iter().all(|value| is_within(*value, MAX_LENGTH)) {
        true => Ok([x, y, z, 0.0, 0.0, 0.0]),
        false => Err((span, MachineFault::BuilderPoint)),
    }
}

/// Returns the joint values after a tool change, of the axes that it moves.
fn tool_change(
    entry: Spanned<ToolChangeEntry>,
    axes: &[Axis],
) -> Result<[Option<f64>; 6], Located> {
    let span = entry.span();
    let values = match entry.into_inner() {
        ToolChangeEntry::Word(word) if word == "stays" => BTreeMap::new(),
        ToolChangeEntry::Word(_) => return Err((span, MachineFault::ToolChange)),
        ToolChangeEntry::Position(values) => values,
    };
    let mut joints = [None; 6];
    for (letter, value) in values {
        let bound = if letter.is_rotary() { MAX_DEGREES } else { MAX_LENGTH };
        let is_known = axes.iter().any(|axis| axis.letter == letter);
        if !is_known || !is_within(value, bound) {
            return Err((span, MachineFault::ToolChange));
        }
        joints[letter.index()] = Some(value);
    }
    Ok(joints)
}

/// Checks the axes one by one, each against those before it.
fn axes(text: &str, entries: &[Spanned<AxisEntry>]) -> Result<Vec<Axis>, Located> {
    let mut axes: Vec<Axis> = Vec::new();
    for entry in entries {
        let (span, entry) = (entry.get_ref().letter.span(), entry.get_ref());
        let letter = *entry.letter.get_ref();
        if let Some(index) = axes.iter().position(|axis| axis.letter == letter) {
            let first = line_of(text, entries[index].get_ref().letter.span().start);
            return Err((span, MachineFault::Repeated { letter, first }));
        }
        let axis = axis(letter, entry)?;
        let mut rotary = axes.iter().filter(|axis| axis.letter.is_rotary());
        if !letter.is_rotary() {
            if let Some(rotary) = rotary.find(|rotary| rotary.side == axis.side) {
                let rotary = rotary.letter;
                return Err((span, MachineFault::CarriedLinear { letter, rotary }));
            }
        } else if let Some(first) = rotary.next() {
            if rotary.next().is_some() {
                return Err((span, MachineFault::ThirdRotary { letter }));
            }
            // Parallel axes turn the tool about one direction only.
            if first.direction.cross(&axis.direction).norm() < SMALLEST_SINE {
                return Err((span, MachineFault::Parallel { first: first.letter, letter }));
            }
        }
        axes.push(axis);
    }
    // Without the rate of one axis, the path of all is unknown.
    if let (Some(_), Some((axis, entry))) = (
        axes.iter().find(|axis| axis.rapid.is_some()),
        axes.iter().zip(entries).find(|(axis, _)| axis.rapid.is_none()),
    ) {
        let (letter, key, example) = (axis.letter, "rapid", "30000");
        return Err((
            entry.get_ref().letter.span(),
            MachineFault::MissingKey { letter, key, example },
        ));
    }
    Ok(axes)
}

fn axis(letter: Letter, entry: &AxisEntry) -> Result<Axis, Located> {
    let (kind, expected) =
        if letter.is_rotary() { (Kind::Rotary, "rotary") } else { (Kind::Linear, "linear") };
    if *entry.kind.get_ref() != kind {
        return Err((entry.kind.span(), MachineFault::Kind { letter, expected }));
    }
    let (direction, point) = match kind {
        Kind::Linear => (linear_direction(letter, entry)?, Point3::origin()),
        Kind::Rotary => (rotary_direction(letter, entry)?, rotary_point(letter, entry)?),
    };
    let limit = if kind == Kind::Rotary { MAX_DEGREES } else { MAX_LENGTH };
    if let Some(limits) = &entry.limits {
        let [low, high] = in_range(letter, "limits", limits, limit)?;
        if low >= high {
            return Err((limits.span(), MachineFault::Limits { letter, low, high }));
        }
    }
    let limits = entry.limits.as_ref().map(|limits| *limits.get_ref());
    if let Some(home) = &entry.home {
        let spanned = Spanned::new(home.span(), [*home.get_ref()]);
        let [home] = in_range(letter, "home", &spanned, limit)?;
        if limits.is_some_and(|[low, high]| !(low..=high).contains(&home)) {
            return Err((spanned.span(), MachineFault::Home { letter, home }));
        }
    }
    let home = entry.home.as_ref().map(|home| *home.get_ref());
    if let Some(rapid) = &entry.rapid
        && !(0.0 < *rapid.get_ref() && rapid.get_ref().is_finite())
    {
        let value = *rapid.get_ref();
        return Err((rapid.span(), MachineFault::Rapid { letter, value }));
    }
    let rapid = entry.rapid.as_ref().map(|rapid| *rapid.get_ref());
    Ok(Axis { letter, side: entry.carries, direction, point, limits, home, rapid })
}

/// Returns the direction of a linear axis. The file may state it, but no other.
fn linear_direction(letter: Letter, entry: &AxisEntry) -> Result<Vector3<f64>, Located> {
    let direction = Vector3::ith(letter.index(), 1.0);
    match (&entry.direction, &entry.point) {
        (Some(stated), _) if Vector3::from(*stated.get_ref()) != direction => {
            Err((stated.span(), MachineFault::LinearDirection { letter }))
        }
        (_, Some(point)) => Err((point.span(), MachineFault::LinearPoint { letter })),
        _ => Ok(direction),
    }
}

/// Returns the unit direction of a rotary axis.
fn rotary_direction(letter: Letter, entry: &AxisEntry) -> Result<Vector3<f64>, Located> {
    let Some(direction) = &entry.direction else {
        let (key, example) = ("direction", "[1, 0, 0]");
        return Err((entry.letter.span(), MachineFault::MissingKey { letter, key, example }));
    };
    let vector = Vector3::from(in_range(letter, "direction", direction, MAX_LENGTH)?);
    // Scaled first: the square of a tiny component underflows.
    let largest = vector.amax();
    if largest == 0.0 {
        return Err((direction.span(), MachineFault::ZeroDirection { letter }));
    }
    Ok((vector / largest).normalize())
}

fn rotary_point(letter: Letter, entry: &AxisEntry) -> Result<Point3<f64>, Located> {
    match &entry.point {
        Some(point) => Ok(Point3::from(in_range(letter, "point", point, MAX_LENGTH)?)),
        None => {
            let (key, example) = ("point", "[0, 0, 0]");
            Err((entry.letter.span(), MachineFault::MissingKey { letter, key, example }))
        }
    }
}

/// Returns the numbers of a key, if they are finite and within ±`limit`.
fn in_range<const N: usize>(
    letter: Letter,
    key: &'static str,
    values: &Spanned<[f64; N]>,
    limit: f64,
) -> Result<[f64; N], Located> {
    match values.get_ref().iter().find(|value| !is_within(**value, limit)) {
        Some(&value) => Err((values.span(), MachineFault::Range { letter, key, value, limit })),
        None => Ok(*values.get_ref()),
    }
}

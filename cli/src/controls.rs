//! `touchoff controls` and `touchoff machines`: the known controls and machines, with every rule and every axis.

use crate::failure::Failure;
use crate::output::Output;
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Write;
use touchoff_verify::gcode::{ControlRules, GENERIC, Rule};
use touchoff_verify::machine::{Axis, Machine, MachineBody, Opponent, Side};

/// A control as a JSON object.
#[derive(Serialize)]
struct ControlRow<'a> {
    name: &'a str,
    /// The words of the rules by their keys.
    rules: BTreeMap<&'static str, &'static str>,
}

/// A machine as a JSON object.
#[derive(Serialize)]
struct MachineRow<'a> {
    name: &'a str,
    /// Joint values after a tool change, in the order X Y Z A B C, of the axes that it moves.
    tool_change: Option<[Option<f64>; 6]>,
    axes: Vec<AxisRow>,
    bodies: Vec<BodyRow<'a>>,
}

/// A body of a machine. Its file has its shape.
#[derive(Serialize)]
struct BodyRow<'a> {
    name: &'a str,
    /// `base`, or the letter of the axis.
    moves_with: String,
    /// Distance to keep, in mm.
    margin: f64,
    against: Vec<&'a str>,
}

/// An axis, with lengths in mm and angles in degrees.
#[derive(Serialize)]
struct AxisRow {
    letter: String,
    carries: &'static str,
    direction: [f64; 3],
    /// A point of a rotary axis: its pivot.
    #[serde(skip_serializing_if = "Option::is_none")]
    point: Option<[f64; 3]>,
    limits: Option<[f64; 2]>,
    home: Option<f64>,
    /// Rate in rapid traverse, per minute.
    rapid: Option<f64>,
}

/// Lists the controls with every rule, or prints one as a file.
pub(crate) fn controls(name: Option<&str>, json: bool) -> Result<(), Failure> {
    let mut out = Output::lines();
    if let (Some(name), false) = (name, json) {
        write!(out, "{}", ControlRules::named(name)?.to_toml())?;
        return Ok(out.flush()?);
    }
    // With a name this prints its row of JSON; its file was printed above.
    let names = name.map_or_else(|| ControlRules::names().collect(), |name| vec![name]);
    for name in names {
        let control = ControlRules::named(name)?;
        let rules = Rule::all().filter_map(|rule| Some((rule, control.get(rule)?)));
        if json {
            let rules =
                rules.map(|(rule, choice)| (rule.key(), rule.describe(choice)[0])).collect();
            out.json(&ControlRow { name, rules })?;
            continue;
        }
        writeln!(out, "{name}")?;
        for (rule, choice) in rules {
            let ([word, meaning], about) = (rule.describe(choice), rule.about());
            let stated = format!("{} = \"{word}\"", rule.key());
            writeln!(out, "  {stated:<40} {about}: {meaning}")?;
        }
    }
    if name.is_none() && !json {
        writeln!(out, "{GENERIC}\n  states no rule: each of these ways is checked")?;
    }
    Ok(out.flush()?)
}

/// Lists the machines with every axis, or prints the file of one.
pub(crate) fn machines(name: Option<&str>, json: bool) -> Result<(), Failure> {
    let mut out = Output::lines();
    if let (Some(name), false) = (name, json) {
        Machine::named(name)?;
        write!(out, "{}", Machine::file(name).unwrap_or_default())?;
        return Ok(out.flush()?);
    }
    let names = name.map_or_else(|| Machine::names().collect(), |name| vec![name]);
    for name in names {
        let machine = Machine::named(name)?;
        let axes: Vec<AxisRow> = machine.axes().iter().map(AxisRow::of).collect();
        if json {
            let bodies = machine.bodies().iter().map(BodyRow::of).collect();
            let row = MachineRow { name, tool_change: machine.tool_change(), axes, bodies };
            out.json(&row)?;
            continue;
        }
        let change = match machine.tool_change() {
            None => "not stated: the control decides".to_owned(),
            Some(joints) if joints == [None; 6] => "the axes stay".to_owned(),
            Some(joints) => format!("{joints:?}"),
        };
        writeln!(out, "{name} (tool change: {change})")?;
        for axis in axes {
            writeln!(out, "  {}", axis.describe())?;
        }
        for BodyRow { name, moves_with, margin, against } in
            machine.bodies().iter().map(BodyRow::of)
        {
            write!(out, "  {name} moves with {moves_with}")?;
            if !against.is_empty() {
                write!(out, ", keeps {margin} mm from {}", against.join(", "))?;
            }
            writeln!(out)?;
        }
    }
    Ok(out.flush()?)
}

impl BodyRow<'_> {
    fn of(body: &MachineBody) -> BodyRow<'_> {
        let against = body.against.iter().map(Opponent::word);
        let (moves_with, against) = (body.link.to_string(), against.collect());
        BodyRow { name: &body.name, moves_with, margin: body.margin, against }
    }
}

impl AxisRow {
    fn of(axis: &Axis) -> AxisRow {
        AxisRow {
            letter: axis.letter.to_string(),
            carries: if axis.side == Side::Table { "table" } else { "tool" },
            direction: axis.direction.into(),
            point: axis.letter.is_rotary().then(|| axis.point.into()),
            limits: axis.limits,
            home: axis.home,
            rapid: axis.rapid,
        }
    }

    fn describe(&self) -> String {
        let AxisRow { letter, carries, direction, point, limits, home, rapid } = self;
        let unit = if point.is_some() { "°" } else { " mm" };
        let limits = match limits {
            Some([low, high]) => format!("from {low} to {high}{unit}"),
            None => "without limits".to_owned(),
        };
        let mut text = format!("{letter} moves the {carries}, {limits}");
        if let Some(home) = home {
            text += &format!(", home {home}");
        }
        if let Some(rapid) = rapid {
            text += &format!(", rapid {rapid}{unit}/min");
        }
        if let Some(point) = point {
            text += &format!(", about {direction:?} through {point:?}");
        }
        text
    }
}

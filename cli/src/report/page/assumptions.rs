//! The assumptions of the page: what the check took for granted, and the files that it read.

use super::super::Content;
use super::super::along::POINTS;
use super::plain;
use crate::postures::picture::describe;
use crate::program::ignored_words;
use maud::{Markup, html};
use touchoff_verify::gcode::GENERIC;
use touchoff_verify::machine::Machine;
use touchoff_verify::{Program, Verifier};

/// Returns the assumptions of the check, and its files.
pub(super) fn assumptions(content: &Content<'_>) -> Markup {
    html! {
        section {
            h2 { "What was assumed" }
            ul { @for line in assumed(content) { li { (plain(&line)) } } }
            h3 { "Files" }
            table.files {
                thead { tr { th { "role" } th { "file" } th { "bytes" } th { "SHA-256" } } }
                tbody {
                    @for file in &content.files {
                        tr {
                            td.name { (plain(&file.role)) }
                            td.text { (plain(&file.name)) }
                            td.number { (file.bytes) }
                            td { code { (file.digest) } }
                        }
                    }
                }
            }
            p.note { "Written by touchoff " (env!("CARGO_PKG_VERSION")) ". Built-in tools are those of this version." }
        }
    }
}

/// Returns the assumptions, a sentence or more each.
fn assumed(content: &Content<'_>) -> Vec<String> {
    let mut lines = limits(content);
    lines.extend(motions(content));
    if content.inputs.file.anyway {
        lines.push("What is left open was accepted (`anyway`).".to_owned());
    }
    if content.checked.is_surface_only() {
        lines.push("The inside of a mesh is undefined; only its surface was checked.".to_owned());
    }
    lines.push(
        "The tool is its profile as drawn, turned about its axis. Deflection, runout, the rounding of corners by the control \
         and acceleration are not modelled."
            .to_owned(),
    );
    lines.extend(display(content));
    lines
}

/// Describes the unit, and the depths that are allowed.
fn limits(content: &Content<'_>) -> Vec<String> {
    let job = &content.inputs.file;
    let unit = job.unit;
    let resolution = job.resolution.unwrap_or_else(|| Verifier::default_resolution(unit));
    let mut lines = vec![
        format!(
            "Lengths are in {unit}. The part's file was read in this unit, and the program is in the frame of the part."
        ),
        format!(
            "No surface may be deeper in the part than {} (the tolerance), in rapid traverse whatever its allowance. An excess \
             of up to {} (the resolution) may be left unreported.",
            unit.format(job.tolerance),
            unit.format(resolution)
        ),
    ];
    let allowed = job.allow.iter().map(|(surface, depth)| match depth {
        depth if *depth == f64::INFINITY => format!("{surface} may be any depth"),
        depth if *depth < 0.0 => format!("{surface} keeps {}", unit.format(-depth)),
        depth => format!("{surface} may be {} deep", unit.format(*depth)),
    });
    let allowed: Vec<String> = allowed.collect();
    if !allowed.is_empty() {
        lines.push(format!("Allowances: {}.", allowed.join("; ")));
    }
    lines
}

/// Describes the motions between positions, and what the program leaves to the control.
fn motions(content: &Content<'_>) -> Vec<String> {
    let inputs = content.inputs;
    let mut lines = Vec::new();
    match &inputs.program {
        Program::Locations(programs) => {
            lines.push(
                "Between two positions the tip moves on a straight line and the axis turns evenly about the common normal of \
                 both axes."
                    .to_owned(),
            );
            if let Some(words) = ignored_words(programs) {
                lines.push(format!("Words that move nothing were ignored: {words}."));
            }
        }
        Program::Machine(readings) => {
            let control = match &inputs.file.control {
                Some(control) if control.to_str() == Some(GENERIC) => {
                    "No control is named: what every control does that is known is checked."
                        .to_owned()
                }
                Some(control) => format!("Control: {}.", control.display()),
                None => "Control: that whose language the program has.".to_owned(),
            };
            lines.push(format!(
                "Machine: {}. {control} Between two blocks the control interpolates its axes. G54 is the frame of the part.",
                inputs.program.machine().map_or("", Machine::name)
            ));
            if readings.len() > 1 {
                let each = readings.iter().map(|reading| reading.assumed().to_string());
                lines.push(format!(
                    "Readings of the program: {}.",
                    each.collect::<Vec<_>>().join("; ")
                ));
            }
        }
    }
    lines
}

/// Describes how exact colours, charts and the 3-D view are.
fn display(content: &Content<'_>) -> Vec<String> {
    let mut lines = vec![
        match content.scene_rounding {
            Some(error) => format!(
                "The 3-D view rounds coordinates by at most {error:.1e} {}.",
                content.inputs.file.unit
            ),
            None => "The part has too many triangles for a 3-D view; pictures stand in for it."
                .to_owned(),
        },
        "Long triangles are divided for colouring. The depth of findings is coloured by samples: the centre of each triangle, \
         points near its corners, and the deepest points found."
            .to_owned(),
        format!(
            "Depth and clearance along the program hold at the positions, not between them; findings hold for whole motions. \
             Forces are sums over {POINTS} sampled points."
        ),
    ];
    if let Some(named) = content.map {
        lines.push(format!("Posture map {}: {}.", named.file.display(), describe(named.map)));
    }
    lines
}

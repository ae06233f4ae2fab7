//! Outlines of form mills in Fusion 360.

use super::shape::FormSegment;
use serde_json::Value;

/// Ends of arcs are stated with few digits: their distances from the centre may differ by this part of the radius.
const ARC_TOLERANCE: f64 = 1e-2;

/// Returns the segments of a profile: a list of ends, each with `arc`, `ccw` and `center` if it ends an arc. The
/// first is the start. The outline begins and ends on the axis, from the tip upward or the other way.
pub(super) fn profile(value: Option<&Value>) -> Result<Vec<FormSegment>, String> {
    let list = value.and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let mut corners = list.iter().map(corner).collect::<Result<Vec<_>, _>>()?;
    let (Some(first), Some(last)) = (corners.first(), corners.last()) else {
        return Err("its profile has no segments".to_owned());
    };
    if first.end[0] != 0.0 || last.end[0] != 0.0 {
        return Err("its profile does not begin and end on the axis".to_owned());
    }
    if first.end[1] > last.end[1] {
        corners = reversed(&corners);
    }
    if corners[0].end[1] != 0.0 || corners.iter().any(|corner| corner.end[1] < 0.0) {
        return Err("its profile does not begin at the tip, z = 0".to_owned());
    }
    let mut segments = Vec::new();
    for pair in corners.windows(2) {
        push(&mut segments, pair[0].end, &pair[1])?;
    }
    Ok(segments)
}

/// The end of a segment, and for an arc its centre and whether it runs counter-clockwise.
#[derive(Clone, Copy)]
struct Corner {
    end: [f64; 2],
    arc: Option<([f64; 2], bool)>,
}

fn corner(value: &Value) -> Result<Corner, String> {
    let point = |key: &str| -> Result<[f64; 2], String> {
        let list = value.get(key).and_then(Value::as_array);
        let number = |k: usize| list?.get(k)?.as_f64().filter(|number| number.is_finite());
        match (number(0), number(1)) {
            (Some(d), Some(z)) => Ok([d, z]),
            _ => Err(format!("a segment of its profile has no point `{key}`")),
        }
    };
    let flag = |key: &str| match value.get(key) {
        None => Ok(None),
        Some(Value::Bool(flag)) => Ok(Some(*flag)),
        Some(_) => Err(format!("`{key}` of a segment of its profile is neither true nor false")),
    };
    let arc = match (flag("arc")?, flag("ccw")?) {
        (Some(true), Some(ccw)) => Some((point("center")?, ccw)),
        (Some(true), None) => return Err("an arc of its profile has no `ccw`".to_owned()),
        (None, _) if value.get("center").is_some() => {
            return Err("a segment of its profile has a `center`, but no `arc`".to_owned());
        }
        _ => None,
    };
    Ok(Corner { end: point("end")?, arc })
}

fn reversed(corners: &[Corner]) -> Vec<Corner> {
    let mut reversed = Vec::new();
    for (k, corner) in corners.iter().enumerate().rev() {
        // The arc that ended at the next corner now ends at this one.
        let arc = corners.get(k + 1).and_then(|next| next.arc);
        reversed.push(Corner { end: corner.end, arc: arc.map(|(centre, ccw)| (centre, !ccw)) });
    }
    reversed
}

/// Adds a segment. An arc of more than half a turn becomes two.
fn push(segments: &mut Vec<FormSegment>, from: [f64; 2], corner: &Corner) -> Result<(), String> {
    let Corner { end, arc } = *corner;
    let Some((centre, ccw)) = arc else {
        segments.push(FormSegment { to: end, arc: None });
        return Ok(());
    };
    let radii = [from, end].map(|[d, z]| (d - centre[0]).hypot(z - centre[1]));
    let radius = (radii[0] + radii[1]) / 2.0;
    if !(radius > 0.0 && (radii[0] - radii[1]).abs() <= ARC_TOLERANCE * radius) {
        return Err("the ends of an arc of its profile are not on one circle".to_owned());
    }
    let [start, stop] = [from, end].map(|[d, z]| (z - centre[1]).atan2(d - centre[0]));
    let turn = if ccw { stop - start } else { start - stop };
    let turn = turn.rem_euclid(std::f64::consts::TAU);
    let concave = !ccw;
    let mut stops = vec![end];
    if turn > std::f64::consts::PI || turn == 0.0 {
        let full = if turn == 0.0 { std::f64::consts::TAU } else { turn };
        let middle = start + if ccw { full / 2.0 } else { -full / 2.0 };
        let at = [centre[0] + radius * middle.cos(), centre[1] + radius * middle.sin()];
        stops.insert(0, at.map(super::term::rounded));
    }
    let mut last = from;
    for to in stops {
        // Rounded ends may be farther apart than the diameter.
        let chord = (to[0] - last[0]).hypot(to[1] - last[1]);
        segments.push(FormSegment { to, arc: Some((radius.max(chord / 2.0), concave)) });
        last = to;
    }
    Ok(())
}

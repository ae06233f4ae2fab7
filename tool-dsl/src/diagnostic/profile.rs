//! Profiles: their segments, arcs and orientation.

use super::data::FormattedNumber;
use super::table::kinds;

kinds! {
    /// Profiles: segments, arcs, sense.
    ProfileKind "T03" "Profiles"

    error T0301 TooManySegments { most: usize }
        "too many segments"
        message "more than {most} segments"
        help "arcs say in one segment what many short lines say"
        explain "The plane is divided by the nearest segment, which would take minutes for more of them."
        without "an example would have hundreds of segments";
    error T0302 BeginsOffAxis { begin: String, axis: String }
        "profile that begins off the axis"
        message "the profile begins at {begin}, not on the axis"
        help "write `start {axis};` and then `line to {begin}`"
        explain "A profile is turned about the axis. It runs from the axis to the axis, and the axis closes it.";
    error T0303 EndsOffAxis { end: String, axis: String }
        "profile that ends off the axis"
        message "the profile ends at {end}, not on the axis"
        help "let it run from the axis to the axis: add `line to {axis}`"
        explain "A profile is turned about the axis. It runs from the axis to the axis, and the axis closes it.";
    error T0304 SegmentWithoutLength
        "segment without a length"
        message "this segment has no length"
        help "drop it"
        explain "Its end is its beginning, so that it has no direction and no normal.";
    error T0305 OffCircle { near: String, far: String }
        "arc off its circle"
        message "the arc's ends are {near} and {far} from its centre"
        help "both ends lie on one circle; by `radius` its centre is found for you"
        explain "An arc's centre is as far from its beginning as from its end.";
    error T0306 RadiusNotPositive
        "radius that is not positive"
        message "an arc's radius is more than 0"
        help "into the material it bulges by `concave`"
        explain "The sign of a radius has no meaning here: `concave` says on which side the centre lies.";
    error T0307 FlatArc { radius: FormattedNumber }
        "arc as flat as a line"
        message "this arc of radius {radius} is a line to all ends"
        help "write `line to`"
        explain "The radius is more than a million times the chord, so that rounding would decide where the arc lies.";
    error T0308 NotConcave
        "arc that is not concave"
        message "this arc is not concave"
        help "its centre lies in the material: drop `concave`"
        explain "`concave` marks arcs whose centre lies outside the material, so that a wrong sign is noticed.";
    error T0309 Concave { centre: String }
        "concave arc"
        message "this arc is concave: its centre {centre} lies outside the material"
        help "say `concave` if it should be"
        explain "`concave` marks arcs whose centre lies outside the material, so that a wrong sign is noticed.";
    error T0310 RadiusTooSmall { radius: FormattedNumber, chord: FormattedNumber, least: FormattedNumber }
        "radius too small"
        message "no arc of radius {radius} spans a chord of {chord}"
        help "its radius is {least} or more; else bring its ends nearer"
        explain "The ends of an arc are at most two radii apart.";
    error T0311 OnAxis
        "segment on the axis"
        message "this segment lies on the axis"
        help "leave it out: the axis closes the profile by itself"
        explain "A segment on the axis bounds no material.";
    error T0312 CrossesAxis
        "segment across the axis"
        message "this segment crosses the axis"
        help "`d` is a radius and never negative"
        explain "Only the half of the section at `d >= 0` is written. It is turned about the axis.";
    error T0313 TouchesAxis
        "segment that touches the axis"
        message "this segment touches the axis"
        help "a profile is on the axis at its two ends only"
        explain "Where a profile touches the axis, the solid would hang together by a single point.";
    error T0314 Clockwise
        "profile that runs clockwise"
        message "the profile runs clockwise"
        help "start at its low end and keep the material on the left"
        explain "The sense of a profile says on which side the material lies.";
    error T0315 AlongAxis { place: String }
        "needle on the axis"
        message "this segment runs along the axis at {place}"
        help "a needle without an angle is no solid: let it meet the axis at an angle"
        explain "The material between the segment and the axis has no angle there, and no direction leads out of it.";
    error T0316 TurnsBack { place: String }
        "needle at a corner"
        message "this segment turns straight back at {place}"
        help "a needle without an angle is no solid: move a corner"
        explain "The material between the two segments has no angle at their corner, and no direction leads out of it.";
    error T0317 HardlyTurns { least: f64, place: String }
        "corner too flat to be told"
        message "this segment turns by less than {least:e} at {place}"
        help "such a corner is told from none by no double: draw both as one line"
        explain "Double precision does not tell such a corner from a straight line.";
    error T0318 MeetsItself { touches: bool, place: String }
        "profile that meets itself"
        message (touches) {
            true => "this segment touches that one at {place}",
            false => "this segment crosses that one at {place}",
        }
        help "a profile never crosses or touches itself: move a corner"
        explain "A profile bounds one solid. Where it meets itself, inside and outside are not told apart.";
    error T0319 Undivided { d: f64, z: f64 }
        "section that could not be divided"
        message "the section could not be divided by nearest features near ({d:.4}, {z:.4})"
        help "write this tool's regions by hand, as in docs/language.md"
        explain "The regions of a profile are the points nearest to each segment. Rounding can hide where three of them meet."
        without "no outline is known for which the division fails";
}

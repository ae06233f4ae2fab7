//! Profiles: their segments, arcs and orientation.

use super::data::FormattedNumber;
use super::table::kinds;

kinds! {
    /// Profiles: segments, arcs, sense.
    ProfileKind "T03" "Profiles"

    error T0301 TooManySegments { limit: usize }
        "too many segments"
        message "the profile has more than {limit} segments"
        help "replace runs of short lines by arcs"
        explain "The compiler divides the section into regions by nearest segment. More segments would take minutes."
        without "an example would have hundreds of segments";
    error T0302 StartsOffAxis { start: String, axis_point: String }
        "profile that starts off the axis"
        message "the profile starts at {start}, not on the axis"
        help "write `start {axis_point};`, then `line to {start}`"
        explain "A profile is rotated about the axis. It starts and ends on the axis, which closes it.";
    error T0303 EndsOffAxis { end: String, axis_point: String }
        "profile that ends off the axis"
        message "the profile ends at {end}, not on the axis"
        help "add `line to {axis_point}` at the end"
        explain "A profile is rotated about the axis. It starts and ends on the axis, which closes it.";
    error T0304 ZeroLengthSegment
        "segment of zero length"
        message "this segment has zero length"
        help "remove it, or correct its end point"
        explain "Its start and end points are equal, so it has no direction and no normal.";
    error T0305 UnequalArcRadii { start_radius: String, end_radius: String }
        "arc ends at unequal distances from the centre"
        message "the arc starts {start_radius} from its centre but ends {end_radius} from it"
        help "correct the centre, or write `radius R` and the compiler finds it"
        explain "The start and the end of an arc are equally far from its centre.";
    error T0306 RadiusNotPositive
        "radius that is not positive"
        message "the radius of an arc must be greater than 0"
        help "write a positive radius; for an arc that curves into the material add `concave`"
        explain "The sign of a radius has no meaning. `concave` says that the centre lies outside the material.";
    error T0307 FlatArc { radius: FormattedNumber }
        "arc too flat"
        message "an arc of radius {radius} is too flat between these points"
        help "write `line to`, or a smaller radius"
        explain "The radius is more than a million times the chord, so rounding would decide where the arc lies.";
    error T0308 NotConcave
        "arc marked `concave` that is not"
        message "this arc is marked `concave`, but its centre lies in the material"
        help "remove `concave`, or move the centre to the other side"
        explain "`concave` marks arcs whose centre lies outside the material. The check finds centres on the wrong side.";
    error T0309 UnmarkedConcave { centre: String }
        "concave arc not marked"
        message "this arc is not marked `concave`, but its centre {centre} lies outside the material"
        help "add `concave`, or move the centre to the other side"
        explain "`concave` marks arcs whose centre lies outside the material. The check finds centres on the wrong side.";
    error T0310 RadiusTooSmall { radius: FormattedNumber, chord: FormattedNumber, min_radius: FormattedNumber }
        "radius too small for its chord"
        message "a radius of {radius} is too small: the end points are {chord} apart"
        help "write a radius of {min_radius} or more, or move the end points closer together"
        explain "The end points of an arc are at most two radii apart.";
    error T0311 OnAxis
        "segment on the axis"
        message "this segment lies on the axis"
        help "remove it: the axis closes the profile"
        explain "A segment on the axis bounds no material.";
    error T0312 CrossesAxis
        "segment that crosses the axis"
        message "this segment crosses the axis"
        help "keep `d` at 0 or more: it is the distance from the axis"
        explain "A profile describes the half of the section with `d >= 0`. It is rotated about the axis.";
    error T0313 TouchesAxis
        "segment that touches the axis"
        message "this segment touches the axis between the ends of the profile"
        help "keep `d` above 0 except at the two ends of the profile"
        explain "Where a profile touches the axis between its ends, two pieces of the solid would meet in a single point.";
    error T0314 Clockwise
        "profile that runs clockwise"
        message "the profile runs clockwise"
        help "reverse the order of the points: start at the low end, with the material on the left"
        explain "The material lies to the left of a profile, seen with `d` to the right and `z` up.";
    error T0315 TangentToAxis { location: String }
        "profile tangent to the axis"
        message "this segment is tangent to the axis at {location}"
        help "make the segment meet the axis at an angle"
        explain "The tip there has an angle of 0, so no direction leads out of the material.";
    error T0316 TurnsBack { location: String }
        "segment that turns straight back"
        message "this segment turns straight back at {location}"
        help "move a point so that the segments enclose an angle"
        explain "The corner has an angle of 0, so no direction leads out of the material.";
    error T0317 CornerTooFlat { min_angle: f64, location: String }
        "corner too flat"
        message "this segment turns by less than {min_angle:e} rad at {location}"
        help "replace the two segments by one, or make the corner sharper"
        explain "Double precision cannot distinguish such a corner from a smooth transition.";
    error T0318 SelfIntersection { touches: bool, location: String }
        "profile that touches or crosses itself"
        message (touches) {
            true => "this segment touches another one at {location}",
            false => "this segment crosses another one at {location}",
        }
        help "move a point so that the segments stay apart"
        explain "A profile bounds one solid. Where it meets itself, inside and outside are ambiguous.";
    error T0319 NoDistance
        "segment without a distance"
        message "the distance from this segment has a constant without a value"
        help "change the segment's ends"
        explain "A region of a profile holds the points nearest to one segment or corner, and its depth is the distance from there."
        without "segments without a direction are refused before";
    note T0320 SegmentLeftOut { surface: String }
        "segment left out"
        message "this segment of `{surface}` has zero length with these params and is left out"
        help "change a param if the segment should be there"
        explain "A parametric tool may shrink a segment to nothing, such as a chamfer of 0. The profile continues without it.";
}

//! Regions, laws, directions, curves.

use super::data::{FormattedNumber, Role, SurfaceRemedy};
use super::table::kinds;
use crate::dimension::Dimension;

kinds! {
    /// Regions, laws, directions and curves.
    RegionKind "T04" "Regions, laws, directions, curves"

    error T0401 NoRegion { tool: String }
        "tool without regions"
        message "`{tool}` has no region"
        help "write `profile {{ … }}`, or `region NAME where … {{ depth: …; }}`"
        explain "A tool is a profile from which regions are derived, an assembly of mounted files, or a set of regions written by hand.";
    error T0402 TooManyRegions { limit: usize }
        "too many regions"
        message "more than {limit} regions"
        help "write a `profile` instead: its regions are derived"
        explain "The planner would need minutes to separate more regions."
        without "an example would have hundreds of regions";
    error T0403 DuplicateRegion { name: String }
        "two regions with the same name"
        message "two regions are called `{name}`"
        help "rename one of them"
        explain "Messages, drawings and generated code identify regions by their names.";
    error T0404 SurfaceCalledCutting
        "surface called `cutting`"
        message "a surface cannot be called `cutting`"
        help "write `as NAME cutting`"
        explain "`cutting` after a surface's name marks that surface as cutting. In laws it stands for all cutting surfaces.";
    error T0405 InconsistentCutting { name: String, marked_here: bool }
        "surface that is both cutting and non-cutting"
        message (marked_here) {
            true => "surface `{name}` is marked `cutting` here but not elsewhere",
            false => "surface `{name}` is marked `cutting` elsewhere but not here",
        }
        help "mark all segments and regions of the surface `cutting`, or none"
        explain "A cutting surface removes material, a non-cutting one must not touch the part. Each surface is one or the other.";
    error T0406 AngleAsQuantity
        "magnitude or niceness that is an angle"
        message "this is an angle, not a number or a power of length"
        help "write a number or a power of length"
        explain "Magnitude and niceness are numbers or powers of length.";
    error T0407 ZeroDirection { region: String }
        "direction of length 0"
        message "the direction of {region} is the zero vector"
        help "write a vector that is not zero, or `toward` a point"
        explain "The direction is normalized to a unit vector, which is impossible for the zero vector.";
    error T0408 DuplicateStatement { keyword: String }
        "duplicate statement"
        message "`{keyword}` is given twice"
        help "remove one of them"
        explain "A tool has one `tip`, one `spindle` and one `regions` item; a region has one value of each quantity.";
    error T0409 DuplicateDirection
        "duplicate direction"
        message "`direction` is given twice"
        help "remove one of them"
        explain "A region has one direction, along which its contacts push.";
    error T0410 NoDepth { region: String }
        "region without a depth"
        message "region {region} has neither `depth` nor `magnitude`, and there is no profile"
        help "write `depth: …;` in it: 0 on the surface, positive inside"
        explain "The depth tells how far a point is inside the tool. Only beside a profile is it derived, as the distance to the surface.";
    error T0411 UndefinedDepth { region: String }
        "magnitude that uses an undefined depth"
        message "`magnitude` of {region} uses `depth`, which is not defined"
        help "write `depth: …;` in the region"
        explain "A region without `depth` takes its depth from its magnitude, which then cannot use `depth`.";
    error T0412 DepthNotLength { dimension: Dimension }
        "depth that is not a length"
        message "a depth must be a length, but this is {dimension}"
        help (dimension) {
            Dimension::Angle => "write the distance to the surface",
            _ => "write the distance to the surface as `depth:`, and this as `magnitude:`",
        }
        explain "Certified queries compare depths with distances. A magnitude may be a number or any power of length.";
    error T0413 AngleAsMagnitude
        "magnitude that is an angle"
        message "a magnitude cannot be an angle"
        help "write a number or a power of length"
        explain "A region without `depth` takes its depth from its magnitude, which must be a number or a power of length.";
    error T0414 ConstantDepth
        "constant depth"
        message "this depth is constant"
        help "write a depth that is 0 on the surface and increases inward"
        explain "A contact pushes in the direction in which the depth decreases fastest. A constant depth has no such direction.";
    error T0415 TooManyConditions { limit: usize }
        "too many conditions"
        message "this region has more than {limit} conditions"
        help "combine several of them with `min` or `max`"
        explain "Conditions are the comparisons after `where`."
        without "an example would have hundreds of conditions";
    error T0416 MixedComparison { left: Dimension, right: Dimension }
        "comparison of different dimensions"
        message "this compares {left} with {right}"
        help "give both sides the same power of length; a number without a unit fits any"
        explain "A comparison of different dimensions would depend on the unit.";
    error T0417 NicenessWithoutSurface
        "niceness without a surface"
        message "this `niceness` law does not say for which surfaces"
        help "write `niceness cutting: …;`, or name the surfaces"
        explain "Niceness ranks contacts of cutting surfaces. On all others it is 0, so a law for all surfaces would not hold.";
    error T0418 DuplicateLaw { quantity: &'static str, surface: Option<String> }
        "two laws for one surface"
        message (surface) {
            Some(surface) => "two laws give the {quantity} of `{surface}`",
            None => "two laws give the {quantity} of all surfaces",
        }
        help "remove one of them"
        explain "For each quantity there is at most one law per surface, one for `cutting`, and one for all surfaces.";
    error T0419 UnknownSurface { name: String, remedy: SurfaceRemedy }
        "unknown surface"
        message "unknown surface `{name}`"
        help (remedy) {
            SurfaceRemedy::Similar(suggestion) => "did you mean `{suggestion}`?",
            SurfaceRemedy::List(surfaces) => "write one of the surfaces {surfaces}",
            SurfaceRemedy::OfMount(surfaces) => "write a surface of the mounted tool: {surfaces}",
            SurfaceRemedy::OfProfile => "write a surface of the profile",
        }
        explain "Surfaces are named by `as` in a profile or a region. Those of a mounted tool begin with the mount's name: `cutter.flute`.";
    error T0420 NicenessOfNonCutting { surface: String }
        "niceness of a non-cutting surface"
        message "`{surface}` is not marked `cutting`, so its niceness is 0"
        help "mark the surface `cutting`, or remove this niceness"
        explain "Niceness ranks contacts of cutting surfaces. On all others it is 0.";
    error T0421 TooManySmoothSegments { limit: usize }
        "too many segments for `regions smooth`"
        message "`regions smooth` with more than {limit} segments"
        help "write `regions nearest;`, or replace many short lines by arcs"
        explain "The compiler intersects the cells of the rounded profile with those of the profile, which would take minutes."
        without "an example would have hundreds of segments";
    error T0422 DepthBesideProfile
        "depth beside a profile"
        message "the profile already gives the depth"
        help "remove `depth:`, or write `magnitude:` instead"
        explain "Beside a profile the depth is the distance to its surface. Regions can only change the magnitude, the direction and the niceness.";
    error T0423 CuttingBesideProfile
        "`cutting` beside a profile"
        message "the profile already tells which surfaces cut"
        help "remove `cutting` here"
        explain "A region beside a profile names one of its surfaces, and the profile marks those that cut.";
    error T0424 SmoothNotPositive
        "tangent length that is not positive"
        message "the tangent length must be more than 0"
        help "write the length before and after each corner over which the direction turns"
        explain "`regions smooth` turns the direction gradually over this length on both sides of each corner.";
    error T0425 NoTangentArc { location: String, max_length: Option<String> }
        "corner that cannot be smoothed"
        message "no arc touches both segments this close to the corner at {location}"
        help (max_length) {
            Some(max_length) => "write a tangent length of at most {max_length}",
            None => "write the regions by hand",
        }
        explain "A corner is smoothed by an arc that is tangent to both segments, at most the tangent length from the corner.";
    error T0426 FansTooWide { corners: Option<[String; 2]>, segment_length: FormattedNumber, max_length: Option<String> }
        "tangent length too large"
        message (corners) {
            Some([first, second]) => "the fans of {first} and {second} do not fit on the segment of length {segment_length}",
            None => "the corner's fan does not fit on the segment of length {segment_length}",
        }
        help (max_length) {
            Some(max_length) => "write a tangent length of at most {max_length}",
            None => "write the regions by hand",
        }
        explain "At each corner the direction turns in a fan of the tangent length on both sides. The fans at both ends of a segment must fit on it.";
    error T0428 UncoveredPoint { location: String }
        "point of a profile without a region"
        message "no region covers the point {location} inside the profile"
        help "widen a region or add one: together they must cover the inside of the profile"
        explain "A contact at a point without a region would have no force.";
    error T0429 RegionOutsideProfile { region: String }
        "region outside the profile"
        message "region {region} contains no point inside the profile"
        help "check whether its conditions contradict each other or an earlier region covers it"
        explain "A region beside a profile contains the points inside the profile at which its conditions hold.";
    error T0430 MixedDirection { first: Dimension, second: Dimension }
        "direction of mixed dimensions"
        message "this direction mixes {first} and {second}"
        help "give all components the same dimension"
        explain "The components of a direction are all numbers, or all the same power of length.";
    error T0431 WrongComponentCount { role: Role, domain: &'static str, expected: usize, count: usize, coordinates: String }
        "point or direction with the wrong number of components"
        message (expected) {
            2 => "{role} in a {domain} has two numbers; this has {count}",
            _ => "{role} in a {domain} has three numbers; this has {count}",
        }
        help ((role, expected)) {
            (Role::Direction, 2) => "write `(radial, axial)`: the components across the axis and along the file's z",
            (Role::Direction, _) => "write `{coordinates}`",
            _ if count > expected => "write `{coordinates}`; a decimal comma? write `0.5`",
            _ => "write `{coordinates}`",
        }
        explain "Points and directions of a `tool` lie in its half plane and have two components. Those of a `solid` have three.";
    error T0432 NotInSolid { keyword: &'static str }
        "item of a tool in a solid"
        message "`{keyword}` exists in a `tool` only"
        help (*keyword) {
            "tip" => "a `solid` has no axis: remove `tip`, since a pose places the file's origin",
            "spindle" => "a `solid` has no axis: remove `spindle`, since a pose places the file's frame",
            _ => "a `solid` has no axis: write its regions by hand",
        }
        explain "Tip, spindle, profile, mounts and `regions` need the axis of a solid of revolution.";
    error T0433 DerivedAndWrittenRegions
        "`regions` beside regions written by hand"
        message "`regions` cannot be combined with regions written by hand"
        help "remove `regions`, or the regions written by hand"
        explain "The regions of a profile are either derived from it or written by hand beside it.";
    error T0434 SecondProfile
        "second profile"
        message "this tool has a second profile"
        help "remove one, or put each profile in a file and join them with `mount`"
        explain "A tool is one solid with one profile.";
    error T0435 NoProfile
        "`regions` without a profile"
        message "`regions` needs a profile from which to derive regions"
        help "write `profile {{ … }}`, or remove `regions`"
        explain "`regions` tells how regions are derived from a profile.";
    warning T0436 DuplicateCurve { name: String }
        "curve listed twice"
        message "`{name}` is listed twice"
        help "remove one of them"
        explain "`bsp` lists the curves that are tested first, in this order.";
    warning T0437 UnusedCurve { name: String }
        "curve that no region depends on"
        message "no region depends on `{name}`"
        help "remove it from `bsp`"
        explain "`bsp` lists the curves that are tested first. A curve that separates no regions is never tested.";
    error T0438 UnknownCurve { name: String, suggestion: Option<String> }
        "unknown curve"
        message "unknown curve `{name}`"
        help (suggestion) {
            Some(suggestion) => "did you mean `{suggestion}`?",
            None => "define it above: `curve {name} = …;`",
        }
        explain "`bsp` lists curves by their names.";
    warning T0439 NoCuttingSurface { quantity: &'static str }
        "law for cutting surfaces of a tool without any"
        message "this {quantity} holds for no surface: none is marked `cutting`"
        help "mark a surface `cutting`, as in `line to (3, 20) as flute cutting;`"
        explain "A law for `cutting` holds for all surfaces with that mark, and this tool has none.";
}

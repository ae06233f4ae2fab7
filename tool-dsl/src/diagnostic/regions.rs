//! Regions, laws, directions, curves.

use super::data::{FormattedNumber, Role, SurfaceRemedy};
use super::table::kinds;
use crate::dimension::Dimension;

kinds! {
    /// Regions, laws, directions and curves.
    RegionKind "T04" "Regions, laws, directions, curves"

    error T0401 NoRegion { tool: String }
        "tool without a region"
        message "`{tool}` has no region"
        help "write its outline, `profile {{ … }}`, or `region NAME where … {{ depth: …; }}`"
        explain "A tool is an outline from which regions are derived, mounted files, or regions written by hand.";
    error T0402 TooManyRegions { most: usize }
        "too many regions"
        message "more than {most} regions"
        help "write the outline as a `profile`: its regions are derived"
        explain "The planner would take minutes to tell more regions apart."
        without "an example would have hundreds of regions";
    error T0403 RegionsAlike { name: String }
        "two regions of one name"
        message "two regions are called `{name}`"
        help "give it another name"
        explain "Messages, drawings and generated code tell regions by their names.";
    error T0404 SurfaceCalledCutting
        "surface called `cutting`"
        message "no surface is called `cutting`"
        help "write `as NAME cutting`"
        explain "`cutting` marks a surface, behind its name. Laws mean all such surfaces by it.";
    error T0405 CuttingDisagrees { name: String, here: bool }
        "surface that cuts here and not there"
        message (here) {
            true => "`{name}` is cutting here",
            false => "`{name}` is not cutting here",
        }
        help "all pieces of one surface agree"
        explain "Gouges of cutting surfaces count otherwise than collisions of others, so that each surface is one or the other.";
    error T0406 AngleAsQuantity
        "quantity that is an angle"
        message "this is an angle"
        help "give a number or a power of length"
        explain "Magnitude and niceness are numbers or powers of length.";
    error T0407 DirectionIsZero { region: String }
        "direction that is 0"
        message "the direction of {region} vanishes"
        help "give a vector that is not 0, or `toward` a point"
        explain "The direction is made a unit vector, which a vector of no length has not.";
    error T0408 SaidTwice { word: String }
        "statement made twice"
        message "`{word}` is said twice"
        help "drop one"
        explain "A tool has one tip, one spindle and one way to its regions, a region one value of each quantity.";
    error T0409 DirectionTwice
        "direction written twice"
        message "the direction is said twice"
        help "drop one"
        explain "A region has one direction, in which a contact pushes.";
    error T0410 NoDepth { region: String }
        "region without a depth"
        message "region {region} says neither `magnitude` nor `depth`, and there is no profile to take it from"
        help "write `depth: …;` in it: 0 on the surface, positive inside"
        explain "Depth tells how far a point is inside the tool. Beside a profile it is the distance to that.";
    error T0411 DepthOfItself { region: String }
        "magnitude by a depth that nothing gives"
        message "`magnitude` of {region} mentions `depth`, which nothing else gives"
        help "write `depth: …;` in the region"
        explain "Without `depth` a region's magnitude is its depth, which cannot be computed from itself.";
    error T0412 DepthNotLength { dimension: Dimension }
        "depth that is no length"
        message "a depth is a length, this is {dimension}"
        help "write how far it is to the surface; any power is a `magnitude:`"
        explain "Certified queries compare depth with distances. What is felt may have any dimension, as `magnitude`.";
    error T0413 AngleAsMagnitude
        "magnitude that is an angle"
        message "a magnitude is no angle"
        help "give a number or a power of length"
        explain "A region without `depth` takes it from its magnitude, which grows with a power of length.";
    error T0414 ConstantDepth
        "constant depth"
        message "this depth is the same everywhere"
        help "a depth is 0 on the surface and grows inward"
        explain "The direction out of the tool is that in which the depth falls.";
    error T0415 TooManyConditions { most: usize }
        "too many conditions"
        message "more than {most} conditions"
        help "several of one kind are one, by `min` or `max`"
        explain "Conditions are those behind the `where` of one region."
        without "an example would have hundreds of conditions";
    error T0416 UnlikeSides { left: Dimension, right: Dimension }
        "comparison of unlike dimensions"
        message "this compares {left} with {right}"
        help "both sides want the same power of length; a bare number fits any"
        explain "A comparison of unlike dimensions would depend on the unit.";
    error T0417 NicenessOfAll
        "niceness of no surface in particular"
        message "for which surfaces is this niceness?"
        help "write `niceness cutting: …;` or name the surfaces"
        explain "Niceness ranks contacts of cutting surfaces; others have none, so that a law for all would not hold.";
    error T0418 TwoLaws { quantity: &'static str, surface: Option<String> }
        "two laws for one surface"
        message (surface) {
            Some(surface) => "two laws give the {quantity} of `{surface}`",
            None => "two laws give the {quantity} of everything",
        }
        help "drop one"
        explain "A surface has one law for each quantity: its own, that of `cutting`, or that of all.";
    error T0419 UnknownSurface { word: String, remedy: SurfaceRemedy }
        "unknown surface"
        message "unknown surface `{word}`"
        help (remedy) {
            SurfaceRemedy::Meant(meant) => "did you mean `{meant}`?",
            SurfaceRemedy::List(surfaces) => "surfaces are {surfaces}",
            SurfaceRemedy::OfPart(surfaces) => "name a surface of the part: {surfaces}",
            SurfaceRemedy::OfProfile => "name a surface of the profile",
        }
        explain "Surfaces are named by `as` in a profile or a region. Those of a mounted part carry its name: `cutter.flute`.";
    error T0420 IdleNiceness { surface: String }
        "niceness of a surface that does not cut"
        message "`{surface}` does not cut, its niceness is 0"
        help "make it `cutting` or drop the rule"
        explain "Niceness ranks contacts of cutting surfaces. That of others is 0.";
    error T0421 SmoothTooLarge { most: usize }
        "`regions smooth` of too many segments"
        message "`regions smooth` of more than {most} segments"
        help "write `regions nearest;`, or arcs instead of many short lines"
        explain "The cells of each corner are laid over those of each segment, which would take minutes."
        without "an example would have hundreds of segments";
    error T0422 DepthBesideProfile
        "depth beside a profile"
        message "`depth` is the profile's here"
        help "write `magnitude:` for what is felt"
        explain "Beside a profile the depth is the distance to it. Regions divide it for other magnitudes and directions.";
    error T0423 CuttingBesideProfile
        "`cutting` beside a profile"
        message "the profile says which surfaces cut"
        help "drop `cutting` here"
        explain "A region beside a profile names one of its surfaces, which is cutting or not.";
    error T0424 SmoothNotPositive
        "tangent length that is not positive"
        message "a tangent length is more than 0"
        help "write how far before and behind a corner the direction turns"
        explain "`regions smooth` turns the direction gradually over this length on both sides of each corner.";
    error T0425 NoTouchingArc { place: String, most: Option<String> }
        "corner that cannot be smoothed"
        message "no arc touches both segments so near to {place}"
        help (most) {
            Some(most) => "write at most {most}",
            None => "write regions by hand",
        }
        explain "A corner is smoothed by an arc that is tangent to both segments, at the tangent length from it.";
    error T0426 FansTooWide { corners: Option<[String; 2]>, edge: FormattedNumber, most: Option<String> }
        "tangent length too large"
        message (corners) {
            Some([first, second]) => "the fans of {first} and {second} do not fit on the edge of length {edge}",
            None => "its fan does not fit on the edge of length {edge}",
        }
        help (most) {
            Some(most) => "write at most {most}",
            None => "write regions by hand",
        }
        explain "The tangent lengths at both ends of an edge together are no longer than the edge.";
    error T0427 SmoothUndivided { place: String }
        "smoothed section that could not be divided"
        message "the smoothed section could not be divided near {place}"
        help "give another tangent length"
        explain "The directions of `regions smooth` are those of the outline with rounded corners. Rounding can hide where three of its pieces meet."
        without "no outline is known for which the division fails";
    error T0428 NotCovered { place: String }
        "part of a profile without a region"
        message "nothing covers {place}, which the profile contains"
        help "the regions beside a profile divide all of it: widen one, or write one more"
        explain "A point of the solid that no region has would be felt by nothing.";
    error T0429 NoPointOfProfile { region: String }
        "region outside the profile"
        message "region {region} has no point of the profile"
        help "do its conditions contradict one another, or does one listed before it cover it?"
        explain "A region beside a profile has those points of it at which its conditions hold.";
    error T0430 UnlikeParts { first: Dimension, other: Dimension }
        "direction of unlike dimensions"
        message "a direction of {first} and {other}"
        help "all its parts are alike"
        explain "A direction's parts are all numbers, or all of the same power of length.";
    error T0431 WrongParts { role: Role, file: &'static str, wanted: usize, count: usize, tuple: String }
        "point or direction with the wrong number of parts"
        message (wanted) {
            2 => "{role} in a {file} has two numbers, this has {count}",
            _ => "{role} in a {file} has three numbers, this has {count}",
        }
        help ((role, wanted)) {
            (Role::Direction, 2) => "write `(radial, axial)`: across the axis, and along the file's z",
            (Role::Direction, _) => "write `{tuple}`",
            _ if count > wanted => "write `{tuple}`; a decimal comma? write `0.5`",
            _ => "write `{tuple}`",
        }
        explain "Points and directions of a `tool` lie in its half plane and have two parts. Those of a `solid` have three.";
    error T0432 NotInSolid { word: &'static str }
        "item of a tool in a solid"
        message "`{word}` exists in a `tool` only"
        help (*word) {
            "tip" => "a `solid` has no axis: its file's origin is the pose's",
            "spindle" => "a `solid` has no axis: its file's frame is the pose's",
            _ => "a `solid` has no axis: it has regions by hand",
        }
        explain "Tip, spindle and profile speak of the axis of a solid of revolution.";
    error T0433 DerivedAndWritten
        "regions derived and written"
        message "the regions are derived and written"
        help "drop this, or the regions"
        explain "The regions of a profile are derived from it, or written by hand beside it.";
    error T0434 SecondProfile
        "second profile"
        message "a second profile"
        help "a tool has one outline: drop one"
        explain "A tool is one solid, whose outline is one profile. Several are joined by `mount`.";
    error T0435 NoProfile
        "regions of no profile"
        message "there is no profile to derive regions of"
        help "write `profile {{ … }}`"
        explain "`regions` says how a profile's regions are derived.";
    warning T0436 ListedTwice { word: String }
        "curve listed twice"
        message "`{word}` is listed twice"
        help "drop one"
        explain "`bsp` lists the curves that are to be tested first, in their order.";
    warning T0437 IdleCurve { word: String }
        "curve that no region depends on"
        message "no region depends on `{word}`"
        help "drop it from `bsp`"
        explain "`bsp` lists the curves that are to be tested first. A curve that parts no regions is never tested.";
    error T0438 UnknownCurve { word: String, meant: Option<String> }
        "unknown curve"
        message "unknown curve `{word}`"
        help (meant) {
            Some(meant) => "did you mean `{meant}`?",
            None => "define it above: `curve {word} = …;`",
        }
        explain "`bsp` lists curves by their names.";
}

//! Checks of the finished tool: its extent, its regions, its plan, its proofs.

use super::data::{FormattedNumber, Statement, Subject};
use super::table::kinds;

kinds! {
    /// Checks of the finished tool.
    CheckKind "T06" "Checks of the finished tool"

    error T0601 TipNotAtEnd { end: FormattedNumber, tip: FormattedNumber, spindle: Option<char> }
        "tool that does not end at its tip"
        message "the tool ends at z = {end}, but `tip` is at z = {tip}"
        help (spindle) {
            Some(sign) => "write `spindle {sign}z;`: the tool's other end is at the tip",
            None => "write `tip z = {end};`",
        }
        explain "A pose places the tip. The tip must be the end of the tool that points away from the spindle.";
    error T0602 ConstantOverflow
        "constant too large for double precision"
        message "a constant of this tool overflows double precision"
        help "avoid powers of powers of large constants, or write lengths in a larger unit"
        explain "Generated code computes in double precision, in which this constant would be infinite."
        without "no text is known in which each constant alone is in range";
    error T0603 NoPoints { domain: &'static str }
        "tool without points"
        message "no point belongs to this {domain}"
        help "correct the conditions: in each region they contradict each other"
        explain "The compiler has proved that no point satisfies all conditions of any region.";
    error T0604 UnboundedRegion { region: String, direction: &'static str, coordinate: &'static str, bound: &'static str }
        "unbounded region"
        message "region {region} has no proved bound toward {direction} {coordinate}"
        help "add a condition such as `{coordinate} {bound}`"
        explain "Queries skip everything outside the tool's bounding box, so that box must be proved.";
    error T0605 UnboundedRegions { domain: &'static str }
        "unbounded regions"
        message "the regions have no proved bounds"
        help (*domain) {
            "solid" => "add conditions such as `hypot(x, y) <= 3, 0 <= z <= 40` to each region",
            _ => "add conditions such as `d <= 3, 0 <= z <= 40` to each region",
        }
        explain "Queries skip everything outside the tool's bounding box, so that box must be proved."
        without "the proof for one region decides: no tool is known that is unbounded only as a whole";
    error T0606 TooManyTests { limit: usize }
        "too many tests"
        message "more than {limit} tests are needed to separate the regions"
        help "separate the regions by fewer curves"
        explain "Generated code finds the region of a point by the signs of curves. With so many tests it would be slow to compile and to run."
        without "an example would have dozens of curves and take minutes";
    error T0607 Inseparable { d: f64, z: f64 }
        "features too close together"
        message "no curve separates the nearest features near ({d:.4}, {z:.4})"
        help "move features apart that are closer than 10^-10 of the tool's size, or draw chords of a circle as an arc"
        explain "At points near a border between such features rounding decides, so the tests would find the wrong region."
        without "it depends on rounding: some balls that are drawn as chords with 3 decimals cause it";
    error T0608 Overlap { first: String, second: String, location: String }
        "overlapping regions"
        message "regions {first} and {second} overlap, for instance at {location}"
        help "bound one of them by the curve that separates them"
        explain "Each point belongs to one region. Regions may share borders, but not interior points.";
    error T0609 CoveredRegion { region: String, covering: String, more: usize }
        "covered region"
        message (more) {
            0 => "region {region} has no points of its own: {covering}, listed before it, covers it",
            _ => "region {region} has no points of its own: {covering} and {more} more, listed before it, cover it",
        }
        help "remove it, or bound the earlier region by the curve that separates them"
        explain "A point in several regions belongs to the one listed first. That leaves no points for this one.";
    warning T0610 NoSamplePoint { region: String, samples: usize }
        "region without a sample point"
        message "region {region} contains none of the {samples} sample points"
        help "check whether its conditions contradict each other"
        explain "The compiler takes sample points all over the tool. A region that contains none of them is empty or very small.";
    error T0611 RootOfNegative { location: String, subject: Subject }
        "square root of a negative number"
        message "square root of a negative number at {location}, in {subject}"
        help "add a condition that the radicand is at least 0, or write `max(0, …)` under the root"
        explain "Each quantity of a region must have a value at all of its points, and each curve at all points of the tool.";
    error T0612 DivisionByZero { location: String, subject: Subject, by_hand: bool }
        "division by zero at a point"
        message "division by zero at {location}, in {subject}"
        help (by_hand) {
            true => "add a condition that keeps the region away from this point",
            false => "write a divisor that is nowhere 0, such as the sum of a length and a distance",
        }
        explain "Each quantity of a region must have a value at all of its points, and each curve at all points of the tool.";
    error T0613 NumericOverflow { location: String, subject: Subject }
        "numeric overflow"
        message "numeric overflow at {location}, in {subject}"
        help "divide by a length of the tool before taking powers"
        explain "Generated code computes in double precision, whose largest number is about 1.8e308.";
    error T0614 NegativeQuantity { quantity: &'static str, region: String, value: FormattedNumber, location: String }
        "negative quantity"
        message "`{quantity}` of {region} is {value} at {location}, but must not be negative"
        help "change the sign, or restrict the region"
        explain "The depth is 0 on the surface and increases inward. The magnitude must not be negative either.";
    error T0615 ZeroDirectionAtPoint { region: String, location: String }
        "direction of length 0 at a point"
        message "the direction of {region} is the zero vector at {location}"
        help "write a vector that is nowhere zero, or `toward` a point"
        explain "The direction is normalized to a unit vector at every point, which is impossible for the zero vector.";
    error T0616 DirectionTooLong { region: String, location: String }
        "direction too long"
        message "the direction of {region} is too long to be normalized at {location}"
        help "divide it by its length"
        explain "The square of its length overflows in double precision.";
    error T0617 NonzeroDepthOnSurface { region: String, depth: FormattedNumber, location: String }
        "depth on the surface that is not 0"
        message "`depth` of {region} is {depth} at {location}, on the surface, where it must be 0"
        help "correct the depth, or add the region that is missing beside this one"
        explain "A tool that just touches a part has depth 0 there. Where the tool ends at a larger depth, the force would jump.";
    warning T0618 SteepDepth { region: String, location: String }
        "depth with an infinite slope"
        message "`depth` of {region} has an infinite slope at {location}"
        help "write a depth that grows in proportion to the distance to the surface; certified queries need it"
        explain "A depth such as the square root of the distance gets steeper toward the surface, so no constant times the distance is an upper bound.";
    warning T0619 UnboundedQuantity { quantity: &'static str, region: String, value: FormattedNumber, location: String }
        "quantity that grows without bound"
        message "`{quantity}` of {region} grows without bound toward the surface: it is {value} near {location}"
        help "add a length to the divisor"
        explain "Contact begins on the surface, where this quantity would be infinite.";
    error T0620 DiscontinuousDepth { depth: FormattedNumber, other_depth: FormattedNumber, location: String, region: String, other_region: String }
        "discontinuous depth"
        message "depth jumps from {depth} to {other_depth} at {location}, between {region} and {other_region}"
        help "make the depths equal at the border; only a `magnitude:` may jump"
        explain "The depth must be a continuous function of the point. Bounds on the depth along motions rely on it.";
    warning T0621 ObliqueDirection { region: String, degrees: FormattedNumber, inward: bool, derived: bool, location: String }
        "direction other than the steepest descent of the depth"
        message (inward) {
            true => "the direction of {region} points straight inward at {location}",
            false => "the direction of {region} is {degrees}° off the steepest descent of its depth at {location}",
        }
        help (derived) {
            true => "report this with the file: the direction is derived from the depth, so the compiler has a bug",
            false => "write the direction of steepest descent, or `direction: … allow oblique;` if this is intended",
        }
        explain "A contact pushes along the direction. If it is not the steepest descent of the depth, closed motions gain or lose energy.";
    warning T0622 RisingNiceness { region: String, location: String, rate: FormattedNumber, unit: &'static str }
        "niceness that increases with depth"
        message "`niceness` of {region} increases with depth at {location}, by {rate} per {unit}"
        help "change the sign, or write `niceness: … allow rising;` if this is intended"
        explain "Niceness ranks contacts. A search for the nicest posture would move the tool into the part.";
    warning T0623 DepthNotProvedExact
        "depth of a profile not proved exact"
        message "the depth of this profile is not proved to be the distance to its surface"
        help "report this with the file: it is a bug in the compiler"
        explain "The depth of a profile is the distance to its surface by construction, which `touchoff check` proves once more."
        without "it is a bug in the compiler";
    warning T0624 Undecided { statement: Statement, location: String, more: usize, factor: Option<FormattedNumber> }
        "undecided proof"
        message (more) {
            0 => "not decided: {statement} near {location}",
            _ => "not decided: {statement} near {location}, and {more} similar cases",
        }
        help (factor) {
            Some(factor) => "the bound proved during compilation still holds: depth is at most {factor} times the distance",
            None => "certified queries refuse this tool; write each depth as the distance to the nearest surface, or as a `min` of distances",
        }
        explain "The prover divides the tool into a limited number of boxes. It found nothing wrong in those that are left.";
    warning T0625 NicenessNowherePositive { region: String, value: FormattedNumber, location: String }
        "niceness that is never above 0"
        message "`niceness` of {region} is above 0 at no sample point; its largest is {value}, at {location}"
        help "write 0 if no contact here is good, or remove `cutting` from the surface"
        explain "Niceness ranges from 0, a bad contact, to 1, the best. A value below 0 counts as 0.";
    note T0626 NicenessAboveOne { region: String, value: FormattedNumber, location: String }
        "niceness above 1"
        message "`niceness` of {region} is {value} at {location}"
        help "scale it to lie between 0 and 1, unless contacts here are meant to outweigh those of other tools and surfaces"
        explain "By convention niceness ranges from 0, a bad contact, to 1, the best. Larger values are taken as they are.";
    warning T0627 ForcelessMagnitude { region: String }
        "magnitude that does not grow with depth"
        message "`magnitude` of {region} is the same at every depth: under the force law `gradient` its contacts exert no force"
        help "let it grow inward from the surface, as `magnitude: 2*depth;` does, or query with the law `thesis`"
        explain "The law `gradient`, the default, takes the magnitude times its slope as force, the slope of an energy. The law `thesis` takes the magnitude alone.";
    note T0628 SlopeOfMagnitude { region: String, slope: FormattedNumber, unit: &'static str, location: String }
        "magnitude whose slope is not 1"
        message "the slope of `magnitude` of {region} is {slope} per {unit} at {location}: under the force law `gradient` it counts in the force, too"
        help "no action needed if this is meant; for k times the force under `gradient` write the root of k as the factor, or query with the law `thesis`"
        explain "The law `gradient`, the default, takes the magnitude times its slope as force, so that a factor of the magnitude counts squared. The law `thesis` takes the magnitude alone.";
    note T0629 UnusedDirection { region: String, degrees: FormattedNumber, location: String }
        "direction that a force law does not use"
        message "the direction of {region} is {degrees}° off the steepest descent of its magnitude at {location}: the force law `gradient` uses the latter only"
        help "no action needed if this is meant; for forces along the direction, query with the law `thesis`"
        explain "The law `gradient`, the default, pushes along the steepest descent of the magnitude. The law `thesis` pushes along the direction.";
    error T0690 MoreErrors
        "more errors"
        message "more errors follow"
        help "correct the errors above first"
        explain "At most 50 errors are shown at once. Later errors often result from earlier ones."
        without "an example would have fifty errors";
    warning T0691 MoreWarnings
        "more warnings"
        message "more warnings follow"
        help "correct the warnings above first"
        explain "At most 50 warnings are shown at once."
        without "an example would have fifty warnings";
    error T0692 Unexplained
        "rejection without a reason"
        message "this tool is rejected, but the compiler gave no reason"
        help "report this with the file: it is a bug in the compiler"
        explain "A rejection always comes with an error. If none is shown, the compiler has a bug."
        without "it is a bug in the compiler";
}

//! Checks of the finished tool: its extent, its regions, its plan, its proofs.

use super::data::{FormattedNumber, Statement, Subject};
use super::table::kinds;

kinds! {
    /// Checks of the finished tool.
    CheckKind "T06" "Checks of the finished tool"

    error T0601 OffTip { end: FormattedNumber, tip: FormattedNumber, spindle: Option<char> }
        "tool that does not end at its tip"
        message "the tool ends at z = {end} and its tip is said to be at {tip}"
        help (spindle) {
            Some(sign) => "its other end is there: write `spindle {sign}z;`",
            None => "write `tip z = {end};`",
        }
        explain "A pose places the tip. The tip is where the tool ends, away from the spindle.";
    error T0602 ConstantOutgrows
        "constant beyond all doubles"
        message "a constant of this tool outgrows all numbers"
        help "powers upon powers of large constants do so: write lengths in a nearer unit"
        explain "Generated code computes in double precision. A constant that it needs is infinite there."
        without "no text is known whose single constants are in range";
    error T0603 NoPoint { file: &'static str }
        "tool without a point"
        message "no point belongs to this {file}"
        help "the conditions of each region contradict one another"
        explain "It is proved that no point fulfils all conditions of any region.";
    error T0604 EndlessRegion { region: String, toward: &'static str, coordinate: &'static str, bound: &'static str }
        "region without an end"
        message "region {region} has no end toward {toward} {coordinate} that can be proved"
        help "bound it there, as in `{coordinate} {bound}`"
        explain "The runtime skips everything outside the box about a tool, so that the box must be proved.";
    error T0605 Endless
        "regions without an end"
        message "no end of the regions can be proved"
        help "bound each by lines, as in `d <= 3, 0 <= z <= 40`"
        explain "The runtime skips everything outside the box about a tool, so that the box must be proved."
        without "the proof for one region decides: no tool is known of which only all together are endless";
    error T0606 TooManyTests { most: usize }
        "too many tests"
        message "the regions need more than {most} tests to tell apart"
        help "divide the tool by fewer curves"
        explain "Generated code decides by the signs of curves which region a point is in. So many tests would be slow to compile and to run."
        without "an example would have dozens of curves and take minutes";
    error T0607 Inseparable { d: f64, z: f64 }
        "features too close together"
        message "no curve tells the nearest features apart near ({d:.4}, {z:.4})"
        help "features closer than 10^-10 of the tool's size cannot be told apart"
        explain "The tree of tests errs at points near a border between features, since rounding decides there."
        without "it depends on rounding: no outline is known to cause it";
    error T0608 Overlap { first: String, second: String, place: String }
        "regions that overlap"
        message "regions {first} and {second} overlap, for instance at {place}"
        help "bound one of them by the curve that divides them"
        explain "A point belongs to one region. Regions share borders, but no points inside both.";
    error T0609 NeverWins { region: String, by: String, more: usize }
        "region that is covered"
        message (more) {
            0 => "region {region} never wins a point: {by}, listed before it, covers it",
            _ => "region {region} never wins a point: {by} and {more} more, listed before it, cover it",
        }
        help "drop it, or bound that one by the curve that divides them"
        explain "A point of several regions belongs to the one listed first, which leaves nothing for this one.";
    warning T0610 NoPointSeen { region: String, points: usize }
        "region without a point"
        message "region {region} has none of the {points} points looked at"
        help "do its conditions contradict one another?"
        explain "The compiler looks at points all over the tool. A region of none of them is empty, or very small.";
    error T0611 RootOfNegative { place: String, subject: Subject }
        "root of a negative number"
        message "square root of a negative number at {place}, in {subject}"
        help "bound the region by what is under the root, or take `max(0, …)` of that"
        explain "Every quantity of a region has a value at all of its points, and every curve at all points of the tool.";
    error T0612 DivisionByZero { place: String, subject: Subject }
        "division by zero"
        message "division by zero at {place}, in {subject}"
        help "bound the region away from there"
        explain "Every quantity of a region has a value at all of its points, and every curve at all points of the tool.";
    error T0613 Unbounded { place: String, subject: Subject }
        "value beyond all bounds"
        message "a number beyond all bounds at {place}, in {subject}"
        help "powers of large numbers grow so: divide by a length of the tool first"
        explain "Generated code computes in double precision, whose largest number is some 1e308.";
    error T0614 Negative { quantity: &'static str, region: String, value: FormattedNumber, place: String }
        "negative quantity"
        message "`{quantity}` of {region} is {value} at {place}"
        help "it is never negative inside: turn a sign, or bound the region"
        explain "Depth is 0 on the surface and grows inward. Magnitude is never negative either.";
    error T0615 DirectionVanishes { region: String, place: String }
        "direction that vanishes"
        message "the direction of {region} vanishes at {place}"
        help "give a vector that is nowhere 0, or `toward` a point"
        explain "The direction is made a unit vector at every point, which a vector of no length has not.";
    error T0616 DirectionTooLong { region: String, place: String }
        "direction too long"
        message "the direction of {region} is too long to be made a unit vector at {place}"
        help "divide it by its size"
        explain "The square of its length overflows in double precision.";
    error T0617 DeepOnSurface { region: String, depth: FormattedNumber, place: String }
        "depth on the surface"
        message "`depth` of {region} is {depth} at {place}, on the surface"
        help "is a region missing beside it? A depth is 0 on the surface"
        explain "A tool that touches a part is 0 deep in it. Where the solid ends at a greater depth, what is felt would jump.";
    warning T0618 SteepDepth { region: String, place: String }
        "depth without a finite slope"
        message "`depth` of {region} has no finite slope at {place}"
        help "certified queries are not available for this tool: they want a depth that grows in step with the distance to the surface"
        explain "A depth such as a root of the distance is steeper the nearer the surface is, so that no distance bounds it.";
    warning T0619 GrowsUnbounded { quantity: &'static str, region: String, value: FormattedNumber, place: String }
        "quantity that grows without bound"
        message "`{quantity}` of {region} grows without bound toward the surface: it is {value} beside {place}"
        help "add a length to what it is divided by: contact begins on the surface"
        explain "Contact begins on the surface, where this quantity would be infinite.";
    error T0620 DepthJumps { own: FormattedNumber, other: FormattedNumber, place: String, region: String, beside: String }
        "depth that jumps"
        message "depth jumps from {own} to {other} at {place}, between {region} and {beside}"
        help "two regions have the same depth where they meet; what is felt may jump: write it as `magnitude:` beside a `depth:` that does not"
        explain "Depth is a continuous function of the point. Bounds of depth along motions follow from that.";
    warning T0621 ObliqueDirection { region: String, degrees: FormattedNumber, inward: bool, derived: bool, place: String }
        "direction other than the steepest way out"
        message (inward) {
            true => "the direction of {region} leads straight inward at {place}",
            false => "the direction of {region} is {degrees}° from the steepest way out of its depth at {place}",
        }
        help (derived) {
            true => "the direction follows from the depth here: this is a mistake of the compiler, and worth a report of it",
            false => "write the direction in which the depth falls fastest, or `direction: … allow oblique;` if it is meant",
        }
        explain "A contact pushes along the direction. One that is not the steepest way out adds or takes energy along closed motions.";
    warning T0622 NicenessRises { region: String, place: String, rate: FormattedNumber, unit: &'static str }
        "niceness that rises with depth"
        message "`niceness` of {region} rises with depth at {place}, by {rate} per {unit}"
        help "a deeper contact is seldom a better one: turn a sign, or write `allow rising` behind it if it is meant"
        explain "Niceness ranks contacts. A search for the nicest posture would be led into the part.";
    warning T0623 NotShownExact
        "depth of a profile not proved to be the distance"
        message "the depth of this profile is not shown to be the distance to its surface"
        help "a profile's depth is that distance: this is a mistake of the compiler, and worth a report of it"
        explain "The depth of a profile is the distance to its surface by construction, which `touchoff check` proves once more."
        without "it is a defect of the compiler";
    warning T0624 Undecided { statement: Statement, place: String, more: usize, exact: bool, bound: Option<FormattedNumber> }
        "proof left open"
        message (more) {
            0 => "not decided: {statement} near {place}",
            _ => "not decided: {statement} near {place}, and {more} more like it",
        }
        help ((exact, bound)) {
            (true, _) => "a profile's depth is the distance to its surface by construction, which is not proved for this tool",
            (false, Some(most)) => "that depth is at most {most} times the distance to the surface was proved while the tool was compiled, and stands",
            (false, None) => "bounds of depth by the distance are then not available",
        }
        explain "The prover divides the tool into boxes and stops at a number of them. Nothing wrong was found in what is left."
        without "only `touchoff check` proves so far; compiling stops before";
    error T0690 MoreErrors
        "more errors"
        message "more is wrong from here on"
        help "mend what stands above first"
        explain "At most 50 errors are shown at once. Later ones often follow from earlier ones."
        without "an example would have fifty errors";
    warning T0691 MoreWarnings
        "more warnings"
        message "more is warned of from here on"
        help "look at what stands above first"
        explain "At most 50 warnings are shown at once."
        without "an example would have fifty warnings";
    error T0692 Unexplained
        "refusal without a reason"
        message "this tool is refused, and the compiler did not say why"
        help "this is a defect of the compiler: please report it with the file"
        explain "A refusal always comes with an error. That none was shown is a defect of the compiler."
        without "it is a defect of the compiler";
}

//! Names, units, dimensions, values.

use super::data::{FormattedNumber, Links, NameRemedy, Names, Operation, ParamRemedy, Role};
use super::table::kinds;
use crate::dimension::Dimension;

kinds! {
    /// Names, units, dimensions and values.
    ValueKind "T02" "Names, units, dimensions, values"

    error T0201 UnknownName { word: String, remedy: NameRemedy }
        "unknown name"
        message "unknown name `{word}`"
        help (remedy) {
            NameRemedy::Meant(meant) => "did you mean `{meant}`?",
            NameRemedy::Define => "define it above, as in `let {word} = 3;`",
            NameRemedy::Constant => "what is given is a constant: numbers with their units, `pi`",
            NameRemedy::Dash => "a name has no dash: write `_`; a difference has spaces about its `-`",
        }
        explain "A name is a coordinate, `pi`, or defined above by `let`, `param` or `curve`.";
    error T0202 NameWithoutValue { word: String }
        "name without a value"
        message "`{word}` has no value: its definition is refused"
        help "mend its definition"
        explain "It follows from another error, which is shown in its place."
        without "only the error that it follows from is shown";
    error T0203 UsedAbove { word: String }
        "name used above its definition"
        message "`{word}` is used above its definition"
        help "move the definition up"
        explain "A name has a value only below its definition, so that a file is read from top to bottom.";
    error T0204 DefinedTwice { word: String }
        "name defined twice"
        message "`{word}` is defined twice"
        help "drop one, or give it another name"
        explain "A name has one meaning in a file. `let`, `param` and `curve` share their names.";
    error T0205 ReservedName { word: String, meaning: Option<&'static str> }
        "name of the language"
        message (meaning) {
            Some(meaning) => "`{word}` is {meaning} and cannot be defined",
            None => "`{word}` belongs to the language and cannot be defined",
        }
        help ((word.as_str(), meaning)) {
            ("d", Some(_)) => "for a diameter use `D`",
            _ => "take another name",
        }
        explain "Coordinates, functions, `pi` and `depth` keep their meaning in every file.";
    error T0206 DefinedByItself { word: String, links: Links, more: usize }
        "circular definition"
        message ((links.0.is_empty(), more)) {
            (true, _) => "`{word}` is defined by itself",
            (false, 0) => "`{word}` is defined by itself: {links}",
            (false, more) => "`{word}` is defined by itself: {links}, and {more} links more lead back to `{word}`",
        }
        help (links.0.is_empty()) {
            true => "write its value: a name has one only below its definition",
            false => "give one of them a value of its own",
        }
        explain "A definition may use names that are defined before it, but not its own name, not even by way of others.";
    warning T0207 UnusedName { word: String }
        "unused name"
        message "`{word}` is never used"
        help "drop it, or is another name misspelt?"
        explain "A definition that nothing uses changes nothing. Often another name was meant where it should be used.";
    error T0208 OtherCoordinate { word: String, other: &'static str }
        "coordinate of the other kind of file"
        message "`{word}` exists in a `{other}` only"
        help (*other) {
            "solid" => "in a `tool` the coordinates are `d`, the distance from the axis, and `z`",
            _ => "in a `solid` write `hypot(x, y)`",
        }
        explain "A `tool` is a solid of revolution, written in `d` and `z`. A `solid` is written in `x`, `y` and `z`.";
    error T0209 NotConstant { word: Option<String>, role: Role }
        "value that is no constant"
        message (word) {
            Some(word) => "`{word}` changes from point to point; {role} takes constants only",
            None => "this changes from point to point; {role} takes constants only",
        }
        help (role) {
            Role::Let | Role::Param => "name a function of the coordinates with `curve`",
            _ => "write a number, or a `let` or `param`",
        }
        explain "Points, radii, exponents, `let` and `param` are fixed when the tool is compiled. Functions of the coordinates are curves.";
    error T0210 DepthUnknown
        "`depth` out of place"
        message "`depth` is not known here"
        help "only `magnitude` and `niceness` may mention `depth`"
        explain "The depth of a point is known once its region is. Curves and conditions decide which region that is.";
    error T0211 UnknownFunction { word: String, meant: Option<&'static str>, known: &'static [&'static str] }
        "unknown function"
        message "unknown function `{word}`"
        help ((meant, known.join(", "))) {
            (Some(meant), _) => "did you mean `{meant}`?",
            (None, known) => "functions are {known}",
        }
        explain "The functions are those whose bounds and derivatives the compiler proves with. Others are written by them.";
    error T0212 WrongArguments { word: String, several: bool, count: usize }
        "wrong number of arguments"
        message (several) {
            true => "`{word}` takes two or more values, this has {count}",
            false => "`{word}` takes one value, this has {count}",
        }
        help (several) {
            true => "write `{word}(a, b)`",
            false => "write `{word}(a)`",
        }
        explain "`min`, `max` and `hypot` take two values or more, all other functions one.";
    error T0213 UnknownUnit { word: String, meant: Option<&'static str>, known: Names }
        "unknown unit of a number"
        message "unknown unit `{word}`"
        help ((word.as_str(), meant)) {
            ("in" | "inches" | "zoll", _) => "write `inch`, as in `0.25inch`",
            (_, Some(meant)) => "did you mean `{meant}`?",
            _ => "units are {known}",
        }
        explain "A unit stands directly behind its number. A length without a unit is in the unit of its file.";
    error T0214 UnknownFileUnit { word: String, meant: Option<&'static str> }
        "unknown unit of a file"
        message "unknown unit `{word}`"
        help (meant) {
            Some(meant) => "write `units {meant};`",
            None => "units are `mm`, `inch` and `m`",
        }
        explain "The first item of a file says the unit of its lengths.";
    error T0215 NoUnit
        "missing unit of length"
        message "no unit: a tool says its unit of length first"
        help "say `units mm;`, `units inch;` or `units m;`"
        explain "A file without a unit would be read in the wrong one sooner or later, so that there is no default.";
    error T0216 UnitNotFirst
        "unit not the first item"
        message "the unit is not the first item"
        help "move `units` to the top: everything below is measured in it"
        explain "The unit applies to every length of the file, so that it stands above all of them.";
    error T0217 UnitTwice
        "unit said twice"
        message "the unit is said twice"
        help "drop one; a single number may carry another unit, as in `0.25inch`"
        explain "A file has one unit for lengths that carry none.";
    error T0218 GluedName { number: f64, word: String, factor: String, diameter: bool }
        "number glued to a name"
        message "`{number}{word}` is not a number"
        help (diameter) {
            true => "write `{number}*{factor}` for two times the distance from the axis",
            false => "write `{number}*{factor}`",
        }
        explain "A product is written with `*`. Letters directly behind a number are its unit.";
    error T0219 ConstantOutOfRange
        "constant out of range"
        message "this constant is out of range"
        help "numbers are 0, or between 1e-90 and 1e90 in size"
        explain "Constants are computed when the tool is compiled, and checked as they grow.";
    error T0220 ValueOutOfRange { value: f64 }
        "value out of range"
        message "{value:e} is out of range"
        help "numbers are 0, or between 1e-90 and 1e90 in size"
        explain "Generated code computes in double precision. Within this range no square or product of two numbers overflows.";
    error T0221 TooManySteps { most: u32 }
        "value with too many steps"
        message "this is built of too many steps upon each other"
        help "at most {most} operations lie between a value and a coordinate"
        explain "Names count with the expressions that they stand for, so that a chain of curves grows tall.";
    error T0222 NotLength { role: Role, dimension: Dimension }
        "dimension other than a length"
        message "{role} takes a length, this is {dimension}"
        help "lengths are numbers with or without `mm`, `inch` or `m`"
        explain "Points, radii and places along the axis are lengths.";
    error T0223 UnlikeOperands { operation: Operation, left: Dimension, right: Dimension }
        "operands of unlike dimensions"
        message (operation) {
            Operation::Add => "this adds {left} to {right}",
            Operation::Subtract => "this subtracts {right} from {left}",
            Operation::Multiply => "this multiplies {left} by {right}",
            Operation::Divide => "this divides {left} by {right}",
        }
        help ((left, right)) {
            (Dimension::Angle, _) | (_, Dimension::Angle) => "an angle is for `sin`, `cos` and `tan`: angles go with angles",
            _ => "both sides want the same power of length; a bare number fits any",
        }
        explain "Every expression has a dimension: a number, a power of length, or an angle. A sum of unlike ones would depend on the unit.";
    error T0224 DivisionByZero
        "division by a constant 0"
        message "division by zero"
        help "this is 0; divide by what is not"
        explain "The divisor is a constant, so that the quotient has a value nowhere.";
    error T0225 Exponent
        "exponent"
        message "an exponent is a multiple of one half from -16 to 16"
        help "only square roots run at every contact"
        explain "Other powers need a logarithm, which differs from machine to machine in its last bits.";
    error T0226 PowerOfAngle
        "power of an angle"
        message "an angle has no powers"
        help "take `sin`, `cos` or `tan` of it first, which are numbers"
        explain "Angles are for trigonometric functions. Lengths never come from powers of them.";
    error T0227 NoSuchPower
        "power that does not exist"
        message "this power of a constant does not exist"
        help "the base is negative under a root, or 0 under a negative exponent"
        explain "The base is a constant, so that the power has a value nowhere.";
    error T0228 RootOfAngle
        "root of an angle"
        message "an angle has no square root"
        help "take `sin`, `cos` or `tan` of it first, which are numbers"
        explain "Angles are for trigonometric functions. Lengths never come from roots of them.";
    error T0229 RootOfNegative
        "root of a negative constant"
        message "square root of a negative number"
        help "take the root of what is 0 or more"
        explain "The number under the root is a constant, so that the root has a value nowhere.";
    error T0230 UnlikeArguments { word: String, first: Dimension, other: Dimension }
        "arguments of unlike dimensions"
        message "`{word}` compares {first} with {other}"
        help "all its values want the same power of length"
        explain "A comparison of unlike dimensions would depend on the unit.";
    error T0231 TrigonometryOfVariable { word: String }
        "trigonometric function of a coordinate"
        message "this `{word}` would run at every contact"
        help "`{word}` takes constants only: numbers, `let`s and `param`s"
        explain "Trigonometric functions are slow and differ in their last bits from machine to machine. Of constants they are computed once, when the tool is compiled.";
    error T0232 NotAngle { word: String, dimension: Dimension, value: f64 }
        "trigonometric function of a number"
        message "`{word}` takes an angle, this is {dimension}"
        help "write `{word}({value}deg)` or `{word}({value}rad)`"
        explain "An angle carries its unit, since degrees are often taken for radians.";
    error T0233 HugeAngle
        "huge angle"
        message "this angle is more than a million radians"
        help "angles are written in `deg` or `rad`"
        explain "Such an angle is mostly a length, or has the wrong unit.";
    error T0234 TanOfRightAngle
        "tangent of a right angle"
        message "`tan` of a right angle does not exist"
        help "write the angle that is meant, less than 90deg"
        explain "The tangent grows without bound toward a right angle.";
    error T0235 CurveOfAngle
        "curve that is an angle"
        message "a curve is no angle"
        help "give a number or a power of length"
        explain "A curve is zero on a line of the section, and its sign tells the sides apart.";
    error T0236 GivenTwice { word: String }
        "param given twice"
        message "`{word}` is given twice"
        help "drop one"
        explain "A param has one value, whether a mount, a macro's call or the command line gives it.";
    error T0237 GivenDimension { word: String, wanted: Dimension, found: Dimension }
        "param given another dimension"
        message "`{word}` is {wanted}, what is given is {found}"
        help "give {wanted}"
        explain "A param's default says its dimension.";
    error T0238 GivenUnit { word: String, number: FormattedNumber, here: &'static str, there: &'static str }
        "param given without a unit"
        message "is `{word}` {number}{here} or {number}{there}?"
        help "this file is in {here}, the mounted one in {there}: write the unit; a mere number is `{number}{here}/1{here}`"
        explain "The two files have different units, and the default has no unit, so that the given number can be meant in either.";
    error T0239 NoSuchParam { tool: String, word: String, remedy: ParamRemedy, params: Names }
        "unknown param"
        message "`{tool}` has no param `{word}`"
        help (remedy) {
            ParamRemedy::Let => "write `param` there; it has {params}",
            ParamRemedy::Meant(meant) => "did you mean `{meant}`? it has {params}",
            ParamRemedy::List => "it has {params}",
        }
        explain "Only a `param` can be given from outside its file.";
}

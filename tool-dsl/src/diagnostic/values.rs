//! Names, units, dimensions, values.

use super::data::{CycleLinks, FormattedNumber, NameRemedy, Names, Operation, ParamRemedy, Role};
use super::table::kinds;
use crate::dimension::Dimension;

kinds! {
    /// Names, units, dimensions and values.
    ValueKind "T02" "Names, units, dimensions, values"

    error T0201 UnknownName { name: String, remedy: NameRemedy }
        "unknown name"
        message "unknown name `{name}`"
        help (remedy) {
            NameRemedy::Similar(suggestion) => "did you mean `{suggestion}`?",
            NameRemedy::Define => "define it above, as in `let {name} = 3;`",
            NameRemedy::Constant => "use constants only: numbers with or without a unit, and `pi`",
            NameRemedy::Dash => "in a name write `_` instead of `-`; for a difference put spaces around `-`",
        }
        explain "A name must be a coordinate, `pi`, or defined above by `let`, `param` or `curve`.";
    error T0202 NameWithoutValue { name: String }
        "name without a value"
        message "`{name}` has no value, because its definition has an error"
        help "correct its definition"
        explain "This follows from another error, which is shown instead."
        without "only the error that it follows from is shown";
    error T0203 UsedBeforeDefinition { name: String }
        "name used above its definition"
        message "`{name}` is used above its definition"
        help "move the definition above this use"
        explain "A file is read from top to bottom, so a name has a value only below its definition.";
    error T0204 DuplicateDefinition { name: String }
        "name defined twice"
        message "`{name}` is defined twice"
        help "remove one definition, or rename it"
        explain "A name has one meaning per file. `let`, `param` and `curve` share one set of names.";
    error T0205 ReservedName { name: String, meaning: Option<&'static str> }
        "reserved name"
        message (meaning) {
            Some(meaning) => "`{name}` is {meaning} and cannot be redefined",
            None => "`{name}` is a reserved name and cannot be redefined",
        }
        help ((name.as_str(), meaning)) {
            ("d", Some(_)) => "choose another name, such as `D` for a diameter",
            _ => "choose another name",
        }
        explain "Coordinates, functions, `pi` and `depth` have the same meaning in every file.";
    error T0206 CircularDefinition { name: String, links: CycleLinks, more: usize }
        "circular definition"
        message ((links.0.is_empty(), more)) {
            (true, _) => "`{name}` is defined in terms of itself",
            (false, 0) => "`{name}` is defined in terms of itself: {links}",
            (false, more) => "`{name}` is defined in terms of itself: {links}, and {more} more links lead back to `{name}`",
        }
        help (links.0.is_empty()) {
            true => "write a value that does not use `{name}`",
            false => "give one of these names a value that does not use the others",
        }
        explain "A definition may use only names that are defined above it. It cannot use its own name, directly or through other names.";
    warning T0207 UnusedName { name: String }
        "unused name"
        message "`{name}` is never used"
        help "remove it, or correct the name where it should be used"
        explain "A definition that nothing uses changes nothing. Often the name is misspelt where it should be used.";
    error T0208 CoordinateOfOtherDomain { name: String, domain: &'static str }
        "coordinate of the other kind of file"
        message "`{name}` is a coordinate of a `{domain}` only"
        help (*domain) {
            "solid" => "in a `tool` use `d`, the distance from the axis, and `z`",
            _ => "in a `solid` use `hypot(x, y)`",
        }
        explain "A `tool` is a solid of revolution, written in `d` and `z`. A `solid` is written in `x`, `y` and `z`.";
    error T0209 NotConstant { name: Option<String>, role: Role }
        "value that is not constant"
        message (name) {
            Some(name) => "`{name}` varies from point to point, but {role} must be constant",
            None => "this varies from point to point, but {role} must be constant",
        }
        help (role) {
            Role::Let | Role::Param => "use `curve` to define a function of the coordinates",
            _ => "use a number, a `let` or a `param`",
        }
        explain "Points, radii, exponents, `let` and `param` are computed once, when the tool is compiled. A function of the coordinates is a `curve`.";
    error T0210 DepthNotAvailable
        "`depth` where it is not available"
        message "`depth` is not available here"
        help "use `depth` in `magnitude` and `niceness` only"
        explain "The depth of a point depends on its region. Curves and conditions are evaluated first, to find that region.";
    error T0211 UnknownFunction { name: String, suggestion: Option<&'static str>, known: &'static [&'static str] }
        "unknown function"
        message "unknown function `{name}`"
        help ((suggestion, known.join(", "))) {
            (Some(suggestion), _) => "did you mean `{suggestion}`?",
            (None, known) => "use one of {known}",
        }
        explain "The compiler has bounds and derivatives for these functions only. Write others in terms of them.";
    error T0212 WrongArgumentCount { function: String, variadic: bool, count: usize }
        "wrong number of arguments"
        message (variadic) {
            true => "`{function}` takes two or more arguments; this call has {count}",
            false => "`{function}` takes one argument; this call has {count}",
        }
        help (variadic) {
            true => "write `{function}(a, b)`",
            false => "write `{function}(a)`",
        }
        explain "`min`, `max` and `hypot` take two or more arguments; all other functions take one.";
    error T0213 UnknownUnit { unit: String, suggestion: Option<&'static str>, known: Names }
        "unknown unit of a number"
        message "unknown unit `{unit}`"
        help ((unit.as_str(), suggestion)) {
            ("in" | "inches" | "zoll", _) => "write `inch`, as in `0.25inch`",
            (_, Some(suggestion)) => "did you mean `{suggestion}`?",
            _ => "use one of {known}",
        }
        explain "A unit follows its number without a space. A length without a unit is in the unit of its file.";
    error T0214 UnknownFileUnit { unit: String, suggestion: Option<&'static str> }
        "unknown unit of a file"
        message "unknown unit `{unit}`"
        help (suggestion) {
            Some(suggestion) => "write `units {suggestion};`",
            None => "use `mm`, `inch` or `m`",
        }
        explain "`units`, the first item of a file, gives the unit of its lengths.";
    error T0215 MissingUnit
        "missing unit of length"
        message "the unit of length is missing"
        help "write `units mm;`, `units inch;` or `units m;` as the first item"
        explain "There is no default unit: a file read in the wrong one would give a tool of the wrong size.";
    error T0216 UnitNotFirst
        "`units` not the first item"
        message "`units` is not the first item"
        help "move `units` above all other items"
        explain "The unit applies to every length in the file, so it comes before all of them.";
    error T0217 DuplicateUnit
        "unit given twice"
        message "the unit is given twice"
        help "remove one; to use another unit for one number, write it there, as in `0.25inch`"
        explain "A file has one unit for all numbers that are written without one.";
    error T0218 NumberJoinedToName { number: f64, name: String, factor: String, diameter: bool }
        "number joined to a name"
        message "`{number}{name}` is not a number with a unit"
        help (diameter) {
            true => "write `{number}*{factor}`; `d` is the distance from the axis, a radius",
            false => "write `{number}*{factor}`",
        }
        explain "A product is written with `*`. Letters that follow a number without a space are its unit.";
    error T0219 ConstantOutOfRange
        "constant out of range"
        message "the value of this constant is out of range"
        help "keep values at 0, or between 1e-90 and 1e90 in absolute value"
        explain "Constants are computed when the tool is compiled, and every intermediate result is checked.";
    error T0220 ValueOutOfRange { value: f64 }
        "value out of range"
        message "the value {value:e} is out of range"
        help "keep values at 0, or between 1e-90 and 1e90 in absolute value"
        explain "Generated code computes in double precision. Within this range no square or product of two numbers overflows or underflows.";
    error T0221 ExpressionTooDeep { limit: u32 }
        "expression nested too deeply"
        message "this expression is nested too deeply"
        help "simplify it to at most {limit} nested operations, counting those of the curves it uses"
        explain "A name counts as the expression that it stands for, so a chain of curves adds up.";
    error T0222 NotLength { role: Role, dimension: Dimension }
        "dimension other than a length"
        message "{role} takes a length; this is {dimension}"
        help "write a number without a unit, or with `mm`, `inch` or `m`"
        explain "Points, radii and positions along the axis are lengths.";
    error T0223 MixedOperands { operation: Operation, left: Dimension, right: Dimension }
        "operands of different dimensions"
        message (operation) {
            Operation::Add => "this adds {left} to {right}",
            Operation::Subtract => "this subtracts {right} from {left}",
            Operation::Multiply => "this multiplies {left} by {right}",
            Operation::Divide => "this divides {left} by {right}",
        }
        help ((left, right)) {
            (Dimension::Angle, _) | (_, Dimension::Angle) => "combine angles with angles only, or use `sin`, `cos` or `tan` of the constant angle, as in `z*tan(10deg)`",
            _ => "give both sides the same power of length; a number without a unit fits any",
        }
        explain "Every expression is a number, a power of length, or an angle. A sum of different dimensions would depend on the unit.";
    error T0224 DivisionByZero
        "division by zero"
        message "division by zero"
        help "correct the divisor: it is always 0"
        explain "The divisor is a constant, so the quotient has no value anywhere.";
    error T0225 UnsupportedExponent
        "unsupported exponent"
        message "an exponent must be a multiple of 1/2 from -16 to 16"
        help "write a whole or half exponent, as in `d^2` or `d^1.5`"
        explain "Other powers need a logarithm, whose last bits differ between machines.";
    error T0226 PowerOfAngle
        "power of an angle"
        message "an angle cannot be raised to a power"
        help "take `sin`, `cos` or `tan` of it first, which gives a number"
        explain "Angles are arguments of `sin`, `cos` and `tan`. A power of an angle is not a dimension of the language.";
    error T0227 UndefinedPower
        "undefined power"
        message "this power of a constant is undefined"
        help "correct the base: it is negative with a half exponent, or 0 with a negative one"
        explain "The base is a constant, so the power has no value anywhere.";
    error T0228 RootOfAngle
        "root of an angle"
        message "an angle has no square root"
        help "take `sin`, `cos` or `tan` of it first, which gives a number"
        explain "Angles are arguments of `sin`, `cos` and `tan`. A root of an angle is not a dimension of the language.";
    error T0229 RootOfNegative
        "root of a negative constant"
        message "square root of a negative number"
        help "correct the argument: it must be 0 or more"
        explain "The argument is a constant, so the root has no value anywhere.";
    error T0230 MixedArguments { function: String, first: Dimension, second: Dimension }
        "arguments of different dimensions"
        message "`{function}` combines {first} with {second}"
        help "give all arguments the same power of length"
        explain "With arguments of different dimensions the result would depend on the unit.";
    error T0231 TrigonometryOfVariable { function: String }
        "trigonometric function of a coordinate"
        message "`{function}` takes constants only; its argument varies from point to point"
        help "use only numbers, `let`s and `param`s in the argument of `{function}`"
        explain "Trigonometric functions are slow, and their last bits differ between machines. They are computed once, when the tool is compiled.";
    error T0232 NotAngle { function: String, dimension: Dimension, value: f64 }
        "trigonometric function of a number"
        message "`{function}` takes an angle; this is {dimension}"
        help "write `{function}({value}deg)` or `{function}({value}rad)`"
        explain "An angle needs a unit, since degrees are easily mistaken for radians.";
    error T0233 HugeAngle
        "angle too large"
        message "this angle is more than a million radians"
        help "correct the value, or its unit: `deg` or `rad`"
        explain "An angle of this size is usually a length, or has the wrong unit.";
    error T0234 TanOfRightAngle
        "tangent of a right angle"
        message "`tan` of a right angle is undefined"
        help "write an angle other than 90deg and its odd multiples"
        explain "The tangent grows without bound toward a right angle.";
    error T0235 CurveOfAngle
        "curve that is an angle"
        message "a curve cannot be an angle"
        help "write an expression that is a number or a power of length"
        explain "A curve is zero along a line of the section (in a `solid`, on a surface), and its sign tells the two sides apart.";
    error T0236 DuplicateArgument { name: String }
        "param given twice"
        message "`{name}` is given twice"
        help "remove one of the two values"
        explain "A param takes one value, from a mount, a macro call or the command line.";
    error T0237 ArgumentDimension { name: String, dimension: Dimension, found: Dimension }
        "param value of the wrong dimension"
        message "`{name}` is {dimension}, but the given value is {found}"
        help "give {dimension}"
        explain "A param has the dimension of its default value.";
    error T0238 AmbiguousArgumentUnit { name: String, number: FormattedNumber, file_unit: &'static str, mounted_unit: &'static str }
        "param value without a unit"
        message "the unit of `{name}` is ambiguous: {number}{file_unit} or {number}{mounted_unit}"
        help "write the unit: this file is in {file_unit}, the mounted one in {mounted_unit}; for a pure number write `{number}{file_unit}/1{file_unit}`"
        explain "The two files have different units and the default has none, so the number could be in either.";
    error T0239 UnknownParam { tool: String, name: String, remedy: ParamRemedy, params: Names }
        "unknown param"
        message "`{tool}` has no param `{name}`"
        help (remedy) {
            ParamRemedy::Let => "change `let {name}` to `param {name}` in that file; it has {params}",
            ParamRemedy::Similar(suggestion) => "did you mean `{suggestion}`? it has {params}",
            ParamRemedy::List => "it has {params}",
        }
        explain "Only a `param` can be given a value from outside its file.";
}

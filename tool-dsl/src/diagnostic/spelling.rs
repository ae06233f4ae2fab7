//! Spelling mistakes: characters and constructs of other languages.

use super::data::NameStart;
use super::table::kinds;

kinds! {
    /// Spelling: characters, numbers, names and operators of other languages.
    SpellingKind "T01" "Text: spelling"

    error T0130 TrailingPoint { digits: String }
        "number that ends in a decimal point"
        message "a number cannot end in a decimal point"
        help "write `{digits}` or `{digits}.0`"
        explain "A decimal point needs a digit on each side.";
    error T0131 LeadingPoint { fraction: String }
        "number that begins with a decimal point"
        message "`.{fraction}` needs a digit before the decimal point"
        help "write `0.{fraction}`"
        explain "A decimal point needs a digit on each side.";
    error T0132 DegreeSign { number: String }
        "degree sign"
        message "`°` is not a unit"
        help "write `{number}deg`"
        explain "Units are written in letters: `deg` and `rad` for angles.";
    error T0133 Superscript { base: String, sign: char, power: u32 }
        "superscript"
        message "superscript `{sign}` is not part of the language"
        help "write `{base}^{power}`"
        explain "A power is written with `^`.";
    error T0134 DiameterSign { sign: char }
        "diameter sign"
        message "`{sign}` is not part of the language"
        help "write half the diameter, as in `6/2`: coordinates are radii"
        explain "The coordinate `d` is the distance from the axis. A diameter on a drawing is twice that.";
    error T0135 SingleQuote
        "single quotation mark"
        message "`'` is not part of the language"
        help "put text between double quotation marks, `\"`"
        explain "Titles and file names are written between double quotation marks.";
    error T0136 ChainedPower
        "chained power"
        message "`^` cannot be chained"
        help "add parentheses: `(a^b)^c` or `a^(b^c)`"
        explain "Languages differ in the order in which they compute `a^b^c`, so parentheses are required.";
    error T0137 InchSign { number: String }
        "inch sign"
        message "`\"` is not a unit"
        help "write `{number}inch`"
        explain "Units of length are `mm`, `inch` and `m`.";
    error T0138 MisplacedText
        "text where none is allowed"
        message "text is allowed only after the tool's name and after `mount`"
        help "remove the quotation marks, or write `tool Name \"title\" {{ … }}` or `mount \"file.tool\" as NAME`"
        explain "Text between quotation marks is a title or the name of a mounted file. Comments begin with `//`.";
    error T0139 UnderscoreInNumber
        "underscore in a number"
        message "a number cannot contain `_`"
        help "write the digits without separators, as in `1000`"
        explain "Digits of a number cannot be grouped.";
    error T0140 InvalidNameStart { start: NameStart }
        "name that does not begin with a letter"
        message "a name must begin with a letter"
        help (start) {
            NameStart::Underscore => "remove the leading `_`",
            NameStart::DigitOfTool => "begin the name with a letter, as in `D6Ball`",
            NameStart::Digit => "begin the name with a letter",
        }
        explain "Names are ASCII letters, digits and `_`, and begin with a letter.";
    error T0141 Lookalike { written: char, suggestion: &'static str }
        "typographic character"
        message "`{written}` is not part of the language"
        help "write `{suggestion}`"
        explain "Operators and names are ASCII characters. Text copied from a document often has typographic ones instead.";
    error T0142 ByteOrderMark
        "byte order mark"
        message "the text begins with a byte order mark (U+FEFF)"
        help "save the file as UTF-8 without a byte order mark"
        explain "Files are UTF-8 without a byte order mark. Some editors write one, and it is invisible.";
    error T0143 ForeignCharacter { written: char }
        "character outside ASCII"
        message "`{written}` is not part of the language"
        help "replace it; names consist of ASCII letters, digits and `_`"
        explain "Only comments and titles may contain characters outside ASCII.";
    error T0144 InvisibleCharacter { code: u32 }
        "invisible character"
        message "the invisible character U+{code:04X} is not part of the language"
        help "delete it; between words use spaces, tabs and line breaks"
        explain "Text copied from a document or a web page often contains invisible characters.";
    error T0145 SpaceBeforeUnit { written: String, number: String, unit: String }
        "space before a unit"
        message "there is a space between the number and its unit `{written}`"
        help "write `{number}{unit}`"
        explain "A unit follows its number without a space.";
    error T0146 LogicalOperator
        "conditions joined by `and` or `or`"
        message "conditions are separated by commas"
        help "for \"and\" write `a <= b, c <= d`; for \"or\" write `min(a, b) <= 0`"
        explain "A region consists of the points where all of its conditions hold. The language has no `and`, `or`, `&&` or `||`.";
    error T0147 DecimalComma { number: String, fraction: String }
        "decimal comma"
        message "a comma is not allowed here"
        help "for a decimal number write a point: `{number}.{fraction}`"
        explain "Numbers have a decimal point. A comma separates coordinates, conditions and arguments.";
    error T0148 ExtraSemicolon
        "unnecessary `;`"
        message "unnecessary `;`"
        help "remove it: a region ends with `}}`"
        explain "Items that end with `}` have no `;` after it.";
    error T0149 SecondTool { keyword: String }
        "second tool in a file"
        message "this is a second {keyword} in one file"
        help "move it to a file of its own"
        explain "A file holds exactly one `tool` or `solid`. To join several tools, use `mount`.";
    error T0150 UnclosedText
        "text without a closing quotation mark"
        message "this text has no closing quotation mark"
        help "close it with `\"` on the same line"
        explain "Text between quotation marks cannot continue on the next line.";
    error T0151 DashInName { written: String, suggestion: String }
        "dash in a name"
        message "`{written}` is not a name: names cannot contain `-`"
        help "write `{suggestion}`"
        explain "Between names `-` is a minus sign. The words of a name are separated by `_`.";
    error T0152 DoubleStar
        "power written `**`"
        message "`**` is not an operator"
        help "write a power as `a^b`"
        explain "Operators are `+`, `-`, `*`, `/` and `^`.";
    error T0153 ReversedComparison { sign: String }
        "comparison written backwards"
        message "`={sign}` is not a comparison"
        help "write `{sign}=`"
        explain "Comparisons are `<=` and `>=`.";
    error T0154 TooManyComparisons
        "too many comparisons in one condition"
        message "this condition has more than two comparisons"
        help "write further comparisons as conditions of their own: `a <= b <= c, c <= d`"
        explain "A condition compares a value with a lower and an upper bound.";
    error T0155 ComparisonOutside
        "comparison outside a condition"
        message "a comparison is allowed only after `where`"
        help "move it to a region: `region NAME where a <= b {{ … }}`"
        explain "A comparison is a condition of a region, not a value.";
    error T0156 SquareBracket { written: char, suggestion: char }
        "square bracket"
        message "`{written}` is not part of the language"
        help "write `{suggestion}`"
        explain "Parentheses group terms, and enclose the arguments of functions and the coordinates of points.";
}

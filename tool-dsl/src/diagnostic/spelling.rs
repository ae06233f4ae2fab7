//! Spelling mistakes: characters and habits from other languages.

use super::data::NameStart;
use super::table::kinds;

kinds! {
    /// Spelling: characters, numbers, names and operators of other languages.
    SpellingKind "T01" "Text: spelling"

    error T0130 TrailingPoint { digits: String }
        "number that ends in a point"
        message "a number ends in a point"
        help "write `{digits}` or `{digits}.0`"
        explain "A decimal point stands between digits.";
    error T0131 LeadingPoint { fraction: String }
        "number that begins with a point"
        message "`.{fraction}` needs a digit before the point"
        help "write `0.{fraction}`"
        explain "A decimal point stands between digits.";
    error T0132 DegreeSign { number: String }
        "degree sign"
        message "`{number}°` is no angle"
        help "write `{number}deg`"
        explain "Units are written in letters, so that every keyboard has them: `deg` and `rad` for angles.";
    error T0133 Superscript { base: String, sign: char, power: u32 }
        "superscript"
        message "`{base}{sign}` is not a name"
        help "write `{base}^{power}`"
        explain "A power is written with `^`.";
    error T0134 DiameterSign { sign: char }
        "diameter sign"
        message "`{sign}` is not part of the language"
        help "coordinates are radii: write half the diameter, as in `6/2`"
        explain "The coordinate `d` is the distance from the axis. A drawing's diameter is twice that.";
    error T0135 SingleQuote
        "single quotation mark"
        message "`'` is not part of the language"
        help "write text between `\"`"
        explain "Titles and file names stand between double quotation marks.";
    error T0136 ChainedPower
        "power of a power"
        message "`^` does not chain"
        help "say with parentheses which comes first: `(a^b)^c` or `a^(b*c)`"
        explain "Languages differ in the order in which `a^b^c` is computed, so that the order is to be written.";
    error T0137 InchSign { number: String }
        "inch sign"
        message "`\"` is not a unit"
        help "write `{number}inch`"
        explain "Units of length are `mm`, `inch` and `m`.";
    error T0138 MisplacedText
        "text out of place"
        message "text stands only behind the tool's name and `mount`"
        help "write it as in `tool Name \"what it is\" {{ … }}` or `mount \"file.tool\" as NAME`"
        explain "Text between quotation marks is a tool's title or the name of a mounted file. Remarks are comments: `// …`.";
    error T0139 UnderscoreInNumber
        "underscore in a number"
        message "a number has no `_`"
        help "write its digits one behind the other, as in `1000`"
        explain "Digits of a number are not grouped.";
    error T0140 NameBegin { start: NameStart }
        "first character of a name"
        message "a name begins with a letter"
        help (start) {
            NameStart::Underscore => "drop the `_`",
            NameStart::DigitOfTool => "put a letter first, as in `D6Ball`",
            NameStart::Digit => "put a letter first",
        }
        explain "Names are ASCII letters, digits and `_`, and begin with a letter.";
    error T0141 Lookalike { written: char, meant: &'static str }
        "typographic character"
        message "`{written}` is not part of the language"
        help "write `{meant}`"
        explain "Operators are ASCII characters. Text that was copied from a document often has typographic ones in their place.";
    error T0142 ByteOrderMark
        "byte order mark"
        message "the text begins with a byte order mark (U+FEFF)"
        help "save the file as UTF-8 without one"
        explain "Files are UTF-8 without a mark at their beginning. Some editors write one, which cannot be seen.";
    error T0143 ForeignCharacter { written: char }
        "character outside ASCII"
        message "`{written}` is not part of the language"
        help "names are ASCII letters, digits and `_`"
        explain "Outside comments and titles the language is written in ASCII.";
    error T0144 InvisibleCharacter { code: u32 }
        "invisible character"
        message "the character U+{code:04X} is not part of the language"
        help "delete it: it cannot be seen; blanks are spaces, tabs and new lines"
        explain "Text that was copied from a document or a web page often has invisible blanks.";
    error T0145 SpaceBeforeUnit { written: String, number: String, unit: String }
        "space before a unit"
        message "a space before the unit `{written}`"
        help "write `{number}{unit}`"
        explain "A unit belongs to its number and stands directly behind it.";
    error T0146 JoinedByWord
        "conditions joined by a word"
        message "conditions are joined by commas"
        help "all hold that stand between commas: `a <= b, c <= d`; \"or\" is `min(a, b) <= 0`"
        explain "A region is where all of its conditions hold. The language has no `and`, `or`, `&&` or `||`.";
    error T0147 DecimalComma { number: String, fraction: String }
        "decimal comma"
        message "a comma stands between things of a list"
        help "a decimal comma? write a point: `{number}.{fraction}`"
        explain "Numbers have a decimal point. A comma parts the numbers of a point, conditions and arguments.";
    error T0148 ExtraSemicolon
        "superfluous `;`"
        message "a `;` too many"
        help "drop it: a region ends with `}}`"
        explain "Items that end with `}` have no `;` behind it.";
    error T0149 SecondFile { word: String }
        "second tool in a file"
        message "a second {word}"
        help "write one tool or solid a file"
        explain "A file holds exactly one `tool` or `solid`. Several tools are joined by `mount`.";
    error T0150 TextNotClosed
        "text not closed"
        message "this text does not end"
        help "close it with `\"` on the same line"
        explain "Text between quotation marks stands on one line.";
    error T0151 DashInName { written: String, meant: String }
        "dash in a name"
        message "`{written}` is not a name: a name has no dash"
        help "write `{meant}`"
        explain "A dash between names is a difference. Words of a name are parted by `_`.";
    error T0152 DoubleStar
        "power written `**`"
        message "`**` is no operator"
        help "a power is written `a^b`"
        explain "Operators are `+`, `-`, `*`, `/` and `^`.";
    error T0153 ReversedComparison { sign: String }
        "comparison written backwards"
        message "`={sign}` is no comparison"
        help "write `{sign}=`"
        explain "Comparisons are `<=` and `>=`.";
    error T0154 LongChain
        "chain of comparisons too long"
        message "one comparison too many"
        help "a chain is `a <= b <= c`; more are conditions of their own: `c <= d`"
        explain "A chain compares a value with a lower and an upper bound.";
    error T0155 ComparisonOutside
        "comparison outside a condition"
        message "a comparison stands behind `where` only"
        help "write it into a region: `region NAME where a <= b {{ … }}`"
        explain "A comparison is a condition of a region. It is no value that could be computed with.";
}

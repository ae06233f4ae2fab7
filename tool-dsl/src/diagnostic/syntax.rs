//! Texts that cannot be parsed, or are larger than any that people write.

use super::data::{Expected, Names};
use super::table::kinds;

kinds! {
    /// Texts: their size, their items, their brackets.
    SyntaxKind "T01" "Text: size, items, brackets"

    error T0101 TextTooLong { bytes: usize, most: usize }
        "text too long"
        message "the text is {bytes} bytes long"
        help "a tool's text has at most {most} bytes"
        explain "A `.tool` file describes one tool. The limit keeps the compiler quick on files that are no tools."
        without "an example would be a MiB long";
    error T0102 NameTooLong { letters: usize, most: usize }
        "name too long"
        message "this name is {letters} letters long"
        help "a name has at most {most}"
        explain "Names appear in messages, drawings and generated code, where longer ones cannot be read.";
    error T0103 TooManyItems { most: usize }
        "too many items"
        message "more than {most} items"
        help "a file describes one tool"
        explain "Items are the statements between the braces of a tool."
        without "an example would have thousands of items";
    error T0104 CommentNotClosed
        "comment not closed"
        message "this comment does not end"
        help "close it with `*/`"
        explain "A comment that begins with `/*` ends with `*/`. Comments may be nested: each has its own end.";
    error T0105 CommentsTooDeep { most: usize }
        "comments nested too deep"
        message "comments are nested more than {most} deep"
        help "close them with `*/`"
        explain "Mostly an earlier comment was not closed, so that all later ones are nested in it.";
    error T0106 BracketsTooDeep { most: usize }
        "brackets nested too deep"
        message "brackets are nested more than {most} deep"
        help "name a part of the expression with `let` or `curve`"
        explain "The limit counts parentheses and braces alike. It keeps the compiler on a small stack.";
    error T0107 ExpressionTooTall { most: u32 }
        "expression with too many steps"
        message "this expression is built of too many steps upon each other"
        help "at most {most}: name a part of it with `let` or `curve`"
        explain "Steps are operations whose operands are results of other operations. A sum of many terms has one step per term.";
    error T0108 ExpressionTooLong
        "sum or product too long"
        message "this expression is too long"
        help "name a part of it with `let` or `curve`"
        explain "One sum or product has at most 64 operands.";
    error T0109 NumberOutOfRange
        "number out of range"
        message "this number is out of range"
        help "numbers are 0, or between 1e-90 and 1e90 in size"
        explain "Generated code computes in double precision. Within this range no square or product of two numbers overflows.";
    error T0110 TakenName { word: String }
        "tool's name taken"
        message "the name `{word}` is taken"
        help "the name becomes a Rust type: take another"
        explain "A compiled tool is a Rust type of its name. Some names belong to Rust, or to the code that is generated beside it.";
    error T0111 NotTypeName { word: String }
        "tool's name not in `UpperCamelCase`"
        message "`{word}` is not a tool's name"
        help "the name becomes a Rust type: write it as `UpperCamelCase`"
        explain "A compiled tool is a Rust type of its name, and Rust's types begin with a capital and have no `_`.";
    error T0112 StrictComparison { written: String }
        "strict comparison"
        message "`{written}` is no comparison here: a region is closed"
        help (written.as_str()) {
            "<" => "write `<=`; a border belongs to the region listed first",
            ">" => "write `>=`; a border belongs to the region listed first",
            "=" | "==" => "write two conditions, `a <= b` and `a >= b`, if a single line is meant; a border \
                           belongs to the region listed first",
            _ => "write `<=` or `>=`; a border belongs to the region listed first",
        }
        explain "Regions contain their borders, so that a tool has no gaps. A point on a border belongs to the region listed first.";
    error T0113 UnknownAllowance { written: String }
        "`allow` that does not fit"
        message "`allow {written}` does not fit here"
        help "write `direction: … allow oblique;` or `niceness: … allow rising;`"
        explain "An allowance silences one warning where the unusual is meant: a direction that is not the steepest way out, or a niceness that rises with depth.";
    error T0114 UnknownFile { word: String, meant: Option<&'static str> }
        "unknown beginning of a file"
        message "a file does not begin with `{word}`"
        help (meant) {
            Some(meant) => "did you mean `{meant}`?",
            None => "write `tool Name {{ … }}`, or `solid Name {{ … }}` without an axis",
        }
        explain "A file holds one `tool`, a solid of revolution, or one `solid`, a shape without an axis.";
    error T0115 UnknownItem { word: String, meant: Option<&'static str>, known: Names }
        "unknown item"
        message "no item begins with `{word}`"
        help ((word.as_str(), meant)) {
            ("depth" | "direction", _) => "`{word}:` belongs inside a `region`",
            (_, Some(meant)) => "did you mean `{meant}`?",
            _ => "an item is one of {known}",
        }
        explain "An item is a statement between the braces of a tool. Its first word says what it is.";
    error T0116 UnknownProperty { word: String, meant: Option<&'static str> }
        "unknown property of a region"
        message "a region has no `{word}`"
        help (meant) {
            Some(meant) => "did you mean `{meant}`?",
            None => "a region says `depth`, `magnitude`, `direction`, `niceness`",
        }
        explain "A region states how deep a point is, and how it is felt there.";
    error T0117 MissingSemicolon
        "missing `;`"
        message "`;` is missing after this"
        help "write `;` here"
        explain "Items and properties end with `;`, but for those that end with `}`.";
    error T0118 TextEnds { expected: Expected }
        "unexpected end"
        message "the text ends here"
        help (expected) {
            Expected::OneOf(_) => "expected {expected}",
            Expected::Setting => "write `PARAM = VALUE`, as in `D = 0.25inch, flute = 18`",
            Expected::Unknown => "write the rest of it",
        }
        explain "The text ends within an item, or within a value from outside the file.";
    error T0119 DoesNotFit { token: String, expected: Expected }
        "token that does not fit"
        message "`{token}` does not fit here"
        help (expected) {
            Expected::OneOf(_) => "expected {expected}",
            Expected::Setting => "write `PARAM = VALUE`, as in `D = 0.25inch, flute = 18`",
            Expected::Unknown => "drop it",
        }
        explain "The grammar has no rule for this token at this place. The remedy lists the tokens that would fit.";
    error T0120 HiddenCharacter { code: u32 }
        "hidden character in a text"
        message "this text has the character U+{code:04X}, which cannot be seen"
        help "delete it: texts are shown as they are written"
        explain "Titles and file names are shown on terminals and in drawings. Control characters and marks that turn a line around could disguise them.";
    error T0121 NoTool
        "file without a tool"
        message "there is no tool in this text"
        help "write `tool Name {{ units mm; … }}`"
        explain "A file holds exactly one `tool` or `solid`.";
    error T0122 ClosesNothing { bracket: char }
        "bracket that closes nothing"
        message "this `{bracket}` closes nothing"
        help "drop it, or open one before"
        explain "Each closing bracket belongs to an opening one of its kind.";
    error T0123 NotClosed { bracket: char, close: char }
        "bracket not closed"
        message "this `{bracket}` is not closed"
        help "write `{close}` where its contents end"
        explain "Each opening bracket is closed by one of its kind. Which one is missing is told by the indentation.";
}

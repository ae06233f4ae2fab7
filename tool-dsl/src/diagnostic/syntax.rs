//! Texts that cannot be parsed, or are larger than any that people write.

use super::data::{Expected, Names};
use super::table::kinds;

kinds! {
    /// Texts: their size, their items, their brackets.
    SyntaxKind "T01" "Text: size, items, brackets"

    error T0101 TextTooLong { bytes: usize, limit: usize }
        "text too long"
        message "the text is {bytes} bytes long; the limit is {limit}"
        help "shorten it to at most {limit} bytes"
        explain "A `.tool` file describes one tool. The limit makes the compiler reject other files quickly."
        without "an example would be a MiB long";
    error T0102 NameTooLong { letters: usize, limit: usize }
        "name too long"
        message "this name is {letters} letters long; the limit is {limit}"
        help "shorten it to at most {limit} letters"
        explain "Names appear in messages, drawings and generated code, where longer names are hard to read.";
    error T0103 TooManyItems { limit: usize }
        "too many items"
        message "this file has more than {limit} items"
        help "split the tool into several files and join them with `mount`"
        explain "Items are the statements between the braces of a tool."
        without "an example would have thousands of items";
    error T0104 UnclosedComment
        "comment not closed"
        message "this comment is not closed"
        help "close it with `*/`"
        explain "A comment that begins with `/*` must end with `*/`. Comments can be nested: each `/*` needs its own `*/`.";
    error T0105 CommentsTooDeep { limit: usize }
        "comments nested too deep"
        message "comments are nested more than {limit} levels deep"
        help "close the earlier comments with `*/`"
        explain "The usual cause is an earlier comment that was not closed: all later comments are then nested in it.";
    error T0106 BracketsTooDeep { limit: usize }
        "brackets nested too deep"
        message "brackets are nested more than {limit} levels deep"
        help "name a subexpression with `let` or `curve`"
        explain "The limit counts parentheses and braces together. It bounds the stack that the compiler needs.";
    error T0107 ExpressionTooDeep { limit: u32 }
        "expression nested too deep"
        message "this expression nests more than {limit} operations"
        help "name a subexpression with `let` or `curve`"
        explain "Each operation on the result of another one adds a level. A sum of many terms has one level per term.";
    error T0108 ExpressionTooLong
        "sum or product too long"
        message "this sum or product has too many operands"
        help "name a subexpression with `let` or `curve`"
        explain "A sum or product has at most 64 operands.";
    error T0109 NumberOutOfRange
        "number out of range"
        message "this number is out of range"
        help "write 0, or a number between 1e-90 and 1e90 in absolute value"
        explain "Generated code computes in double precision. Within this range the product of two numbers never overflows.";
    error T0110 ReservedToolName { name: String }
        "reserved name of a tool"
        message "the tool's name `{name}` is reserved"
        help "choose another name"
        explain "A tool's name becomes a Rust type. Some names belong to Rust.";
    error T0111 NotTypeName { name: String }
        "tool's name not in `UpperCamelCase`"
        message "the tool's name `{name}` is not in `UpperCamelCase`"
        help "write it like `D6BallEr16`: a capital letter first, no `_`"
        explain "A tool's name becomes a Rust type. Rust types begin with a capital letter and contain no `_`.";
    error T0112 StrictComparison { written: String }
        "comparison other than `<=` or `>=`"
        message "`{written}` cannot be used here: regions include their borders"
        help (written.as_str()) {
            "<" => "write `<=`; a point on a border belongs to the region listed first",
            ">" => "write `>=`; a point on a border belongs to the region listed first",
            "=" | "==" => "write `<=` or `>=`; for the points of one curve write both, `a <= b, a >= b`",
            _ => "write `<=` or `>=`; a point on a border belongs to the region listed first",
        }
        explain "Regions include their borders, so that a tool has no gaps. A point on a border belongs to the region listed first.";
    error T0113 UnknownAllowance { written: String }
        "invalid `allow`"
        message "`allow {written}` is not valid here"
        help "write `direction: … allow oblique;` or `niceness: … allow rising;`"
        explain "`allow` silences one warning where the unusual is intended: a direction other than the steepest descent of the depth, or a niceness that increases with depth.";
    error T0114 UnknownFileKeyword { keyword: String, suggestion: Option<&'static str> }
        "unknown first word of a file"
        message "a file begins with `tool` or `solid`, not with `{keyword}`"
        help (suggestion) {
            Some(suggestion) => "did you mean `{suggestion}`?",
            None => "write `tool Name {{ … }}`, or `solid Name {{ … }}` if it has no axis",
        }
        explain "A file contains one `tool`, which is a solid of revolution, or one `solid`, which has no axis.";
    error T0115 UnknownItem { keyword: String, suggestion: Option<&'static str>, known: Names }
        "unknown item"
        message "unknown item `{keyword}`"
        help ((keyword.as_str(), suggestion)) {
            ("depth" | "direction", _) => "write `{keyword}:` inside a `region`",
            (_, Some(suggestion)) => "did you mean `{suggestion}`?",
            _ => "write one of {known}",
        }
        explain "An item is a statement between the braces of a tool. Its first word tells what it is.";
    error T0116 UnknownProperty { name: String, suggestion: Option<&'static str> }
        "unknown property of a region"
        message "a region has no property `{name}`"
        help (suggestion) {
            Some(suggestion) => "did you mean `{suggestion}`?",
            None => "write `depth`, `magnitude`, `direction` or `niceness`",
        }
        explain "The properties of a region give the depth, magnitude, direction and niceness at each of its points.";
    error T0117 MissingSemicolon
        "missing `;`"
        message "`;` is missing after this"
        help "write `;` here"
        explain "Items and properties end with `;`, except those that end with `}`.";
    error T0118 UnexpectedEnd { expected: Expected }
        "unexpected end of the text"
        message "unexpected end of the text"
        help (expected) {
            Expected::OneOf(_) => "expected {expected}",
            Expected::Argument => "write `PARAM = VALUE`, as in `D = 0.25inch, flute = 18`",
            _ => "complete the statement",
        }
        explain "The text ends inside an item, or inside a value that is given for a `param`.";
    error T0119 UnexpectedToken { token: String, expected: Expected }
        "unexpected token"
        message "unexpected `{token}`"
        help (expected) {
            Expected::OneOf(_) => "expected {expected}",
            Expected::Similar(_) => "did you mean `{expected}`?",
            Expected::OneStart => "remove it: a profile is one line, and each segment begins where the one before it ends",
            Expected::Argument => "write `PARAM = VALUE`, as in `D = 0.25inch, flute = 18`",
            Expected::Unknown => "remove it",
        }
        explain "The grammar does not allow this token here. The remedy lists the tokens that it allows.";
    error T0120 HiddenCharacter { code: u32 }
        "invisible character in a title or file name"
        message "this text contains the invisible character U+{code:04X}"
        help "delete it"
        explain "Titles and file names are shown on terminals and in drawings. Control characters and marks that change the direction of text could disguise them.";
    error T0121 NoTool
        "file without a tool"
        message "there is no tool in this text"
        help "write `tool Name {{ units mm; … }}`"
        explain "A file contains exactly one `tool` or `solid`.";
    error T0122 UnmatchedBracket { bracket: char }
        "unmatched closing bracket"
        message "this `{bracket}` has no matching opening bracket"
        help "remove it, or add the opening bracket before it"
        explain "Each closing bracket needs an opening bracket of the same kind before it.";
    error T0123 UnclosedBracket { bracket: char, closing_bracket: char }
        "unclosed bracket"
        message "this `{bracket}` is not closed"
        help "write `{closing_bracket}` where its contents end"
        explain "Each opening bracket needs a closing bracket of the same kind. The compiler finds the unclosed one by the indentation.";
}

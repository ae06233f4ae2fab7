//! Source text of tools in which every length is multiplied by a number `s`.

use touchoff_tests::library;
use touchoff_tests::oracle::restated::Restated;

/// Returns a power of two in the tool language, whose exponents are at most 16.
pub(crate) fn power_of_two(k: i32) -> String {
    let sixteenths = std::iter::repeat_n(16, k.unsigned_abs() as usize / 16);
    let exponents = sixteenths.chain([k.abs() % 16]);
    exponents
        .fold("1".to_owned(), |text, exponent| text + &format!(" * 2^({})", k.signum() * exponent))
}

/// Returns a restated tool with surface names that a file may use: dots occur only in assemblies.
pub(crate) fn with_plain_names(tool: &Restated) -> Restated {
    // A restatement has names that live as long as the program.
    let plain = |name: &'static str| -> &'static str {
        if name.contains('.') { name.replace('.', "_").leak() } else { name }
    };
    let mut tool = tool.clone();
    for surface in tool.surfaces.iter_mut().chain(&mut tool.cutting) {
        *surface = plain(surface);
    }
    tool
}

/// Returns the source text of a profile. Its surfaces need [plain names][with_plain_names].
pub(crate) fn profile_text(tool: &Restated, scale: &str) -> String {
    let profile = tool.text(|number| format!("{}*s", number.to_decimal_string()));
    format!("tool {} {{ units mm; let s = {scale};\n{profile} }}", tool.name)
}

/// Returns the source text of the thesis's tool and of the solids, whose regions are written by hand: the library's,
/// without niceness. A number is no length if it is a factor, a divisor or an exponent.
pub(crate) fn hand_written_text(name: &str, scale: &str) -> Option<String> {
    let file = match name {
        "Fig73" => "fig_7_3",
        "Block" => "block",
        "LBracket" => "l_bracket",
        _ => return None,
    };
    let mut text = String::new();
    let source = library::source(file);
    let code = source.text.lines().filter_map(|line| line.split("//").next());
    for line in code.filter(|line| !line.trim_start().starts_with("niceness")) {
        let mut rest = line;
        while let Some(first) = rest.chars().next() {
            let is_word = |c: char| c.is_ascii_alphanumeric() || c == '.' || c == '_';
            let end = rest.find(|c| !is_word(c)).unwrap_or(rest.len()).max(first.len_utf8());
            let (word, after) = rest.split_at(end);
            let is_factor = text.ends_with(['*', '/', '^']) || after.starts_with('*');
            text += word;
            if first.is_ascii_digit() && !is_factor {
                text += "*s";
            }
            rest = after;
        }
        text.push('\n');
    }
    Some(text.replacen("units mm;", &format!("units mm; let s = {scale};"), 1))
}

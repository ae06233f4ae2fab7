//! Source text of tools in which every length is multiplied by a number `s`.

use touchoff_tests::oracle::big::Big;
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
    let surface = |k: usize| {
        let cutting = if tool.cutting.contains(&tool.surfaces[k]) { " cutting" } else { "" };
        format!("{}{cutting}", tool.surfaces[k])
    };
    let number = |number: &Big| format!("{}*s", number.to_decimal_string());
    let profile = tool.profile().text(number, surface);
    format!("tool {} {{ units mm; let s = {scale};\n{profile} }}", tool.name)
}

/// Returns the source text of the thesis's tool and of the solids, whose regions are written by hand.
pub(crate) fn hand_written_text(name: &str, scale: &str) -> Option<String> {
    let text = match name {
        "Fig73" => FIG73,
        "Block" => BLOCK,
        "LBracket" => BRACKET,
        _ => return None,
    };
    Some(text.replace("SCALE", scale))
}

const FIG73: &str = "tool Fig73 { units mm; let s = SCALE; tip z = 20*s; spindle -z;
curve back = z + d - 5*s;
curve shoulder = z - d - 6*s;
curve corner = z + d - 14*s;
curve cone = z + d - 16*s;
curve ball = hypot(d, z - 19*s) - 1*s;
region I as housing where z >= 0, back <= 0 { magnitude: z; direction: (0, -1); }
region II as housing where d <= 5*s, back >= 0, z <= max(9*s, d + 6*s) {
    magnitude: 5*s - d; direction: (1, 0); }
region III as housing where d >= 3*s, shoulder >= 0, z <= 11*s {
    magnitude: 11*s - z; direction: (0, 1); }
region IV as housing where d <= 3*s, 9*s <= z <= 11*s {
    magnitude: 14*s - d - z; direction: (1, 1); }
region V as spindle where d <= 3*s, 11*s <= z <= max(13*s, 14*s - d) {
    magnitude: 3*s - d; direction: (1, 0); }
region VI as spindle where d >= 1*s, z >= 13*s, cone <= 0 {
    magnitude: 16*s - d - z; direction: (1, 1); }
region VII as spindle where d <= 1*s, corner >= 0, cone <= 0 {
    magnitude: 17*s - 2*d - z; direction: (2, 1); }
region VIII as flute cutting where d <= 1*s, cone >= 0, z <= 19*s {
    magnitude: 1*s - d; direction: (1, 0); }
region IX as nose cutting where z >= 19*s, ball <= 0 {
    magnitude: -ball; direction: away from (0, 19*s); } }";

const BLOCK: &str = "solid Block { units mm; let s = SCALE;
curve left = x + 20*s;
curve right = 20*s - x;
curve front = y + 15*s;
curve back = 15*s - y;
curve bottom = z;
curve top = 20*s - z;
region left where 0 <= left <= min(right, front, back, bottom, top) { depth: left; }
region right where 0 <= right <= min(left, front, back, bottom, top) { depth: right; }
region front where 0 <= front <= min(left, right, back, bottom, top) { depth: front; }
region back where 0 <= back <= min(left, right, front, bottom, top) { depth: back; }
region bottom where 0 <= bottom <= min(left, right, front, back, top) { depth: bottom; }
region top where 0 <= top <= min(left, right, front, back, bottom) { depth: top; } }";

const BRACKET: &str = "solid LBracket { units mm; let s = SCALE;
curve bottom = z;
curve ledge = 6*s - z;
curve end = 20*s - x;
curve bore = hypot(x - 10*s, y) - 3.3*s;
curve side = 10*s - abs(y);
curve back = x + 10*s;
curve wall = -4*s - x;
curve top = 24*s - z;
curve edge = hypot(wall, ledge);
region lying_bottom where wall <= 0, 0 <= bottom <= min(ledge, end, side, bore) { depth: bottom; }
region lying_top where wall <= 0, 0 <= ledge <= min(bottom, end, side, bore) { depth: ledge; }
region lying_end where wall <= 0, 0 <= end <= min(bottom, ledge, side) { depth: end; }
region lying_side where wall <= 0, 0 <= side <= min(bottom, ledge, end) { depth: side; }
region bore where wall <= 0, 0 <= bore <= min(bottom, ledge) {
    depth: bore; direction: (10*s - x, -y, 0); }
region heel_bottom where wall >= 0, ledge >= 0, 0 <= bottom <= min(back, side, edge) { depth: bottom; }
region heel_back where wall >= 0, ledge >= 0, 0 <= back <= min(bottom, side, edge) { depth: back; }
region heel_side where wall >= 0, ledge >= 0, 0 <= side <= min(bottom, back, edge) { depth: side; }
region heel_edge where wall >= 0, ledge >= 0, edge <= min(bottom, back, side) { depth: edge; }
region standing_back where ledge <= 0, 0 <= back <= min(wall, side, top) { depth: back; }
region standing_inner where ledge <= 0, 0 <= wall <= min(back, side, top) { depth: wall; }
region standing_side where ledge <= 0, 0 <= side <= min(back, wall, top) { depth: side; }
region standing_top where ledge <= 0, 0 <= top <= min(back, wall, side) { depth: top; } }";

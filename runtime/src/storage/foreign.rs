//! Recognition of files that are not saved parts.

/// Letters that occur at the beginning of every saved part.
const NAME: &[u8] = b"TOUCHOFF";
/// The number of bytes examined at the beginning of a file.
pub(super) const PREFIX_LENGTH: usize = 512;
/// Bytes of a binary STL file before its triangles, and per triangle.
const STL: [u64; 2] = [84, 50];

/// Initial bytes of known file formats.
const SIGNATURES: [(&[u8], &str); 12] = [
    (b"solid", "an STL mesh (text)"),
    (b"ply\n", "a PLY file"),
    (b"ply\r", "a PLY file"),
    (b"ISO-10303-21", "a STEP file"),
    (b"PK\x03\x04", "a zip archive (3MF is one)"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"\x28\xb5\x2f\xfd", "a zstd archive"),
    (b"\x89PNG", "a PNG picture"),
    (b"\x89HDF", "an HDF5 file"),
    (b"glTF", "a glTF mesh"),
    (b"\x7fELF", "a program"),
    (b"version https://git-lfs", "a pointer of Git LFS: `git lfs pull` brings the file itself"),
];

/// Returns a description of a file of `length` bytes that begins with `prefix`.
pub(super) fn describe(prefix: &[u8], length: u64) -> &'static str {
    let prefix = &prefix[..prefix.len().min(PREFIX_LENGTH)];
    if prefix.is_empty() {
        return "an empty file";
    }
    if (0..=3).any(|at| prefix.get(at..).is_some_and(|rest| rest.starts_with(NAME))) {
        return "a saved part that was changed on its way, as where it is sent as text: send it \
                as binary";
    }
    if prefix.iter().all(|byte| *byte == 0) {
        return "zeros, as a copy that was interrupted leaves them";
    }
    if let Some((_, kind)) = SIGNATURES.iter().find(|(start, _)| prefix.starts_with(start)) {
        return kind;
    }
    if let Some(count) = prefix.get(80..84) {
        let triangles = count.iter().rev().fold(0, |count, byte| count << 8 | u64::from(*byte));
        if STL[0] + STL[1] * triangles == length {
            return "an STL mesh (binary)";
        }
    }
    let Ok(text) = str::from_utf8(prefix).or_else(|error| {
        // The last character may be cut in two.
        str::from_utf8(&prefix[..error.valid_up_to().max(PREFIX_LENGTH - 4).min(prefix.len())])
    }) else {
        return "a binary file of another program";
    };
    let is_obj = |line: &str| ["v ", "vn ", "f ", "mtllib "].iter().any(|k| line.starts_with(k));
    match text {
        _ if text.lines().any(is_obj) => "an OBJ mesh",
        _ if text.starts_with(['{', '[']) => "a JSON file",
        _ if text.starts_with('<') => "an XML or HTML file",
        _ if text.chars().any(|c| c.is_control() && !c.is_whitespace()) => {
            "a binary file of another program"
        }
        _ => "a text file",
    }
}

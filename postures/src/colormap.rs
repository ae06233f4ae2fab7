//! Colours for values from 0 to 1.

/// Viridis (Smith and van der Walt 2015) at tenths: steps of equal brightness, also in grey and with red-green
/// colour blindness.
const VIRIDIS: [[u8; 3]; 11] = [
    [0x44, 0x01, 0x54],
    [0x48, 0x25, 0x76],
    [0x41, 0x44, 0x87],
    [0x35, 0x60, 0x8d],
    [0x2a, 0x78, 0x8e],
    [0x21, 0x90, 0x8c],
    [0x22, 0xa8, 0x84],
    [0x43, 0xbf, 0x71],
    [0x7a, 0xd1, 0x51],
    [0xbb, 0xdf, 0x27],
    [0xfd, 0xe7, 0x25],
];

/// Returns the sRGB colour of a value from 0 (dark violet) to 1 (yellow). Values beyond are clamped, and NaN
/// counts as 0.
pub fn colormap(part: f64) -> [u8; 3] {
    let part = if part.is_nan() { 0.0 } else { part.clamp(0.0, 1.0) };
    let position = part * (VIRIDIS.len() - 1) as f64;
    // The brightest value is the end of the last step, not the start of another.
    let index = (position as usize).min(VIRIDIS.len() - 2);
    let fraction = position - index as f64;
    [0, 1, 2].map(|k| {
        let [from, to] = [index, index + 1].map(|stop| f64::from(VIRIDIS[stop][k]));
        (from + (to - from) * fraction).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::colormap;

    #[test]
    fn it_grows_brighter_from_end_to_end() {
        let luminance = |value: f64| {
            let [r, g, b] = colormap(value).map(f64::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let steps: Vec<f64> = (0..=100).map(|k| luminance(f64::from(k) / 100.0)).collect();
        assert!(steps.is_sorted(), "{steps:?}");
        assert_eq!(colormap(-1.0), colormap(0.0));
        assert_eq!(colormap(f64::NAN), colormap(0.0));
        assert_eq!(colormap(f64::INFINITY), [0xfd, 0xe7, 0x25]);
    }
}

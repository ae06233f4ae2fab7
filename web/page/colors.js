// The colours of values: viridis (van der Walt and Smith, 2015), whose lightness rises evenly.

const STOPS = [
  [68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142],
  [31, 158, 137], [53, 183, 121], [110, 206, 88], [181, 222, 43], [253, 231, 37],
];

/**
 * Returns the colour of a value from 0 to 1 as sRGB, 0 to 1 each.
 * @param {number} value
 * @returns {[number, number, number]}
 */
export function colorOf(value) {
  const at = Math.min(Math.max(value, 0), 1) * (STOPS.length - 1);
  const k = Math.min(Math.floor(at), STOPS.length - 2);
  const mix = (c) => (STOPS[k][c] + (at - k) * (STOPS[k + 1][c] - STOPS[k][c])) / 255;
  return [mix(0), mix(1), mix(2)];
}

/** The colours as a CSS gradient from left to right. */
export const gradient = `linear-gradient(to right, ${STOPS.map((stop) => `rgb(${stop.join()})`).join()})`;

/** The colours of a tool's surfaces: those that cut, and the others. */
export const CUTTING = ['#2f7fc4', '#5ba4de', '#1d5f99', '#86bfec'];
export const OTHER = ['#8b97a5', '#b4bdc7', '#6d7986', '#cdd4db'];

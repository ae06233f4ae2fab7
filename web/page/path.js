// The path of a program as lines.

/** The greatest number of positions of a path that are drawn. */
export const MAX_POSITIONS = 50_000;

/**
 * Returns the lines of feed and of rapid traverse: the ends of each, 6 values per line. Of more positions than `most`, every second,
 * third, … is kept, and the last. A line is one of rapid traverse if all motions between its ends are.
 * @param {Float32Array} positions tips, each with 1 in rapid traverse, else 0
 * @param {number} most
 * @returns {{feed: Float32Array, rapid: Float32Array}}
 */
export function pathLines(positions, most = MAX_POSITIONS) {
  const last = positions.length / 4 - 1;
  const step = Math.max(1, Math.ceil(last / (most - 1)));
  const lines = { feed: [], rapid: [] };
  for (let from = 0; from < last; from += step) {
    const to = Math.min(from + step, last);
    let isRapid = true;
    for (let k = from + 1; k <= to; k++) isRapid &&= positions[4 * k + 3] === 1;
    const line = isRapid ? lines.rapid : lines.feed;
    for (const end of [from, to]) line.push(...positions.subarray(4 * end, 4 * end + 3));
  }
  return { feed: Float32Array.from(lines.feed), rapid: Float32Array.from(lines.rapid) };
}

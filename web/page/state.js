// The engine's list of values as an object.

/**
 * @typedef {{tip: number[], rotation: number[]}} Frame tip, and rotation column by column
 * @typedef {{cycle: number, tool: Frame, hand: Frame, force: number[], torque: number[], depth: number, niceness: number,
 *   count: number, stiffest: number, held: boolean}} State
 */

/**
 * @param {Float64Array} list
 * @returns {State | null} the state, `null` before the first cycle
 */
export function stateOf(list) {
  if (list.length === 0) return null;
  const part = (from, count) => Array.from(list.subarray(from, from + count));
  return {
    cycle: list[0],
    tool: { tip: part(1, 3), rotation: part(4, 9) },
    hand: { tip: part(13, 3), rotation: part(16, 9) },
    force: part(25, 3),
    torque: part(28, 3),
    depth: list[31],
    niceness: list[32],
    count: list[33],
    stiffest: list[34],
    held: list[35] === 1,
  };
}

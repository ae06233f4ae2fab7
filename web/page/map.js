// The map of what was touched: the best niceness per triangle.

/** @typedef {{niceness: number, pose: number[], tool: string}} Touched */

export class TouchMap {
  /** @type {Map<number, Touched>} */
  #best = new Map();
  /** The changes of each stroke, for undoing: triangle and what it was before. @type {Map<number, Touched | undefined>[]} */
  #strokes = [];
  #areas = new Float64Array();
  #area = 0;

  /** @param {Float32Array} positions of a new part's triangles */
  reset(positions) {
    this.#best.clear();
    this.#strokes = [];
    this.#areas = new Float64Array(positions.length / 9);
    for (let k = 0; k < this.#areas.length; k++) {
      const p = positions.subarray(9 * k, 9 * k + 9);
      const [a, b] = [3, 6].map((from) => [0, 1, 2].map((i) => p[from + i] - p[i]));
      this.#areas[k] = 0.5 * Math.hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
    }
    this.#area = this.#areas.reduce((sum, area) => sum + area, 0);
  }

  /** Begins a stroke, which is undone as one. */
  beginStroke() {
    if (this.#strokes.at(-1)?.size !== 0) this.#strokes.push(new Map());
  }

  /**
   * Records contacts of one pose. Returns the triangles that became better, with their niceness.
   * @param {Float32Array} contacts
   * @param {number} values per contact
   * @param {{cutting: boolean}[]} surfaces
   * @param {number[]} pose
   * @param {string} tool
   * @returns {[number, number][]}
   */
  record(contacts, values, surfaces, pose, tool) {
    const better = [];
    const count = contacts.length / values;
    // A posture is usable only if nothing but cutting surfaces touches.
    for (let k = 0; k < count; k++) if (!surfaces[contacts[values * k + 5]]?.cutting) return better;
    for (let k = 0; k < count; k++) {
      const triangle = contacts[values * k + 9];
      const niceness = contacts[values * k + 4];
      const before = this.#best.get(triangle);
      if (before && before.niceness >= niceness) continue;
      if (this.#strokes.length === 0) this.beginStroke();
      const stroke = this.#strokes.at(-1);
      if (!stroke.has(triangle)) stroke.set(triangle, before);
      this.#best.set(triangle, { niceness, pose, tool });
      better.push([triangle, niceness]);
    }
    return better;
  }

  /** Undoes the last stroke that changed anything. Returns the triangles with their niceness, `null` if untouched. */
  undo() {
    let stroke = this.#strokes.pop();
    while (stroke && stroke.size === 0) stroke = this.#strokes.pop();
    const changed = [];
    for (const [triangle, before] of stroke ?? []) {
      if (before) this.#best.set(triangle, before);
      else this.#best.delete(triangle);
      changed.push([triangle, before?.niceness ?? null]);
    }
    return changed;
  }

  /** Forgets everything. Returns the triangles that were touched. */
  clear() {
    const touched = [...this.#best.keys()].map((triangle) => [triangle, null]);
    this.#best.clear();
    this.#strokes = [];
    return touched;
  }

  /** Returns the fraction of the part's area that was touched. */
  get coverage() {
    let sum = 0;
    for (const triangle of this.#best.keys()) sum += this.#areas[triangle];
    return this.#area > 0 ? sum / this.#area : 0;
  }

  /** Returns the map as a table: one line per triangle, ordered. */
  table() {
    const lines = ['triangle,niceness,tool,x,y,z,qx,qy,qz,qw'];
    for (const [triangle, { niceness, pose, tool }] of [...this.#best].sort(([a], [b]) => a - b)) {
      lines.push([triangle, niceness.toPrecision(6), tool, ...pose].join());
    }
    return lines.join('\n') + '\n';
  }
}

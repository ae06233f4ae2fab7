// The time line of a program: clearance, depth and findings by position.

const FONT = '11px system-ui, "DejaVu Sans", sans-serif';
const INK = '#16202c';
const FAINT = '#4d5b6b';
const CLEARANCE = '#0b5cad';
const DEPTH = '#c2410c';
const BAD = '#b3261e';
const OPEN = '#8a5a00';
/** Heights of the lanes of clearance, findings and depth, in pixels. */
const LANES = [30, 10, 30];
/** Greatest clearance that is drawn, mm. */
const FAR = 5;

export class Timeline {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    this.last = 0;
    this.cursor = 0;
    this.tolerance = 0;
    this.far = FAR;
    this.unit = 'mm';
    /** @type {number[][]} position, depth and clearance */
    this.samples = [];
    /** The worst first. @type {{finding: import('./program.js').Finding, place: import('./program.js').Place}[]} */
    this.places = [];
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** Begins with another program. */
  reset(last, { unit, millimetres }) {
    Object.assign(this, { last, unit, cursor: 0, samples: [], places: [], far: FAR / millimetres });
    this.draw();
  }

  add(values) {
    for (let k = 0; k < values.length; k += 3) this.samples.push([values[k], values[k + 1], values[k + 2]]);
    this.draw();
  }

  setResult(findings, tolerance) {
    const places = findings.flatMap((finding) => finding.places.map((place) => ({ finding, place })));
    Object.assign(this, { places, tolerance });
    this.draw();
  }

  setCursor(position) {
    this.cursor = position;
    this.draw();
  }

  #x(position) {
    return this.last > 0 ? 1 + ((this.canvas.clientWidth - 2) * position) / this.last : 1;
  }

  /** Returns the position below a place of the canvas. */
  positionAt(x) {
    return Math.min(Math.max(((x - 1) / (this.canvas.clientWidth - 2)) * this.last, 0), this.last);
  }

  /** Returns the finding below a place of the canvas: of several, the worst. */
  findingAt(x, y) {
    if (y < LANES[0] - 3 || y > LANES[0] + LANES[1] + 3) return null;
    return this.places.find(({ place: { span: [first, last] } }) => this.#x(first - 1) - 3 <= x && x <= this.#x(last) + 3) ?? null;
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const ratio = window.devicePixelRatio;
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    const context = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext('2d'));
    context.scale(ratio, ratio);
    context.font = FONT;
    const [top, middle, bottom] = LANES;
    const floor = top + middle;
    context.fillStyle = '#eef2f6';
    context.fillRect(0, top, width, middle);

    const clearances = this.samples.filter(([, , clearance]) => Number.isFinite(clearance));
    if (clearances.length) {
      context.beginPath();
      clearances.forEach(([position, , clearance], k) => {
        const y = top - 1 - (top - 2) * Math.min(clearance / this.far, 1);
        if (k) context.lineTo(this.#x(position), y);
        else context.moveTo(this.#x(position), y);
      });
      context.strokeStyle = CLEARANCE;
      context.stroke();
    }

    const deepest = Math.max(2 * this.tolerance, ...this.samples.map(([, depth]) => depth));
    const at = (depth) => floor + bottom * Math.min(depth / deepest, 1);
    if (deepest > 0) {
      context.beginPath();
      context.moveTo(this.#x(0), floor);
      for (const [position, depth] of this.samples) context.lineTo(this.#x(position), at(depth));
      context.lineTo(this.#x(this.samples.at(-1)?.[0] ?? 0), floor);
      context.fillStyle = DEPTH;
      context.fill();
      context.setLineDash([4, 4]);
      context.beginPath();
      context.moveTo(0, at(this.tolerance));
      context.lineTo(width, at(this.tolerance));
      context.strokeStyle = FAINT;
      context.stroke();
      context.setLineDash([]);
    }

    // The worst comes last, on top.
    for (const { finding, place: { span: [first, last] } } of [...this.places].reverse()) {
      const from = this.#x(Math.max(first - 1, 0));
      context.fillStyle = finding.severity === 'violation' ? BAD : OPEN;
      context.fillRect(from, top + 1, Math.max(this.#x(last) - from, 2), middle - 2);
    }

    const label = (text, color, y) => {
      context.strokeStyle = '#ffffff';
      context.lineWidth = 3;
      context.strokeText(text, 4, y);
      context.lineWidth = 1;
      context.fillStyle = color;
      context.fillText(text, 4, y);
    };
    const number = (value) => `${Number(value.toPrecision(3))} ${this.unit}`;
    if (clearances.length) label(`distance of what does not cut, to ${number(this.far)}`, CLEARANCE, 11);
    if (deepest > 0) label(`depth, to ${number(deepest)}; dashed: tolerance`, DEPTH, height - 4);
    context.fillStyle = INK;
    context.fillRect(this.#x(this.cursor) - 1, 0, 2, height);
  }
}

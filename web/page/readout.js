// The numbers beside the picture, and title, axes and scale on it.

import { gradient } from './colors.js';

const id = (name) => /** @type {HTMLElement} */ (document.getElementById(name));
const vector = (values, digits) => values.map((value) => (Math.abs(value) < 0.5 * 10 ** -digits ? 0 : value).toFixed(digits)).join('  ');
const SVG = 'http://www.w3.org/2000/svg';

export class Readout {
  /** @type {{name: string, cutting: boolean}[]} */
  #surfaces = [];
  /** Decimals of a length, fewer in mm than in m. */
  #decimals = 3;
  #axes = [];

  constructor() {
    id('legend').querySelector('i').style.background = gradient;
    const svg = document.createElementNS(SVG, 'svg');
    svg.setAttribute('viewBox', '-38 -38 76 76');
    for (const [name, color] of [['x', '#b3261e'], ['y', '#176639'], ['z', '#0b5cad']]) {
      const line = document.createElementNS(SVG, 'line');
      const text = document.createElementNS(SVG, 'text');
      line.setAttribute('stroke', color);
      line.setAttribute('stroke-width', '2.5');
      text.setAttribute('fill', color);
      text.setAttribute('text-anchor', 'middle');
      text.setAttribute('dominant-baseline', 'central');
      text.textContent = name;
      svg.append(line, text);
      this.#axes.push({ line, text });
    }
    id('axes').append(svg);
  }

  /**
   * @param {{unit: string, millimetres: number}} facts of the part
   */
  setUnit({ unit, millimetres }) {
    this.#decimals = Math.max(0, Math.round(3 + Math.log10(millimetres)));
    for (const cell of document.querySelectorAll('.unit')) cell.textContent = unit;
  }

  /** @param {{name: string, cutting: boolean}[]} surfaces */
  setSurfaces(surfaces) {
    this.#surfaces = surfaces;
    const rows = surfaces.map(({ name, cutting }) => {
      const row = document.createElement('tr');
      const head = document.createElement('th');
      head.textContent = cutting ? `${name}, cuts` : name;
      row.append(head, ...[0, 1, 2].map(() => document.createElement('td')));
      return row;
    });
    id('surfaces').querySelector('tbody').replaceChildren(...rows);
  }

  /**
   * @param {import('./state.js').State} state
   * @param {Float64Array} surfaces points, depth and niceness by surface
   */
  show(state, surfaces) {
    const digits = this.#decimals;
    const length = (value) => value.toFixed(digits);
    id('force').textContent = Math.hypot(...state.force).toFixed(2);
    id('force-xyz').textContent = vector(state.force, 2);
    id('torque').textContent = Math.hypot(...state.torque).toFixed(1);
    id('torque-xyz').textContent = vector(state.torque, 1);
    id('depth').textContent = state.count ? length(state.depth) : 'none';
    id('niceness').textContent = state.count ? state.niceness.toFixed(3) : 'none';
    id('count').textContent = String(state.count);
    id('stretch').textContent = length(Math.hypot(...state.tool.tip.map((value, k) => value - state.hand.tip[k])));
    id('tip').textContent = vector(state.tool.tip, Math.max(0, digits - 1));
    id('axis').textContent = vector(state.tool.rotation.slice(6), 3);
    id('surfaces').querySelectorAll('tbody tr').forEach((row, k) => {
      const [points = 0, depth, niceness] = surfaces.subarray(3 * k, 3 * k + 3);
      const cells = row.querySelectorAll('td');
      const values = points ? [length(depth), niceness.toFixed(2), String(points)] : ['', '', ''];
      values.forEach((value, i) => { cells[i].textContent = value; });
      row.classList.toggle('touched', points > 0);
      row.classList.toggle('wrong', points > 0 && !this.#surfaces[k].cutting);
    });
  }

  /**
   * @param {{rate: number, p50: number, p99: number}} timing
   * @param {number} fps
   */
  showLoop({ rate, p50, p99 }, fps) {
    id('rate').textContent = rate ? rate.toFixed(0) : 'rests';
    // The clock resolves 5 µs at best.
    const time = (value) => (value < 5 ? 'below 5' : value.toFixed(0));
    id('p50').textContent = time(p50);
    id('p99').textContent = time(p99);
    id('fps').textContent = fps.toFixed(0);
  }

  /**
   * Draws the axes as the camera sees them, and a bar of a round length.
   * @param {import('./scene.js').Scene} scene
   * @param {number[]} at the point at which the scale holds
   * @param {string} unit
   */
  showView(scene, at, unit) {
    const { right, up, away } = scene.directions();
    this.#axes.forEach(({ line, text }, axis) => {
      const [x, y] = [right, up].map((direction) => direction.getComponent(axis));
      line.setAttribute('x2', (23 * x).toFixed(1));
      line.setAttribute('y2', (-23 * y).toFixed(1));
      text.setAttribute('x', (32 * x).toFixed(1));
      text.setAttribute('y', (-32 * y).toFixed(1));
      const faces = Math.abs(away.getComponent(axis)) > 0.97;
      line.style.display = text.style.display = faces ? 'none' : '';
    });
    const pixel = scene.pixel(at);
    const widest = 130 * pixel;
    const power = 10 ** Math.floor(Math.log10(widest));
    const length = [5, 2, 1].map((factor) => factor * power).find((one) => one <= widest) ?? power;
    id('scale-bar').style.width = `${length / pixel}px`;
    id('scale-text').textContent = `${Number(length.toPrecision(1))} ${unit}`;
  }

  /** @param {string} part @param {string} tool @param {string} title */
  showTitle(part, tool, title) {
    const small = document.createElement('small');
    small.textContent = title;
    id('title').replaceChildren(`${tool} on ${part}`, small);
  }

  /** Shows a message until the next one; without text, none. */
  message(text, isError = false) {
    id('message').hidden = !text;
    id('message').textContent = text ?? '';
    id('message').classList.toggle('error', isError);
  }
}

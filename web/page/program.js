// A program on the part: its path, a time line with findings, and the tool at any position.

import { Timeline } from './timeline.js';

const id = (name) => /** @type {any} */ (document.getElementById(name));
/** Duration of a whole program that plays, s, and least rate in positions per second. */
const PLAYED = { seconds: 40, rate: 4 };

/** @typedef {{kind: string, surface: string | null, at: number, span: number[], lines: number[], rapid: boolean, measured: number[] | null, limit: number | null, point: number[] | null, triangle: number, axis: number[]}} Finding */

export class ProgramView {
  /**
   * @param {import('./scene.js').Scene} scene
   * @param {{part: () => Promise<any>, tool: () => any, unit: () => {unit: string, millimetres: number}, message: (text: string, isError?: boolean) => void}} page
   */
  constructor(scene, page) {
    this.scene = scene;
    this.page = page;
    /** The pose to show: tip and quaternion; `null` while the hand holds the tool. @type {number[] | null} */
    this.pose = null;
    this.position = 0;
    this.last = 0;
    /** @type {{name: string, bytes: ArrayBuffer} | null} */
    this.file = null;
    /** The machine to begin with; with a text, it is not among the known ones. @type {{name: string, text: string | null} | null} */
    this.machine = null;
    this.timeline = new Timeline(id('timeline'));
    /** @type {Worker | null} */
    this.worker = null;
    this.asked = null;
    this.isBusy = false;
    this.isPlaying = false;
    this.#listen();
  }

  #listen() {
    id('position').addEventListener('input', () => {
      this.#play(false);
      this.seek(Number(id('position').value));
    });
    id('play').addEventListener('click', () => this.#play(!this.isPlaying));
    id('program-tool').addEventListener('change', () => this.#check({}));
    id('tolerance').addEventListener('change', () => this.#check({}));
    id('machine').addEventListener('change', () => this.#check({ program: true }));
    id('close-program').addEventListener('click', () => this.close());
    id('timeline').addEventListener('click', (event) => {
      const finding = this.timeline.findingAt(event.offsetX, event.offsetY);
      if (finding) this.show(finding);
      else this.seek(this.timeline.positionAt(event.offsetX));
    });
  }

  /** Opens a program: positions, or G-code. */
  async open(name, bytes) {
    this.file = { name, bytes };
    id('program').hidden = false;
    if (!this.worker) {
      this.page.message('starting the check');
      this.worker = new Worker('checker.js', { type: 'module' });
      this.worker.onerror = (event) => this.page.message(`the check has stopped: ${event.message}; load the page again`, true);
      await new Promise((resolve) => {
        /** @type {any} */ (this.worker).onmessage = ({ data }) => {
          id('machine').replaceChildren(...data.machines.map((machine) => new Option(machine)));
          if (this.machine?.text) id('machine').add(new Option(this.machine.name, '', true, true), 0);
          else if (this.machine) id('machine').value = this.machine.name;
          resolve(null);
        };
      });
      this.worker.onmessage = ({ data }) => this.#replies[data.kind](data);
    }
    await this.#check({ part: true, tool: true, program: true });
  }

  close() {
    this.file = null;
    this.leave();
    this.scene.setPath(null);
    id('program').hidden = id('findings').hidden = true;
  }

  /** Checks again with another part or another tool. */
  refresh(what) {
    if (this.file) this.#check(what);
  }

  /** Stops playing. */
  pause() {
    this.#play(false);
  }

  /** Lets go of the tool, which the hand takes. */
  leave() {
    this.pause();
    this.pose = null;
  }

  async #check(what) {
    if (!this.worker || !this.file) return;
    const machine = id('machine').value || this.machine?.text;
    id('verdict').textContent = 'checking';
    id('verdict').className = '';
    this.done = 0;
    const chosen = id('program-tool').value;
    this.worker.postMessage({
      kind: 'check',
      part: what.part ? await this.page.part() : null,
      tool: what.tool ? this.page.tool() : null,
      program: what.program ? { ...this.file, machine } : null,
      number: chosen === '' ? null : Number(chosen),
      tolerance: Number(id('tolerance').value),
    });
  }

  #replies = {
    program: ({ facts, number, positions }) => {
      this.last = positions.length / 4 - 1;
      this.facts = facts;
      this.scene.setPath(positions);
      this.timeline.reset(this.last, this.page.unit());
      id('position').max = String(this.last);
      const options = facts.tools.map((tool) => {
        const name = tool.number === null ? 'any' : `T${tool.number}`;
        return new Option(`${name}, ${tool.motions} motions`, tool.number ?? '', false, tool.number === number);
      });
      id('program-tool').replaceChildren(...options);
      id('program-tools').hidden = facts.tools.length < 2;
      id('machines').hidden = facts.machine === null;
      id('program-notes').textContent = facts.notes.join('\n');
      id('findings-list').replaceChildren();
      this.page.message('');
      this.seek(Math.min(this.position, this.last));
    },
    progress: ({ count }) => {
      this.done += count;
      id('verdict').textContent = `checking: ${Math.min(this.done, this.last + 1)} of ${this.last + 1} motions`;
    },
    result: ({ result, tolerance, milliseconds }) => {
      this.timeline.setResult(result.findings, tolerance);
      const seconds = (milliseconds / 1000).toFixed(1);
      const [text, kind] = verdict(result);
      id('verdict').textContent = `${text} (${result.motions} motions, proved in ${seconds} s)`;
      id('verdict').className = kind;
      id('program-notes').textContent = [...this.facts.notes, ...result.remarks].join('\n');
      id('findings').hidden = false;
      id('findings-list').replaceChildren(...result.findings.map((finding) => this.#row(finding)));
      id('canvas').dataset.findings = String(result.findings.length);
    },
    along: ({ samples, done }) => {
      this.timeline.add(samples);
      if (done) id('canvas').dataset.along = 'done';
    },
    at: ({ position, state }) => {
      this.isBusy = false;
      this.pose = Array.from(state.subarray(0, 7));
      this.timeline.setCursor(position);
      id('position').value = String(position);
      id('position-text').textContent = this.#describe(state);
      if (this.asked !== null) this.seek(this.asked);
    },
    error: ({ message }) => {
      this.isBusy = false;
      id('verdict').textContent = '';
      this.page.message(message, true);
    },
  };

  /** Goes to a position of the program. Of positions asked for meanwhile, the last one counts. */
  seek(position) {
    this.position = position;
    this.asked = position;
    if (this.isBusy || !this.worker) return;
    this.asked = null;
    this.isBusy = true;
    this.worker.postMessage({ kind: 'at', position });
  }

  /** Shows a finding, and looks at it. */
  show(finding) {
    this.#play(false);
    this.seek(finding.at);
    if (finding.point) this.scene.lookAt(finding.point, finding.triangle, finding.axis);
  }

  #play(on) {
    this.isPlaying = on;
    id('play').textContent = on ? '❚❚' : '▶';
    id('play').setAttribute('aria-label', on ? 'Pause' : 'Play');
  }

  /** Moves on along the program while it plays. */
  advance(seconds) {
    if (!this.isPlaying || this.isBusy) return;
    const rate = Math.max(this.last / PLAYED.seconds, PLAYED.rate);
    const from = this.position >= this.last ? 0 : this.position;
    const next = Math.min(from + rate * seconds, this.last);
    this.seek(next);
    if (next === this.last) this.#play(false);
  }

  #length(value) {
    const { unit, millimetres } = this.page.unit();
    return `${value.toFixed(Math.max(0, Math.round(3 + Math.log10(millimetres))))} ${unit}`;
  }

  #describe(state) {
    const [line, rapid, , high, low, , whole] = state.subarray(7);
    const parts = [`line ${line}`, rapid ? 'rapid traverse' : 'feed'];
    // Below the last digit that is shown, a bound is rounding.
    if (Number.parseFloat(this.#length(high)) > 0) parts.push(`at most ${this.#length(high)} deep`);
    else parts.push(`${this.#length(whole)} or more from the part`);
    if (Number.isFinite(low)) parts.push(low > 0 ? `what does not cut: ${this.#length(low)} or more away` : 'what does not cut touches');
    return parts.join(' · ');
  }

  /** @param {Finding} finding */
  #row(finding) {
    const button = document.createElement('button');
    const measured = finding.measured ? ` ${this.#length(finding.measured[1])}` : '';
    const name = document.createElement('b');
    name.textContent = `${finding.surface ?? 'tool'}: ${finding.kind === 'near' ? 'distance' : finding.kind}${finding.kind === 'right through' ? '' : measured}`;
    const [worst, first, last] = finding.lines;
    const lines = first === last ? `line ${worst}` : `lines ${first} to ${last}, worst ${worst}`;
    button.append(name, `${lines}${finding.rapid ? ', rapid traverse' : ''}`);
    button.addEventListener('click', () => this.show(finding));
    const item = document.createElement('li');
    item.append(button);
    return item;
  }
}

/**
 * Returns the verdict on a program and its class. Like that of `touchoff verify`, it is not good where the result proves
 * nothing.
 * @returns {[string, string]}
 */
function verdict({ findings, others, open, clear, inside_known: known, far, unit_factor: factor }) {
  if (findings.length) return [`${findings.length} finding${findings.length === 1 ? '' : 's'}`, 'bad'];
  if (others.length) return [others.join('; '), 'bad'];
  if (!known) return ['no findings at the surface; the part is not closed, so a tool inside it is not found', 'open'];
  if (open.length) return [`no findings in what was checked; ${open.join('; ')}`, 'open'];
  if (factor) return [`no findings, but all feed lies outside the part, and would fit if it were ${factor} times as large: check the units`, 'open'];
  if (far) return ['no findings, but the tool never comes near the part: check unit and position', 'open'];
  return clear ? ['no findings', 'good'] : ['no findings, but nothing could have been found', 'open'];
}

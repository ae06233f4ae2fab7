// A program on the part: its path, a time line with findings, and the tool at any position.

import { Timeline } from './timeline.js';

const id = (name) => /** @type {any} */ (document.getElementById(name));
/** Duration of a whole program that plays, s, and least rate in positions per second. */
const PLAYED = { seconds: 40, rate: 4 };

/** Lines of the program's text that are shown before and after that of the position. */
const AROUND = 2;
/** Index of the tool's number in a state, which is -1 without one. */
const NUMBER = 15;

/** Consecutive motions of a finding, in the reading that is shown. @typedef {{line: number, at: number, span: number[], surface: string | null, point: number[] | null, triangle: number, axis: number[]}} Place */
/** @typedef {{severity: string, text: string, line: number, tool_number: number | null, at: number | null, places: Place[]}} Finding */

export class ProgramView {
  /**
   * @param {import('./scene.js').Scene} scene
   * @param {{part: () => Promise<any>, tools: () => string[], tool: () => string, source: (name: string) => any, show: (name: string) => Promise<void>,
   *   unit: () => {unit: string, millimetres: number, lowest: number[], highest: number[]}, message: (text: string, isError?: boolean) => void}} page
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
    /** @type {string[]} */
    this.lines = [];
    /** The name of the tool of each number. @type {Map<number | null, string>} */
    this.tools = new Map();
    /** The number of the tool at the position. @type {number | null} */
    this.number = null;
    /** The machine to begin with; with a text, it is not among the known ones. @type {{name: string, text: string | null} | null} */
    this.machine = null;
    this.timeline = new Timeline(id('timeline'));
    /** @type {Worker | null} */
    this.worker = null;
    /** The facts about the program. @type {any} */
    this.facts = null;
    /** The tools that the command was given, by number. @type {[number | null, string][]} */
    this.given = [];
    this.asked = null;
    this.isBusy = false;
    this.isPlaying = false;
    this.#listen();
  }

  #listen() {
    id('show-path').addEventListener('change', () => this.scene.showPath(id('show-path').checked));
    id('position').addEventListener('input', () => {
      this.#play(false);
      this.seek(Number(id('position').value));
    });
    id('play').addEventListener('click', () => this.#play(!this.isPlaying));
    id('tolerance').addEventListener('change', () => this.#check());
    for (const name of ['sides', 'below', 'above']) id(`stock-${name}`).addEventListener('change', () => this.#check());
    id('machine').addEventListener('change', () => this.#read({ program: true }));
    id('close-program').addEventListener('click', () => this.close());
    id('timeline').addEventListener('click', (event) => {
      const found = this.timeline.findingAt(event.offsetX, event.offsetY);
      if (found) this.show(found.finding, found.place);
      else this.seek(this.timeline.positionAt(event.offsetX));
    });
  }

  /** Opens a program: positions, or G-code. */
  async open(name, bytes) {
    this.file = { name, bytes };
    // Lines are counted as by the reader of programs.
    this.lines = new TextDecoder().decode(bytes).split(/\r\n|[\r\n]/);
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
    await this.#read({ part: true, program: true });
  }

  close() {
    this.file = this.facts = null;
    this.leave();
    this.scene.setPath(null);
    this.scene.setStock(new Float32Array());
    id('program').hidden = id('findings').hidden = true;
  }

  /** Checks again with another part. */
  replacePart() {
    if (this.file) this.#read({ part: true });
  }

  /** Sets the tool at the position. */
  choose(name) {
    if (!this.facts) return;
    this.tools.set(this.number, name);
    this.#listTools();
  }

  /** Checks again with another tool at the position. */
  replaceTool(name) {
    this.choose(name);
    this.#check();
  }

  /** Checks again with the tools whose names begin with a number of the program. Returns whether there are any. */
  take(names) {
    const numbered = names.map((name) => [this.#numberOf(name), name]).filter(([number]) => number !== null);
    for (const [number, name] of numbered) this.tools.set(number, name);
    if (!numbered.length) return false;
    this.#listTools();
    this.#check();
    return true;
  }

  /** Returns the number of the program with which the name of a tool begins, as in `T2_drill.tool`. */
  #numberOf(name) {
    const number = Number(name.match(/^t(\d+)/i)?.[1] ?? Number.NaN);
    return this.facts?.tools.some((used) => used.number === number) ? number : null;
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

  async #read(what) {
    if (!this.worker || !this.file) return;
    const machine = id('machine').value || this.machine?.text;
    this.worker.postMessage({
      kind: 'read',
      part: what.part ? await this.page.part() : null,
      program: what.program ? { ...this.file, machine } : null,
    });
  }

  /** Checks all motions, once each number has a tool. */
  #check() {
    if (!this.worker || !this.facts) return;
    const missing = this.facts.tools.filter(({ number }) => !this.tools.has(number)).map(({ number }) => nameOf(number));
    id('verdict').textContent = missing.length ? `choose the tool of ${missing.join(', ')}` : 'checking';
    id('verdict').className = missing.length ? 'open' : '';
    id('findings').hidden = false;
    if (missing.length) return;
    this.done = 0;
    this.worker.postMessage({
      kind: 'check',
      tools: this.facts.tools.map(({ number }) => ({ number, ...this.page.source(/** @type {string} */ (this.tools.get(number))) })),
      stock: this.#stock(),
      tolerance: Number(id('tolerance').value),
    });
  }

  /** Returns the corners of the stock, which exceeds the part by the margins; none without margins. */
  #stock() {
    const [sides, below, above] = ['sides', 'below', 'above'].map((name) => id(`stock-${name}`).value);
    if (!sides && !below && !above) return [];
    const { lowest, highest } = this.page.unit();
    const [x, y, z] = [sides, sides, below].map((margin, axis) => lowest[axis] - Number(margin));
    return [x, y, z, ...[sides, sides, above].map((margin, axis) => highest[axis] + Number(margin))];
  }

  /** Lists the numbers of the program, each with the choice of its tool. */
  #listTools() {
    const names = this.page.tools();
    const rows = this.facts.tools.map(({ number, motions }) => {
      const choice = document.createElement('select');
      choice.setAttribute('aria-label', `Tool of ${nameOf(number)}`);
      const chosen = this.tools.get(number);
      choice.append(...(chosen ? [] : [new Option('choose…', '')]), ...names.map((name) => new Option(name, name, false, name === chosen)));
      choice.addEventListener('change', () => {
        this.tools.set(number, choice.value);
        this.#check();
      });
      const row = document.createElement('tr');
      const cells = [nameOf(number), `${motions} motions`, choice].map((content) => {
        const cell = document.createElement('td');
        cell.append(content);
        return cell;
      });
      row.append(...cells);
      return row;
    });
    id('program-tools').replaceChildren(...rows);
    id('program-tools').hidden = rows.length < 2;
  }

  #replies = {
    read: ({ facts }) => {
      if (facts) {
        const isSame = this.facts?.name === this.file?.name;
        this.facts = { ...facts, name: this.file?.name };
        if (!isSame) this.tools = new Map(this.given);
        for (const name of this.page.tools()) {
          const number = this.#numberOf(name);
          if (number !== null && !this.tools.has(number)) this.tools.set(number, name);
        }
        const [{ number }] = facts.tools;
        this.number = number;
        // One tool is the one that is shown.
        if (facts.tools.length === 1 && !this.tools.has(number)) this.tools.set(number, this.page.tool());
        id('machines').hidden = facts.machine === null;
        id('program-notes').textContent = facts.notes.join('\n');
      }
      this.page.message('');
      this.#listTools();
      this.#check();
    },
    motions: ({ positions }) => {
      this.last = positions.length / 4 - 1;
      this.scene.setPath(positions);
      this.scene.setStock(new Float32Array());
      this.timeline.reset(this.last, this.page.unit());
      id('position').max = String(this.last);
      id('findings-list').replaceChildren();
      this.seek(Math.min(this.position, this.last));
    },
    progress: ({ count }) => {
      this.done += count;
      id('verdict').textContent = `checking: ${Math.min(this.done, this.last + 1)} of ${this.last + 1} motions`;
    },
    result: ({ result: { verdict, findings, motions, stock }, tolerance, milliseconds }) => {
      this.timeline.setResult(findings, tolerance);
      const seconds = (milliseconds / 1000).toFixed(1);
      id('verdict').textContent = `${verdict.text} (${motions} motions, checked in ${seconds} s)`;
      id('verdict').className = { clean: 'good', findings: 'bad' }[verdict.verdict] ?? 'open';
      const reasons = verdict.reasons.map((reason) => `not verified: ${reason}`);
      id('program-notes').textContent = [...reasons, ...this.facts.notes, stock].filter(Boolean).join('\n');
      id('findings').hidden = false;
      id('findings-list').replaceChildren(...findings.map((finding) => this.#row(finding)));
      id('canvas').dataset.findings = String(findings.length);
    },
    stock: ({ positions }) => {
      if (this.file) this.scene.setStock(positions);
      id('canvas').dataset.stock = String(positions.length / 9);
    },
    along: ({ samples, done }) => {
      this.timeline.add(samples);
      if (done) id('canvas').dataset.along = 'done';
    },
    at: async ({ position, state }) => {
      this.number = state[NUMBER] < 0 ? null : state[NUMBER];
      // The tool comes before its pose.
      const name = this.tools.get(this.number);
      if (name) await this.page.show(name);
      this.isBusy = false;
      if (!this.file) return;
      this.pose = Array.from(state.subarray(0, 7));
      this.timeline.setCursor(position);
      id('position').value = String(position);
      id('position-text').textContent = this.#describe(state);
      this.#excerpt(state[7]);
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

  /**
   * Shows a place of a finding, and looks at it.
   * @param {Finding} finding
   * @param {Place | undefined} place
   */
  async show({ at, tool_number: number }, place) {
    this.#play(false);
    const position = place?.at ?? at;
    if (position !== null) this.seek(position);
    if (!place?.point) return;
    // The distance of the view depends on the tool.
    await this.page.show(/** @type {string} */ (this.tools.get(number)));
    this.scene.lookAt(place.point, place.triangle, place.axis, place.surface);
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
    const parts = [`line ${line}`, ...this.#ofTool(this.number), rapid ? 'rapid traverse' : 'feed'];
    // Below the last digit that is shown, a bound is rounding.
    if (Number.parseFloat(this.#length(high)) > 0) parts.push(`at most ${this.#length(high)} deep`);
    else parts.push(`${this.#length(whole)} or more from the part`);
    if (Number.isFinite(low)) parts.push(low > 0 ? `what does not cut: ${this.#length(low)} or more away` : 'what does not cut touches');
    return parts.join(' · ');
  }

  /** Names a tool if the program has several. */
  #ofTool(number) {
    return this.facts.tools.length > 1 ? [nameOf(number)] : [];
  }

  /** Shows the program's text around a line. */
  #excerpt(line) {
    const first = Math.max(line - AROUND, 1);
    const rows = this.lines.slice(first - 1, line + AROUND).map((text, k) => {
      const row = document.createElement('div');
      row.textContent = `${String(first + k).padStart(String(line + AROUND).length)}  ${text}`;
      row.classList.toggle('here', first + k === line);
      return row;
    });
    id('excerpt').replaceChildren(...rows);
  }

  /**
   * Makes a row of the list. Of several places, each click shows the next.
   * @param {Finding} finding
   */
  #row(finding) {
    const { severity, line, text, places } = finding;
    const [button, name, sentence] = ['button', 'b', 'span'].map((tag) => document.createElement(tag));
    button.className = severity;
    name.textContent = `line ${line}`;
    sentence.textContent = text;
    button.append(name, sentence);
    let shown = -1;
    button.addEventListener('click', () => {
      shown = (shown + 1) % Math.max(places.length, 1);
      this.show(finding, places[shown]);
      if (places.length > 1) name.textContent = `${shown + 1} of ${places.length}: line ${places[shown].line}`;
    });
    const item = document.createElement('li');
    item.append(button);
    return item;
  }
}

/** Returns the name of a number of a program. */
const nameOf = (number) => (number === null ? 'before the first tool' : `T${number}`);

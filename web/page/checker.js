// The check of programs, in a thread of its own.

import init, { Checker, Engine } from './engine.js';
import { engineModule } from './wasm.js';

/** Positions for which depth and clearance are drawn, at most. */
const SAMPLES = 800;
/** Time for which samples are computed before other requests are answered, ms. */
const SLICE = 30;

/** @type {Checker} */
let checker;
let version = 0;

globalThis.checkedMotions = (count) => postMessage({ kind: 'progress', count });

/** Computes depth and clearance at positions from `next` on, in slices. */
function follow(of, step, next, last) {
  if (of !== version) return;
  const samples = [];
  const begin = performance.now();
  while (next <= last && performance.now() - begin < SLICE) {
    const [, depth, low] = checker.at(next).subarray(9);
    samples.push(next, depth, low);
    next += step;
  }
  postMessage({ kind: 'along', samples, done: next > last });
  if (next <= last) setTimeout(() => answer({ kind: 'follow', of, step, next, last }), 0);
}

/** The position to which the stock is to be cut, `null` if it is there. @type {number | null} */
let cutTo = null;
let isCutting = false;
let hasStock = false;
/** The number of points of the stock that was sent last. */
let sentPoints = -1;

/** Cuts the stock in slices, and sends what remains after each that has cut something. */
function cut() {
  const begin = performance.now();
  while (cutTo !== null && performance.now() - begin < SLICE) {
    if (checker.cutStock(cutTo)) cutTo = null;
  }
  const points = checker.stockPoints();
  if (points !== sentPoints) {
    sentPoints = points;
    const positions = checker.stockPositions();
    postMessage({ kind: 'stock', positions }, { transfer: [positions.buffer] });
  }
  isCutting = cutTo !== null;
  if (isCutting) setTimeout(() => answer({ kind: 'cut' }), 0);
}

/** @type {Record<string, (message: any) => void>} */
const requests = {
  /** Takes what is new of part and program. */
  read({ part, program }) {
    version++;
    if (part?.bytes) checker.readPart(new Uint8Array(part.bytes), part.name, part.unit);
    else if (part) checker.generatePart(part.shape);
    const facts = program && JSON.parse(checker.readProgram(new Uint8Array(program.bytes), program.name, program.machine));
    if (facts?.tools.length === 0) throw new Error('the program has no motions that can be checked');
    postMessage({ kind: 'read', facts });
  },
  /** Checks the motions of all tools, each given with its number in the program. */
  check({ tools, stock, tolerance }) {
    version++;
    checker.setStock(new Float64Array(stock));
    hasStock = stock.length > 0;
    sentPoints = -1;
    for (const { number, name, text, files } of tools) {
      checker.setTool(number ?? undefined, name, text ?? Engine.libraryText(name), JSON.stringify(files));
    }
    const positions = checker.takeMotions();
    const count = positions.length / 4;
    postMessage({ kind: 'motions', positions });
    const before = performance.now();
    const result = JSON.parse(checker.check(tolerance));
    postMessage({ kind: 'result', result, tolerance, milliseconds: performance.now() - before });
    follow(version, Math.max(1, Math.ceil(count / SAMPLES)), 0, count - 1);
  },
  at({ position }) {
    postMessage({ kind: 'at', position, state: checker.at(position) });
    if (!hasStock) return;
    cutTo = position;
    if (!isCutting) setTimeout(() => answer({ kind: 'cut' }), 0);
    isCutting = true;
  },
  cut,
  follow({ of, step, next, last }) {
    follow(of, step, next, last);
  },
};

/** Answers a request, or says why it cannot be met. */
function answer(data) {
  try {
    requests[data.kind](data);
  } catch (error) {
    if (data.kind === 'cut') isCutting = hasStock = false;
    postMessage({ kind: 'error', request: data.kind, message: String(error instanceof Error ? error.message : error) });
  }
}

onmessage = ({ data }) => answer(data);

await init({ module_or_path: await engineModule() });
checker = new Checker();
postMessage({ kind: 'ready', machines: JSON.parse(Checker.machines()) });

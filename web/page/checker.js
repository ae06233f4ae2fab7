// The check of programs, in a thread of its own.

import init, { Checker } from './engine.js';
import { engineModule } from './wasm.js';

/** Positions for which depth and clearance are drawn, at most. */
const SAMPLES = 800;
/** Time for which samples are computed before other requests are answered, ms. */
const SLICE = 30;

/** @type {Checker} */
let checker;
/** @type {{machine: string | null, tools: {number: number | null, motions: number}[], notes: string[]}} */
let facts;
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

/** @type {Record<string, (message: any) => void>} */
const requests = {
  /** Takes what is new of part, tool and program, and checks the motions of a tool of the program. */
  check({ part, tool, program, number, tolerance }) {
    version++;
    if (part?.bytes) checker.readPart(new Uint8Array(part.bytes), part.name, part.unit);
    else if (part) checker.generatePart(part.shape);
    if (tool) checker.setTool(tool.name, tool.text, JSON.stringify(tool.files));
    if (program) facts = JSON.parse(checker.readProgram(new Uint8Array(program.bytes), program.name, program.machine));
    const taken = facts.tools.find((one) => one.number === number) ?? facts.tools[0];
    if (!taken) throw new Error('the program has no motions that can be checked');
    const positions = checker.takeMotions(taken.number ?? undefined);
    const count = positions.length / 4;
    postMessage({ kind: 'program', facts, number: taken.number, positions });
    const before = performance.now();
    const result = JSON.parse(checker.check(tolerance));
    postMessage({ kind: 'result', result, tolerance, milliseconds: performance.now() - before });
    follow(version, Math.max(1, Math.ceil(count / SAMPLES)), 0, count - 1);
  },
  at({ position }) {
    postMessage({ kind: 'at', position, state: checker.at(position) });
  },
  follow({ of, step, next, last }) {
    follow(of, step, next, last);
  },
};

/** Answers a request, or says why it cannot be met. */
function answer(data) {
  try {
    requests[data.kind](data);
  } catch (error) {
    postMessage({ kind: 'error', request: data.kind, message: String(error instanceof Error ? error.message : error) });
  }
}

onmessage = ({ data }) => answer(data);

await init({ module_or_path: await engineModule() });
checker = new Checker();
postMessage({ kind: 'ready', machines: JSON.parse(Checker.machines()) });

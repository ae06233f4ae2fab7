// The engine in a thread of its own: a cycle every millisecond while the hand moves or has just moved.

import init, { Engine } from './engine.js';
import { Timing } from './timing.js';
import { engineModule } from './wasm.js';

const PERIOD = 1; // ms
/** Cycles that are caught up at most; older ones are skipped. */
const MAX_LATE = 50;
/** Time without a new target after which the loop rests, ms. */
const REST_AFTER = 1500;

/** @type {Engine} */
let engine;
let start = 0;
let done = 0;
let skipped = 0;
let moved = 0;
let running = false;
let lastPose = '';
const timing = new Timing();
const turn = new MessageChannel();
turn.port1.onmessage = () => {
  cycle();
  if (running) turn.port2.postMessage(0);
};

/** Runs the cycles that are due. */
function cycle() {
  const now = performance.now();
  let due = Math.floor((now - start) / PERIOD) - done;
  if (due > MAX_LATE) {
    skipped += due - MAX_LATE;
    done += due - MAX_LATE;
    due = MAX_LATE;
  }
  for (let k = 0; k < due; k++) {
    const before = performance.now();
    engine.step(1);
    timing.add(performance.now() - before);
  }
  done += due;
  if (now - moved > REST_AFTER) running = false;
}

/** Begins or continues the loop. */
function wake() {
  moved = performance.now();
  if (running || !engine.isRunning()) return;
  running = true;
  start = performance.now();
  done = 0;
  timing.restart(start);
  turn.port2.postMessage(0);
}

/** @returns {{positions: Float32Array, normals: Float32Array, surfaces: Uint32Array}} */
const toolTriangles = () => ({ positions: engine.toolPositions(), normals: engine.toolNormals(), surfaces: engine.toolSurfaces() });

/** The text to compile next. @type {{name: string, text: string, files: Record<string, string>, version: number} | null} */
let waitingTool = null;

/** Sends a state to be shown. */
function send(state, contacts) {
  const surfaces = engine.surfaceContacts();
  postMessage({ kind: 'frame', state, contacts, surfaces, timing: timing.summary(running), skipped }, [state.buffer, contacts.buffer, surfaces.buffer]);
}

/** @type {Record<string, (message: any) => void>} */
const requests = {
  part({ shape, bytes, name, unit, points }) {
    if (bytes) engine.readPart(new Uint8Array(bytes), name, unit);
    else engine.generatePart(shape);
    const positions = engine.partPositions();
    const facts = JSON.parse(engine.partFacts());
    postMessage({ kind: 'part', facts, positions, tool: toolTriangles() }, [positions.buffer]);
    // A tool that waits is compiled before, so that there is a picture meanwhile.
    setTimeout(() => answer({ kind: 'points', points }), 0);
  },
  /** Samples the part: it can be touched then. */
  points({ points }) {
    postMessage({ kind: 'points', points, radius: engine.samplePart(points) });
  },
  tool(request) {
    // Of texts that arrive while one compiles, the last one counts.
    if (!waitingTool) setTimeout(() => answer({ kind: 'compile' }), 0);
    waitingTool = request;
  },
  /** Compiles the text that waits, and takes the tool unless it has errors. */
  compile() {
    const { name, text, files, version } = waitingTool;
    waitingTool = null;
    const before = performance.now();
    const result = JSON.parse(engine.compileTool(name, text, JSON.stringify(files)));
    const milliseconds = performance.now() - before;
    postMessage({ kind: 'tool', version, result, milliseconds, tool: result.tool && toolTriangles() });
  },
  libraryTool({ file, version }) {
    const text = Engine.libraryText(file);
    postMessage({ kind: 'text', name: file, text });
    requests.tool({ name: file, text, files: {}, version });
  },
  stiffness({ value }) { engine.setStiffness(value); },
  start({ pose }) {
    engine.start(new Float64Array(pose));
    postMessage({ kind: 'stiffness', derived: engine.derivedStiffness() });
    lastPose = pose.join();
    wake();
  },
  /** A frame of the page while a program holds the tool: no cycles, only the contact at its pose. */
  show({ pose }) {
    running = false;
    lastPose = '';
    const values = new Float64Array(pose);
    const state = engine.isRunning() ? engine.stateAt(values) : new Float64Array();
    send(state, engine.shownContacts(values));
  },
  /** A frame of the page: the pose asked for, to be reached within the time between frames. */
  frame({ pose, interval }) {
    const key = pose.join();
    if (key !== lastPose && engine.isRunning()) {
      lastPose = key;
      engine.moveTo(new Float64Array(pose), interval / PERIOD);
      wake();
    }
    send(engine.state(), engine.contacts());
  },
};

/** Answers a request, or says why it cannot be met. */
function answer(data) {
  try {
    requests[data.kind](data);
  } catch (error) {
    postMessage({ kind: 'error', request: data.kind, message: String(error instanceof Error ? error.message : error) });
    // A page that waits for a frame gets the next one.
    if (data.kind === 'frame' || data.kind === 'show') send(new Float64Array(), new Float32Array());
  }
}

onmessage = ({ data }) => answer(data);

await init({ module_or_path: await engineModule() });
// The contact stiffness follows from tool and part, until the page states one.
engine = new Engine(1000 / PERIOD, 0);
postMessage({ kind: 'ready', library: JSON.parse(Engine.library()) });

// The page: brings the engine, the picture, the hand and the editor together.

import { Quaternion } from 'three';
import { Editor } from './editor.js';
import { Hand } from './hand.js';
import { TouchMap } from './map.js';
import { ProgramView } from './program.js';
import { Readout } from './readout.js';
import { CONTACT_VALUES, Scene } from './scene.js';
import { stateOf } from './state.js';

const SHAPES = { pocket: 'plate with a pocket', tube: 'tube of the thesis' };
const DEFAULT_TOOL = 'd2_ball.tool';
const id = (name) => /** @type {any} */ (document.getElementById(name));

const scene = new Scene(id('canvas'));
const hand = new Hand(scene);
const readout = new Readout();
const map = new TouchMap();
const worker = new Worker('worker.js', { type: 'module' });
const editor = new Editor(id('editor'), (text) => compile(toolName, text, toolFiles));

const program = new ProgramView(scene, {
  part: partSource,
  tools: () => [...sources.keys()],
  tool: () => toolName,
  source: (name) => ({ name, ...sources.get(name) }),
  show: (name) => new Promise((resolve) => {
    if (name === toolName && awaiting.length === 0) {
      resolve();
    } else {
      if (name !== toolName) takeTool(name);
      awaiting.push(resolve);
    }
  }),
  unit: () => part,
  message: (text, isError) => readout.message(text, isError),
});

// A hand on the tool stops the program.
hand.taken = () => program.pause();

/** The file and the facts of part and tool, and the texts that the tool may mount. */
let partName = '';
/** @type {any} */ let part = null;
let isSampled = false;
let toolName = '';
let toolFiles = {};
/** The text and the files of each known tool, by the name of its file; those of the library have no text here. @type {Map<string, {text: string | null, files: any}>} */
const sources = new Map();
/** The text of the library's tool that was shown last. */
let libraryText = '';
/** Callbacks for the arrival of the tool that a program asked for. @type {(() => void)[]} */
const awaiting = [];
/** @type {any} */ let tool = null;
let version = 0;
/** @type {import('./state.js').State | null} */
let state = null;
let waiting = false;
let lastFrame = performance.now();
let interval = 16;
let fps = 0;
let lastLoop = 0;

const ask = (kind, rest = {}, transfer = []) => worker.postMessage({ kind, ...rest }, transfer);

function compile(name, text, files) {
  toolName = name;
  toolFiles = files;
  ask('tool', { name, text, files, version: ++version });
}

/** Places the tool upright above the part, as high as a tenth of its size. */
function place() {
  if (!part || !tool) return;
  const { lowest, highest } = part;
  const middle = [0, 1].map((k) => 0.5 * (lowest[k] + highest[k]));
  hand.place([lowest[0] + 0.1 * (highest[0] - lowest[0]), middle[1], highest[2] + 0.06 * scene.size]);
  restart();
}

/** Returns what a thread needs to read the part. */
async function partSource() {
  if (lastPart) return lastPart;
  return { bytes: await lastFile.arrayBuffer(), name: partName, unit: id('unit').value };
}

/** Begins a session where the tool stands, which is outside the part even if the hand is not. */
function restart() {
  state = null;
  if (isSampled && tool) ask('start', { pose: [...(hand.stands ?? hand.tip.toArray()), ...hand.turn.toArray()] });
}

function title() {
  if (part && tool) readout.showTitle(partName, tool.name, tool.title);
}

const replies = {
  async ready({ library }) {
    for (const { file, name, title } of library) {
      sources.set(file, { text: null, files: {} });
      id('tool').add(new Option(`${name}${title ? `: ${title}` : ''}`, file));
    }
    await begin();
  },
  part({ facts, positions, tool: triangles }) {
    if (part?.millimetres !== facts.millimetres) id('tolerance').value = String(Number((0.01 / facts.millimetres).toPrecision(1)));
    part = facts;
    hand.millimetre = facts.millimetres;
    scene.setPart(positions);
    map.reset(positions);
    coverage();
    readout.setUnit(facts);
    if (tool) scene.setTool(triangles, tool.surfaces);
    title();
  },
  /** The part has points now, and can be touched. */
  points({ points, radius }) {
    // Points of a part that another one is about to replace.
    if (!part) return;
    isSampled = true;
    const cover = radius ? `, none of the surface farther than ${radius.toFixed(3)} ${part.unit} from one` : '';
    id('facts').textContent = `${partName}: ${part.findings.join('; ')}.\n${points.toLocaleString('en')} points${cover}.`;
    readout.message('');
    place();
    program.replacePart();
    openLater();
  },
  /** The contact stiffness that follows from tool and part: in use while the field is empty. */
  stiffness({ derived }) {
    if (derived) id('stiffness').placeholder = derived.toPrecision(3);
  },
  text({ text }) {
    editor.text = libraryText = text;
  },
  tool({ version: of, result, tool: triangles, milliseconds }) {
    // A later text is on its way.
    if (of !== version) return;
    const first = result.diagnostics[0];
    editor.show(result.diagnostics);
    const problem = id('problem');
    problem.className = first?.severity ?? '';
    const count = result.diagnostics.length;
    problem.textContent = first
      ? `${first.file ? `${first.file}: ` : ''}${first.message}; ${first.help}${count > 1 ? ` (and ${count - 1} more)` : ''}`
      : `no errors, compiled in ${milliseconds.toFixed(0)} ms`;
    id('drawing').classList.toggle('stale', !result.tool);
    const callers = awaiting.splice(0);
    for (const resolve of callers) resolve();
    if (!result.tool) {
      if (id('editor-pane').hidden) readout.message(problem.textContent, true);
      return;
    }
    // The library's texts are known to the check.
    if (editor.text !== libraryText) sources.set(toolName, { text: editor.text, files: toolFiles });
    const isNew = !tool || tool.name !== result.tool.name;
    tool = result.tool;
    id('drawing').innerHTML = tool.svg;
    readout.setSurfaces(tool.surfaces);
    if (part) {
      scene.setTool(triangles, tool.surfaces);
      if (isNew && !program.pose) place();
      else restart();
      if (!callers.length) program.replaceTool(toolName);
    }
    title();
  },
  frame({ state: list, contacts, surfaces, timing, skipped }) {
    waiting = false;
    state = stateOf(list);
    if (state && tool && surfaces.length === 3 * tool.surfaces.length) {
      hand.stands = state.tool.tip;
      scene.show(state, contacts);
      readout.show(state, surfaces);
      // A program has no hand on which the haptic model could give a force.
      id('wrench').hidden = id('stretch-row').hidden = program.pose !== null;
      id('contact-at').textContent = program.pose ? 'Contact at this position' : 'Contact';
      if (state.count > 0 && hand.drag?.moves && !program.pose) {
        const better = map.record(contacts, CONTACT_VALUES, tool.surfaces, hand.pose, tool.name);
        if (better.length) {
          scene.colorTriangles(better);
          coverage();
        }
      }
      // For scripts: where the tool is on the canvas.
      id('canvas').dataset.tip = scene.project(state.tool.tip).map((value) => value.toFixed(1)).join();
      id('canvas').dataset.force = state.force.join();
      id('canvas').dataset.range = String(scene.toolRange());
      id('canvas').dataset.timing = JSON.stringify({ ...timing, skipped, fps });
    }
    const now = performance.now();
    if (now - lastLoop > 250) {
      lastLoop = now;
      readout.showLoop(timing, fps);
    }
  },
  error({ message }) {
    waiting = false;
    readout.message(message, true);
  },
};

worker.onmessage = ({ data }) => replies[data.kind](data);
worker.onerror = (event) => readout.message(`the engine has stopped: ${event.message}; load the page again`, true);

function coverage() {
  id('coverage').textContent = (100 * map.coverage).toFixed(1);
}

/** Draws, and asks the engine for the next state. */
function frame(now) {
  requestAnimationFrame(frame);
  const elapsed = Math.min(now - lastFrame, 250);
  lastFrame = now;
  interval += 0.1 * (elapsed - interval);
  fps = 1000 / Math.max(interval, 1);
  hand.advance(elapsed / 1000, state ? Math.hypot(...state.force) : 0);
  program.advance(elapsed / 1000);
  followProgram();
  if (isSampled && tool && !waiting) {
    waiting = true;
    if (program.pose) ask('show', { pose: program.pose });
    else ask('frame', { pose: hand.pose, interval: Math.min(Math.max(interval, 4), 100) });
  }
  scene.draw();
  // For scripts, too.
  id('canvas').dataset.camera = scene.camera.position.toArray().map((value) => value.toFixed(3)).join();
  if (part) readout.showView(scene, state?.tool.tip ?? scene.orbit.target.toArray(), part.unit);
}

/** The pose of the program that the hand has taken over. @type {number[] | null} */
let followed = null;

/** Keeps the hand with a program that holds the tool, until somebody moves the hand. */
function followProgram() {
  if (!program.pose) return;
  if (program.pose !== followed) {
    followed = program.pose;
    hand.place(followed.slice(0, 3), new Quaternion(...followed.slice(3)));
  } else if (hand.pose.some((value, k) => Math.abs(value - followed[k]) > 1e-9)) {
    program.leave();
    state = null;
    ask('start', { pose: followed });
  }
}

/** Reads a part's file. */
async function openPart(file) {
  readout.message(`reading ${file.name}`);
  const bytes = await file.arrayBuffer();
  loadPart(file.name, { bytes, unit: id('unit').value });
}

function loadPart(name, request) {
  partName = name;
  part = null;
  isSampled = false;
  readout.message(`sampling ${name}`);
  ask('part', { name, points: Number(id('points').value), ...request }, request.bytes ? [request.bytes] : []);
  // Kept for another number of points or another unit.
  lastPart = request.bytes ? null : request;
}
let lastPart = null;
let lastFile = null;

/** Opens files of tools, each of which can mount the others. */
async function openTools(files) {
  const texts = await Promise.all(files.map(async (file) => [file.name, await file.text()]));
  for (const [name, text] of texts) addTool(name, text, Object.fromEntries(texts.filter(([other]) => other !== name)));
  // Tools that a program has by their numbers are shown where it uses them.
  if (!program.take(texts.map(([name]) => name))) chooseTool(texts[0][0]);
}

/** Shows a tool, which takes the place of that at the position of a program. */
function chooseTool(name) {
  program.choose(name);
  takeTool(name);
}

/** Adds a tool to those that can be chosen, in place of one with its name. */
function addTool(name, text, files) {
  sources.set(name, { text, files });
  for (const option of [...id('tool').options]) if (option.value === name) option.remove();
  id('tool').add(new Option(name, name), 0);
}

/** Begins with what the server was given, or a default part and tool. */
async function begin() {
  const session = await (await fetch('session.json')).json();
  for (const [shape, name] of Object.entries(SHAPES)) id('part').add(new Option(name, shape));
  for (const { name, text, files } of session.tools ?? []) if (text !== null) addTool(name, text, files);
  program.given = (session.tools ?? []).filter(({ number }) => number !== null).map(({ number, name }) => [number, name]);
  takeTool(session.tools?.[0]?.name ?? DEFAULT_TOOL);
  if (session.program) {
    const { name, machine } = session.program;
    program.machine = machine;
    waitingProgram = [name, await (await fetch('program')).arrayBuffer()];
  }
  if (session.part) {
    const { name, unit } = session.part;
    id('part').add(new Option(name, ''), 0);
    id('part').value = '';
    id('unit').value = unit;
    lastFile = new File([await (await fetch('part')).arrayBuffer()], name);
    await openPart(lastFile);
  } else {
    loadPart(SHAPES.pocket, { shape: 'pocket' });
  }
  requestAnimationFrame(frame);
}

/** A program that is opened as soon as the part is there. @type {[string, ArrayBuffer] | null} */
let waitingProgram = null;
function openLater() {
  if (waitingProgram && tool) program.open(...waitingProgram);
  waitingProgram = null;
}

/** Shows a tool that is known. */
function takeTool(name) {
  const { text, files } = /** @type {any} */ (sources.get(name));
  id('tool').value = name;
  if (text === null) {
    toolName = name;
    toolFiles = files;
    ask('libraryTool', { file: name, version: ++version });
  } else {
    editor.text = text;
    compile(name, text, files);
  }
}

const on = (name, event, handler) => id(name).addEventListener(event, handler);
on('part', 'change', () => (id('part').value ? loadPart(SHAPES[id('part').value], { shape: id('part').value }) : openPart(lastFile)));
on('points', 'change', () => {
  isSampled = false;
  readout.message(`sampling ${partName}`);
  ask('points', { points: Number(id('points').value) });
});
on('unit', 'change', () => lastFile && !lastPart && openPart(lastFile));
on('tool', 'change', () => chooseTool(id('tool').value));
on('open-part', 'click', () => id('part-file').click());
on('open-tool', 'click', () => id('tool-file').click());
on('open-program', 'click', () => id('program-file').click());
on('program-file', 'change', async () => {
  const [file] = id('program-file').files;
  if (file) program.open(file.name, await file.arrayBuffer()).catch((error) => readout.message(error.message, true));
  id('program-file').value = '';
});
on('part-file', 'change', () => take([...id('part-file').files]));
on('tool-file', 'change', () => take([...id('tool-file').files]));
on('stiffness', 'change', () => {
  ask('stiffness', { value: Number(id('stiffness').value) });
  restart();
});
on('edit', 'click', () => {
  const pane = id('editor-pane');
  pane.hidden = !pane.hidden;
  id('edit').setAttribute('aria-expanded', String(!pane.hidden));
  document.querySelector('main').classList.toggle('editing', !pane.hidden);
});
on('spacemouse', 'click', async () => {
  try {
    readout.message(`connected: ${await hand.connectSpaceMouse()}`);
  } catch (error) {
    readout.message(error.message, true);
  }
});
on('canvas', 'pointerdown', () => {
  id('canvas').focus();
  map.beginStroke();
});
for (const button of document.querySelectorAll('[data-view]')) {
  button.addEventListener('click', () => scene.view(button.dataset.view));
}
const undo = () => {
  scene.colorTriangles(map.undo());
  coverage();
};
on('undo', 'click', undo);
on('canvas', 'keydown', (event) => {
  if (event.key === 'z' && (event.ctrlKey || event.metaKey)) undo();
});
on('clear', 'click', () => {
  scene.colorTriangles(map.clear());
  coverage();
});
on('export', 'click', () => {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([map.table()], { type: 'text/csv' }));
  link.download = 'touched.csv';
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
});

const MESH = /\.(stl|ply|obj)$/i;

/** Takes files that were opened or dropped: tools and parts by their ending, else a program. */
function take(files) {
  const tools = files.filter((file) => file.name.endsWith('.tool'));
  if (tools.length) {
    openTools(tools).catch((error) => readout.message(error.message, true));
  }
  const [other] = files.filter((file) => !file.name.endsWith('.tool') && !MESH.test(file.name));
  if (other) {
    other.arrayBuffer().then((bytes) => program.open(other.name, bytes)).catch((error) => readout.message(error.message, true));
  }
  const mesh = files.find((file) => MESH.test(file.name));
  if (mesh) {
    lastFile = mesh;
    id('part').add(new Option(mesh.name, ''), 0);
    id('part').selectedIndex = 0;
    openPart(mesh).catch((error) => readout.message(error.message, true));
  }
}
for (const name of ['dragenter', 'dragover', 'dragleave', 'drop']) {
  document.addEventListener(name, (event) => {
    event.preventDefault();
    id('view').classList.toggle('drop', name === 'dragover' || name === 'dragenter');
    if (name === 'drop') take([...event.dataTransfer.files]);
  });
}
coverage();

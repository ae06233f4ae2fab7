// Programs under Node.js: what the engine proves about them has closed forms.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { gunzipSync } from 'node:zlib';
import { pathLines } from '../page/path.js';
import { Checker, Engine, initSync } from '../dist/engine.js';

initSync({ module: gunzipSync(readFileSync(new URL('../dist/engine.wasm.gz', import.meta.url))) });
let done = 0;
globalThis.checkedMotions = (count) => { done += count; };

const DEEP = 0.2;
const bytes = (text) => new TextEncoder().encode(text);
const table = bytes(`-18,0,5,0,0,1\n-16,0,${-DEEP},0,0,1\n-14,0,${-DEEP},0,0,1\n-14,0,5,0,0,1\n`);
const gcode = bytes(`G21 G90\nT7 M6\nG43 H7\nG0 X-18. Y0. Z5.\nG1 X-16. Z${-DEEP} F100.\nX-14.\nG0 Z5.\nM30\n`);

const checker = new Checker();
checker.generatePart('pocket');
const refused = (body, reason) => assert.throws(body, (error) => reason.test(error.message) || assert.fail(error.message));
const take = (number, file) => checker.setTool(number, file, Engine.libraryText(file), '{}');
assert.ok(JSON.parse(Checker.machines()).includes('A-C trunnion'));

for (const [name, program, number] of [['along.csv', table, undefined], ['along.nc', gcode, 7]]) {
  const facts = JSON.parse(checker.readProgram(program, name, '3-axis'));
  assert.equal(facts.tools.length, 1);
  assert.equal(facts.machine, name.endsWith('.nc') ? '3-axis' : null);
  take(number, 'd2_ball.tool');
  const positions = checker.takeMotions();
  assert.equal(positions.length, 4 * 4);
  done = 0;
  const result = JSON.parse(checker.check(0.01));
  assert.equal(done, 4);
  assert.equal(result.motions, 3);
  // A ball whose tip is 0.2 below the top of the plate is 0.2 deep in it. A cut through the top face has a border, at
  // which the ball is not deeper.
  const [finding] = result.findings;
  const { severity, kind, surface, depth, allowed_depth: allowed, point, places: [{ axis }] } = finding;
  assert.deepEqual([severity, kind, surface, result.findings.length, result.verdict.verdict], ['violation', 'deep', 'ball', 1, 'findings']);
  assert.ok(depth[0] <= DEEP && DEEP <= depth[1], depth.join());
  assert.ok(depth[1] - depth[0] < 2e-3, depth.join());
  assert.equal(allowed, 0.01);
  assert.ok(Math.abs(point[2]) < 1e-9);
  assert.deepEqual(axis, [0, 0, 1]);

  const state = (position) => {
    const [x, y, z, , , , w, line, rapid, low, high, others, , whole, most] = checker.at(position);
    return { tip: [x, y, z], w, line, rapid, depth: [low, high], others, whole: [whole, most] };
  };
  const middle = state(1.5);
  assert.deepEqual(middle.tip.map((value) => Number(value.toFixed(12))), [-15, 0, -DEEP]);
  assert.ok(middle.depth[0] <= DEEP && DEEP <= middle.depth[1] && middle.depth[1] - middle.depth[0] < 1e-4);
  // The shank of D2Ball begins 5 mm above the tip.
  assert.ok(middle.others <= 5 - DEEP && middle.others > 5 - DEEP - 0.3, String(middle.others));
  const above = state(3);
  assert.deepEqual([above.tip[2], above.depth[1] < 1e-9], [5, true]);
  assert.ok(above.whole[0] <= 5 && 5 <= above.whole[1], above.whole.join());
  assert.deepEqual([state(-1).tip, state(Number.NaN).tip, state(99).tip], [[-18, 0, 5], [-18, 0, 5], [-14, 0, 5]]);
  // With a tolerance above the depth nothing is found.
  const { verdict: { verdict, reasons }, findings } = JSON.parse(checker.check(0.25));
  assert.deepEqual(findings.filter((found) => found.severity !== 'remark'), []);
  // The table is proved; the G-code never starts the spindle.
  assert.deepEqual([verdict, /never starts the spindle/.test(reasons.join())], name.endsWith('.nc') ? ['none', true] : ['clean', false], reasons.join());
}

// Two tools, each of which is 0.2 deep once: the ball that is drawn changes with the number, and findings have theirs.
const both = ['T1 M6\nG43 H1\nG0 X-18. Y0. Z5.\nG1 Z-0.2 F100.\nG0 Z5.\n', 'T2 M6\nG43 H2\nG0 X-15. Y0. Z5.\nG1 Z-0.2 F100.\nG0 Z5.\n'].join('');
const used = JSON.parse(checker.readProgram(bytes(`G21 G90\n${both}M30\n`), 'both.nc', '3-axis'));
assert.deepEqual(used.tools, [{ number: 1, motions: 2 }, { number: 2, motions: 2 }]);
take(1, 'd2_ball.tool');
refused(() => checker.takeMotions(), /T2 of the program has no tool/);
take(2, 'ball_er16.tool');
assert.equal(checker.takeMotions().length, 4 * 6);
const two = JSON.parse(checker.check(0.01));
assert.deepEqual(two.findings.map(({ tool_number: number, at, surface, places: [{ span }], through }) => [number, at, surface, span, through]).toSorted(),
  [[1, 1, 'ball', [1, 2], false], [2, 4, 'cutter.ball', [4, 5], false]]);
assert.deepEqual([1, 4].map((position) => checker.at(position)[15]), [1, 2]);

// A stock 1 mm above the plate is cut as the program plays, and what remains at the end is what the check counts.
checker.setStock(new Float64Array([-20, -15, -10, 20, 15, 1]));
checker.takeMotions();
const end = 5;
const cutTo = (position) => {
  let steps = 1;
  while (!checker.cutStock(position)) steps++;
  return [checker.stockPoints(), steps];
};
const times = [];
const timed = (body) => {
  const before = performance.now();
  const result = body();
  times.push(`${(performance.now() - before).toFixed(0)} ms`);
  return result;
};
const [whole] = timed(() => cutTo(0));
// The surface of the box, two triangles for each face of a cell; its sides hold 40, 30 and 11 parts in 40 · 30 · 11 / 200,000.
const spacing = Math.cbrt((40 * 30 * 11) / 200_000);
const [nx, ny, nz] = [40, 30, 11].map((side) => Math.round(side / spacing));
assert.equal(whole, nx * ny * nz);
assert.equal(timed(() => checker.stockPositions()).length / 9, 4 * (nx * ny + ny * nz + nz * nx));
const [left, steps] = timed(() => cutTo(end));
console.log(`    a stock of ${whole} points is made in ${times[0]}, its surface in ${times[1]}, and cut by ${end} motions in ${times[2]}`);
assert.equal(steps, end);
const remain = JSON.parse(checker.check(0.01)).stock.match(/^stock: (\d+) of (\d+) points remain/);
assert.deepEqual(remain.slice(1).map(Number), [left, whole]);
// T1 has cut a dimple of 1.2 mm with its ball of 1 mm: half a ball and a cylinder of 0.2 mm.
const [dimple] = cutTo(1);
const volume = (whole - dimple) * spacing ** 3;
const exact = Math.PI * (2 / 3 + 0.2);
assert.ok(Math.abs(volume - exact) < 0.2 * exact, `${volume} of ${exact}`);
refused(() => checker.setStock(new Float64Array([1, 2, 3])), /a box has 6 values/);
checker.setStock(new Float64Array());
assert.ok(checker.cutStock(end));
assert.equal(checker.stockPositions().length, 0);

// The worst comes first, then remarks. A trunnion turns by 180° while the tool is upright, which only a remark says.
checker.readProgram(bytes('G21 G90\nT1 M6\nG43.4 H1\nG0 X-18. Y0. Z5. A0. C0.\nG1 Z-0.05 F100.\nX-16. Z-3. C180.\nG0 Z5.\nM30\n'), 'turn.nc', 'A-C trunnion');
take(1, 'd2_ball.tool');
checker.takeMotions();
const { findings: sorted } = JSON.parse(checker.check(0.01));
const ranks = sorted.map(({ severity }) => ['violation', 'undecided', 'remark'].indexOf(severity));
assert.ok(ranks.length > 1 && ranks.at(-1) === 2 && ranks.every((rank, k) => k === 0 || rank >= ranks[k - 1]), ranks.join());
const depths = sorted.filter(({ kind, through }) => kind === 'deep' && !through).map(({ depth }) => depth[0]);
assert.deepEqual(depths, depths.toSorted((one, other) => other - one));

// What proves nothing is told: a feed from a place that only the machine knows, and a program in another unit.
const unknown = JSON.parse(checker.readProgram(bytes('G21 G90\nT1 M6\nG43 H1\nG1 X0. Y0. Z5. F100.\nX1.\nM30\n'), 'unknown.nc', '3-axis'));
assert.match(unknown.open.join('\n'), /line 4: \d motions? not checked, first at line 4: only the machine knows where the tool change/);
assert.match(unknown.open.join('\n'), /never starts the spindle/);
// A program is followed up to the line that is not read, and allows no verdict.
const broken = JSON.parse(checker.readProgram(bytes('G21 G90\nG1 X#1 F100.\n'), 'bad.nc', '3-axis'));
assert.match(broken.open.join('\n'), /line 2: /);
const inch = Array.from({ length: 9 }, (_, k) => `${25.4 * (4 * k - 16)},${25.4 * 12},-127,0,0,1`).join('\n');
checker.readProgram(bytes(inch), 'inch.csv', '3-axis');
take(undefined, 'd2_ball.tool');
checker.takeMotions();
const { verdict: far } = JSON.parse(checker.check(0.01));
assert.ok(far.verdict === 'none' && /never comes within/.test(far.reasons.join()) && /0\.0393/.test(far.reasons.join()), JSON.stringify(far));

// What is refused, with its reason.
refused(() => checker.readProgram(gcode, 'along.nc', '7-axis'), /7-axis/);
refused(() => checker.readProgram(bytes('0,0,x,0,0,1\n'), 'bad.csv', '3-axis'), /bad\.csv/);
refused(() => checker.check(-1), /tolerance/);
refused(() => checker.setTool(undefined, 'x.tool', 'tool X { units mm; }', '{}'), /x\.tool has errors/);
const long = bytes(`G21 G90\nG0 X0. Y0. Z5.\n${'X1.\nX0.\n'.repeat(100_001)}M30\n`);
refused(() => checker.readProgram(long, 'long.nc', '3-axis'), /long\.nc has 2000\d\d motions.*touchoff verify/s);
refused(() => new Checker().takeMotions(), /something is missing/);
// A path of 11 positions, the middle four of its motions in rapid traverse.
const path = Float32Array.from({ length: 44 }, (_, k) => (k % 4 === 0 ? k / 4 : k % 4 === 3 ? Number(k > 16 && k < 32) : 0));
const ends = (most) => Object.fromEntries(Object.entries(pathLines(path, most)).map(([mode, values]) => [mode, [...values].filter((_, k) => k % 3 === 0)]));
assert.deepEqual(ends(11).rapid, [3, 4, 4, 5, 5, 6, 6, 7]);
assert.deepEqual(ends(11).feed.length, 2 * 6);
// Every third position is kept of at most 5, and the last; a line with some feed is one of feed.
assert.deepEqual(ends(5), { feed: [0, 3, 6, 9, 9, 10], rapid: [3, 6] });
assert.deepEqual(ends(3), { feed: [0, 5, 5, 10], rapid: [] });

console.log('ok: programs of positions and of G-code are checked as the closed forms say');

// Programs under Node.js: what the engine proves about them has closed forms.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { gunzipSync } from 'node:zlib';
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
checker.setTool('d2_ball.tool', Engine.libraryText('d2_ball.tool'), '{}');
assert.ok(JSON.parse(Checker.machines()).includes('A-C trunnion'));

for (const [name, program, number] of [['along.csv', table, undefined], ['along.nc', gcode, 7]]) {
  const facts = JSON.parse(checker.readProgram(program, name, '3-axis'));
  assert.equal(facts.tools.length, 1);
  assert.equal(facts.machine, name.endsWith('.nc') ? '3-axis' : null);
  const positions = checker.takeMotions(number);
  assert.equal(positions.length, 4 * 4);
  done = 0;
  const result = JSON.parse(checker.check(0.01));
  assert.equal(done, 4);
  assert.equal(result.motions, 3);
  // A ball whose tip is 0.2 below the top of the plate is 0.2 deep in it. A cut through the top face has a border, at
  // which the ball is not deeper.
  const [finding] = result.findings;
  assert.deepEqual([finding.kind, finding.surface, result.findings.length, result.clear], ['deep', 'ball', 1, false]);
  assert.ok(finding.measured[0] <= DEEP && DEEP <= finding.measured[1], finding.measured.join());
  assert.ok(finding.measured[1] - finding.measured[0] < 2e-3, finding.measured.join());
  assert.equal(finding.limit, 0.01);
  assert.ok(Math.abs(finding.point[2]) < 1e-9);

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
  assert.ok(JSON.parse(checker.check(0.25)).clear);
}

// What proves nothing is told: a feed from a place that only the machine knows, and a program in another unit.
const unknown = JSON.parse(checker.readProgram(bytes('G21 G90\nT1 M6\nG43 H1\nG1 X0. Y0. Z5. F100.\nX1.\nM30\n'), 'unknown.nc', '3-axis'));
assert.match(unknown.open.join('\n'), /line 4: \d motions? not checked, first at line 4: only the machine knows where the tool change/);
assert.match(unknown.open.join('\n'), /never starts the spindle/);
const inch = Array.from({ length: 9 }, (_, k) => `${25.4 * (4 * k - 16)},${25.4 * 12},-127,0,0,1`).join('\n');
checker.readProgram(bytes(inch), 'inch.csv', '3-axis');
checker.takeMotions(undefined);
const far = JSON.parse(checker.check(0.01));
assert.ok(far.far && far.clear && Math.abs(far.unit_factor * 25.4 - 1) < 1e-9, JSON.stringify(far));

// What is refused, with its reason.
const refused = (body, reason) => assert.throws(body, (error) => reason.test(error.message) || assert.fail(error.message));
refused(() => checker.readProgram(bytes('G21 G90\nG1 X#1 F100.\n'), 'bad.nc', '3-axis'), /bad\.nc.*2/s);
refused(() => checker.readProgram(gcode, 'along.nc', '4-axis'), /4-axis/);
refused(() => checker.readProgram(bytes('0,0,x,0,0,1\n'), 'bad.csv', '3-axis'), /bad\.csv/);
refused(() => checker.check(-1), /tolerance/);
refused(() => checker.setTool('x.tool', 'tool X { units mm; }', '{}'), /x\.tool has errors/);
const long = bytes(`G21 G90\nG0 X0. Y0. Z5.\n${'X1.\nX0.\n'.repeat(100_001)}M30\n`);
refused(() => checker.readProgram(long, 'long.nc', '3-axis'), /long\.nc has 2000\d\d motions.*touchoff verify/s);
refused(() => new Checker().takeMotions(undefined), /something is missing/);
console.log('ok: programs of positions and of G-code are checked as the closed forms say');

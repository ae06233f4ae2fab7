// Times the wrench in WebAssembly as web/examples/wrench.rs does natively; `web/tests/wrench` runs both in turn.
//   node web/tests/wrench.mjs      prints for each tool its median in nanoseconds

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { gunzipSync } from 'node:zlib';
import { Engine, initSync } from '../dist/engine.js';

initSync({ module: gunzipSync(readFileSync(new URL('../dist/engine.wasm.gz', import.meta.url))) });
const POSES = 2000;
const half = Math.sqrt(0.5);
const poses = Array.from({ length: POSES }, (_, k) => {
  const [sine, cosine] = [Math.sin(2.4 * k), Math.cos(2.4 * k)];
  const radius = 5 - 0.02 - 0.28 * ((0.618 * k) % 1);
  return new Float64Array([radius * cosine, radius * sine, 2 + 9 * ((0.7549 * k) % 1), -sine * half, cosine * half, 0, half]);
});
for (const name of ['d2_ball', 'ball_er16']) {
  const engine = new Engine(1000, 4000);
  engine.generatePart('tube');
  engine.samplePart(100_000);
  engine.compileTool(`${name}.tool`, Engine.libraryText(`${name}.tool`), '{}');
  engine.start(new Float64Array([0, 0, 99, 0, 0, 0, 1]));
  // The first rounds let the browser's compiler optimise.
  for (let round = 0; round < 3; round++) assert.ok(poses.every((pose) => engine.wrench(pose)[0] > 0), 'poses touch');
  const times = poses.map((pose) => {
    const start = process.hrtime.bigint();
    engine.wrench(pose);
    return Number(process.hrtime.bigint() - start);
  });
  times.sort((one, other) => one - other);
  console.log(`${name} wasm ${times[POSES / 2]}`);
}

// The loop in Chromium at a part of your own, with 100,000 points:
//   node web/tests/loop.mjs PART UNIT        prints cycles per second and times of cycles; UNIT is mm, inch or m

import assert from 'node:assert/strict';
import { openPage } from './chromium.mjs';

const [part, unit] = process.argv.slice(2);
assert.ok(part && unit, 'usage: node web/tests/loop.mjs PART UNIT');
const { page, address, problems, press, close } = await openPage();
try {
  await page.goto(address);
  await page.waitForFunction(() => document.getElementById('canvas').dataset.tip);
  await page.selectOption('#points', '100000');
  await page.selectOption('#unit', unit);
  await page.setInputFiles('#part-file', part);
  await page.waitForFunction(() => /100,000 points/.test(document.getElementById('facts').textContent), null, { timeout: 60_000 });
  await page.waitForTimeout(1000);
  const box = await page.locator('#canvas').boundingBox();
  const read = async () => JSON.parse(await page.getAttribute('#canvas', 'data-timing'));
  // Down onto the part beside its middle, then to and fro across it.
  await press(0.12 * box.width, 0.3 * box.height, 20);
  const [x, y] = [box.x + 0.5 * box.width, box.y + 0.55 * box.height];
  let touching = 0;
  let rates = [];
  let timing = {};
  for (let k = 0; k < 120; k++) {
    await page.mouse.move(x + 0.15 * box.width * Math.sin(k / 6), y + 0.12 * box.height * Math.cos(k / 9));
    await page.waitForTimeout(60);
    timing = await read();
    if (timing.rate > 0) rates.push(timing.rate);
    touching += Number(Number(await page.textContent('#count')) > 0);
  }
  await page.mouse.up();
  rates = rates.sort((one, other) => one - other);
  console.log(`${timing.count} cycles, median ${rates[rates.length >> 1]?.toFixed(0)} a second, p50 ${timing.p50.toFixed(0)} µs, p99 ${timing.p99.toFixed(0)} µs, ${timing.skipped} skipped, ${timing.fps.toFixed(0)} pictures a second, in contact at ${touching} of 120 looks`);
  assert.ok(touching > 20, 'the tool touches the part');
  assert.deepEqual(problems, []);
} finally {
  await close();
}

// The memory of the page while a tool slides along the part and a program plays:
//   node web/tests/soak.mjs [SECONDS]      default 20; five minutes are 300

import assert from 'node:assert/strict';
import { openPage } from './chromium.mjs';

const seconds = Number(process.argv[2] ?? 20);
/** Growth that is allowed between the first quarter and the end, in MB: that of the browser's own caches. */
const GROWTH = 4;
const { page, address, problems, press, close } = await openPage({ width: 900, height: 600 });
try {
  await page.goto(address);
  await page.waitForFunction(() => document.getElementById('canvas').dataset.tip);
  const rows = Array.from({ length: 200 }, (_, k) => `${-18 + 0.02 * k},${-10 + 0.1 * k},-0.005,0,0,1`);
  await page.setInputFiles('#program-file', { name: 'over.csv', mimeType: 'text/csv', buffer: Buffer.from(rows.join('\n')) });
  await page.waitForFunction(() => document.getElementById('canvas').dataset.along === 'done');

  /** Returns the memory of the page and its threads after a collection, in MB: the engine's own included. */
  const memory = async () => (await page.evaluate(() => performance.measureUserAgentSpecificMemory())).bytes / 1e6;
  const end = performance.now() + 1000 * seconds;
  const found = [];
  for (let k = 0; performance.now() < end || found.length < 3; k++) {
    if (k % 2) {
      await page.click('#play');
      await page.waitForTimeout(1500);
    } else {
      await page.click('[data-view=corner]');
      await page.locator('#position').fill('0');
      await page.waitForTimeout(300);
      await press(0, 60, 10);
      const box = await page.locator('#canvas').boundingBox();
      for (let step = 0; step < 30; step++) {
        await page.mouse.move(box.x + box.width * (0.4 + 0.005 * step), box.y + box.height * 0.6);
        await page.waitForTimeout(30);
      }
      await page.mouse.up();
    }
    found.push(await memory());
  }
  const early = Math.max(...found.slice(0, Math.max(1, Math.ceil(found.length / 4))));
  const late = found.at(-1);
  console.log(`ok: ${seconds} s, memory ${found.map((value) => value.toFixed(1)).filter((_, k) => k % Math.ceil(found.length / 12) === 0).join(' ')} MB`);
  assert.ok(late < early + GROWTH, `from ${early.toFixed(1)} to ${late.toFixed(1)} MB`);
  assert.deepEqual(problems, []);
} finally {
  await close();
}

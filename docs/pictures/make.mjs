// Makes the pictures of the page in this folder: program.png, edit.png, live.gif, and with a report, report.png.
//   node docs/pictures/make.mjs [REPORT.html]      after `npm ci` in web/; CHROMIUM names another browser than /usr/bin/chromium
// The rest are made by `touchoff map` (docs/postures.md).

import { writeFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { openPage } from '../../web/tests/chromium.mjs';
import { Recording } from './recording.mjs';

const file = (name) => fileURLToPath(new URL(name, import.meta.url));
const { page, address, press, mistype, close } = await openPage({ width: 1080, height: 640 });
const recording = new Recording(page);
const canvas = () => page.locator('#canvas').boundingBox();
const text = (selector) => page.textContent(selector);
const until = (condition) => page.waitForFunction(condition, null, { timeout: 60_000 });
const shot = (name) => page.screenshot({ path: file(name) });

/** Moves the mouse from a place to another, as fractions of the canvas, and records each step. */
async function drag(from, to, steps) {
  const { x, y, width, height } = await canvas();
  for (let k = 1; k <= steps; k++) {
    const [u, v] = from.map((value, axis) => value + ((to[axis] - value) * k) / steps);
    await page.mouse.move(x + width * u, y + height * v);
    await page.waitForTimeout(60);
    await recording.take();
  }
}

/** Records until a time has passed. */
async function rest(frames) {
  for (let k = 0; k < frames; k++) {
    await page.waitForTimeout(60);
    await recording.take();
  }
}

await page.goto(address);
await until(() => document.getElementById('canvas').dataset.tip);
await rest(3);

// A ball pressed into the plate slides into the pocket and along its wall.
await press(60, 110, 12);
await rest(2);
await drag([0.42, 0.54], [0.56, 0.62], 14);
await drag([0.56, 0.62], [0.62, 0.72], 8);
await rest(3);
await drag([0.62, 0.72], [0.5, 0.6], 10);
await page.mouse.up();
await rest(4);

// A program around the floor of the pocket, which cuts into a wall.
const corners = [[-11, -7], [7, -7], [7, 7.3], [-11, 7]].map(([x, y]) => [0.99 * x, 0.99 * y]);
const rows = [`${corners[0]},8,0,0,1`];
corners.forEach(([x, y], k) => {
  const [u, v] = corners[(k + 1) % corners.length];
  for (let step = 0; step < 12; step++) rows.push(`${x + ((u - x) * step) / 12},${y + ((v - y) * step) / 12},-4.5,0,0,1`);
});
rows.push(`${corners[0]},-4.5,0,0,1`, `${corners[0]},8,0,0,1`);
await page.setInputFiles('#program-file', { name: 'pocket.csv', mimeType: 'text/csv', buffer: Buffer.from(rows.join('\n')) });
await until(() => document.getElementById('canvas').dataset.along === 'done');
console.log(await text('#verdict'));
const last = Number(await page.getAttribute('#position', 'max'));
for (let k = 0; k <= 30; k++) {
  await page.locator('#position').fill(String((last * k) / 30));
  await page.waitForTimeout(60);
  await recording.take();
}
await page.click('#findings-list button');
await page.waitForTimeout(600);
await rest(8);
await shot('program.png');
await page.click('#close-program');

// An error in the tool's text, under the cursor.
await page.click('[data-view=corner]');
await mistype();
await page.waitForTimeout(500);
await shot('edit.png');

writeFileSync(file('live.gif'), recording.gif());
console.log(`live.gif: ${recording.count} pictures`);
if (process.argv[2]) {
  await page.goto(pathToFileURL(resolve(process.argv[2])).href);
  await page.setViewportSize({ width: 1080, height: 900 });
  await page.locator('button.show').first().click();
  await page.waitForTimeout(1500);
  await shot('report.png');
}
await close();

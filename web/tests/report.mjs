// A report of `touchoff report` in headless Chromium, opened as a file:
//   node web/tests/report.mjs TOUCHOFF [FOLDER_FOR_SCREENSHOTS]      TOUCHOFF is the program

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { openBrowser } from './chromium.mjs';

const [program, pictures] = process.argv.slice(2);
if (pictures) mkdirSync(pictures, { recursive: true });
const folder = mkdtempSync(join(tmpdir(), 'touchoff-'));

/** A block of 20 by 20 by 10 mm, its top at z = 0. */
function block() {
  const corner = (k) => [20 * (k & 1) - 10, 10 * (k & 2) - 10, 2.5 * (k & 4) - 10];
  const faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  const facets = faces.flatMap(([a, b, c, d]) => [[a, b, c], [a, c, d]]).map((facet) => `facet normal 0 0 0\nouter loop\n${facet
    .map((k) => `vertex ${corner(k).join(' ')}`).join('\n')}\nendloop\nendfacet\n`);
  return `solid s\n${facets.join('')}endsolid s\n`;
}

try {
  writeFileSync(join(folder, 'block.stl'), block());
  // Two gouges of the top, 0.2 and 0.5 mm deep.
  const heights = [5, 0, -0.2, 0, 0, -0.5, 0, 5];
  writeFileSync(join(folder, 'top.csv'), heights.map((z, k) => `${2 * k - 7},0,${z},0,0,1`).join('\n'));
  const options = ['report', 'block.stl', '--unit', 'mm', '--tool', 'D2Ball', '--program', 'top.csv', '--tolerance', '0.01', '-o', 'report.html'];
  // Status 1 says that there are findings.
  assert.throws(() => execFileSync(resolve(program), options, { cwd: folder, stdio: 'pipe' }), (error) => error.status === 1);
  const address = pathToFileURL(join(folder, 'report.html')).href;

  const { page, outside, problems, close } = await openBrowser(address, { width: 1200, height: 900 });
  await page.goto(address);
  await page.waitForTimeout(1000);
  const picture = () => page.locator('#canvas').screenshot();
  const whole = await picture();
  assert.ok(whole.length > 5000, `${whole.length} bytes`);
  const buttons = page.locator('button.show');
  assert.equal(await buttons.count(), 2);
  await buttons.nth(0).click();
  await page.waitForTimeout(800);
  const first = await picture();
  assert.notDeepEqual(first, whole, 'a click on a finding moves the camera');
  await buttons.nth(1).click();
  await page.waitForTimeout(800);
  assert.notDeepEqual(await picture(), first, 'another finding is at another place');
  assert.match(await page.locator('tr.current').textContent(), /0\.200\d? mm deep/);
  if (pictures) await page.screenshot({ path: join(pictures, 'report.png') });
  const pdf = await page.pdf();
  assert.ok(pdf.length > 20_000, `${pdf.length} bytes of print`);
  assert.deepEqual([outside, problems], [[], []]);
  await close();

  // Without WebGL and without a script there are pictures.
  const without = await openBrowser(address, { width: 1200, height: 900 }, ['--disable-3d-apis']);
  await without.page.goto(address);
  await without.page.waitForTimeout(300);
  assert.ok(await without.page.isHidden('#canvas'));
  const shown = await without.page.locator('img').evaluateAll((images) => images
    .filter((image) => image.checkVisibility() && image.naturalWidth > 300).length);
  assert.ok(shown >= 3, `${shown} pictures`);
  assert.deepEqual(without.outside, []);
  if (pictures) await without.page.screenshot({ path: join(pictures, 'report-still.png') });
  await without.close();
  const size = readFileSync(join(folder, 'report.html')).length / 1e6;
  console.log(`ok: a report of ${size.toFixed(1)} MB opens as a file, shows its findings, prints, and has pictures without WebGL`);
} finally {
  rmSync(folder, { recursive: true, force: true });
}

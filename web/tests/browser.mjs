// The page in headless Chromium. `web/tests/run` installs what it needs and runs it.
//   node web/tests/browser.mjs [FOLDER_FOR_SCREENSHOTS]

import assert from 'node:assert/strict';
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { MISTAKE, openPage } from './chromium.mjs';

const pictures = process.argv[2];
if (pictures) mkdirSync(pictures, { recursive: true });
const { page, address, outside, problems, close, press, mistype } = await openPage();

/** The depth in mm up to which the tool gives way to a hand at 5 mm: the derived contact stiffness lets some 5 N press it in by 0.055. */
const MAX_DEPTH = 0.1;

const text = (selector) => page.textContent(selector);
const number = async (selector) => Number.parseFloat(await text(selector));
const data = (name) => page.getAttribute('#canvas', `data-${name}`);
const shot = async (name) => { if (pictures) await page.screenshot({ path: join(pictures, `${name}.png`) }); };
const until = (condition, argument) => page.waitForFunction(condition, argument, { timeout: 60_000 });

/** Returns how many colours the canvas shows. */
const colors = () => page.evaluate(() => {
  const canvas = document.getElementById('canvas');
  const copy = document.createElement('canvas');
  copy.width = canvas.width;
  copy.height = canvas.height;
  const context = copy.getContext('2d');
  context.drawImage(canvas, 0, 0);
  const { data } = context.getImageData(0, 0, copy.width, copy.height);
  const found = new Set();
  for (let k = 0; k < data.length; k += 4 * 7) found.add((data[k] << 16) | (data[k + 1] << 8) | data[k + 2]);
  return found.size;
});

async function check(name, body) {
  const before = performance.now();
  await body();
  console.log(`ok: ${name} (${((performance.now() - before) / 1000).toFixed(1)} s)`);
}

try {
  await check('the page opens with a part and a tool', async () => {
    const before = performance.now();
    await page.goto(address);
    await until(() => document.getElementById('title').textContent);
    console.log(`    first picture after ${((performance.now() - before) / 1000).toFixed(2)} s`);
    await until(() => document.getElementById('canvas').dataset.tip);
    console.log(`    first state after ${((performance.now() - before) / 1000).toFixed(2)} s`);
    assert.match(await text('#title'), /D2Ball on plate with a pocket/);
    assert.match(await text('#scale-text'), /^\d+ mm$/);
    assert.equal(await page.locator('#axes text').count(), 3);
  });

  await check('the canvas shows a picture', async () => {
    const count = await colors();
    assert.ok(count > 100, `${count} colours`);
    await shot('open');
  });

  await check('a drag pushes the ball 5 mm into the plate: the tool stays outside, and the force points out', async () => {
    await page.click('[data-view=front]');
    await page.waitForTimeout(300);
    const scale = await page.evaluate(() => document.getElementById('scale-bar').getBoundingClientRect().width / Number.parseFloat(document.getElementById('scale-text').textContent));
    const above = (await text('#tip')).trim().split(/\s+/).map(Number)[2];
    await press(0, (above + 5) * scale);
    await page.waitForTimeout(700);
    const [depth, stretch] = [await number('#depth'), await number('#stretch')];
    const force = (await data('force')).split(',').map(Number);
    console.log(`    hand ${stretch.toFixed(2)} mm from the tool, depth ${depth} mm, force ${force.map((f) => f.toFixed(2)).join(' ')} N`);
    assert.ok(stretch > 4.7 && stretch < 5.3, `the hand is ${stretch} mm away`);
    assert.ok(depth > 0 && depth <= MAX_DEPTH, `${depth} mm deep`);
    assert.ok(force[2] > 4 && Math.hypot(force[0], force[1]) < 0.2 * force[2], force.join());
    assert.ok((await number('#force')) > 4);
    await shot('pressed');
  });

  await check('the loop keeps its rate while the tool slides, and triangles take colour', async () => {
    const box = await page.locator('#canvas').boundingBox();
    const [x, y] = (await data('tip')).split(',').map(Number);
    let deepest = 0;
    let timing = {};
    for (let k = 0; k < 40; k++) {
      await page.mouse.move(box.x + x + 40 * Math.sin(k / 3), box.y + y + 40);
      await page.waitForTimeout(50);
      deepest = Math.max(deepest, Number.parseFloat(await text('#depth')) || 0);
      const latest = JSON.parse(await data('timing'));
      if (latest.rate > 0) timing = latest;
    }
    console.log(`    ${timing.rate.toFixed(0)} cycles/s, cycle p50 ${timing.p50.toFixed(0)} µs, p99 ${timing.p99.toFixed(0)} µs, ${timing.fps.toFixed(0)} pictures/s, ${timing.count} cycles, ${timing.skipped} skipped, at most ${deepest} mm deep`);
    assert.ok(deepest <= MAX_DEPTH, `${deepest} mm deep`);
    assert.ok(timing.rate > 0 && timing.count > 500);
    assert.ok((await number('#coverage')) > 0);
    await shot('slid');
    await page.mouse.up();
  });

  await check('letting go releases the force', async () => {
    await page.waitForTimeout(800);
    assert.ok((await number('#force')) < 0.5, await text('#force'));
  });

  await check('an error in the text shows under the cursor with its remedy, and goes with it', async () => {
    await mistype();
    const problem = await text('.cm-problem');
    console.log(`    ${problem}`);
    assert.match(problem, /rr/);
    assert.match(problem, /T\d{4}/);
    await shot('error');
    for (let k = 0; k < MISTAKE.length; k++) await page.keyboard.press('Backspace');
    await until(() => /compiled in/.test(document.getElementById('problem').textContent));
    console.log(`    ${await text('#problem')}`);
    assert.equal(await page.locator('.cm-problem').count(), 0);
    assert.equal(await page.locator('#drawing svg').count(), 1);
  });

  await check('a tool of the library that mounts files compiles', async () => {
    await page.selectOption('#tool', 'ball_er16.tool');
    await until(() => /BallEr16/.test(document.getElementById('title').textContent));
    await page.waitForTimeout(800);
    console.log(`    ${await text('#problem')}`);
    await shot('mounted');
  });

  await check('a program shows its findings on a time line, and a click on one moves the camera there', async () => {
    await page.click('#edit');
    await page.selectOption('#tool', 'd2_ball.tool');
    await until(() => /D2Ball/.test(document.getElementById('title').textContent));
    // Over the top of the plate, 0.2 mm deep on the way.
    const rows = Array.from({ length: 41 }, (_, k) => `${-18 + 0.1 * k},${-10 + 0.5 * k},${k > 15 && k < 25 ? -0.2 : 0},0,0,1`);
    const program = ['-18,-10,12,0,0,1', ...rows, '-14,10,12,0,0,1'].join('\n');
    await page.setInputFiles('#program-file', { name: 'over.csv', mimeType: 'text/csv', buffer: Buffer.from(program) });
    await until(() => document.getElementById('canvas').dataset.along === 'done');
    console.log(`    ${await text('#verdict')}`);
    assert.match(await text('#verdict'), /^findings: 1 violation \(42 motions/);
    assert.match(await text('#findings-list'), /ball is 0\.2000 mm deep in the part/);
    await page.waitForTimeout(300);
    const camera = await data('camera');
    await shot('program');
    await page.click('#findings-list button');
    await until((before) => document.getElementById('canvas').dataset.camera !== before, camera);
    await until(() => /at most 0\.200 mm deep/.test(document.getElementById('position-text').textContent));
    await until(() => Number(document.getElementById('count').textContent) > 0);
    await shot('finding');
    // The text of the program, with the line of the position marked.
    const line = Number((await text('#position-text')).match(/^line (\d+)/)[1]);
    assert.equal(await text('#excerpt .here'), `${line}  ${program.split('\n')[line - 1]}`);
    assert.equal(await page.locator('#excerpt div').count(), 5);
    // The tool stands at the middle of the canvas, where the camera looks.
    const [x, y] = (await data('tip')).split(',').map(Number);
    const box = await page.locator('#canvas').boundingBox();
    assert.ok(Math.hypot(x - box.width / 2, y - box.height / 2) < 0.15 * box.height, `${x}, ${y}`);
  });

  await check('what goes right through is one row, the path has dashes in rapid traverse, and a switch hides it', async () => {
    const program = 'G21 G90\nT1 M6\nS900 M3\nG43 H1\nG0 X-18. Y-5. Z15.\nG0 Z2.\nG1 Z-14. F200.\nG1 Z-3.\nG0 Z15.\nG0 X18.\nM30\n';
    await page.setInputFiles('#program-file', { name: 'through.nc', mimeType: 'text/plain', buffer: Buffer.from(program) });
    await until(() => /right through the part/.test(document.getElementById('findings-list').textContent));
    const rows = await page.locator('#findings-list button').allTextContents();
    console.log(`    ${rows.join('\n    ')}`);
    assert.equal(rows.length, 1);
    // Each click shows the next place.
    for (const index of [1, 2, 3]) {
      await page.click('#findings-list button');
      assert.match(await text('#findings-list button'), new RegExp(`^${index} of 3: line \\d+`));
    }
    await page.click('[data-view=front]');
    await page.waitForTimeout(300);
    await shot('path');
    /** Returns how often the colour of rapid traverse begins along the row of pixels with the most of it. */
    const dashes = () => page.evaluate(() => {
      const canvas = document.getElementById('canvas');
      const copy = document.createElement('canvas');
      Object.assign(copy, { width: canvas.width, height: canvas.height });
      const context = copy.getContext('2d');
      context.drawImage(canvas, 0, 0);
      const { data, width, height } = context.getImageData(0, 0, canvas.width, canvas.height);
      const isRapid = (k) => data[k] > 190 && data[k + 1] > 110 && data[k + 1] < 190 && data[k + 2] < 110;
      let most = 0;
      for (let y = 0; y < height; y++) {
        let begun = 0;
        for (let x = 1; x < width; x++) begun += Number(isRapid(4 * (y * width + x)) && !isRapid(4 * (y * width + x - 1)));
        most = Math.max(most, begun);
      }
      return most;
    });
    const drawn = await dashes();
    assert.ok(drawn > 5, `${drawn} dashes`);
    await page.uncheck('#show-path');
    await page.waitForTimeout(300);
    assert.equal(await dashes(), 0);
    await page.check('#show-path');
  });

  await check('a program with two tools is followed as a whole', async () => {
    const lines = ['G21 G90', 'T1 M6', 'S900 M3', 'G43 H1', 'G0 X-18. Y0. Z5.', 'G1 Z-0.2 F100.', 'G0 Z5.',
      'T2 M6', 'S900 M3', 'G43 H2', 'G0 X-15. Y0. Z5.', 'G1 Z-0.5 F100.', 'G0 Z5.', 'M30'];
    const ball = 'tool T2 { units mm; profile { start (0, 0); arc to (3, 3) center (0, 3) as ball cutting; line to (3, 40), (0, 40) as shank; } niceness cutting: 1 - depth/3; }';
    await page.setInputFiles('#tool-file', { name: 'T2_ball.tool', mimeType: 'text/plain', buffer: Buffer.from(ball) });
    await until(() => /^T2 on/.test(document.getElementById('title').textContent));
    await page.setInputFiles('#program-file', { name: 'both.nc', mimeType: 'text/plain', buffer: Buffer.from(lines.join('\n')) });
    // The name of a file gives its number; the other one is asked for.
    await until(() => document.getElementById('verdict').textContent === 'choose the tool of T1');
    const choices = page.locator('#program-tools select');
    assert.equal(await choices.nth(1).inputValue(), 'T2_ball.tool');
    await choices.nth(0).selectOption('d2_ball.tool');
    await until(() => /^findings: 2 violations \(/.test(document.getElementById('verdict').textContent));
    const rows = await page.locator('#findings-list button').allTextContents();
    assert.match(rows.join('\n'), /ball is 0\.5000 mm deep.*\n.*ball is 0\.2000 mm deep/);
    // The tool changes with the position.
    for (const [row, name] of [[0, 'T2'], [1, 'D2Ball']]) {
      await page.locator('#findings-list button').nth(row).click();
      await until((tool) => document.getElementById('title').textContent.startsWith(`${tool} on`), name);
    }
    await until(() => / · T1 · /.test(document.getElementById('position-text').textContent));
    await shot('tools');
    await page.click('#play');
    await until(() => / · T2 · /.test(document.getElementById('position-text').textContent));
    await until(() => document.getElementById('title').textContent.startsWith('T2 on'));
    await until(() => document.getElementById('play').getAttribute('aria-label') === 'Play');
    // Margins state a stock, which is cut up to the position, and whole again at the start.
    await page.fill('#stock-above', '1');
    await page.press('#stock-above', 'Tab');
    await until(() => /stock: \d+ of \d+ points remain/.test(document.getElementById('program-notes').textContent));
    await until(() => Number(document.getElementById('canvas').dataset.stock) > 0);
    const cut = await data('stock');
    await shot('stock');
    await page.locator('#position').fill('0');
    await until((before) => document.getElementById('canvas').dataset.stock !== before, cut);
    assert.ok(Number(await data('stock')) < Number(cut), 'holes add faces');
    await page.fill('#stock-above', '');
    await page.press('#stock-above', 'Tab');
    await page.locator('#position').fill(await page.getAttribute('#position', 'max'));
    await until(() => / · T2 · /.test(document.getElementById('position-text').textContent));
    // A file for another number does not change the tool at the position.
    await page.setInputFiles('#tool-file', { name: 'T1_small.tool', mimeType: 'text/plain', buffer: Buffer.from(ball.replace('T2', 'Small').replaceAll('3', '2')) });
    await until(() => document.querySelector('#program-tools select').value === 'T1_small.tool');
    await until(() => /^findings: 2 violations \(/.test(document.getElementById('verdict').textContent));
    assert.match(await text('#title'), /^T2 on/);
    // Another tool in its place is checked at once.
    await page.selectOption('#tool', 'd2_ball.tool');
    await until(() => document.querySelectorAll('#program-tools select')[1].value === 'd2_ball.tool');
    await until(() => /^findings: 2 violations \(/.test(document.getElementById('verdict').textContent));
  });

  await check('a click on a finding and on the tool keeps the tool whole and in its program', async () => {
    // A holder leans toward the viewer, over a wall of the pocket.
    await page.selectOption('#tool', 'ball_er16.tool');
    await until(() => /BallEr16/.test(document.getElementById('title').textContent));
    const axis = '0,-0.6,0.8';
    const rows = Array.from({ length: 9 }, (_, k) => `${-2 + 0.5 * k},-5,-5,${axis}`);
    const program = [`-2,-5,12,${axis}`, ...rows, `2,-5,12,${axis}`].join('\n');
    await page.setInputFiles('#program-file', { name: 'wall.csv', mimeType: 'text/csv', buffer: Buffer.from(program) });
    await until(() => document.getElementById('verdict').textContent.includes('(10 motions'));
    const findings = page.locator('#findings-list button');
    for (let k = 0; k < await findings.count(); k++) {
      await findings.nth(k).click();
      await page.waitForTimeout(400);
      const range = Number(await data('range'));
      assert.ok(range > 0, `finding ${k} cuts the tool ${range} mm before the viewer`);
    }
    await shot('whole');
    const tip = await text('#tip');
    const [x, y] = (await data('tip')).split(',').map(Number);
    const box = await page.locator('#canvas').boundingBox();
    // A hand that trembles by a pixel.
    await page.mouse.move(box.x + x, box.y + y - 25);
    await page.mouse.down();
    await page.mouse.move(box.x + x + 1, box.y + y - 25);
    await page.waitForTimeout(200);
    await page.mouse.up();
    await page.waitForTimeout(300);
    assert.deepEqual([await text('#tip'), await page.isHidden('#wrench')], [tip, true]);
    // A click on the tool stops a program that plays, and the view can be turned again.
    await page.click('#play');
    await page.waitForTimeout(300);
    const [left, top] = (await data('tip')).split(',').map(Number);
    await page.mouse.click(box.x + left, box.y + top - 25, { delay: 100 });
    assert.equal(await page.getAttribute('#play', 'aria-label'), 'Play');
    const camera = await data('camera');
    await page.mouse.move(box.x + 40, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + 90, box.y + box.height / 2, { steps: 5 });
    await page.mouse.up();
    await until((before) => document.getElementById('canvas').dataset.camera !== before, camera);
    await page.selectOption('#tool', 'd2_ball.tool');
    await until(() => /D2Ball/.test(document.getElementById('title').textContent));
    const over = ['-18,-10,12,0,0,1', '-18,-10,0,0,0,1', '-14,10,12,0,0,1'].join('\n');
    await page.setInputFiles('#program-file', { name: 'over.csv', mimeType: 'text/csv', buffer: Buffer.from(over) });
    await until(() => document.getElementById('verdict').textContent.includes('(2 motions'));
  });

  await check('a scrub moves the tool, and a drag takes it from the program', async () => {
    await page.locator('#position').fill('0');
    await until(() => /^line 1 · feed · 1[12]\.\d+ mm or more from the part/.test(document.getElementById('position-text').textContent));
    await until(() => / 12\.00\s*$/.test(document.getElementById('tip').textContent));
    await page.click('[data-view=front]');
    assert.equal(await text('#contact-at'), 'Contact at this position');
    assert.ok(await page.isHidden('#wrench'), 'no force without a hand');
    await page.waitForTimeout(300);
    await press(30, 0, 5);
    await until(() => !document.getElementById('wrench').hidden);
    assert.match(await text('#wrench caption'), /haptic model.*no cutting forces/);
    await until(() => Number(document.getElementById('tip').textContent.trim().split(/\s+/)[0]) > -17.9);
    await page.mouse.up();
    await page.click('#close-program');
    assert.ok(await page.isHidden('#program'));
  });

  await check('a part of a file is read in its unit, and a broken one is refused with the reason', async () => {
    const corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
    const facets = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map((facet) => `facet normal 0 0 0\nouter loop\n${facet
      .map((corner) => `vertex ${corners[corner].join(' ')}`).join('\n')}\nendloop\nendfacet\n`);
    const file = (name, content) => ({ name, mimeType: 'model/stl', buffer: Buffer.from(content) });
    await page.selectOption('#unit', 'inch');
    await page.setInputFiles('#part-file', file('corner.stl', `solid s\n${facets.join('')}endsolid s\n`));
    await until(() => /^corner\.stl: closed.*volume 0\.166667 inch³/s.test(document.getElementById('facts').textContent));
    assert.match(await text('#scale-text'), /^[\d.]+ inch$/);
    await page.waitForTimeout(500);
    await shot('file');
    await page.setInputFiles('#part-file', file('broken.stl', 'solid s\nfacet normal 0 0 0\nouter loop\nvertex 0 0 nan\n'));
    await page.waitForSelector('#message.error');
    console.log(`    ${await text('#message')}`);
    assert.match(await text('#message'), /broken\.stl/);
  });

  await check('no request leaves the page, and nothing fails', async () => {
    assert.deepEqual(outside, []);
    assert.deepEqual(problems, []);
  });
} catch (error) {
  await shot('failed');
  console.error(error, problems);
  process.exitCode = 1;
} finally {
  await close();
}

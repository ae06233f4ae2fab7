// Writes docs/pictures/live.png: a ball end mill that has slid along the generated plate, pressed by the hand.
//   node docs/pictures/live.mjs        after `npm ci` in web/; CHROMIUM names another browser than /usr/bin/chromium

import { fileURLToPath } from 'node:url';
import { openPage } from '../../web/tests/chromium.mjs';

const { page, address, press, close } = await openPage({ width: 1240, height: 760 });
await page.goto(address);
await page.waitForFunction(() => document.getElementById('canvas').dataset.tip);
await press(60, 120);
// Along the plate, in the plane of the screen.
const { x, y, width, height } = await page.locator('#canvas').boundingBox();
for (let k = 0; k <= 60; k++) {
  await page.mouse.move(x + width * (0.42 + 0.0035 * k), y + height * (0.55 + 0.003 * k));
  await page.waitForTimeout(40);
}
await page.waitForTimeout(800);
await page.screenshot({ path: fileURLToPath(new URL('live.png', import.meta.url)) });
await close();

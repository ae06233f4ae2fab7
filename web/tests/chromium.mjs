// The page of web/dist in headless Chromium.

import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';
import { serve } from './serve.mjs';

// Isolated, the page's clock resolves 5 µs.
const ISOLATION = { 'cross-origin-opener-policy': 'same-origin', 'cross-origin-embedder-policy': 'require-corp' };
const ARGUMENTS = [
  '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync', '--enable-blink-features=ForceEagerMeasureMemory', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
];

/**
 * Opens a browser with a profile of its own and an empty page. The lists `outside` and `problems` collect requests to
 * addresses that do not begin with `own`, and errors of the page.
 */
export async function openBrowser(own, viewport, more = []) {
  const profile = mkdtempSync(join(tmpdir(), 'touchoff-'));
  const executablePath = process.env.CHROMIUM ?? '/usr/bin/chromium';
  const browser = await chromium.launchPersistentContext(profile, { executablePath, headless: true, viewport, args: [...ARGUMENTS, ...more] });
  const page = await browser.newPage();
  const outside = [];
  const problems = [];
  page.on('request', (request) => {
    const url = request.url();
    if (!/^(data|blob):/.test(url) && !url.startsWith(own)) outside.push(url);
  });
  page.on('console', (message) => { if (message.type() === 'error') problems.push(message.text()); });
  page.on('pageerror', (error) => problems.push(String(error)));

  async function close() {
    await browser.close();
    rmSync(profile, { recursive: true, force: true });
  }
  return { page, outside, problems, close };
}

/** A text with an unknown name. */
export const MISTAKE = ' let s = rr;';

/** Serves the page, and opens a browser in which nothing is loaded yet. */
export async function openPage(viewport = { width: 1400, height: 860 }) {
  const server = await serve(fileURLToPath(new URL('../dist/', import.meta.url)), ISOLATION);
  const browser = await openBrowser(server.address, viewport);
  const { page } = browser;

  /** Drags the tool by pixels, in steps, and keeps the button down. */
  async function press(dx, dy, steps = 30) {
    const box = await page.locator('#canvas').boundingBox();
    const [x, y] = (await page.getAttribute('#canvas', 'data-tip')).split(',').map(Number);
    // A little above the tip, where the tool is.
    const from = [box.x + x, box.y + y - 25];
    await page.mouse.move(...from);
    await page.mouse.down();
    await page.mouse.move(from[0] + dx, from[1] + dy, { steps });
  }

  /** Opens the editor, and adds a text with an error to the third line of the tool. */
  async function mistype() {
    await page.click('#edit');
    await page.click('.cm-content');
    await page.keyboard.press('Control+Home');
    for (let k = 0; k < 2; k++) await page.keyboard.press('ArrowDown');
    await page.keyboard.press('End');
    await page.keyboard.type(MISTAKE);
    await page.waitForSelector('.cm-problem.error', { timeout: 20_000 });
  }

  async function close() {
    await browser.close();
    server.close();
  }
  return { ...browser, address: server.address, press, mistype, close };
}

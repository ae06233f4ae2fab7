// A recording of a page as an animated picture.

import { createRequire } from 'node:module';

const require = createRequire(new URL('../../web/package.json', import.meta.url));
const { GIFEncoder, applyPalette, quantize } = require('gifenc');
const { PNG } = require('pngjs');

/** Duration of a picture, ms. */
const DELAY = 90;
/** The last colour of the palette stands for what has not changed. */
const COLORS = 255;

export class Recording {
  #pictures = [];

  /** @param {import('playwright-core').Page} page */
  constructor(page) {
    this.page = page;
  }

  get count() {
    return this.#pictures.length;
  }

  /** Takes a picture of the page. */
  async take() {
    this.#pictures.push(PNG.sync.read(await this.page.screenshot()));
  }

  /** Returns the recording as a GIF. All pictures have one palette, made of some of them. */
  gif() {
    const sample = this.#pictures.filter((_, k) => k % Math.ceil(this.count / 6) === 0);
    const palette = quantize(Buffer.concat(sample.map(({ data }) => data)), COLORS);
    const gif = GIFEncoder();
    let before = null;
    for (const { data, width, height } of this.#pictures) {
      const colors = applyPalette(data, palette);
      const changes = before ? colors.map((color, k) => (color === before[k] ? COLORS : color)) : colors;
      const first = before === null;
      gif.writeFrame(changes, width, height, {
        palette: first ? [...palette, [0, 0, 0]] : undefined,
        first, delay: DELAY, repeat: 0, transparent: !first, transparentIndex: COLORS, dispose: 1,
      });
      before = colors;
    }
    gif.finish();
    return gif.bytes();
  }
}

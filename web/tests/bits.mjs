// The engine in WebAssembly has the bits of web/tests/bits.txt, which web/tests/bits.rs compares with the native engine.

import { readFileSync } from 'node:fs';
import { gunzipSync } from 'node:zlib';
import { Engine, initSync } from '../dist/engine.js';

initSync({ module: gunzipSync(readFileSync(new URL('../dist/engine.wasm.gz', import.meta.url))) });

const lines = [];
const bits = new DataView(new ArrayBuffer(8));
const hex = (value) => {
  bits.setFloat64(0, value);
  return bits.getBigUint64(0).toString(16).padStart(16, '0');
};
/** FNV-1a over the bytes of doubles, the highest byte first. */
const digest = (values) => {
  let sum = 0xcbf29ce484222325n;
  for (const value of values) {
    bits.setFloat64(0, value);
    for (let k = 0; k < 8; k++) sum = BigInt.asUintN(64, (sum ^ BigInt(bits.getUint8(k))) * 0x100000001b3n);
  }
  return sum.toString(16).padStart(16, '0');
};
let seed = 1;
/** The next number of a linear congruential generator, from 0 to 1 (Numerical Recipes, 3rd edition, 7.1.6). */
const random = () => {
  seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
  return seed / 4294967296;
};

// A part with exact coordinates: those of the tube are sines, of which each platform has its own last bit.
for (const file of ['d2_ball.tool', 'ball_er16.tool', 'fig_7_3.tool', 'l_bracket.tool']) {
  const engine = new Engine(1000, 4000);
  engine.generatePart('pocket');
  const radius = engine.samplePart(5000);
  engine.compileTool(file, Engine.libraryText(file), '{}');
  engine.start(new Float64Array([0, 0, 50, 0, 0, 0, 1]));
  lines.push(`${file} ${hex(radius)}`);
  for (let k = 0; k < 30; k++) {
    const tip = [36 * random() - 18, 26 * random() - 13, 10 * random() - 8];
    const turn = [random() - 0.5, random() - 0.5, random() - 0.5, 0.5 + random()];
    const norm = Math.sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2] + turn[3] * turn[3]);
    const pose = new Float64Array([...tip, ...turn.map((value) => value / norm)]);
    const contacts = engine.contactsAt(pose);
    lines.push(`${Array.from(engine.wrench(pose), hex).join(' ')} ${contacts.length / 16} ${digest(contacts)}`);
  }
}
const found = `${lines.join('\n')}\n`;
const kept = readFileSync(new URL('bits.txt', import.meta.url), 'utf8');
if (found !== kept) {
  const wrong = lines.findIndex((line, k) => line !== kept.split('\n')[k]);
  console.error(`line ${wrong + 1} of bits.txt: expected\n${kept.split('\n')[wrong]}\nfound\n${lines[wrong]}`);
  process.exit(1);
}
console.log(`ok: ${lines.length} lines of bits as in bits.txt`);

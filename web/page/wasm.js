// Fetches the engine for a thread.

/** Fetches the engine, which is compressed unless the server has expanded it, and compiles it. */
export async function engineModule() {
  const response = await fetch(new URL('engine.wasm.gz', self.location.href));
  if (!response.ok) throw new Error(`the server has no engine.wasm.gz (status ${response.status})`);
  const bytes = await response.arrayBuffer();
  const [first, second] = new Uint8Array(bytes);
  if (first !== 0x1f || second !== 0x8b) return WebAssembly.compile(bytes);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return WebAssembly.compile(await new Response(stream).arrayBuffer());
}

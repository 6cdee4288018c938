// Runs the cases of a conformance suite that server.py gives, and posts what `draw` draws of each to it.
//
//   import { runSuite } from './runner.mjs';
//   const verdict = await runSuite(draw, (text) => console.log(text));
//
// `draw(scene, camera, background)` returns (a promise of) width * height * 4 numbers, rows from the top: a
// Float32Array, or a Uint8Array of codes. Of WebGL take them by `readPixels`, of WebGPU by `readTexture`. A picture of
// floats is judged far more sharply than one of codes.

// Columns by name, as the file has them: x, f_dc_0, f_rest_0, opacity (a logit), scale_0 (a logarithm), rot_0 (w) …
// Records with a number that is not finite, or without a rotation, are left out.
export function parsePly(buffer) {
  const text = new TextDecoder('latin1').decode(buffer);
  const body = text.indexOf('end_header\n') + 'end_header\n'.length;
  const names = [...text.slice(0, body).matchAll(/property float (\w+)/g)].map((match) => match[1]);
  const view = new DataView(buffer, body);
  const rows = [];
  for (let at = 0; at + 4 * names.length <= view.byteLength; at += 4 * names.length) {
    const row = Object.fromEntries(names.map((name, k) => [name, view.getFloat32(at + 4 * k, true)]));
    const isTurned = row.rot_0 || row.rot_1 || row.rot_2 || row.rot_3;
    if (isTurned && Object.values(row).every(Number.isFinite))
      rows.push(row);
  }
  const columns = Object.fromEntries(names.map((name) => [name, Float32Array.from(rows, (row) => row[name])]));
  return { count: rows.length, columns, harmonics: 1 + names.filter((name) => name.startsWith('f_rest_')).length / 3 };
}

// The floats of the framebuffer that is bound, which needs EXT_color_buffer_float. WebGL's rows come from below.
export function readPixels(gl, width, height) {
  const below = new Float32Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, below);
  return turned(below, width, height);
}

export function turned(below, width, height) {
  const pixels = new below.constructor(below.length);
  for (let y = 0; y < height; y++)
    pixels.set(below.subarray(4 * width * y, 4 * width * (y + 1)), 4 * width * (height - 1 - y));
  return pixels;
}

// The floats of a texture of the format rgba32float, with the usage COPY_SRC.
export async function readTexture(device, texture) {
  const { width, height } = texture;
  const bytesPerRow = 256 * Math.ceil((16 * width) / 256);
  const buffer = device.createBuffer({
    size: bytesPerRow * height,
    usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ,
  });
  const encoder = device.createCommandEncoder();
  encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow }, { width, height });
  device.queue.submit([encoder.finish()]);
  await buffer.mapAsync(GPUMapMode.READ);
  const padded = new Float32Array(buffer.getMappedRange());
  const pixels = new Float32Array(4 * width * height);
  for (let y = 0; y < height; y++)
    pixels.set(padded.subarray((bytesPerRow / 4) * y, (bytesPerRow / 4) * y + 4 * width), 4 * width * y);
  buffer.destroy();
  return pixels;
}

async function ask(url, how) {
  const answer = await fetch(url, how);
  if (!answer.ok)
    throw new Error(`${url}: ${answer.status} ${await answer.text()}`);
  return answer;
}

// `tell` hears of each case. The verdict has the exit code of conic judge, 0 if all is right, and its text.
export async function runSuite(draw, tell = () => {}, base = '') {
  for (const { name, scene, camera, background } of await (await ask(base + '/cases')).json()) {
    tell(name);
    const seen = await (await ask(base + camera)).json();
    const pixels = await draw(parsePly(await (await ask(base + scene)).arrayBuffer()), seen, background);
    await ask(`${base}/pictures/${name}`, {
      method: 'POST',
      headers: { 'X-Width': seen.width, 'X-Height': seen.height },
      body: pixels,
    });
  }
  return (await ask(base + '/judge', { method: 'POST' })).json();
}

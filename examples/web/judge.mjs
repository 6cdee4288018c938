// The page judge.html: takes files, and shows what `conic judge` says of them.

const scenes = ['.compressed.ply', '.ply', '.splat', '.ksplat', '.spz', '.sog', '.glb', '.gltf'];
const pictures = ['.npy', '.npz', '.exr', '.pfm'], browsers = ['.png', '.jpg', '.jpeg', '.webp'];
const roles = { scene: 'the scene', camera: 'its camera', picture: 'the picture' };
const chosen = {}; // by role: name and bytes
const find = (id) => document.getElementById(id);

const program = (async () => {
  const own = find('conic.wasm'); // in a page that is one file
  return own ? Uint8Array.from(atob(own.textContent), (c) => c.charCodeAt(0)).buffer
    : (await fetch('conic.wasm')).arrayBuffer();
})();

async function conic(words, files, wanted) {
  const own = find('worker.mjs');
  const worker = own ? new Worker(URL.createObjectURL(new Blob([own.textContent], { type: 'text/javascript' })))
    : new Worker('worker.mjs', { type: 'module' });
  const answer = await new Promise((resolve) => {
    worker.onmessage = ({ data }) => resolve(data);
    worker.onerror = ({ message }) => resolve({ code: 4, told: `The worker failed: ${message}` });
    program.then((bytes) => worker.postMessage({ bytes, words, files, wanted }));
  });
  worker.terminate();
  return answer;
}

const endingOf = (name, endings) => endings.find((ending) => name.toLowerCase().endsWith(ending));

function roleOf(name) {
  if (endingOf(name, scenes))
    return 'scene';
  return endingOf(name, ['.json']) ? 'camera' : endingOf(name, [...pictures, ...browsers]) ? 'picture' : undefined;
}

// An array of bytes (height, width, 4) as a .npy, whose header is padded to 64 bytes.
function numpy(pixels, width, height) {
  const text = `{'descr': '|u1', 'fortran_order': False, 'shape': (${height}, ${width}, 4), }`;
  const header = text.padEnd(Math.ceil((text.length + 11) / 64) * 64 - 11) + '\n';
  const start = Uint8Array.from('\x93NUMPY\x01\x00', (c) => c.charCodeAt(0));
  const size = Uint8Array.of(header.length & 255, header.length >> 8);
  return [start, size, new TextEncoder().encode(header), pixels];
}

// What the browser can decode becomes codes in a .npy, as this build of conic reads no PNG. A 2D canvas would multiply
// colours by alpha, and round them.
async function decoded(file) {
  const bitmap = await createImageBitmap(file, { colorSpaceConversion: 'none', premultiplyAlpha: 'none' });
  const { width, height } = bitmap, gl = new OffscreenCanvas(1, 1).getContext('webgl');
  const pixels = new Uint8Array(4 * width * height), texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  return new Uint8Array(await new Blob(numpy(pixels, width, height)).arrayBuffer());
}

async function take(files) {
  for (const file of files) {
    const role = roleOf(file.name);
    if (!role) {
      find('told').textContent = `${file.name}: a scene ends in ${scenes.join(', ')}; a camera in .json; `
        + `a picture in ${[...pictures, ...browsers].join(', ')}`;
      continue;
    }
    const isDecoded = Boolean(endingOf(file.name, browsers));
    const bytes = isDecoded ? await decoded(file) : new Uint8Array(await file.arrayBuffer());
    chosen[role] = { told: file.name, isDecoded, bytes, name: `${role}${isDecoded ? '.npy'
      : endingOf(file.name, [...scenes, ...pictures, '.json'])}` };
  }
  find('files').replaceChildren(...Object.entries(roles).map(([role, words]) => {
    const row = document.createElement('tr');
    for (const text of [words, chosen[role]?.told ?? '-'])
      row.insertCell().textContent = text;
    return row;
  }));
  find('judge').disabled = !Object.keys(roles).every((role) => chosen[role]);
}

export async function judge() {
  const { scene, camera, picture } = chosen;
  const words = ['judge', scene.name, '--camera', camera.name, '--picture', picture.name, '--profile',
    find('profile').value, '--report', 'report.html', ...(picture.isDecoded ? ['--straight'] : []),
    ...find('more').value.split(/\s+/).filter(Boolean)];
  find('judge').disabled = true;
  find('told').textContent = 'Judging …';
  const files = Object.fromEntries([scene, camera, picture].map(({ name, bytes }) => [name, bytes]));
  const { code, told, written } = await conic(words, files, 'report.html');
  find('told').textContent = `${{ 0: 'Right.', 1: 'Wrong.' }[code] ?? 'This could not be judged.'}\n${told}`;
  find('report').hidden = find('save').hidden = !written;
  if (written)
    find('report').srcdoc = new TextDecoder().decode(written);
  find('judge').disabled = false;
  return code;
}

find('judge').onclick = judge;
find('pick').onchange = ({ target }) => take(target.files);
find('save').onclick = () => {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([find('report').srcdoc], { type: 'text/html' }));
  link.download = 'report.html';
  link.click();
};
find('drop').ondragover = (event) => {
  event.preventDefault();
  find('drop').classList.add('over');
};
find('drop').ondragleave = () => find('drop').classList.remove('over');
find('drop').ondrop = (event) => {
  event.preventDefault();
  find('drop').classList.remove('over');
  take(event.dataTransfer.files);
};
take([]);
// The names that --profile takes are those that conic tells of itself.
conic(['judge', 'scene.ply', '--picture', 'picture.npy', '--profile', '?'], {}).then(({ told }) => {
  const names = (/it takes ([^\n]*)/.exec(told)?.[1].split(', ') ?? []).filter((name) => name !== 'surface');
  find('told').textContent = names.length ? '' : told;
  find('profile').replaceChildren(...names.map((name) => new Option(name, name, false, name === 'gsplat-1.6')));
  console.info(`${names.length} profiles`);
});

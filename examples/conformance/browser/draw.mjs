// The rules of gsplat 1.6 in plain JavaScript, as ../numpy-renderer.py has them: what a page draws in this example.

function harmonicsOf(v) {
  const length = Math.hypot(...v);
  const [x, y, z] = v.map((number) => number / length);
  return [0.28209479177387814, -0.4886025119029199 * y, 0.4886025119029199 * z, -0.4886025119029199 * x,
    1.0925484305920792 * x * y, -1.0925484305920792 * y * z, 0.31539156525252005 * (3 * z * z - 1),
    -1.0925484305920792 * x * z, 0.5462742152960396 * (x * x - y * y),
    -0.5900435899266435 * y * (3 * x * x - y * y), 2.890611442640554 * x * y * z,
    -0.4570457994644658 * y * (5 * z * z - 1), 0.3731763325901154 * z * (5 * z * z - 3),
    -0.4570457994644658 * x * (5 * z * z - 1), 1.445305721320277 * z * (x * x - y * y),
    -0.5900435899266435 * x * (x * x - 3 * y * y)];
}

function rotationOf(quaternion) { // w comes first, and the length is any
  const length = Math.hypot(...quaternion);
  const [w, x, y, z] = quaternion.map((number) => number / length);
  return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]];
}

const axes = [0, 1, 2];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

function setUp({ columns, harmonics }, i, camera) {
  const view = camera.world_to_camera;
  const mean = ['x', 'y', 'z'].map((name) => columns[name][i]);
  const p = axes.map((row) => dot(view[row], mean) + view[row][3]);
  if (p[2] < 0.01)
    return null;
  const turn = rotationOf([0, 1, 2, 3].map((k) => columns[`rot_${k}`][i]));
  const scale = axes.map((k) => Math.fround(Math.exp(columns[`scale_${k}`][i]))); // the file has logarithms
  const M = [['width', 'fx', 'cx'], ['height', 'fy', 'cy']].map(([size, f, c], row) => {
    const [n, focal, middle] = [camera[size], camera[f], camera[c]];
    const low = -(middle + 0.15 * n) / focal, high = (n - middle + 0.15 * n) / focal;
    const slope = Math.min(Math.max(p[row] / p[2], low), high);
    const J = axes.map((k) => (focal / p[2]) * (view[row][k] - slope * view[2][k]));
    return axes.map((axis) => scale[axis] * dot(J, axes.map((k) => turn[k][axis])));
  });
  const a = dot(M[0], M[0]) + 0.3, b = dot(M[0], M[1]), c = dot(M[1], M[1]) + 0.3, det = a * c - b * b;
  const direction = axes.map((k) => mean[k] + axes.reduce((sum, row) => sum + view[row][k] * view[row][3], 0));
  const Y = harmonicsOf(direction);
  const color = axes.map((channel) => {
    let sum = 0.5 + Y[0] * columns[`f_dc_${channel}`][i];
    for (let k = 1; k < harmonics; k++) // f_rest has one channel after the other
      sum += Y[k] * columns[`f_rest_${channel * (harmonics - 1) + k - 1}`][i];
    return Math.max(sum, 0);
  });
  return {
    place: [(camera.fx * p[0]) / p[2] + camera.cx, (camera.fy * p[1]) / p[2] + camera.cy],
    key: Math.fround(p[2]), conic: [c / det, -b / det, a / det], color,
    opacity: Math.fround(1 / (1 + Math.exp(-columns.opacity[i]))), // and logits
  };
}

export function draw(scene, camera, background) {
  const { width, height } = camera;
  const shown = Array.from({ length: scene.count }, (_, i) => setUp(scene, i, camera)).filter(Boolean);
  shown.sort((a, b) => a.key - b.key); // which keeps the file's order of equal ones
  const pixels = new Float32Array(4 * width * height);
  for (let at = 0; at < width * height; at++) {
    const x = (at % width) + 0.5, y = Math.floor(at / width) + 0.5, color = [0, 0, 0];
    let T = 1;
    for (const g of shown) {
      const dx = x - g.place[0], dy = y - g.place[1];
      const q = 0.5 * (g.conic[0] * dx * dx + g.conic[2] * dy * dy) + g.conic[1] * dx * dy;
      const alpha = Math.min(g.opacity * Math.exp(-q), 0.99);
      if (q < 0 || alpha < 1 / 255)
        continue;
      if (T * (1 - alpha) <= 1e-4) // this one is left out, and all behind it
        break;
      axes.forEach((k) => { color[k] += alpha * T * g.color[k]; });
      T *= 1 - alpha;
    }
    axes.forEach((k) => { pixels[4 * at + k] = color[k] + T * background[k]; });
    pixels[4 * at + 3] = 1 - T;
  }
  return pixels;
}

// three.js' renderer and camera, as the page's address asks for them: ?scene=FILE&camera=JSON of conic.
import * as THREE from 'three';
export function stage() {
  const at = new URLSearchParams(location.search), given = JSON.parse(at.get('camera')), m = given.world_to_camera;
  const renderer = new THREE.WebGLRenderer({ antialias: false, alpha: true });
  renderer.setPixelRatio(1);
  renderer.setSize(given.width, given.height);
  renderer.setClearColor(0, 0);
  document.body.appendChild(renderer.domElement);
  const camera = new THREE.PerspectiveCamera(2 * Math.atan(given.height / 2 / given.fy) * 180 / Math.PI,
    given.width / given.height, 0.1, 1000);
  // camera to world, of the axes right, up, back
  const turn = new THREE.Matrix4().set(m[0][0], -m[1][0], -m[2][0], 0, m[0][1], -m[1][1], -m[2][1], 0,
    m[0][2], -m[1][2], -m[2][2], 0, 0, 0, 0, 1);
  camera.quaternion.setFromRotationMatrix(turn);
  for (const [r, axis] of ['x', 'y', 'z'].entries())
    camera.position[axis] = -(m[0][r] * m[0][3] + m[1][r] * m[1][3] + m[2][r] * m[2][3]);
  camera.updateMatrixWorld();
  return { renderer, camera, scene: at.get('scene'), world: new THREE.Scene() };
}

import * as THREE from 'three';
import type { Viewport } from './viewport';

/** Pixel position inside a view and distance from the camera plane. */
export interface Projected {
  readonly x: number;
  readonly y: number;
  readonly depth: number;
}

/** Calls `visit` for every point in front of the camera with its pixel position (x right, y down) and its depth. */
export function projectAll(view: Viewport, visit: (index: number, x: number, y: number, depth: number) => void): void {
  const { body, width, height } = view;
  if (!body) return;
  const m = cameraMatrix(view).elements;
  const { positions } = body;
  for (let i = 0, p = 0; p < positions.length; i++, p += 3) {
    const x = positions[p];
    const y = positions[p + 1];
    const z = positions[p + 2];
    const w = m[3] * x + m[7] * y + m[11] * z + m[15];
    if (w <= 0) continue;
    const across = (m[0] * x + m[4] * y + m[8] * z + m[12]) / w;
    const upward = (m[1] * x + m[5] * y + m[9] * z + m[13]) / w;
    visit(i, (across * 0.5 + 0.5) * width, (0.5 - upward * 0.5) * height, w);
  }
}

/** One point; null when it lies behind the camera. */
export function project(view: Viewport, index: number): Projected | null {
  const { body, width, height } = view;
  if (!body) return null;
  const point = new THREE.Vector4(...body.positions.subarray(3 * index, 3 * index + 3), 1).applyMatrix4(cameraMatrix(view));
  if (point.w <= 0) return null;
  return {
    x: (point.x / point.w / 2 + 0.5) * width,
    y: (0.5 - point.y / point.w / 2) * height,
    depth: point.w,
  };
}

/** How many pixels a length takes at a depth. */
export const pixelsAt = (view: Viewport, length: number, depth: number): number =>
  (length * view.height) / (2 * Math.tan(THREE.MathUtils.degToRad(view.camera.fov / 2)) * depth);

function cameraMatrix({ camera }: Viewport): THREE.Matrix4 {
  camera.updateMatrixWorld();
  return new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
}

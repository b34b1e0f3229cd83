import * as THREE from 'three';
import type { Viewport } from './viewport';

/** Pixel position inside a view and distance from the camera plane. */
export interface Projected {
  readonly x: number;
  readonly y: number;
  readonly depth: number;
}

/** Calls `visit` with the pixel position (x right, y down) and the depth of those of `points` that are in front of the camera. */
export function projectEach(
  view: Viewport,
  points: Iterable<number>,
  visit: (index: number, x: number, y: number, depth: number) => void,
): void {
  const { body, width, height } = view;
  if (!body) return;
  const m = cameraMatrix(view).elements;
  const { positions } = body;
  for (const index of points) {
    const x = positions[3 * index];
    const y = positions[3 * index + 1];
    const z = positions[3 * index + 2];
    const w = m[3] * x + m[7] * y + m[11] * z + m[15];
    if (!(w > 0)) continue;
    const across = (m[0] * x + m[4] * y + m[8] * z + m[12]) / w;
    const upward = (m[1] * x + m[5] * y + m[9] * z + m[13]) / w;
    visit(index, (across * 0.5 + 0.5) * width, (0.5 - upward * 0.5) * height, w);
  }
}

/** The same for every point of the body. */
export function projectAll(view: Viewport, visit: (index: number, x: number, y: number, depth: number) => void): void {
  projectEach(view, Array((view.body?.positions.length ?? 0) / 3).keys(), visit);
}

/** One point; null when it lies behind the camera or is not there. */
export function project(view: Viewport, index: number): Projected | null {
  let projected: Projected | null = null;
  projectEach(view, [index], (_, x, y, depth) => (projected = { x, y, depth }));
  return projected;
}

/** How many pixels a length takes at a depth. */
export const pixelsAt = (view: Viewport, length: number, depth: number): number => length / (lengthOfPixel(view) * depth);

/** The length that one pixel covers at depth 1. */
export const lengthOfPixel = (view: Viewport): number => (2 * Math.tan(THREE.MathUtils.degToRad(view.camera.fov / 2))) / view.height;

function cameraMatrix({ camera }: Viewport): THREE.Matrix4 {
  camera.updateMatrixWorld();
  return new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
}

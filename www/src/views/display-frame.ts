import type { Axis, PreparedShape } from 'geose-fmap';
import * as THREE from 'three';
import type { Scan } from '../app-state';

/** Positions ready to be drawn: y up, box around the origin, lengths in units of √area so that all bodies have one size. */
export interface DisplayFrame {
  /** xyz per point. Made from the f64 positions, so that a scan far from its origin keeps its detail. */
  readonly positions: Float32Array;
  /** Half the size of the box along x, y, z. */
  readonly halfExtent: readonly [number, number, number];
  /** Typical distance between neighbouring points: that of a square grid on the unit area. */
  readonly spacing: number;
}

type Turn = readonly [axis: 0 | 1 | 2, sign: 1 | -1];

/** Which of the scan's axes the display's x, y and z are, by the axis that is up: rotations, no mirrors. */
const turns: Readonly<Record<'x' | 'y' | 'z', readonly [Turn, Turn, Turn]>> = {
  x: [
    [1, -1],
    [0, 1],
    [2, 1],
  ],
  y: [
    [0, 1],
    [1, 1],
    [2, 1],
  ],
  z: [
    [0, 1],
    [2, 1],
    [1, -1],
  ],
};

/** The rotation that puts a scan's upward axis upright; a scan of which no axis is clearly up stays as it is. */
export function upright(upAxis: Axis | null): THREE.Quaternion {
  const matrix = new THREE.Matrix4().set(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1);
  turns[upAxis ?? 'y'].forEach(([axis, sign], row) => (matrix.elements[4 * axis + row] = sign));
  return new THREE.Quaternion().setFromRotationMatrix(matrix);
}

const kept = new WeakMap<PreparedShape, DisplayFrame>();

/** The scan's points as they are drawn, made once per scan and shared. */
export function displayFrame(scan: Scan): DisplayFrame {
  const known = kept.get(scan.shape);
  if (known) return known;
  const frame = frameOf(scan);
  kept.set(scan.shape, frame);
  return frame;
}

/** The faces that are drawn: those of the scan, unless they were to be ignored. */
export const drawnFaces = (scan: Scan): Uint32Array<ArrayBuffer> | null =>
  scan.choices.faces === 'ignore' ? null : scan.shape.geometry().faces;

function frameOf(scan: Scan): DisplayFrame {
  const { upAxis, scale } = scan.shape.info;
  const points = scan.shape.geometry().positions;
  const turn = turns[upAxis ?? 'y'];
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  const include = (point: number): void => {
    for (let k = 0; k < 3; k++) {
      low[k] = Math.min(low[k], points[3 * point + k]);
      high[k] = Math.max(high[k], points[3 * point + k]);
    }
  };
  // Points of a mesh that belong to no face are not seen, however far off they lie.
  const faces = drawnFaces(scan);
  if (faces) faces.forEach(include);
  else for (let i = 0; 3 * i < points.length; i++) include(i);
  const positions = new Float32Array(points.length);
  for (let i = 0; i < points.length; i += 3) {
    for (let k = 0; k < 3; k++) {
      const [axis, sign] = turn[k];
      positions[i + k] = (sign * (points[i + axis] - (low[axis] + high[axis]) / 2)) / scale;
    }
  }
  const half = ([axis]: Turn): number => (high[axis] - low[axis]) / 2 / scale;
  return {
    positions,
    halfExtent: [half(turn[0]), half(turn[1]), half(turn[2])],
    spacing: Math.sqrt(3 / points.length),
  };
}

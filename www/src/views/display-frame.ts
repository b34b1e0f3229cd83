import type { ShapeInfo } from 'geose-fmap';

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

/** The scan's points as they are drawn; a scan of which no axis is clearly up stays as it is. */
export function displayFrame(points: Float64Array, { upAxis, scale }: Pick<ShapeInfo, 'upAxis' | 'scale'>): DisplayFrame {
  const turn = turns[upAxis ?? 'y'];
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; i++) {
    low[i % 3] = Math.min(low[i % 3], points[i]);
    high[i % 3] = Math.max(high[i % 3], points[i]);
  }
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

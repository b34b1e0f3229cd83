import type { ShapeInfo } from 'geose-fmap';

/** Positions ready to be drawn: y up, around the origin, root mean square distance from it 1. */
export interface DisplayFrame {
  /** xyz per point. Made from the f64 positions, so that a scan far from its origin keeps its detail. */
  readonly positions: Float32Array;
  /** Half the size of the box along x, y, z. */
  readonly halfExtent: readonly [number, number, number];
  /** Typical distance between neighbouring points if the box's surface were evenly covered. */
  readonly spacing: number;
}

/** Where x, y and z of the display come from: axis and sign, each a rotation of the scan's own axes. */
const turns: Readonly<Record<string, readonly [axis: number, sign: 1 | -1][]>> = {
  '+x': [
    [1, -1],
    [0, 1],
    [2, 1],
  ],
  '-x': [
    [1, 1],
    [0, -1],
    [2, 1],
  ],
  '+y': [
    [0, 1],
    [1, 1],
    [2, 1],
  ],
  '-y': [
    [0, -1],
    [1, -1],
    [2, 1],
  ],
  '+z': [
    [0, 1],
    [2, 1],
    [1, -1],
  ],
  '-z': [
    [0, 1],
    [2, -1],
    [1, 1],
  ],
};

export function displayFrame(points: Float64Array, upAxis: ShapeInfo['upAxis']): DisplayFrame {
  const turn = turns[/^[+-]/.test(upAxis) ? upAxis : `+${upAxis}`] ?? turns['+y'];
  const count = points.length / 3;
  const positions = new Float32Array(points.length);
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; i++) {
    const axis = i % 3;
    low[axis] = Math.min(low[axis], points[i]);
    high[axis] = Math.max(high[axis], points[i]);
  }
  const middle = low.map((value, axis) => (value + high[axis]) / 2);
  let squares = 0;
  for (let i = 0; i < points.length; i++) squares += (points[i] - middle[i % 3]) ** 2;
  const scale = 1 / Math.sqrt(squares / count || 1);
  for (let i = 0; i < count; i++) {
    for (let k = 0; k < 3; k++) {
      const [axis, sign] = turn[k];
      positions[3 * i + k] = sign * scale * (points[3 * i + axis] - middle[axis]);
    }
  }
  const [x, y, z] = turn.map(([axis]) => ((high[axis] - low[axis]) / 2) * scale) as [number, number, number];
  const boxSurface = 8 * (x * y + y * z + z * x);
  return { positions, halfExtent: [x, y, z], spacing: Math.sqrt(boxSurface / count) };
}

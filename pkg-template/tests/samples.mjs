// The sample bodies that ship with the page: point i of one is point i of the others.
import { readFileSync } from 'node:fs';

/** The bytes of a sample's file. */
export const sample = (name) => readFileSync(new URL(`../../www/public/samples/${name}.ply`, import.meta.url));

/** A random order of the indices below `count`, the same each time (xorshift). */
export function shuffled(count) {
  let state = 0x2545f491;
  const order = Uint32Array.from({ length: count }, (_, i) => i);
  for (let i = count - 1; i > 0; i--) {
    state ^= state << 13;
    state ^= state >>> 17;
    state ^= state << 5;
    const j = (state >>> 0) % (i + 1);
    [order[i], order[j]] = [order[j], order[i]];
  }
  return order;
}

/** The mesh with a point in the middle of each edge: n points become about 4n, the first n of them the old ones. */
export function subdivided({ positions, faces }) {
  const points = [...positions];
  const middles = new Map();
  const middle = (i, j) => {
    const key = i < j ? `${i} ${j}` : `${j} ${i}`;
    if (!middles.has(key)) {
      middles.set(key, points.length / 3);
      for (let axis = 0; axis < 3; axis++) points.push((positions[3 * i + axis] + positions[3 * j + axis]) / 2);
    }
    return middles.get(key);
  };
  const finer = [];
  for (let f = 0; f < faces.length; f += 3) {
    const [i, j, k] = faces.subarray(f, f + 3);
    const [ij, jk, ki] = [middle(i, j), middle(j, k), middle(k, i)];
    finer.push(i, ij, ki, ij, j, jk, ki, jk, k, ij, jk, ki);
  }
  return { positions: Float64Array.from(points), faces: Uint32Array.from(finer) };
}

/** Points with their coordinates changed: `change` takes and gives one point. */
export function moved(positions, change) {
  const out = new Float64Array(positions.length);
  for (let i = 0; i < positions.length; i += 3) out.set(change(positions.subarray(i, i + 3)), i);
  return out;
}

/** Mean distance between where points of a were sent and where they belong, in hundredths of b's √area. */
export function error({ targetOf }, truth, { positions }, scale) {
  const at = (i) => positions.subarray(3 * i, 3 * i + 3);
  const distance = (p, q) => Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
  const sum = truth.reduce(
    (total, right, i) => total + (targetOf[i] < positions.length / 3 ? distance(at(targetOf[i]), at(right)) : Infinity),
    0,
  );
  return (100 * sum) / truth.length / scale;
}

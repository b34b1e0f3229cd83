// Bodies that need no file: a sphere, and a lump with five unequal limbs in two poses.

const PHI = (1 + Math.sqrt(5)) / 2;
const CORNERS = [
  [-1, PHI, 0],
  [1, PHI, 0],
  [-1, -PHI, 0],
  [1, -PHI, 0],
  [0, -1, PHI],
  [0, 1, PHI],
  [0, -1, -PHI],
  [0, 1, -PHI],
  [PHI, 0, -1],
  [PHI, 0, 1],
  [-PHI, 0, -1],
  [-PHI, 0, 1],
];
const SIDES = [
  [0, 11, 5],
  [0, 5, 1],
  [0, 1, 7],
  [0, 7, 10],
  [0, 10, 11],
  [1, 5, 9],
  [5, 11, 4],
  [11, 10, 2],
  [10, 7, 6],
  [7, 1, 8],
  [3, 9, 4],
  [3, 4, 2],
  [3, 2, 6],
  [3, 6, 8],
  [3, 8, 9],
  [4, 9, 5],
  [2, 4, 11],
  [6, 2, 10],
  [8, 6, 7],
  [9, 8, 1],
];

/** The unit sphere: each side of an icosahedron cut into frequency² triangles; 10 · frequency² + 2 points. */
export function sphere(frequency) {
  const points = [];
  const faces = [];
  const indexOf = new Map();
  const point = (corners, weights) => {
    const raw = [0, 1, 2].map((axis) => corners.reduce((sum, corner, i) => sum + corner[axis] * weights[i], 0));
    const length = Math.hypot(...raw);
    const unit = raw.map((value) => value / length);
    const key = unit.map((value) => Math.round(value * 1e6)).join(' ');
    if (!indexOf.has(key)) indexOf.set(key, points.push(unit) - 1);
    return indexOf.get(key);
  };
  for (const side of SIDES) {
    const corners = side.map((corner) => CORNERS[corner]);
    const at = (i, j) => point(corners, [frequency - i - j, i, j]);
    for (let i = 0; i < frequency; i++) {
      for (let j = 0; i + j < frequency; j++) {
        faces.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
        if (i + j < frequency - 1) faces.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
      }
    }
  }
  return { positions: Float64Array.from(points.flat()), faces: Uint32Array.from(faces.flat()) };
}

/** Direction and length of each limb: no two alike, no symmetry. */
const LIMBS = [
  [[0, 1, 0.1], 0.9],
  [[0.8, -0.6, 0.1], 1.8],
  [[-0.7, -0.7, 0.2], 1.3],
  [[0.9, 0.4, -0.2], 1.1],
  [[-0.95, 0.2, 0.4], 0.6],
];

/** A lump with limbs. `bend` turns it about z, the further up the more: nearly an isometry, and point i stays point i. */
export function lump({ frequency = 8, bend = 0 } = {}) {
  const { positions, faces } = sphere(frequency);
  for (let i = 0; i < positions.length; i += 3) {
    const unit = positions.subarray(i, i + 3);
    const radius = LIMBS.reduce((sum, [direction, length]) => {
      const cosine = (unit[0] * direction[0] + unit[1] * direction[1] + unit[2] * direction[2]) / Math.hypot(...direction);
      return sum + length * Math.exp((cosine - 1) * 14);
    }, 0.6);
    const [x, y, z] = unit.map((value) => value * radius);
    const angle = bend * y;
    unit.set([x * Math.cos(angle) - y * Math.sin(angle), x * Math.sin(angle) + y * Math.cos(angle), z]);
  }
  return { positions, faces };
}

/** The bytes of an OFF file. */
export const off = (body) => new TextEncoder().encode(offText(body));

/** The text of an OFF file. */
export function offText({ positions, faces }) {
  const lines = (array, start) =>
    Array.from({ length: array.length / 3 }, (_, i) => `${start}${array[3 * i]} ${array[3 * i + 1]} ${array[3 * i + 2]}\n`).join('');
  return `OFF\n${positions.length / 3} ${faces.length / 3} 0\n${lines(positions, '')}${lines(faces, '3 ')}`;
}

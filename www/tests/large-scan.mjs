// A scan as large as studios make them, without shipping one.

/** A lumpy ring of `around` × `along` points, twice as many triangles unless it is to be a cloud, as binary PLY. */
export function ringPly(around, along, withFaces) {
  const points = around * along;
  const header = [
    'ply',
    'format binary_little_endian 1.0',
    `element vertex ${points}`,
    ...['x', 'y', 'z'].map((axis) => `property float ${axis}`),
    ...(withFaces ? [`element face ${2 * points}`, 'property list uchar uint vertex_indices'] : []),
    'end_header\n',
  ].join('\n');
  const bytes = Buffer.alloc(header.length + 12 * points + (withFaces ? 2 * 13 * points : 0));
  let offset = bytes.write(header);
  for (let i = 0; i < points; i++) {
    for (const coordinate of ringPoint(i, around, along)) offset = bytes.writeFloatLE(coordinate, offset);
  }
  if (!withFaces) return bytes;
  for (let i = 0; i < points; i++) {
    const [u, v] = [Math.floor(i / around), i % around];
    const at = (further, aside) => ((u + further) % along) * around + ((v + aside) % around);
    for (const corners of [
      [at(0, 0), at(1, 0), at(1, 1)],
      [at(0, 0), at(1, 1), at(0, 1)],
    ]) {
      offset = bytes.writeUInt8(3, offset);
      for (const corner of corners) offset = bytes.writeUInt32LE(corner, offset);
    }
  }
  return bytes;
}

/** Point i of the ring: it stands upright around the z axis, 2.7 wide and 3.8 high. */
function ringPoint(i, around, along) {
  const [s, t] = [(2 * Math.PI * Math.floor(i / around)) / along, (2 * Math.PI * (i % around)) / around];
  const radius = 0.35 * (1 + 0.2 * Math.cos(3 * s) + 0.05 * Math.sin(5 * t));
  const out = 1 + radius * Math.cos(t);
  return [out * Math.cos(s), 1.4 * out * Math.sin(s), radius * Math.sin(t)];
}

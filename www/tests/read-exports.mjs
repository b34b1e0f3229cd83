// What the page exports, read back without its own code.
import assert from 'node:assert/strict';

const readers = {
  float: { size: 4, read: (bytes, at) => bytes.readFloatLE(at) },
  uchar: { size: 1, read: (bytes, at) => bytes.readUInt8(at) },
};

/** Positions and colours (three per point each) and the number of faces of a binary PLY. */
export function readPly(bytes) {
  const end = bytes.indexOf('end_header\n') + 'end_header\n'.length;
  const header = bytes.subarray(0, end).toString('latin1');
  assert.match(header, /^ply\nformat binary_little_endian 1\.0\n/);
  const points = Number(/element vertex (\d+)/.exec(header)[1]);
  const properties = [...header.matchAll(/property (float|uchar) (\w+)/g)].map(([, type, name]) => ({ name, ...readers[type] }));
  const [positions, colours] = [[], []];
  let at = end;
  for (let i = 0; i < points; i++) {
    for (const { name, size, read } of properties) {
      if (['x', 'y', 'z'].includes(name)) positions.push(read(bytes, at));
      if (['red', 'green', 'blue'].includes(name)) colours.push(read(bytes, at));
      at += size;
    }
  }
  const faces = Number(/element face (\d+)/.exec(header)?.[1] ?? 0);
  assert.equal(bytes.length - at, 13 * faces);
  return { positions, colours, faces };
}

/** The JSON part of a GLB. */
export function readGlb(bytes) {
  assert.equal(bytes.toString('latin1', 0, 4), 'glTF');
  assert.equal(bytes.readUInt32LE(8), bytes.length);
  assert.equal(bytes.toString('latin1', 16, 20), 'JSON');
  return JSON.parse(bytes.toString('utf8', 20, 20 + bytes.readUInt32LE(12)));
}

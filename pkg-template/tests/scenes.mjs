// Scans as they come from rooms and from modellers' programs, made from a body: on a floor, and as a glTF with its data beside it.

/** A body that stands on a square floor of (`cells` + 1)² points, whose sides are `side` long, just below its feet; the body's points come first. */
export function onFloor({ positions, faces }, { side = 2, cells = 24 } = {}) {
  const low = positions.reduce((least, value, i) => (i % 3 === 1 ? Math.min(least, value) : least), Infinity);
  const points = [...positions];
  const triangles = faces ? [...faces] : null;
  const first = points.length / 3;
  const along = (step) => side * (step / cells - 0.5);
  for (let i = 0; i <= cells; i++) for (let j = 0; j <= cells; j++) points.push(along(i), low - 0.005, along(j));
  for (let i = 0; i < cells; i++) {
    for (let j = 0; j < cells; j++) {
      const corner = first + i * (cells + 1) + j;
      const [beside, beyond] = [corner + 1, corner + cells + 2];
      triangles?.push(corner, beside, beyond, corner, beyond, beyond - 1);
    }
  }
  return { positions: Float64Array.from(points), ...(triangles && { faces: Uint32Array.from(triangles) }) };
}

/** Every `step`-th point of a body, without its faces. */
export const thinned = ({ positions }, step) => ({ positions: positions.filter((_, i) => Math.floor(i / 3) % step === 0) });

/**
 * A mesh as a glTF document whose data is in a file called `uri`, with a picture for a skin: `{ document, data }`. `moved` is what its one morph target, saved at
 * full weight, adds to every point.
 */
export function gltfOf({ positions, faces }, { uri = 'body.bin', moved = [0, 0, 0] } = {}) {
  const count = positions.length / 3;
  const [places, ways] = [Float32Array.from(positions), Float32Array.from(positions, (_, i) => moved[i % 3])];
  const parts = [places, ways, Uint32Array.from(faces)].map(({ buffer }) => Buffer.from(buffer));
  const offsets = [0, parts[0].length, parts[0].length + parts[1].length];
  const bounds = (array) => {
    const of = (choose) =>
      [0, 1, 2].map((axis) => array.reduce((best, value, i) => (i % 3 === axis ? choose(best, value) : best), array[axis]));
    return { min: of(Math.min), max: of(Math.max) };
  };
  const places3 = { componentType: 5126, type: 'VEC3', count };
  const document = {
    asset: { version: '2.0' },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ weights: [1], primitives: [{ attributes: { POSITION: 0 }, targets: [{ POSITION: 1 }], indices: 2, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }],
    textures: [{ source: 0 }],
    images: [{ uri: 'textures/skin.png' }],
    accessors: [
      { bufferView: 0, ...places3, ...bounds(places) },
      { bufferView: 1, ...places3, ...bounds(ways) },
      { bufferView: 2, componentType: 5125, type: 'SCALAR', count: faces.length },
    ],
    bufferViews: parts.map(({ length }, i) => ({ buffer: 0, byteOffset: offsets[i], byteLength: length })),
    buffers: [{ uri, byteLength: offsets[2] + parts[2].length }],
  };
  return { document: Buffer.from(JSON.stringify(document)), data: Buffer.concat(parts) };
}

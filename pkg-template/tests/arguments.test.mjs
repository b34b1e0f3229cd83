import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { inspect } from 'node:util';
import { lump, off } from './bodies.mjs';
import { installedPackage } from './installed.mjs';

const { GeoSeError, Matcher } = await installedPackage();
const SMALL = lump({ frequency: 6 });
const { positions, faces } = SMALL;

async function codeOf(promise) {
  const error = await promise.then(
    () => null,
    (reason) => reason,
  );
  assert.ok(error instanceof GeoSeError, `rejects with a GeoSeError, not ${error}`);
  assert.equal(error.name, 'GeoSeError');
  assert.ok(error.message.length > 10, 'a sentence for a person');
  assert.equal(typeof error.details, 'object');
  return error.code;
}

/** Its memory now belongs to somebody else. */
function transferred(buffer) {
  structuredClone(buffer, { transfer: [buffer] });
  return buffer;
}

function transferredArray() {
  const array = new Float64Array(300);
  transferred(array.buffer);
  return array;
}

describe('wrong arguments are typed errors', () => {
  let matcher, shape;
  before(async () => {
    matcher = await Matcher.create();
    shape = await matcher.prepare(SMALL, { eigenpairs: 20 });
  });
  after(() => matcher.dispose());

  const scans = {
    undefined: undefined,
    null: null,
    'a string': 'a.ply',
    'a number': 7,
    'a float array': positions,
    'an empty object': {},
    'positions in rows': { positions: [[0, 0, 0]] },
    'positions as a string': { positions: '0 0 0' },
    'positions of the wrong type': { positions: new Uint8Array(300) },
    'positions with a hole': { positions: [...positions.slice(0, 299), undefined] },
    'faces in rows': { positions, faces: [[0, 1, 2]] },
    'faces of floats': { positions, faces: new Float32Array(faces) },
    'a negative index': { positions, faces: Int32Array.of(0, 1, -2) },
    'half an index': { positions, faces: [0, 1, 1.5] },
    'labels as text': { positions, labels: Array(positions.length / 3).fill('head') },
    'an unknown array': { positions, triangles: faces },
    'a buffer that was transferred': transferred(new Uint8Array(100).buffer),
    'positions that were transferred': { positions: transferredArray() },
  };
  for (const [what, scan] of Object.entries(scans)) {
    test(`a scan that is ${what}`, async () => {
      assert.equal(await codeOf(matcher.prepare(scan)), 'invalid-argument');
      assert.equal(await codeOf(matcher.laplacian(scan)), 'invalid-argument');
    });
  }

  const refused = {
    'no bytes at all': new Uint8Array(),
    'bytes of no format': Uint8Array.from({ length: 500 }, (_, i) => (i * 37) % 256),
    'a file cut short': off(SMALL).slice(0, 2000),
    'too few points': { positions: positions.slice(0, 30) },
    'positions not in threes': { positions: positions.slice(0, 301) },
    'faces not in threes': { positions, faces: faces.slice(0, 301) },
    'a face of no point': { positions, faces: Uint32Array.of(0, 1, 99999) },
    'labels of another length': { positions, labels: new Uint8Array(3) },
    'positions that are not numbers': { positions: new Float64Array(positions.length).fill(NaN) },
    'one place for all points': { positions: new Float64Array(positions.length) },
  };
  for (const [what, scan] of Object.entries(refused)) {
    test(`a scan of ${what} is refused by name, and the next call works`, async () => {
      const code = await codeOf(matcher.prepare(scan));
      assert.match(code, /^[a-z]+(-[a-z]+)+$/);
      assert.ok(!['invalid-argument', 'crashed', 'out-of-memory'].includes(code), code);
      assert.equal((await matcher.prepare(SMALL, { eigenpairs: 20 })).info.points, positions.length / 3);
    });
  }

  test('options of the wrong type or name', async () => {
    for (const options of [7, 'fast', null, { signal: {} }, { onProgress: 'log' }, { name: 7 }, { format: 7 }, { points: () => 5 }]) {
      assert.equal(await codeOf(matcher.prepare(SMALL, options)), 'invalid-argument', JSON.stringify(options));
    }
    for (const options of [
      { points: 'many' },
      { eigenpairs: -1 },
      { faces: 'maybe' },
      { laplacian: 'best' },
      { eigenparis: 20 },
      { up: 'left' },
      { eigenpairs: 20n },
      { eigenpairs: 20, points: 100n },
      { points: 3e9 },
    ]) {
      assert.match(await codeOf(matcher.prepare(SMALL, options)), /option/, inspect(options));
    }
    for (const [options, sentence] of [
      [{ points: 1.5 }, 'points must be a whole number, not 1.5'],
      [{ eigenpairs: 20n }, 'eigenpairs must be a whole number, not the BigInt 20'],
      [{ up: 'w' }, `up must be 'x' or 'y' or 'z', not "w"`],
    ]) {
      await assert.rejects(matcher.prepare(SMALL, options), { code: 'invalid-option', message: sentence });
    }
    for (const [landmarks, sentence] of [
      [{}, 'landmarks must be an array of pairs [point of a, point of b], not Object'],
      [[[0, 0], 2], 'landmarks[1] must be a pair [point of a, point of b], not 2'],
      [[[0, -1]], 'landmarks[0][1] must be the index of a point, not -1'],
    ]) {
      await assert.rejects(matcher.match(shape, shape, { landmarks }), { code: 'invalid-option', message: sentence });
    }
    const nothing = { laplacian: null, up: null, eigenpairs: 20 };
    assert.equal((await matcher.prepare(SMALL, nothing)).info.eigenpairs, 20, 'null is as good as nothing');
    await assert.rejects(matcher.spectrum(shape), { code: 'invalid-argument', message: /what matcher.laplacian\(\) gives/ });
    const circle = {};
    circle.points = circle;
    assert.match(await codeOf(matcher.prepare(SMALL, circle)), /option/);
    assert.equal(
      await codeOf(matcher.laplacian(SMALL).then((laplacian) => matcher.spectrum(laplacian, { eigenpairs: 0 }))),
      'invalid-option',
    );
    for (const options of [{ refine: 'much' }, { parts: 'all' }, { landmarks: [[0]] }, { landmark: [[0, 0]] }]) {
      assert.match(await codeOf(matcher.match(shape, shape, options)), /option/, JSON.stringify(options));
    }
    assert.match(await codeOf(matcher.laplacian(SMALL, { kind: 'best' })), /option/);
    for (const options of [7, null, { device: 'gpu' }, { devise: 'cpu' }]) {
      assert.equal(await codeOf(Matcher.create(options)), 'invalid-argument', JSON.stringify(options));
    }
  });

  test('a device that is not there', async () => {
    assert.equal(await codeOf(Matcher.create({ device: 'webgpu' })), 'device-unavailable');
  });

  test('anything but prepared shapes to match', async () => {
    for (const [a, b] of [
      [shape, SMALL],
      [undefined, shape],
      [shape, null],
    ]) {
      assert.equal(await codeOf(matcher.match(a, b)), 'invalid-argument');
    }
  });

  test('a laplacian of the wrong arrays', async () => {
    const laplacian = await matcher.laplacian(shape);
    for (const wrong of [undefined, {}, { ...laplacian, indices: [...laplacian.indices] }, { ...laplacian, mass: null }]) {
      assert.equal(await codeOf(matcher.spectrum(wrong)), 'invalid-argument');
    }
    for (const inconsistent of [
      { ...laplacian, mass: laplacian.mass.slice(1) },
      { ...laplacian, indptr: laplacian.indptr.slice(1) },
    ]) {
      assert.notEqual(await codeOf(matcher.spectrum(inconsistent)), 'crashed');
    }
  });

  test('a shape that was freed, though calls under way finish', async () => {
    const short = await matcher.prepare(SMALL, { eigenpairs: 20 });
    const running = matcher.match(short, shape);
    short.free();
    short.free();
    assert.equal((await running).targetOf.length, positions.length / 3);
    assert.equal(await codeOf(matcher.match(short, shape)), 'freed');
    assert.equal(await codeOf(matcher.laplacian(short)), 'freed');
    for (const use of [() => short.geometry(), () => short.spectrum(), () => short.parts]) assert.throws(use, { code: 'freed' });
  });

  test('a matcher that was disposed of', async () => {
    const other = await Matcher.create();
    const open = [other.prepare(SMALL), other.match(shape, shape)];
    other.dispose();
    other.dispose();
    for (const call of open) assert.equal(await codeOf(call), 'disposed');
    assert.equal(await codeOf(other.prepare(SMALL)), 'disposed');
    assert.equal((await matcher.match(shape, shape)).targetOf.length, positions.length / 3);
  });

  test('Symbol.dispose frees and disposes', async () => {
    const other = await Matcher.create();
    const short = await other.prepare(SMALL, { eigenpairs: 20 });
    short[Symbol.dispose]();
    other[Symbol.dispose]();
    assert.equal(await codeOf(matcher.match(short, short)), 'freed');
    assert.equal(await codeOf(other.match(shape, shape)), 'disposed');
  });
});

import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { lump, off } from './bodies.mjs';
import { installedPackage } from './installed.mjs';

const { Matcher, PreparedShape, UNMATCHED, STAGES, installed } = await installedPackage();
const OPTIONS = { eigenpairs: 60 };
const A = lump();
const B = lump({ frequency: 7, bend: 0.3 });
const points = ({ positions }) => positions.length / 3;
const bytesOf = (array) => Buffer.from(array.buffer, array.byteOffset, array.byteLength);

describe('what a matcher hands out', () => {
  let matcher, a, b, match;
  before(async () => {
    matcher = await Matcher.create();
    a = await matcher.prepare(off(A), { ...OPTIONS, name: 'a.off' });
    b = await matcher.prepare(B, OPTIONS);
    match = await matcher.match(a, b);
  });
  after(() => matcher.dispose());

  test('a device with a reason', () => {
    assert.equal(matcher.device.kind, 'cpu');
    assert.ok(matcher.device.reason.length > 0);
  });

  test('a map with one entry per uploaded point, both ways', () => {
    for (const [map, from, to] of [
      [match, A, B],
      [match.reverse, B, A],
    ]) {
      assert.ok(map.targetOf instanceof Uint32Array);
      assert.ok(map.confidence instanceof Float32Array);
      assert.equal(map.targetOf.length, points(from));
      assert.equal(map.confidence.length, points(from));
      // Whole shapes have partners everywhere.
      assert.deepEqual(map.overlap, new Float32Array(points(from)).fill(1));
      map.targetOf.forEach((target, i) => {
        assert.ok(target < points(to) || target === UNMATCHED, `target ${target} of ${i}`);
        assert.ok(map.confidence[i] >= 0 && map.confidence[i] <= 1, `confidence ${map.confidence[i]} of ${i}`);
        if (target === UNMATCHED) assert.equal(map.confidence[i], 0);
      });
      const { rows, cols, data } = map.functionalMap;
      assert.ok(data instanceof Float64Array);
      assert.equal(data.length, rows * cols);
    }
    assert.equal(match.functionalMap.rows, match.reverse.functionalMap.cols);
    assert.ok(new Set(match.targetOf).size > points(B) / 10, 'the map goes to many points');
  });

  test('a report that says how it went', () => {
    const { report } = match;
    assert.equal(report.device, 'cpu');
    assert.equal(report.fallback, null);
    assert.deepEqual(report.pointsUsed, [points(A), points(B)]);
    assert.ok(report.peakMemoryBytes > 0);
    assert.deepEqual(report.gpu, { dispatches: 0, uploads: 0, downloads: 0 });
    assert.equal(report.scale.found, 'areas');
    assert.ok(Math.abs(report.scale.ratio * b.info.scale - a.info.scale) < 1e-9 * a.info.scale);
    assert.ok(Array.isArray(report.warnings));
    for (const { code } of report.warnings) assert.notEqual(code, 'no-network');
    // These shapes are no people: the report is unsure, and the network's weights took no part.
    assert.ok(report.warnings.some(({ code, message }) => code === 'other-category' && message.startsWith('unsure')));
    assert.equal(report.weights, null);
    for (const stage of Object.keys(report.seconds)) assert.ok(STAGES.includes(stage), stage);
  });

  test('what it found out about the scan', () => {
    assert.ok(a instanceof PreparedShape);
    const { kind, name, points: n, faces, pieces, pointsUsed, laplacian } = a.info;
    assert.deepEqual(
      { kind, name, n, faces, pieces, pointsUsed, laplacian },
      { kind: 'mesh', name: 'a.off', n: points(A), faces: A.faces.length / 3, pieces: 1, pointsUsed: points(A), laplacian: 'cotangent' },
    );
    assert.ok(Array.isArray(a.repairs));
  });

  test('the scan as it was read, as a copy each time', () => {
    const { positions, faces, labels } = b.geometry();
    assert.deepEqual(positions, B.positions);
    assert.deepEqual(faces, B.faces);
    assert.equal(labels, null);
    positions.fill(0);
    assert.deepEqual(b.geometry().positions, B.positions);
  });

  test('a basis that is orthonormal under its mass, and its columns', () => {
    const { eigenvalues, eigenvectors, mass } = a.spectrum();
    const k = eigenvalues.length;
    assert.equal(k, a.info.eigenpairs);
    assert.equal(eigenvectors.length, points(A) * k);
    assert.equal(mass.length, points(A));
    for (const [p, q] of [
      [0, 0],
      [1, 1],
      [k - 1, k - 1],
      [0, 1],
      [2, k - 1],
    ]) {
      const product = mass.reduce((sum, m, i) => sum + m * eigenvectors[i * k + p] * eigenvectors[i * k + q], 0);
      assert.ok(Math.abs(product - (p === q ? 1 : 0)) < 1e-6, `⟨${p}, ${q}⟩ = ${product}`);
    }
    assert.deepEqual(
      a.eigenfunction(2),
      Float64Array.from({ length: points(A) }, (_, i) => eigenvectors[i * k + 2]),
    );
    assert.throws(() => a.eigenfunction(k), { name: 'GeoSeError', code: 'invalid-argument' });
  });

  test('the same bytes on every run and from every matcher', async () => {
    const again = await matcher.match(a, b);
    const other = await Matcher.create();
    const elsewhere = await other.match(await other.prepare(A, OPTIONS), await other.prepare(off(B), OPTIONS));
    other.dispose();
    for (const { targetOf, reverse } of [again, elsewhere]) {
      assert.ok(bytesOf(targetOf).equals(bytesOf(match.targetOf)));
      assert.ok(bytesOf(reverse.targetOf).equals(bytesOf(match.reverse.targetOf)));
    }
  });

  test('a shape that another matcher can use', async () => {
    const other = await Matcher.create();
    const { targetOf } = await other.match(a, b);
    other.dispose();
    assert.deepEqual(targetOf, match.targetOf);
  });

  test('parts as given, for every uploaded point', async () => {
    const labels = Uint8Array.from({ length: points(A) }, (_, i) => (A.positions[3 * i + 1] > 0 ? 1 : 0));
    const labelled = await matcher.prepare({ ...A, labels }, OPTIONS);
    const { parts } = labelled;
    assert.equal(parts.source, 'given');
    assert.equal(parts.groups, undefined);
    assert.deepEqual(parts.labels, labels);
    assert.equal(parts.probabilities.length, labels.length * parts.names.length);
    parts.labels.forEach((label, i) => assert.equal(parts.probabilities[i * parts.names.length + label], 1));
    assert.deepEqual(labelled.geometry().labels, Uint32Array.from(labels));

    const given = await matcher.match(labelled, labelled, { parts: 'given' });
    given.targetOf.forEach((target, i) => assert.equal(labels[target], labels[i]));
    await assert.rejects(matcher.match(labelled, b, { parts: 'given' }), { name: 'GeoSeError', code: 'no-labels' });
  });

  test('parts as predicted where none were given, the same arrays each time', async () => {
    for (const shape of [a, b]) {
      const { labels, names, source } = shape.parts;
      assert.equal(source, 'predicted');
      assert.equal(names.length, 14);
      assert.ok(labels instanceof Uint8Array && labels.every((label) => label < 14));
      assert.equal(shape.parts.probabilities, shape.parts.probabilities);
      const { groups } = shape.parts;
      assert.equal(groups.names.length, 8);
      assert.equal(groups.names[groups.of[names.indexOf('left hand')]], 'left arm');
      assert.equal(groups.names[groups.of[names.indexOf('right foot')]], 'right shank');
    }
    assert.equal(a.parts.labels.length, points(A));
    assert.equal(structuredClone(a.parts).probabilities.length, 14 * points(A));
    // Labels that are no numbers of parts do not keep the prediction away.
    const numbered = await matcher.prepare({ ...A, labels: Uint32Array.from({ length: points(A) }, (_, i) => i) }, OPTIONS);
    assert.equal(numbered.parts.source, 'predicted');
    assert.deepEqual(numbered.parts.probabilities, a.parts.probabilities);
  });

  test('a map for each choice of parts, the predicted ones by default', async () => {
    const [predicted, none] = [await matcher.match(a, b, { parts: 'predicted' }), await matcher.match(a, b, { parts: 'none' })];
    assert.deepEqual(predicted.targetOf, match.targetOf);
    assert.equal(none.targetOf.length, points(A));
    assert.deepEqual(none.report.weights, match.report.weights, 'features are learned with or without parts');
  });

  test('a sampled cloud: a map, a geometry and a basis at every uploaded point', async () => {
    const cloud = { positions: lump({ frequency: 20 }).positions };
    const shape = await matcher.prepare(cloud, { ...OPTIONS, points: 800 });
    assert.equal(shape.info.kind, 'cloud');
    assert.ok(shape.info.pointsUsed < points(cloud));
    assert.equal(shape.geometry().faces, null);
    const { eigenvalues, eigenvectors, mass } = shape.spectrum();
    const k = eigenvalues.length;
    assert.equal(eigenvectors.length, points(cloud) * k);
    assert.equal(mass.filter((m) => m > 0).length, shape.info.pointsUsed);
    assert.deepEqual(
      shape.eigenfunction(3),
      Float64Array.from({ length: points(cloud) }, (_, i) => eigenvectors[i * k + 3]),
    );
    const { targetOf } = await matcher.match(shape, b);
    assert.equal(targetOf.length, points(cloud));
  });
});

describe('what a matcher takes', () => {
  test('bytes, a buffer, a blob, a file and arrays of many types, all alike and all unchanged', async () => {
    const matcher = await Matcher.create();
    const small = lump({ frequency: 6 });
    const bytes = off(small);
    const inputs = [
      bytes,
      Buffer.from(bytes),
      bytes.buffer,
      new Blob([bytes]),
      new File([bytes], 'small.off'),
      small,
      { positions: [...small.positions], faces: [...small.faces] },
      { positions: small.positions, faces: Uint16Array.from(small.faces) },
      { positions: small.positions, faces: Int32Array.from(small.faces), labels: null },
    ];
    const before = structuredClone(inputs);
    const shapes = await Promise.all(inputs.map((input) => matcher.prepare(input, { eigenpairs: 20 })));
    assert.deepEqual(structuredClone(inputs), before);
    for (const shape of shapes) {
      assert.deepEqual(shape.geometry(), { ...small, labels: null });
      assert.deepEqual(shape.spectrum(), shapes[0].spectrum());
    }
    assert.equal(shapes[4].info.name, 'small.off');
    matcher.dispose();
  });

  test('the input as it was when the call was made', async () => {
    const matcher = await Matcher.create();
    const input = lump({ frequency: 6 });
    const expected = input.positions.slice();
    const first = matcher.prepare(input, { eigenpairs: 20 });
    const queued = matcher.prepare(input, { eigenpairs: 20 });
    input.positions.fill(NaN);
    for (const shape of [await first, await queued]) assert.deepEqual(shape.geometry().positions, expected);
    matcher.dispose();
  });

  test('the wasm as an address, as bytes, as a response and as a module', async () => {
    const { readFile } = await import('node:fs/promises');
    const file = `${installed}/geose_fmap_bg.wasm`;
    const bytes = await readFile(file);
    const response = () => new Response(bytes, { headers: { 'content-type': 'application/wasm' } });
    const mistyped = () => new Response(bytes, { headers: { 'content-type': 'text/plain' } });
    const sources = [file, new URL(`file://${file}`), bytes, bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length)];
    for (const wasm of [...sources, response(), Promise.resolve(response()), mistyped(), await WebAssembly.compile(bytes)]) {
      (await Matcher.create({ wasm, worker: `${installed}/worker.js` })).dispose();
    }
  });
});

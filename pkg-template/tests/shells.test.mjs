// Bodies put together from shells, which are prepared with points of their own between the uploaded ones: nothing of those is in what a caller is given.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { sphere } from './bodies.mjs';
import { installedPackage } from './installed.mjs';
import { moved, sample } from './samples.mjs';

const { Matcher } = await installedPackage();

/** Shells in one mesh. */
function together(...shells) {
  const [positions, faces] = [[], []];
  for (const shell of shells) {
    const first = positions.length / 3;
    for (const corner of shell.faces) faces.push(first + corner);
    for (const coordinate of shell.positions) positions.push(coordinate);
  }
  return { positions: Float64Array.from(positions), faces: Uint32Array.from(faces) };
}

/** The faces whose middle is between two heights as a shell of their own, wider than the body; `vertex` says which point of the body each of its points was. */
function slice({ positions, faces }, [low, high], wider) {
  const vertex = [];
  const known = new Map();
  const corners = [];
  for (let f = 0; f < faces.length; f += 3) {
    const face = [...faces.subarray(f, f + 3)];
    const height = face.reduce((sum, i) => sum + positions[3 * i + 1], 0) / 3;
    if (height < low || height >= high) continue;
    for (const i of face) {
      if (!known.has(i)) known.set(i, vertex.push(i) - 1);
      corners.push(known.get(i));
    }
  }
  const points = Float64Array.from(vertex.flatMap((i) => [...positions.subarray(3 * i, 3 * i + 3)]));
  return { positions: moved(points, ([x, y, z]) => [wider * x, y, wider * z]), faces: Uint32Array.from(corners), vertex };
}

const sum = (values) => values.reduce((total, value) => total + value, 0);
const says = ({ repairs }, code) => repairs.some((repair) => repair.code === code);

describe('a body in shells', () => {
  let matcher;
  before(async () => (matcher = await Matcher.create()));
  after(() => matcher.dispose());

  /** Everything has as many rows as the scan has points, and belongs together. */
  function hasRowsOfItsPoints(shape, points) {
    assert.ok(says(shape, 'shells-joined'));
    assert.equal(shape.info.points, points);
    const { eigenvalues, eigenvectors, mass } = shape.spectrum();
    const k = eigenvalues.length;
    assert.equal(eigenvectors.length, points * k);
    assert.equal(mass.length, points);
    assert.ok(mass.every((m) => m >= 0));
    const area = shape.info.scale ** 2;
    assert.ok(Math.abs(sum(mass) - area) < 1e-9 * area, `${sum(mass)} of ${area}: points put between others leave their mass to these`);
    const column = shape.eigenfunction(3);
    assert.deepEqual(
      column,
      Float64Array.from({ length: points }, (_, i) => eigenvectors[i * k + 3]),
    );
    const norm = sum(mass.map((m, i) => m * column[i] ** 2));
    assert.ok(Math.abs(norm - 1) < 0.2, `of ${norm}: its mass stands where the function is alike`);
    const { labels, probabilities, names } = shape.parts;
    assert.equal(labels.length, points);
    assert.equal(probabilities.length, points * names.length);
    labels.forEach((label, i) => {
      const row = probabilities.subarray(i * names.length, (i + 1) * names.length);
      assert.equal(row[label], Math.max(...row), `part of point ${i}`);
    });
    assert.ok(shape.unmatched.every((point) => point < points));
  }

  test('all points of two balls, and more between them', async () => {
    const ball = sphere(3);
    const aside = { ...ball, positions: moved(ball.positions, ([x, y, z]) => [x + 1.4, y, z]) };
    const scan = together(sphere(20), aside);
    const points = scan.positions.length / 3;
    const whole = await matcher.prepare(scan, { eigenpairs: 20, wholeScan: true });
    hasRowsOfItsPoints(whole, points);
    assert.ok(whole.info.pointsUsed > points);
    const sampled = await matcher.prepare(scan, { eigenpairs: 20, points: 1000, wholeScan: true });
    hasRowsOfItsPoints(sampled, points);
    assert.equal(sampled.info.pointsUsed, 1000);
  });

  test('parts of a person in three shells are those of the person', async () => {
    const person = await matcher.prepare(sample('woman-standing'));
    const body = person.geometry();
    const shells = [slice(body, [-1, 0.75], 1), slice(body, [0.75, 1.38], 1.05), slice(body, [1.38, 3], 1)];
    const vertex = shells.flatMap((shell) => shell.vertex);
    for (const points of [5000, 1500]) {
      const shape = await matcher.prepare(together(...shells), { points });
      hasRowsOfItsPoints(shape, vertex.length);
      const alike = vertex.filter((i, point) => shape.parts.labels[point] === person.parts.labels[i]).length;
      assert.ok(alike > 0.95 * vertex.length, `${alike} of ${vertex.length}`);
    }
  });
});

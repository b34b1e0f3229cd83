import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { sphere } from './bodies.mjs';
import { installedPackage } from './installed.mjs';

const { Matcher } = await installedPackage();
const UNIT_SPHERE = sphere(16);
const N = UNIT_SPHERE.positions.length / 3;

/** Eigenvalues of the unit sphere: l (l + 1), 2 l + 1 times each. */
const harmonics = (count) => [0, 1, 2, 3, 4, 5, 6].flatMap((l) => Array(2 * l + 1).fill(l * (l + 1))).slice(0, count);

describe('operators of the unit sphere', () => {
  let matcher;
  before(async () => (matcher = await Matcher.create()));
  after(() => matcher.dispose());

  for (const [kind, scan, tolerance] of [
    // A mesh of 2562 points, 0.07 between neighbours: the error of the cotangents is of the order of its square times λ.
    ['cotangent', UNIT_SPHERE, 0.03],
    ['geodesic', { positions: UNIT_SPHERE.positions }, 0.15],
    ['euclidean', { positions: UNIT_SPHERE.positions }, 0.15],
  ]) {
    test(`${kind}: symmetric, constants in its kernel, mass that sums to the area, eigenvalues l (l + 1)`, async (t) => {
      const laplacian = await matcher.laplacian(scan, { kind });
      const { indptr, indices, values, mass } = laplacian;
      assert.equal(laplacian.kind, kind);
      assert.equal(indptr.length, N + 1);
      assert.equal(indices.length, indptr[N]);
      assert.equal(values.length, indptr[N]);
      const entries = new Map();
      for (let row = 0; row < N; row++) {
        let sum = 0;
        for (let e = indptr[row]; e < indptr[row + 1]; e++) {
          entries.set(row * N + indices[e], values[e]);
          sum += values[e];
        }
        assert.ok(Math.abs(sum) < 1e-9 * Math.abs(entries.get(row * N + row)), `row ${row} sums to ${sum}`);
      }
      for (const [key, value] of entries) assert.equal(entries.get((key % N) * N + Math.floor(key / N)), value);
      const area = mass.reduce((sum, m) => sum + m, 0);
      t.diagnostic(`area ${area.toFixed(4)} of ${(4 * Math.PI).toFixed(4)}`);
      assert.ok(Math.abs(area / (4 * Math.PI) - 1) < tolerance, `area ${area}`);

      const { eigenvalues, eigenvectors, mass: sameMass } = await matcher.spectrum(laplacian, { eigenpairs: 25 });
      assert.deepEqual(sameMass, mass);
      assert.equal(eigenvalues.length, 25);
      assert.equal(eigenvectors.length, N * 25);
      t.diagnostic(`eigenvalues ${[1, 4, 9, 16].map((i) => eigenvalues[i].toFixed(3)).join(', ')}`);
      harmonics(25).forEach((exact, i) =>
        assert.ok(Math.abs(eigenvalues[i] - exact) <= tolerance * exact + 1e-6, `λ${i} = ${eigenvalues[i]}, not ${exact}`),
      );
    });
  }

  test('a prepared shape has the same Laplacian as its scan, and the default kind goes by what it is', async () => {
    const mesh = await matcher.prepare(UNIT_SPHERE, { eigenpairs: 20 });
    assert.deepEqual(await matcher.laplacian(mesh), await matcher.laplacian(UNIT_SPHERE, { kind: 'cotangent' }));
    const cloud = { positions: UNIT_SPHERE.positions };
    assert.deepEqual(await matcher.laplacian(cloud), await matcher.laplacian(cloud, { kind: 'geodesic' }));
  });

  test('all parameters of Algorithm 1 are there, and one that a kind does not have is refused by name', async () => {
    const cloud = { positions: UNIT_SPHERE.positions };
    const built = (options) => matcher.laplacian(cloud, options);
    const literal = { kind: 'geodesic-literal' };
    assert.deepEqual(await built({ ...literal, k0: 5, k: 20, tau: 3, iterations: 3 }), await built(literal));
    const entries = async (options) => (await built({ ...literal, ...options })).values.length;
    const whole = await entries({});
    assert.ok((await entries({ k: 10 })) < whole, 'fewer candidates');
    assert.ok((await entries({ tau: 1.01 })) < whole, 'stricter');
    assert.ok((await entries({ iterations: 0, k0: 8 })) < whole, 'the first graph alone');

    const { kind, indptr, indices, values, mass } = await built({ kind: 'gaussian', k: 12, sigma: 0.1 });
    assert.equal(kind, 'gaussian');
    assert.ok(mass.every((m) => m === 1));
    const at = (i) => cloud.positions.slice(3 * i, 3 * i + 3);
    for (let e = indptr[0]; e < indptr[1]; e++) {
      if (indices[e] === 0) continue;
      const squared = at(indices[e]).reduce((sum, x, c) => sum + (x - at(0)[c]) ** 2, 0);
      assert.ok(Math.abs(values[e] + Math.exp(-squared / (2 * 0.1 ** 2))) < 1e-6);
    }

    for (const [options, option] of [
      [{ kind: 'gaussian', tau: 3 }, 'tau'],
      [{ kind: 'euclidean', sigma: 0.1 }, 'sigma'],
      [{ kind: 'cotangent', k: 20 }, 'k'],
      [{ ...literal, k: 2 }, 'k'],
      [{ ...literal, tau: 0.5 }, 'tau'],
      [{ ...literal, iterations: 1.5 }, 'iterations'],
      [{ ...literal, sigma: 'small' }, 'sigma'],
    ]) {
      await assert.rejects(built(options), (error) => {
        assert.equal(error.code, 'invalid-option');
        assert.equal(error.details.option, option);
        assert.match(error.message, new RegExp(`\\b${option}\\b`));
        return true;
      });
    }
  });

  test('no more eigenpairs than n − 2', async () => {
    const small = sphere(3);
    const n = small.positions.length / 3;
    const { eigenvalues } = await matcher.spectrum(await matcher.laplacian(small), { eigenpairs: 500 });
    assert.equal(eigenvalues.length, n - 2);
  });
});

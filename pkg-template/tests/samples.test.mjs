import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { cancelEverywhere } from './customer.mjs';
import { installedPackage } from './installed.mjs';
import { error, moved, sample, shuffled, subdivided } from './samples.mjs';

const { Matcher } = await installedPackage();

/** How many rows of probabilities there are, after a look at each: it sums to 1, and its largest entry is at the label. */
function rowsOf({ labels, probabilities, names }) {
  labels.forEach((label, i) => {
    const row = probabilities.subarray(names.length * i, names.length * (i + 1));
    const sum = row.reduce((total, p) => total + p, 0);
    assert.ok(Math.abs(sum - 1) < 1e-5, `row ${i} sums to ${sum}`);
    assert.equal(row[label], Math.max(...row), `label of ${i}`);
  });
  return probabilities.length / names.length;
}

describe('real bodies of 5000 points, with default options', () => {
  let matcher, woman, man, match;
  before(async () => {
    matcher = await Matcher.create();
    woman = await matcher.prepare(sample('woman-standing'), { name: 'woman.ply' });
    man = await matcher.prepare(sample('man-standing'));
    match = await matcher.match(woman, man);
  });
  after(() => matcher.dispose());
  const identity = () => Uint32Array.from({ length: woman.info.points }, (_, i) => i);

  test('two persons: the error of the map, the seconds of each stage', (t) => {
    const { report } = match;
    const far = error(match, identity(), man.geometry(), man.info.scale);
    t.diagnostic(`error ${far.toFixed(2)}, ${report.peakMemoryBytes / 2 ** 20} MiB`);
    t.diagnostic(`prepare ${JSON.stringify(woman.info.seconds)}, match ${JSON.stringify(report.seconds)}`);
    assert.deepEqual(report.pointsUsed, [5000, 5000]);
    // 1.3 when this was written; a body turned left for right has some 20.
    assert.ok(far < 3, `error ${far}`);
    assert.ok(error(match.reverse, identity(), woman.geometry(), woman.info.scale) < 3);
  });

  test('parts of a body without labels are those it was made of', async (t) => {
    const { positions, faces, labels } = woman.geometry();
    assert.equal(woman.parts.source, 'given');
    for (const bare of [{ positions, faces }, { positions }]) {
      const { parts, info } = await matcher.prepare(bare);
      assert.equal(parts.source, 'predicted');
      assert.equal(parts.names.length, 14);
      assert.equal(rowsOf(parts), 5000);
      assert.ok(parts.names.includes('left hand') && parts.names.includes('right hand'));
      const same = parts.labels.filter((label, i) => label === labels[i]).length / 5000;
      t.diagnostic(`${info.kind}: ${(100 * same).toFixed(1)} % of the points`);
      assert.ok(same > 0.85, `${info.kind}: ${same}`);
    }
  });

  test('parts of a mesh of 20 000 points are at every uploaded point', async (t) => {
    const { labels } = woman.geometry();
    const fine = subdivided(woman.geometry());
    const { parts, info } = await matcher.prepare(fine);
    assert.equal(info.pointsUsed, 5000);
    assert.equal(info.points, fine.positions.length / 3);
    assert.ok(info.points > 19_900, `${info.points}`);
    assert.equal(rowsOf(parts), info.points);
    const same = labels.filter((label, i) => label === parts.labels[i]).length / 5000;
    t.diagnostic(`${(100 * same).toFixed(1)} % of the points`);
    assert.ok(same > 0.8, `${same}`);
  });

  test('the same bytes a second time', async () => {
    const again = await matcher.match(await matcher.prepare(sample('woman-standing')), man);
    assert.deepEqual(again.targetOf, match.targetOf);
    assert.deepEqual(again.confidence, match.confidence);
    assert.deepEqual(again.reverse.targetOf, match.reverse.targetOf);
  });

  test('a shuffled copy without faces is found again', async (t) => {
    const { positions } = woman.geometry();
    const order = shuffled(woman.info.points);
    const copy = { positions: new Float64Array(positions.length) };
    const truth = new Uint32Array(order.length);
    order.forEach((from, to) => {
      copy.positions.set(positions.subarray(3 * from, 3 * from + 3), 3 * to);
      truth[from] = to;
    });
    const cloud = await matcher.prepare(copy, { name: 'shuffled' });
    assert.equal(cloud.info.kind, 'cloud');
    assert.equal(cloud.info.name, 'shuffled');
    const far = error(await matcher.match(woman, cloud), truth, copy, woman.info.scale);
    t.diagnostic(`error ${far.toFixed(3)}`);
    assert.ok(far <= 1, `error ${far}`);
  });

  test('a copy that was turned, moved and scaled has the same map', async (t) => {
    const { positions, faces } = woman.geometry();
    const [c, s] = [Math.cos(1.1), Math.sin(1.1)];
    const turned = moved(positions, ([x, y, z]) => [
      7.5 * (c * x - s * z) + 40,
      7.5 * (0.6 * y - 0.8 * (s * x + c * z)),
      7.5 * (0.8 * y + 0.6 * (s * x + c * z)) - 3,
    ]);
    const { targetOf } = await matcher.match(await matcher.prepare({ positions: turned, faces }), man);
    const same = targetOf.filter((target, i) => target === match.targetOf[i]).length / targetOf.length;
    t.diagnostic(`${(100 * same).toFixed(2)} % of the points`);
    assert.ok(same >= 0.995, `${100 * same} %`);
  });

  test('a mesh that is sampled: the map, the basis and each eigenfunction are at every uploaded point', async (t) => {
    const shape = await matcher.prepare(sample('woman-standing'), { points: 1500, eigenpairs: 60 });
    assert.equal(shape.info.pointsUsed, 1500);
    const { eigenvalues, eigenvectors, mass } = shape.spectrum();
    const k = eigenvalues.length;
    // The operator is that of the mesh: every vertex has its own row and its own mass.
    assert.equal(eigenvectors.length, 5000 * k);
    assert.equal(mass.filter((m) => m > 0).length, 5000);
    assert.deepEqual(
      shape.eigenfunction(7),
      Float64Array.from({ length: 5000 }, (_, i) => eigenvectors[i * k + 7]),
    );
    const far = error(await matcher.match(shape, man), identity(), man.geometry(), man.info.scale);
    t.diagnostic(`error ${far.toFixed(2)}`);
    assert.ok(far < 4, `error ${far}`);
  });

  test('cancelling at any stage settles within 300 ms and loses nothing', async (t) => {
    const times = await cancelEverywhere(Matcher, sample('woman-standing'), sample('man-standing'));
    t.diagnostic(JSON.stringify(times));
    for (const [stage, milliseconds] of Object.entries(times)) assert.ok(milliseconds < 300, `${stage}: ${milliseconds} ms`);
  });

  test('thirty matches need no more memory than three', async (t) => {
    // Of few points and in a memory of its own, which has no room yet in which a loss would go unseen.
    const small = { points: 1000, eigenpairs: 60 };
    const other = await Matcher.create();
    const [a, b] = [await other.prepare(sample('woman-standing'), small), await other.prepare(sample('man-standing'), small)];
    const peaks = [];
    for (let i = 0; i < 30; i++) peaks.push((await other.match(a, b)).report.peakMemoryBytes);
    other.dispose();
    t.diagnostic(`${peaks[2]} bytes after 3, ${peaks[29]} after 30`);
    assert.ok(peaks[2] > 0);
    assert.equal(peaks[29], peaks[2]);
  });
});

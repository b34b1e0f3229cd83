import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { asked, plan, sizeOf, tables, warning } from '../evaluate.mjs';

const folder = mkdtempSync(path.join(tmpdir(), 'geose-sets-'));
after(() => rmSync(folder, { recursive: true, force: true }));

function write(name, text) {
  mkdirSync(path.dirname(path.join(folder, name)), { recursive: true });
  writeFileSync(path.join(folder, name), text);
}

test('every set is measured in the modes that its files allow', () => {
  for (const set of ['bodies', 'clouds', 'parts', 'pieces']) write(`${set}/shapes/a.off`, '');
  for (const set of ['bodies', 'clouds', 'pieces']) write(`${set}/pairs.txt`, 'a a\n');
  write('bodies/corres/a.vts', '');
  write('bodies/labels/a.txt', '');
  write('clouds/corres/a.tpl', '');
  write('pieces/corres/a.baryc_gt', '');
  write('parts/pairs.txt', '\n');
  write('parts/labels/a.txt', '');
  write('README.md', '');
  const told = plan(folder).map(({ set, mode, parts, laplacian }) => [set, mode, parts ?? laplacian].join(' '));
  assert.deepEqual(told, [
    ...['mesh', 'cloud', 'mesh-cloud'].flatMap((mode) => ['predicted', 'none', 'given'].map((parts) => `bodies ${mode} ${parts}`)),
    'bodies mesh cotangent',
    ...['default', 'geodesic', 'euclidean', 'geodesic-literal'].map((laplacian) => `bodies cloud ${laplacian}`),
    ...['clouds cloud predicted', 'clouds cloud none', 'parts mesh predicted', 'parts cloud predicted'],
    ...['mesh', 'cloud', 'mesh-cloud'].flatMap((mode) => [`pieces ${mode} predicted`, `pieces ${mode} none`]),
  ]);
});

test('one set is turned too, on 40 pairs at most', () => {
  write('faust_r/shapes/a.off', '');
  write('faust_r/pairs.txt', 'a a\n');
  const turned = plan(folder).filter(({ rotate }) => rotate);
  assert.deepEqual([...new Set(turned.map(({ set }) => set))], ['faust_r']);
  const names = (all) => turned.map((task) => asked(task, all).name);
  const named = (mode, pairs) => `faust_r_${mode}_parts-predicted_rotate-so3_limit-${pairs}`;
  assert.deepEqual(names('60'), [named('mesh', 40), named('cloud', 40), named('mesh-cloud', 40)]);
  assert.deepEqual(names(undefined), names('60'));
  assert.equal(names('5')[0], named('mesh', 5));
  const [{ options }] = turned.map((task) => asked(task, '60'));
  assert.equal(options.join(' '), '--mode mesh --parts predicted --rotate so3 --limit 40');
  rmSync(path.join(folder, 'faust_r'), { recursive: true });

  assert.deepEqual(asked({ set: 'bodies', mode: 'cloud', laplacian: 'euclidean', oracle: true }, undefined), {
    name: 'bodies_cloud_oracle-euclidean_all',
    options: ['--mode', 'cloud', '--oracle', '--laplacian', 'euclidean'],
  });
});

test('tables have a dash where a set has no data', () => {
  const nothing = { pairs: 0, sources: 0, age: null, age_interval: null, age_raw: null, accuracy: null, flips: null, flipped_points: null };
  const more = { part_miou: null, part_agreement: null, seconds_per_shape: 0.514, seconds_per_pair: null };
  const confidence = { confidence_auc: 0.8312, ece: null };
  const oracle = { pairs: 3, sources: 2, age: 1.256, age_interval: [0.96, 1.549], accuracy: { 0.01: 0.5, 0.02: 0.8125, 0.05: 1 } };
  const [matches, oracles] = tables([
    { set: 'parts', mode: 'mesh', parts: 'none', oracle: false, found: { ...nothing, ...more, ...confidence } },
    { set: 'turned', mode: 'mesh', parts: 'none', rotate: 'so3', oracle: false, found: { ...nothing, ...more, ...confidence } },
    { set: 'bodies', mode: 'cloud', laplacian: 'geodesic', oracle: true, found: oracle },
  ]);
  const rows = matches.split('\n');
  assert.match(rows.at(-1), /^\| turned \| mesh, so3 \| none \|/);
  assert.equal(rows.at(-2), '| parts | mesh | none | 0 | 0 | – | – | – | – | – | – | – | – | – | 0.831 | – | 0.51 | – |');
  assert.equal(oracles.split('\n').at(-1), '| bodies | cloud | geodesic | 3 | 2 | 1.26 (1.0–1.5) | 50.0 % | 81.3 % | 100.0 % |');
  for (const table of [matches, oracles]) {
    const columns = new Set(table.split('\n').map((row) => row.split('|').length));
    assert.equal(columns.size, 1, 'every row is as wide as the head');
  }
});

test('a page says which figures come from few pairs or sources though the set has more', () => {
  const lines = Array.from({ length: 30 }, (_, i) => [`a${i % 12} b`, `a${i % 12}  c`]).flat();
  write('many/pairs.txt', `${lines.join('\n')}\n\n`);
  write('few/pairs.txt', 'a b\na c\n');
  const sizes = (set) => sizeOf(folder, set);
  assert.deepEqual(
    [sizes('many'), sizes('few'), sizes('none')],
    [
      { pairs: 60, sources: 12 },
      { pairs: 2, sources: 1 },
      { pairs: 0, sources: 0 },
    ],
  );
  const cell = (set, pairs, sources, more) => ({ set, mode: 'mesh', parts: 'none', oracle: false, found: { pairs, sources }, ...more });
  const enough = [cell('many', 40, 10), cell('few', 2, 1), cell('none', 0, 0)];
  assert.equal(warning(enough, sizes), '');
  const short = [cell('many', 39, 12), cell('many', 50, 9, { rotate: 'so3' }), cell('few', 1, 1, { oracle: true, laplacian: 'geodesic' })];
  const sentence = warning([...enough, ...short], sizes);
  const named = ['many mesh, parts none (39 from 12)', 'many mesh, so3, parts none (50 from 9)', 'few mesh, geodesic (1 from 1)'];
  assert.ok(sentence.endsWith(`stand behind ${named.join('; ')}.`), sentence);
});

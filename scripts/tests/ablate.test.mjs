import assert from 'node:assert/strict';
import { test } from 'node:test';
import { MARKER, VARIANTS, figures, partsOf, updated } from '../ablate.mjs';
import { Failure } from '../run.mjs';

/** A row with this figure in every column of figures. */
const row = (variant, bodies, figure) => [
  variant,
  'predicted',
  '10 min',
  bodies,
  '60',
  '2',
  '36, 20',
  'abc1234',
  '560, 580',
  ...Array(5).fill(figure),
];
const rows = (text) => text.split('\n').filter((line) => /^\| w/.test(line));

test('what was not measured now stays, and so do notes', () => {
  const first = updated('', [row('without a', '400', '1.00'), row('without b', '400', '2.00')]);
  const noted = `${first}\nA note.\n\n| without c | of another day |\n`;
  const second = updated(noted, [row('without a', '400', '3.00'), row('without a', '1500', '4.00')]);
  assert.deepEqual(
    rows(second).map((line) => line.split(' | ').filter((_, column) => [0, 3, 9].includes(column))),
    [['| without a', '400', '3.00'], ['| without b', '400', '2.00'], ['| without a', '1500', '4.00'], ['| without c']],
  );
  assert.ok(second.endsWith(`${MARKER}\n\nA note.\n\n| without c | of another day |\n`));
  assert.equal(updated(second, []), second);
});

test('a page that rows or notes would be lost from is refused', () => {
  assert.throws(() => updated('# Notes by hand\n', []), Failure);
  assert.throws(() => updated(`| variant | error |\n| --- | --- |\n| without a | 1.00 |\n\n${MARKER}\n`, []), Failure);
});

test('a row shows the mean over seeds, what each seed gave, and how sure that is', () => {
  const found = (age, interval, agreement) => ({ age, age_interval: interval, part_agreement: agreement });
  const mesh = [found(2, [1.84, 2.3], 0.9), found(2.5, [2.1, 2.96], 0.8)];
  const cloud = [found(4, [3.5, 4.5], 0.7), found(5, [4.25, 6], 0.75)];
  assert.deepEqual(figures([mesh, cloud]), [
    ...['2.25: 2.00 (1.8–2.3), 2.50 (2.1–3.0)', '4.50: 4.00 (3.5–4.5), 5.00 (4.3–6.0)', '72.5 %: 70.0 %, 75.0 %'],
  ]);
  assert.deepEqual(figures([[found(2, [1.84, 2.3], 0.9)]]), ['2.00 (1.8–2.3)', '90.0 %']);
  // A network that knows no parts agrees on none.
  assert.equal(figures([[found(2, null, null), found(2, null, null)]]).at(-1), '–');
});

test('only networks that do not learn parts are given them, and for comparison what ships and attention, which acts through them', () => {
  const given = Object.keys(VARIANTS).filter((name) => partsOf(VARIANTS[name]).includes('given'));
  const ours = given.filter((name) => !VARIANTS[name].paper);
  assert.deepEqual(ours, [
    ...['as it ships', 'without cross-entropy of parts', 'with attention', 'attention kept to given parts', "the paper's losses"],
  ]);
  const papers = Object.keys(VARIANTS).filter((name) => VARIANTS[name].paper);
  assert.deepEqual(
    papers.filter((name) => !given.includes(name)),
    [],
  );
  assert.deepEqual(partsOf(VARIANTS['without moments']), ['predicted']);
});

test("a variant of the paper's differs from it in one thing", () => {
  const base = VARIANTS['the paper as printed'];
  const changed = (variant) => [
    ...Object.keys(variant.network ?? {}),
    ...['points', 'laplacian', 'run'].filter((key) => variant[key] !== base[key]),
  ];
  const names = Object.keys(VARIANTS).filter((name) => name.startsWith('the paper,'));
  assert.ok(names.length > 3);
  for (const name of names) assert.equal(changed(VARIANTS[name]).length, 1, name);
});

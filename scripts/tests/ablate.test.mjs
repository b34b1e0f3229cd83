import assert from 'node:assert/strict';
import { test } from 'node:test';
import { MARKER, VARIANTS, partsOf, updated } from '../ablate.mjs';
import { Failure } from '../run.mjs';

/** A row with this figure in every column of figures. */
const row = (variant, bodies, figure) => [variant, 'predicted', '10', bodies, '20', 'abc1234', ...Array(9).fill(figure)];
const rows = (text) => text.split('\n').filter((line) => /^\| w/.test(line));

test('what was not measured now stays, and so do notes', () => {
  const first = updated('', [row('without a', '400', '1.00'), row('without b', '400', '2.00')]);
  const noted = `${first}\nA note.\n\n| without c | of another day |\n`;
  const second = updated(noted, [row('without a', '400', '3.00'), row('without a', '1500', '4.00')]);
  assert.deepEqual(
    rows(second).map((line) => line.split(' | ').filter((_, column) => [0, 3, 6].includes(column))),
    [['| without a', '400', '3.00'], ['| without b', '400', '2.00'], ['| without a', '1500', '4.00'], ['| without c']],
  );
  assert.ok(second.endsWith(`${MARKER}\n\nA note.\n\n| without c | of another day |\n`));
  assert.equal(updated(second, []), second);
});

test('a page that rows or notes would be lost from is refused', () => {
  assert.throws(() => updated('# Notes by hand\n', []), Failure);
  assert.throws(() => updated(`| variant | error |\n| --- | --- |\n| without a | 1.00 |\n\n${MARKER}\n`, []), Failure);
});

test('only networks that do not learn parts are given them, and what ships for comparison', () => {
  const given = Object.keys(VARIANTS).filter((name) => partsOf(VARIANTS[name]).includes('given'));
  assert.deepEqual(given, ['as it ships', 'without cross-entropy of parts', "the paper's losses", 'the paper as printed']);
  assert.deepEqual(partsOf(VARIANTS['without moments']), ['predicted']);
});

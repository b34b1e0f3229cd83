import assert from 'node:assert/strict';
import { test } from 'node:test';
import { note, slowest, step, takeCosts } from '../costs.mjs';

test('the slowest come first, and what took no time does not come', async () => {
  takeCosts();
  note('quick', 0.1);
  note('slow', 2);
  note('slower', 75.25, 80);
  await assert.rejects(
    step('failing', () => {
      throw new Error('it cannot be done');
    }),
  );
  const taken = takeCosts();
  assert.deepEqual(
    taken.map(({ name }) => name),
    ['quick', 'slow', 'slower', 'failing'],
  );
  assert.deepEqual(slowest(taken, 2), ['    75.3 s  slower, 80 s of processor', '     2.0 s  slow']);
  assert.deepEqual(takeCosts(), []);
});

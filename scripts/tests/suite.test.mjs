import assert from 'node:assert/strict';
import { test } from 'node:test';
import { countResults } from '../suite.mjs';

test('closing lines of cargo and of Node are summed', () => {
  const cargo = 'test result: ok. 3 passed; 0 failed; 1 ignored; 0 measured\ntest result: FAILED. 2 passed; 1 failed; 0 ignored\n';
  assert.deepEqual(countResults(cargo, 101), { passed: 5, failed: 1, skipped: 1 });
  const node = 'ℹ tests 8\nℹ pass 4\nℹ fail 1\nℹ cancelled 2\nℹ skipped 1\nℹ todo 0\n';
  assert.deepEqual(countResults(node, 1), { passed: 4, failed: 3, skipped: 1 });
});

test('a program that ran nothing has failed, whatever its exit code', () => {
  for (const text of ['', 'test result: ok. 0 passed; 0 failed; 0 ignored\n', 'ℹ pass 0\nℹ fail 0\nℹ skipped 3\n']) {
    const { passed, failed, complaint } = countResults(text, 0);
    assert.deepEqual({ passed, failed }, { passed: 0, failed: 1 });
    assert.match(complaint, /nothing ran/);
  }
});

test('a program that ends badly has failed, though no test of it did', () => {
  assert.equal(countResults('ℹ pass 4\nℹ fail 0\n', 'SIGTERM').failed, 1);
  assert.equal(countResults('ℹ pass 4\nℹ fail 0\n', 0).failed, 0);
});

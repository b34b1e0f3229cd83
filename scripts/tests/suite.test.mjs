import assert from 'node:assert/strict';
import { test } from 'node:test';
import { countResults, timesIn } from '../suite.mjs';

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

test('the times of builds, binaries and tests are read, and a group is not counted beside its tests', () => {
  const cargo = [
    '    Finished `test` profile [optimized + debuginfo] target(s) in 2m 03s',
    '     Running unittests src/lib.rs (target/debug/deps/geose_fmap-0123)',
    'Running headless tests in Chrome on `http://127.0.0.1:41203/`',
    'test result: ok. 3 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 1.50s',
    '     Running tests/gold.rs (target/debug/deps/gold-0123)',
    'test result: ok. 2 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 12.25s',
    '   Doc-tests geose_fmap',
    'test result: ok. 1 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.50s',
  ];
  assert.deepEqual(
    timesIn(cargo.join('\n')).map(({ name, seconds }) => [name, seconds]),
    [
      ['cargo build, profile test', 123],
      ['src/lib.rs', 1.5],
      ['tests/gold.rs', 12.25],
      ['Doc-tests', 0.5],
    ],
  );
  const node = [
    '▶ a group',
    '  ✔ one (500ms)',
    '  ✖ two (1500.5ms)',
    '▶ a group (2000.5ms)',
    '✔ three (10ms)',
    'ℹ tests 3',
    '✖ two (1500.5ms)',
  ];
  const expected = [
    { name: 'one', seconds: 0.5 },
    { name: 'two', seconds: 1.5005 },
    { name: 'three', seconds: 0.01 },
  ];
  assert.deepEqual(timesIn(node.join('\n')), expected);
});

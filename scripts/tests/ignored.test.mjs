import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { root } from '../run.mjs';
import { DATA, readersOf } from '../test.mjs';

test('every ignored test runs where the data is that it needs', () => {
  const run = new Set(DATA.flatMap(readersOf));
  const folder = path.join(root, 'tests');
  const files = readdirSync(folder, { recursive: true }).filter((name) => name.endsWith('.rs'));
  const ignored = files.filter((name) => readFileSync(path.join(folder, name), 'utf8').includes('#[ignore'));
  assert.ok(ignored.length > 3, `${ignored}`);
  for (const name of ignored) assert.ok(run.has(name.split(path.sep)[0].replace(/\.rs$/, '')), name);
});

import assert from 'node:assert/strict';
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { root } from '../run.mjs';
import { DATA, readersOf } from '../test.mjs';

test('every ignored test names data, and runs where that is', () => {
  const sources = ['src', 'tests'].flatMap((folder) =>
    readdirSync(path.join(root, folder), { recursive: true }).map((name) => path.join(folder, name)),
  );
  const ignored = sources
    .filter((name) => name.endsWith('.rs'))
    .flatMap((name) => readFileSync(path.join(root, name), 'utf8').match(/#\[ignore.*/g) ?? []);
  assert.ok(ignored.length > 3, `${ignored}`);
  for (const reason of ignored) assert.ok(DATA.includes(/: set (\w+) and pass --include-ignored"\]$/.exec(reason)?.[1]), reason);
  for (const reader of DATA.flatMap(readersOf)) assert.ok(existsSync(path.join(root, 'tests', `${reader}.rs`)), reader);
});

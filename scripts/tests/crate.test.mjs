import assert from 'node:assert/strict';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, statSync, utimesSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { mirror } from '../crate.mjs';

test('a folder becomes the same as another, and what was the same keeps its age', (t) => {
  const folder = mkdtempSync(path.join(tmpdir(), 'geose-mirror-'));
  t.after(() => rmSync(folder, { recursive: true }));
  const [from, to] = ['from', 'to'].map((name) => path.join(folder, name));
  const write = (name, text, age) => {
    const file = path.join(folder, name);
    mkdirSync(path.dirname(file), { recursive: true });
    writeFileSync(file, text);
    utimesSync(file, age, age);
  };
  write('from/same', 'a', 1000);
  write('from/deep/changed', 'new', 1000);
  write('from/deep/added', 'b', 1000);
  mirror(from, to);
  const before = statSync(path.join(to, 'same')).mtimeMs;
  assert.notEqual(before, 1_000_000, 'as old as its packer says');
  write('to/deep/changed', 'old', 2000);
  write('to/gone', 'c', 2000);
  rmSync(path.join(to, 'deep/added'));

  mirror(from, to);
  assert.equal(statSync(path.join(to, 'same')).mtimeMs, before);
  assert.equal(readFileSync(path.join(to, 'deep/changed'), 'utf8'), 'new');
  assert.ok(statSync(path.join(to, 'deep/changed')).mtimeMs > 2_000_000, 'what changed is younger than what was made from it');
  assert.ok(existsSync(path.join(to, 'deep/added')));
  assert.equal(existsSync(path.join(to, 'gone')), false);
});

import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { homedir } from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { project } from './installed.mjs';

test('no file of the package names a folder of the machine it was built on', () => {
  const { installed, remove } = project();
  const files = readdirSync(installed, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
  assert.ok(files.some(({ name }) => name === 'geose_fmap_bg.wasm'));
  const workspace = path.resolve(import.meta.dirname, '../..');
  for (const { parentPath, name } of files) {
    const text = readFileSync(path.join(parentPath, name), 'latin1');
    for (const folder of [homedir(), workspace, '.cargo/registry']) assert.ok(!text.includes(`${folder}/`), `${name} names ${folder}`);
  }
  remove();
});

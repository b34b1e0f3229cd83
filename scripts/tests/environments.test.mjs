import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { ENVIRONMENTS } from '../../pkg-template/tests/environments/list.mjs';
import { readmeWithTable } from '../environments.mjs';
import { root } from '../run.mjs';

const folder = path.join(root, 'pkg-template/tests');
const sources = readdirSync(folder)
  .filter((name) => name.endsWith('.test.mjs'))
  .map((name) => readFileSync(path.join(folder, name), 'utf8'));

test('every environment of the list is tried by a test', () => {
  const untried = ENVIRONMENTS.filter(
    ({ name }) => !sources.some((text) => text.replace(/inEnvironment\(\s+/g, 'inEnvironment(').includes(`inEnvironment('${name}'`)),
  );
  assert.deepEqual(untried, []);
});

test("the README's table is made anew from the list, whoever edited it", () => {
  const readme = readmeWithTable();
  for (const { name, line } of ENVIRONMENTS) {
    const row = readme.split('\n').find((text) => text.startsWith(`| ${name} |`));
    assert.ok(row?.includes(line ?? 'nothing'), `${name}: ${row}`);
  }
  const edited = readme.replace('| Node | 20 or later |', '| Node | 12 or later |');
  assert.notEqual(edited, readme);
  assert.equal(readmeWithTable(edited), readme);
  assert.throws(() => readmeWithTable('no table'), /has no <!-- environments/);
});

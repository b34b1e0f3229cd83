import assert from 'node:assert/strict';
import { mkdirSync, rmSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { after, test } from 'node:test';
import { once } from '../fresh.mjs';
import { root } from '../run.mjs';

const FOLDER = 'dist/.fresh-test';
const write = (name, text) => writeFileSync(path.join(root, FOLDER, name), text);
after(() => {
  for (const made of [FOLDER, 'dist/.made/.fresh-test']) rmSync(path.join(root, made), { recursive: true, force: true });
});

test('a thing is made again only when an input changed, an output is gone, or making it failed', async () => {
  mkdirSync(path.join(root, FOLDER, 'in'), { recursive: true });
  const make = (action) => once('.fresh-test', { inputs: [`${FOLDER}/in`], outputs: [`${FOLDER}/out`] }, action);
  const succeed = () => write('out', '');
  write('in/a', 'one');
  assert.equal(await make(succeed), true);
  assert.equal(await make(succeed), false);
  write('in/a', 'one');
  assert.equal(await make(succeed), false, 'written again with the same content');
  write('in/b', 'two');
  await assert.rejects(
    make(() => {
      throw new Error('it cannot be made');
    }),
  );
  assert.equal(await make(succeed), true, 'after a failure');
  rmSync(path.join(root, FOLDER, 'out'));
  assert.equal(await make(succeed), true, 'its output was gone');
});

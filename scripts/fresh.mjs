// No needless work the second time: a thing is made again only when the content of its inputs has changed.
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readFileSync, readdirSync, rmSync, statSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { root, say } from './run.mjs';

/**
 * Calls `make` unless it was called before with the same `inputs` (files and folders, relative to the workspace) and all
 * `outputs` are still there. `inputs` should name the script that calls, as its steps decide the result too.
 */
export async function once(name, { inputs, outputs, also = '' }, make) {
  const stamp = path.join(root, 'dist/.made', name);
  const wanted = fingerprint(inputs, also);
  const there = outputs.every((file) => existsSync(path.join(root, file)));
  if (there && existsSync(stamp) && readFileSync(stamp, 'utf8') === wanted) return false;
  say(`making ${name}`);
  rmSync(stamp, { force: true });
  await make();
  mkdirSync(path.dirname(stamp), { recursive: true });
  writeFileSync(stamp, wanted);
  return true;
}

function fingerprint(inputs, also) {
  const hash = createHash('sha256').update(also);
  for (const file of inputs.flatMap(filesOf).sort()) hash.update(`\n${file}\n`).update(readFileSync(path.join(root, file)));
  return hash.digest('hex');
}

function filesOf(name) {
  const full = path.join(root, name);
  if (!existsSync(full)) return [];
  if (!statSync(full).isDirectory()) return [name];
  return readdirSync(full)
    .filter((child) => child !== 'node_modules')
    .flatMap((child) => filesOf(path.join(name, child)));
}

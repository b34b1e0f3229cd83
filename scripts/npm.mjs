// node_modules as package-lock.json says.
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { createHash } from 'node:crypto';
import path from 'node:path';
import { root, run, say } from './run.mjs';

const MARKER = path.join(root, 'node_modules/.installed-lock');

/** Runs `npm ci` when node_modules is missing or belongs to another lock. */
export function ensureNodeModules() {
  const lock = createHash('sha256')
    .update(readFileSync(path.join(root, 'package-lock.json')))
    .digest('hex');
  if (existsSync(MARKER) && readFileSync(MARKER, 'utf8') === lock) return;
  say('npm ci');
  run('npm', ['ci']);
  writeFileSync(MARKER, lock);
}

// What customers run the package in: installed in a temporary folder for the tests, and the table of it in the package's README.
//   node scripts/environments.mjs           writes the table
//   node scripts/environments.mjs install   installs, and prints the folder
import { createHash } from 'node:crypto';
import { cpSync, existsSync, mkdirSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { table } from '../pkg-template/tests/environments/list.mjs';
import { Failure, main, root, run, say } from './run.mjs';

const PINS = ['package.json', 'package-lock.json'].map((name) => path.join(root, 'pkg-template/tests/environments', name));
const pinned = Object.keys(JSON.parse(readFileSync(PINS[0], 'utf8')).dependencies);
const README = path.join(root, 'pkg-template/README.md');
const [BEGIN, END] = ['<!-- environments: written by scripts/environments.mjs -->', '<!-- /environments -->'];

/**
 * The folder that they are installed in: outside of the workspace, whose own packages would be found from inside it, and one for each set of versions. It is
 * kept for the next time.
 */
export function ensureEnvironments() {
  const hash = createHash('sha256');
  for (const file of PINS) hash.update(readFileSync(file));
  const folder = path.join(tmpdir(), `geose-fmap-environments-${hash.digest('hex').slice(0, 12)}`);
  // Whoever clears temporary folders may have left a part of it.
  if (pinned.every((name) => existsSync(path.join(folder, 'node_modules', name, 'package.json')))) return folder;
  rmSync(folder, { recursive: true, force: true });
  say('installing what customers run the package in');
  const unfinished = `${folder}-${process.pid}`;
  mkdirSync(unfinished, { recursive: true });
  for (const file of PINS) cpSync(file, path.join(unfinished, path.basename(file)));
  try {
    run('npm', ['ci', '--ignore-scripts=false', '--no-audit', '--no-fund', '--loglevel', 'error'], { cwd: unfinished });
    renameSync(unfinished, folder);
  } catch (cause) {
    rmSync(unfinished, { recursive: true, force: true });
    throw new Failure(
      `What customers run the package in could not be installed, so nothing is known of it (${cause.message}). Is the npm registry within reach?`,
    );
  }
  return folder;
}

/** The README with the table as the list of environments has it. */
export function readmeWithTable(text = readFileSync(README, 'utf8')) {
  const [from, to] = [text.indexOf(BEGIN), text.indexOf(END)];
  if (from < 0 || to < from) throw new Failure(`pkg-template/README.md has no ${BEGIN} … ${END}: the table belongs between them.`);
  return `${text.slice(0, from + BEGIN.length)}\n${table()}\n${text.slice(to)}`;
}

/** Throws where the README's table is not that of the list. */
export function checkTable() {
  if (readmeWithTable() !== readFileSync(README, 'utf8'))
    throw new Failure(
      'The table of environments in pkg-template/README.md is not that of the list: `node scripts/environments.mjs` writes it.',
    );
}

await main(import.meta, ([what]) => {
  if (what === 'install') console.log(ensureEnvironments());
  else writeFileSync(README, readmeWithTable());
});

// The programs that customers run the package in: installed once, in pinned versions, and one project in each of them.
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { test } from 'node:test';
import { createRequire } from 'node:module';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { readFileSync } from 'node:fs';
import { environmentNamed } from './environments/list.mjs';
import { run } from './customer.mjs';
import { installedPackage, project } from './installed.mjs';

/** How the customer's program prepares its scans here: enough to come by every file of the package, and over in half a second. */
export const PREPARING = { eigenpairs: 20, points: 200 };
const OPTIONS = { device: 'cpu' };

/** The text of a program that runs the customer's and hands what comes of it to `hand`, the text of a function. */
export const program = (hand) => `
  import { Matcher } from 'geose-fmap';
  import { run } from './customer.mjs';
  await run(Matcher, ${JSON.stringify(OPTIONS)}, ${JSON.stringify(PREPARING)})
    .then((outcome) => ({ outcome }), (error) => ({ error: \`\${error.code}: \${error.message}\` }))
    .then(${hand});
`;

/** What the program needs beside it. */
export const BESIDE = Object.fromEntries(
  ['customer.mjs', 'bodies.mjs'].map((name) => [name, readFileSync(new URL(name, import.meta.url), 'utf8')]),
);

/** A page that runs it. */
export const smallPage = () => ({
  ...BESIDE,
  'index.html': '<!doctype html><link rel="icon" href="data:," /><script type="module" src="./main.js"></script>\n',
  'main.js': program('({ outcome, error }) => (window.outcome = outcome ?? { error })'),
});

let inNode;
/** What the program tells in Node. */
export const expected = async () => (inNode ??= await run((await installedPackage()).Matcher, OPTIONS, PREPARING));

/** The folder where everything is installed. */
function installation() {
  const folder = process.env.GEOSE_ENVIRONMENTS;
  if (!folder)
    throw new Error(
      'GEOSE_ENVIRONMENTS must name the folder of installed programs, so this was not tried: `node scripts/environments.mjs install` makes it',
    );
  return folder;
}

/** A project with the package that finds the installed programs one folder up. */
export const projectInside = (files) => project({ ...BESIDE, ...files }, installation());

/** A file of an installed program. */
export const installedFile = (...names) => path.join(installation(), 'node_modules', ...names);

/** A module of an installed program. */
export const importInstalled = (name) => import(pathToFileURL(createRequire(installedFile('any.js')).resolve(name)).href);

/** Runs a program to its end; what it printed and its exit code. It may not take longer than a minute: then it never ends by itself. */
export function ran(file, args, { cwd, env = {} }) {
  return new Promise((resolve) => {
    const options = { cwd, env: { ...process.env, NODE_TEST_CONTEXT: undefined, ...env }, timeout: 60_000, maxBuffer: 1 << 26 };
    const child = execFile(file, args, options, (error, stdout, stderr) => {
      resolve({ status: error ? (error.code ?? error.signal) : 0, stdout, stderr });
    });
    child.stdin.end();
  });
}

/**
 * Tests an environment as the list says of it. `outcomeOf(line)` runs the program there, with the line that has to be added or, if that is undefined, as it
 * is, and resolves to `{ outcome }` or `{ error }`; `wanted` gives the outcome to expect, which is that in Node unless said otherwise.
 */
export function inEnvironment(name, outcomeOf, wanted = expected) {
  const { line, named = line } = environmentNamed(name);
  const works = async () => {
    const { outcome, error } = await outcomeOf(line);
    assert.equal(error, undefined);
    assert.deepEqual(outcome, await wanted());
  };
  if (line === undefined) {
    test(`${name}: nothing has to be added`, works);
    return;
  }
  test(`${name}: fails with a sentence that names what to add`, async () => {
    const { outcome, error } = await outcomeOf(undefined);
    assert.equal(outcome, undefined, 'it works as it is: say so in the list');
    assert.ok(error.includes(named), error);
  });
  test(`${name}: works with what was added`, works);
}

// Running other programs: where the workspace is, what a failed program looks like, how a script starts.
import { spawn, spawnSync } from 'node:child_process';
import { accessSync, constants } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

/** Absolute path of the workspace: every path and every program here starts from it. */
export const root = path.resolve(import.meta.dirname, '..');

/** A sentence for the person at the terminal; shown without a stack. */
export class Failure extends Error {}

/** Runs a program with its output shown; throws a `Failure` unless it ends with 0. */
export function run(program, args, { env = environment(), cwd = root, timeout } = {}) {
  const { status, signal, error } = spawnSync(program, args, {
    cwd,
    env,
    timeout,
    stdio: ['ignore', 'inherit', 'inherit'],
  });
  if (status !== 0) throw new Failure(`${program} ${args.join(' ')}: ${error?.message ?? signal ?? `exit code ${status}`}`);
}

/** The same beside others: resolves when it has ended. */
export function start(program, args, { env = environment(), cwd = root } = {}) {
  return new Promise((resolve, reject) => {
    const fail = (why) => reject(new Failure(`${program} ${args.join(' ')}: ${why}`));
    const child = spawn(program, args, { cwd, env, stdio: ['ignore', 'inherit', 'inherit'] });
    child.on('error', (error) => fail(error.message));
    child.on('close', (status, signal) => (status === 0 ? resolve() : fail(signal ?? `exit code ${status}`)));
  });
}

/** What a program wrote to standard output, trimmed; `null` when it is missing or fails. */
export function output(program, args, { env = environment(), cwd = root } = {}) {
  const { status, stdout } = spawnSync(program, args, {
    cwd,
    env,
    encoding: 'utf8',
    maxBuffer: 1 << 28,
    stdio: ['ignore', 'pipe', 'ignore'],
  });
  return status === 0 ? stdout.trim() : null;
}

/** Absolute path of the first of `names` that is a program on the PATH; `null` if none is. */
export function which(names) {
  for (const name of names) {
    for (const folder of (process.env.PATH ?? '').split(path.delimiter)) {
      const file = path.join(folder, name);
      try {
        accessSync(file, constants.X_OK);
        return file;
      } catch {
        // not here: look in the next folder
      }
    }
  }
  return null;
}

/** An environment with `folders` first on the PATH and `more` on top. What cargo builds is in target/, wherever it goes elsewhere. */
export function environment(folders = [], more = {}) {
  const PATH = [...folders, process.env.PATH ?? ''].join(path.delimiter);
  return { ...process.env, CARGO_TARGET_DIR: path.join(root, 'target'), ...more, PATH };
}

/** Calls `action` if the module with this `import.meta` is the script that was started, and turns what it throws into an exit code. */
export async function main(meta, action) {
  if (path.resolve(process.argv[1] ?? '') !== fileURLToPath(meta.url)) return;
  try {
    await action(process.argv.slice(2));
  } catch (error) {
    console.error(error instanceof Failure ? `\n${error.message}` : error);
    process.exitCode = 1;
  }
}

/** Says what happens next, so that a long silence has a name. */
export function say(what) {
  console.log(`▸ ${what}`);
}

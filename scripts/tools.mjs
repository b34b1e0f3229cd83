// wasm-bindgen's command line and its runner of tests, in the version this workspace needs: built into .tools/ unless on the PATH.
import { readFileSync, rmSync } from 'node:fs';
import path from 'node:path';
import { Failure, environment, output, root, run, say } from './run.mjs';

/** Folders that go first on the PATH: the tools of this workspace and wasm-opt (npm package binaryen). */
export const toolFolders = [path.join(root, '.tools/bin'), path.join(root, 'node_modules/.bin')];

/** wasm-bindgen's command line must be of exactly the version the crate links. */
export function lockedWasmBindgen() {
  const lock = readFileSync(path.join(root, 'Cargo.lock'), 'utf8');
  const version = /^name = "wasm-bindgen"\r?\nversion = "([^"]+)"/m.exec(lock)?.[1];
  if (!version) throw new Failure('Cargo.lock names no wasm-bindgen.');
  return version;
}

export function ensureTools() {
  const version = lockedWasmBindgen();
  const found = output('wasm-bindgen', ['--version'], { env: environment(toolFolders) });
  if (found?.split(/\s+/).includes(version)) return;
  say(`cargo install wasm-bindgen-cli ${version} into .tools`);
  const programs = ['wasm-bindgen', 'wasm-bindgen-test-runner'].flatMap((name) => ['--bin', name]);
  const install = ['install', 'wasm-bindgen-cli', '--version', version, '--force', '--root', path.join(root, '.tools'), ...programs];
  // It runs for a second or two and builds for minutes: unoptimised, in 1 minute instead of 2, it takes a second more.
  const build = path.join(root, '.tools/build');
  const env = environment([], { CARGO_PROFILE_RELEASE_OPT_LEVEL: '0', CARGO_TARGET_DIR: build });
  try {
    run('cargo', [...install, '--locked'], { env });
  } catch {
    say('its own lock names a version this registry does not have; once more with what it has');
    run('cargo', install, { env });
  }
  rmSync(build, { recursive: true, force: true });
}

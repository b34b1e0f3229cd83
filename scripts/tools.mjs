// wasm-pack and wasm-bindgen-cli in the versions this workspace needs, built into .tools/ unless they are on the PATH.
import { readFileSync, rmSync } from 'node:fs';
import path from 'node:path';
import { Failure, environment, output, root, run, say } from './run.mjs';

const WASM_PACK = '0.15.1';

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
  ensureTool('wasm-pack', 'wasm-pack', WASM_PACK);
  ensureTool('wasm-bindgen-cli', 'wasm-bindgen', lockedWasmBindgen());
  rmSync(path.join(root, '.tools/build'), { recursive: true, force: true });
}

function ensureTool(crate, program, version) {
  const found = output(program, ['--version'], { env: environment(toolFolders) });
  if (found?.split(/\s+/).includes(version)) return;
  say(`cargo install ${crate} ${version} into .tools`);
  const install = ['install', crate, '--version', version, '--force', '--root', path.join(root, '.tools')];
  // They run for a second and build for minutes: little optimisation, and what both depend on is built once.
  const env = environment([], {
    CARGO_PROFILE_RELEASE_OPT_LEVEL: '1',
    CARGO_TARGET_DIR: path.join(root, '.tools/build'),
  });
  try {
    run('cargo', [...install, '--locked'], { env });
  } catch {
    say('its own lock names a version this registry does not have; once more with what it has');
    run('cargo', install, { env });
  }
}

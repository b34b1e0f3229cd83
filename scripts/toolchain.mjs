// Everything the builds and tests need beyond Rust and Node. Run by itself it installs all of it and says what was found.
import { existsSync, readdirSync } from 'node:fs';
import { homedir } from 'node:os';
import path from 'node:path';
import { ensureChromium, writeWebdriver } from './chromium.mjs';
import { ensureNodeModules } from './npm.mjs';
import { environment, main, run } from './run.mjs';
import { wasmRust } from './rust.mjs';
import { ensureTools, toolFolders } from './tools.mjs';

/** The environment in which this crate is built for wasm32 and its bindings are made. */
export function wasmEnvironment() {
  const env = wasmCompiler();
  ensureTools();
  return env;
}

/** The same without wasm-bindgen, which takes a minute or two to be built: enough for cargo and clippy. */
export function wasmCompiler() {
  ensureNodeModules();
  const rust = wasmRust();
  const env = environment(toolFolders, rust);
  if (env.RUSTFLAGS) console.log(`not used for wasm32: RUSTFLAGS=${env.RUSTFLAGS}`);
  return { ...env, CARGO_ENCODED_RUSTFLAGS: [SIMD, ...withoutPaths(env)].join('\x1f') };
}

/** As in .cargo/config.toml, which serves whoever calls cargo without these scripts: flags from the environment replace those. */
const SIMD = '-Ctarget-feature=+simd128';

/** Flags under which the sentences of panics name the files of dependencies without the folders of this machine. */
function withoutPaths(env) {
  const sources = path.join(env.CARGO_HOME ?? path.join(homedir(), '.cargo'), 'registry/src');
  run('cargo', ['fetch', '--quiet', '--locked', '--target', 'wasm32-unknown-unknown'], { env });
  const registries = existsSync(sources) ? readdirSync(sources) : [];
  return registries.map((registry) => `--remap-path-prefix=${path.join(sources, registry)}=/crates`);
}

await main(import.meta, () => {
  const { RUSTUP_TOOLCHAIN = 'as it is' } = wasmEnvironment();
  const { browser, driver } = ensureChromium();
  writeWebdriver(browser);
  console.log(`Rust for wasm32: ${RUSTUP_TOOLCHAIN}; browser: ${browser}; driver: ${driver ?? 'none'}`);
});

// Everything the builds and tests need beyond Rust and Node. Run by itself it installs all of it and says what was found.
import { ensureChromium, writeWebdriver } from './chromium.mjs';
import { ensureNodeModules } from './npm.mjs';
import { environment, main } from './run.mjs';
import { wasmRust } from './rust.mjs';
import { ensureTools, toolFolders } from './tools.mjs';

/** The environment in which cargo, clippy and wasm-pack build this crate for wasm32. */
export function wasmEnvironment() {
  ensureNodeModules();
  const rust = wasmRust();
  ensureTools();
  // Cargo would take RUSTFLAGS instead of those in .cargo/config.toml.
  const { RUSTFLAGS, ...env } = environment(toolFolders, rust);
  if (RUSTFLAGS) console.log(`not used for wasm32: RUSTFLAGS=${RUSTFLAGS}`);
  return env;
}

await main(import.meta, () => {
  const { RUSTUP_TOOLCHAIN = 'as it is' } = wasmEnvironment();
  const { browser, driver } = ensureChromium();
  writeWebdriver(browser);
  console.log(`Rust for wasm32: ${RUSTUP_TOOLCHAIN}; browser: ${browser}; driver: ${driver ?? 'fetched by wasm-pack'}`);
});

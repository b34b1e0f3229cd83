// The WebAssembly module with its bindings: src/ → pkg/, by cargo, wasm-bindgen and wasm-opt, and a look at the size budget.
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { once } from './fresh.mjs';
import { Failure, main, output, root, run } from './run.mjs';
import { checkSize } from './size.mjs';
import { wasmEnvironment } from './toolchain.mjs';

/** -O1: 7 s and 13 % smaller. -O3 took 23 s for another 3 % (1 % gzipped) and matched no faster in Node. */
const OPTIMISE = [
  '-O1',
  '--enable-bulk-memory',
  '--enable-multivalue',
  '--enable-mutable-globals',
  '--enable-nontrapping-float-to-int',
  '--enable-reference-types',
  '--enable-sign-ext',
  '--enable-simd',
];

const TARGET = 'wasm32-unknown-unknown';
/** Where cargo puts a module, and beside it the list of files that it was made from; without their endings. */
const BUILT = path.join(root, `target/${TARGET}/release/geose_fmap`);

/** The two modules there are: the one that ships, and a smaller one for whoever builds their own. */
const MODULES = {
  'with WebGPU': { folder: 'pkg', features: ['--features', 'gpu'] },
  'without WebGPU': { folder: 'dist/without-webgpu', features: [] },
};

/** What a module is made from. */
const SOURCES = ['src', 'data', 'Cargo.toml', 'Cargo.lock', '.cargo', 'scripts/wasm.mjs', 'scripts/toolchain.mjs'];

/**
 * Builds a module's folder if what it is made from has changed. Cargo is not asked each time: it has one place for both modules, and
 * would make the one of them anew whenever the other was made last.
 */
export async function buildWasm(kind = 'with WebGPU') {
  const env = wasmEnvironment();
  const { folder, features } = MODULES[kind];
  const module = `${folder}/geose_fmap_bg.wasm`;
  const outputs = [module, `${folder}/geose_fmap.js`, `${folder}/geose_fmap.d.ts`];
  await once(folder, { inputs: SOURCES, also: output('rustc', ['-vV'], { env }), outputs }, () => {
    // The crate is a plain Rust library, which only this build wants as a module.
    const build = ['rustc', '--release', '--lib', '--crate-type', 'cdylib', '--target', TARGET, '--locked'];
    run('cargo', [...build, ...features], { env });
    checkSources();
    run('wasm-bindgen', ['--target', 'web', '--out-dir', folder, `${BUILT}.wasm`], { env });
    run('wasm-opt', [...OPTIMISE, '-o', module, module], { env });
  });
  return checkSize(module, kind);
}

/** Throws if cargo says that the module was made from a file that is not among the sources above. */
function checkSources() {
  const files = readFileSync(`${BUILT}.d`, 'utf8')
    .replace(/^.*?: /, '')
    .trim();
  for (const file of files.split(/(?<!\\) /).map((name) => path.relative(root, name.replaceAll('\\ ', ' ')))) {
    if (!SOURCES.some((source) => file === source || file.startsWith(`${source}${path.sep}`)))
      throw new Failure(`The module is made from ${file}, too: say so in scripts/wasm.mjs.`);
  }
}

await main(import.meta, () => buildWasm());

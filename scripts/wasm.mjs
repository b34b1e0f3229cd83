// The WebAssembly module with its bindings: src/ → pkg/, by wasm-pack, then wasm-opt and a look at the size budget.
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { once } from './fresh.mjs';
import { main, root, run } from './run.mjs';
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

/** The two modules there are: the one that ships, and a smaller one for whoever builds their own. */
const MODULES = {
  'with WebGPU': { folder: 'pkg', features: ['--features', 'gpu'] },
  'without WebGPU': { folder: 'dist/without-webgpu', features: [] },
};

/** Builds a module's folder if the crate has changed. Cargo knows best whether it has: it is always asked, and its result decides. */
export async function buildWasm(kind = 'with WebGPU') {
  const env = wasmEnvironment();
  const { folder, features } = MODULES[kind];
  const module = `${folder}/geose_fmap_bg.wasm`;
  run('cargo', ['build', '--release', '--lib', '--target', 'wasm32-unknown-unknown', '--locked', ...features], { env });
  const compiled = readFileSync(path.join(root, 'target/wasm32-unknown-unknown/release/geose_fmap.wasm'));
  const also = createHash('sha256').update(compiled).digest('hex');
  await once(
    folder,
    { inputs: ['Cargo.lock', 'scripts/wasm.mjs'], also, outputs: [module, `${folder}/geose_fmap.js`, `${folder}/geose_fmap.d.ts`] },
    () => {
      const build = ['build', '--release', '--target', 'web', '--no-pack', '--no-opt', '--out-dir', folder];
      run('wasm-pack', [...build, '--', '--locked', ...features], { env });
      run('wasm-opt', [...OPTIMISE, '-o', module, module], { env });
    },
  );
  return checkSize(module, kind);
}

await main(import.meta, () => buildWasm());

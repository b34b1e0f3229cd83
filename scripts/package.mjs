// The npm package: pkg-template/ and pkg/ → dist/package, and packed → dist/geose-fmap-<version>.tgz.
import { cpSync, existsSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { once } from './fresh.mjs';
import { shippedLicences } from './licences.mjs';
import { Failure, environment, main, root, run } from './run.mjs';
import { toolFolders } from './tools.mjs';
import { buildWasm } from './wasm.mjs';

const FOLDER = 'dist/package';
/** Where the compiler puts its modules, as pkg-template/tsconfig.json says. */
const COMPILED = 'dist/compiled';
const TEMPLATE = ['src', 'package.json', 'tsconfig.json', 'README.md'].map((name) => `pkg-template/${name}`);
const LICENCES = ['LICENSE-MIT', 'LICENSE-APACHE'];
const BINDINGS = 'pkg/geose_fmap.js';
const MODULE = 'pkg/geose_fmap_bg.wasm';
const at = (name) => path.join(root, name);
const json = (name) => JSON.parse(readFileSync(at(name), 'utf8'));

/** Version of the published package; the crate's is the same. */
function version() {
  const { version } = json('pkg-template/package.json');
  const crate = /^version = "([^"]+)"/m.exec(readFileSync(at('Cargo.toml'), 'utf8'))?.[1];
  if (version !== crate) throw new Failure(`pkg-template/package.json says ${version}, Cargo.toml ${crate}: make them the same.`);
  return version;
}

/** Compiles the TypeScript of the package: enough for others to be type-checked against, also while its folder is in use. */
export function compilePackage() {
  run('tsc', ['--project', 'pkg-template'], { env: environment(toolFolders) });
}

/**
 * The worker becomes one file, its bindings with it: whatever copies that file and nothing else (a bundler that takes it for a picture, a person) has a worker that runs.
 */
function bundleWorker() {
  cpSync(at(BINDINGS), at(`${COMPILED}/${path.basename(BINDINGS)}`));
  const bundle = ['--bundle', '--format=esm', '--target=es2022', `--outfile=${FOLDER}/worker.js`, '--log-level=warning'];
  run('esbuild', [`${COMPILED}/worker.js`, ...bundle], { env: environment(toolFolders) });
}

/** Copies what was compiled, but for the worker. Modules that are no more may still lie there. */
function copyModules() {
  const sources = readdirSync(at('pkg-template/src')).filter((name) => !name.endsWith('.d.ts') && name !== 'worker.ts');
  for (const name of sources.map((source) => path.basename(source, '.ts'))) {
    for (const ending of ['js', 'd.ts']) cpSync(at(`${COMPILED}/${name}.${ending}`), at(`${FOLDER}/${name}.${ending}`));
  }
}

/** Fills dist/package. */
export async function buildPackage() {
  await buildWasm();
  version();
  const made = [BINDINGS, MODULE, 'Cargo.lock', 'package-lock.json', 'scripts/package.mjs', 'scripts/licences.mjs'];
  const inputs = [...TEMPLATE, ...LICENCES, ...made];
  await once('package', { inputs, outputs: [`${FOLDER}/package.json`, `${FOLDER}/geose_fmap_bg.wasm`] }, () => {
    rmSync(at(FOLDER), { recursive: true, force: true });
    compilePackage();
    copyModules();
    bundleWorker();
    for (const name of ['pkg-template/package.json', 'pkg-template/README.md', ...LICENCES, MODULE]) {
      cpSync(at(name), at(`${FOLDER}/${path.basename(name)}`));
    }
    writeFileSync(at(`${FOLDER}/THIRD-PARTY-LICENSES.txt`), shippedLicences());
  });
}

/** Packs dist/package; returns the absolute path of the tarball. */
export async function packPackage() {
  await buildPackage();
  const tarball = `dist/geose-fmap-${version()}.tgz`;
  await once('tarball', { inputs: [FOLDER], outputs: [tarball] }, () => {
    const stale = existsSync(at('dist')) ? readdirSync(at('dist')).filter((name) => name.endsWith('.tgz')) : [];
    for (const name of stale) rmSync(at(`dist/${name}`));
    run('npm', ['pack', `./${FOLDER}`, '--pack-destination', 'dist', '--ignore-scripts', '--loglevel', 'error']);
  });
  return at(tarball);
}

await main(import.meta, async () => console.log(await packPackage()));

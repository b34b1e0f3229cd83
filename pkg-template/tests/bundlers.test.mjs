import assert from 'node:assert/strict';
import { cpSync, mkdirSync, readdirSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { promisify } from 'node:util';
import { after, before, describe } from 'node:test';
import { build } from 'esbuild';
import webpack from 'webpack';
import { launch, serve, visit } from './browser.mjs';
import { importInstalled, inEnvironment, installedFile, program, projectInside, ran, smallPage } from './environment.mjs';

/** What the list asks to copy, copied. */
function copyFiles(from, to) {
  for (const name of ['worker.js', 'geose_fmap_bg.wasm']) cpSync(path.join(from, name), path.join(to, name));
}

/** Two workers or two modules would be one too many. */
function assertOnce(folder) {
  const names = readdirSync(folder, { recursive: true }).map((name) => path.basename(name));
  assert.equal(names.filter((name) => name.endsWith('.wasm')).length, 1, names.join(' '));
  assert.ok(names.filter((name) => /worker/.test(name)).length <= 1, names.join(' '));
}

describe('pages that a bundler made', () => {
  let browser;
  before(async () => (browser = await launch()));
  after(() => browser.close());

  /** Bundles the page into the folder `out` and tells what the built page tells. */
  async function outcomeOf(bundle) {
    const files = smallPage();
    const { folder, installed, remove } = projectInside(files);
    const out = path.join(folder, 'out');
    mkdirSync(out);
    await bundle({ folder, installed, out });
    if (!readdirSync(out).includes('index.html')) writeFileSync(path.join(out, 'index.html'), files['index.html']);
    const { origin, close } = await serve(out);
    try {
      const { outcome } = await visit(browser, origin);
      return outcome.error ? outcome : { outcome };
    } finally {
      await close();
      remove();
    }
  }

  inEnvironment('webpack', () =>
    outcomeOf(async ({ folder, out }) => {
      const stats = await promisify(webpack)({ context: folder, mode: 'production', entry: './main.js', output: { path: out } });
      assert.ok(!stats.hasErrors(), stats.toString());
      assertOnce(out);
    }),
  );

  inEnvironment('esbuild', (line) =>
    outcomeOf(async ({ folder, installed, out }) => {
      const entryPoints = [path.join(folder, 'main.js')];
      await build({ absWorkingDir: folder, entryPoints, bundle: true, format: 'esm', target: 'es2022', outdir: out, logLevel: 'warning' });
      if (line) copyFiles(installed, out);
    }),
  );

  /** Rollup with plugins; what it warns of fails the test. */
  const withRollup = async ({ folder, out }, ...plugins) => {
    const { rollup } = await importInstalled('rollup');
    const { nodeResolve } = await importInstalled('@rollup/plugin-node-resolve');
    const onwarn = (warning) => assert.fail(warning.message);
    const bundle = await rollup({ input: path.join(folder, 'main.js'), plugins: [nodeResolve({ browser: true }), ...plugins], onwarn });
    await bundle.write({ dir: out, format: 'es' });
  };
  inEnvironment('Rollup without one', (line) =>
    outcomeOf(async (place) => {
      await withRollup(place);
      if (line) copyFiles(place.installed, place.out);
    }),
  );
  inEnvironment('Rollup with an asset plugin', () =>
    outcomeOf(async (place) => {
      const { importMetaAssets } = await importInstalled('@web/rollup-plugin-import-meta-assets');
      await withRollup(place, importMetaAssets());
      assertOnce(place.out);
    }),
  );

  inEnvironment('Parcel', () =>
    outcomeOf(async ({ folder, out }) => {
      const args = [installedFile('parcel', 'lib', 'bin.js'), 'build', 'index.html', '--no-cache', '--no-source-maps', '--dist-dir', out];
      const { status, stdout, stderr } = await ran(process.execPath, args, { cwd: folder });
      assert.equal(status, 0, stdout + stderr);
      assertOnce(out);
    }),
  );
});

describe('programs for Node that a bundler made', () => {
  inEnvironment('esbuild for Node', async (line) => {
    // CommonJS cannot wait outside of a function.
    const entry = program('(told) => console.log(JSON.stringify(told))').replace('await run', 'run');
    const { folder, remove } = projectInside({ 'main.js': entry });
    const told = [];
    for (const [format, ending] of Object.entries({ esm: 'mjs', cjs: 'cjs' })) {
      const outfile = `out.${ending}`;
      const external = line ? [line.split(':')[1]] : [];
      await build({
        absWorkingDir: folder,
        entryPoints: ['main.js'],
        bundle: true,
        platform: 'node',
        format,
        outfile,
        external,
        logLevel: 'error',
      });
      const { status, stdout, stderr } = await ran(process.execPath, [outfile], { cwd: folder });
      assert.equal(status, 0, stderr);
      told.push(JSON.parse(stdout));
    }
    remove();
    const [first, second] = told;
    assert.deepEqual(second.outcome, first.outcome);
    // Their words differ, as a bundle of CommonJS has no address of its own; what to add does not.
    const advised = ({ error }) => error?.split('. ').at(-1);
    assert.equal(advised(second), advised(first));
    return first;
  });
});

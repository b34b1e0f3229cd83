import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import path from 'node:path';
import { promisify } from 'node:util';
import { after, before, describe, test } from 'node:test';
import { build } from 'esbuild';
import webpack from 'webpack';
import { launch, page, serve, visit } from './browser.mjs';
import { run } from './customer.mjs';
import { installedPackage, project } from './installed.mjs';

describe('other bundlers', () => {
  let browser, expected;
  before(async () => {
    expected = await run((await installedPackage()).Matcher);
    browser = await launch();
  });
  after(() => browser.close());

  /** Bundles the page's program into the folder `out` and tells what the built page tells. */
  async function outcomeOf(bundle) {
    const { folder, remove } = project(page());
    const out = path.join(folder, 'out');
    await bundle(folder, out);
    writeFileSync(path.join(out, 'index.html'), '<!doctype html><script type="module" src="./main.js"></script>\n');
    const { origin, close } = await serve(out);
    try {
      return (await visit(browser, origin)).outcome;
    } finally {
      await close();
      remove();
    }
  }

  test('webpack needs no configuration', async () => {
    const outcome = await outcomeOf(async (context, out) => {
      const stats = await promisify(webpack)({ context, mode: 'production', entry: './main.js', output: { path: out } });
      assert.ok(!stats.hasErrors(), stats.toString());
    });
    assert.deepEqual(outcome, expected);
  });

  test('esbuild needs the worker and the wasm as entries, as the README says', async () => {
    const outcome = await outcomeOf((folder, outdir) =>
      build({
        absWorkingDir: folder,
        entryPoints: ['main.js', 'node_modules/geose-fmap/worker.js', 'node_modules/geose-fmap/geose_fmap_bg.wasm'],
        bundle: true,
        format: 'esm',
        target: 'es2022',
        loader: { '.wasm': 'copy' },
        entryNames: '[name]',
        outdir,
        logLevel: 'warning',
      }),
    );
    assert.deepEqual(outcome, expected);
  });
});

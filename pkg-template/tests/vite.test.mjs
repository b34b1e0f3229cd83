import assert from 'node:assert/strict';
import path from 'node:path';
import { after, before, describe, test } from 'node:test';
import { build, createServer, preview } from 'vite';
import { launch, page, visit } from './browser.mjs';
import { run } from './customer.mjs';
import { installedPackage, project } from './installed.mjs';

describe('a Vite project without any configuration', () => {
  let browser, expected, installation;
  before(async () => {
    expected = await run((await installedPackage()).Matcher);
    browser = await launch();
    installation = project(page());
  });
  after(async () => {
    await browser.close();
    installation.remove();
  });
  const vite = (more = {}) => ({ root: installation.folder, configFile: false, logLevel: 'warn', ...more });

  test('builds, and the built page gives the bytes Node gives', async () => {
    const { output } = await build(vite());
    const names = output.map(({ fileName }) => path.basename(fileName));
    assert.equal(names.filter((name) => name.endsWith('.wasm')).length, 1, names.join(' '));
    assert.equal(names.filter((name) => name.startsWith('worker')).length, 1, names.join(' '));
    const server = await preview(vite({ preview: { port: 0, host: '127.0.0.1' } }));
    const { outcome, complaints } = await visit(browser, server.resolvedUrls.local[0]);
    await server.close();
    assert.deepEqual(outcome, expected);
    assert.deepEqual(complaints, []);
  });

  // Vite 7 and older need the exclusion; that a newer one does not mind it is what can be tested here.
  for (const [what, optimizeDeps] of Object.entries({ 'as it is': {}, 'with the line for Vite 7': { exclude: ['geose-fmap'] } })) {
    test(`serves for development ${what}`, async () => {
      const server = await createServer(vite({ optimizeDeps, server: { port: 0, host: '127.0.0.1' } }));
      await server.listen();
      const { outcome } = await visit(browser, server.resolvedUrls.local[0]);
      await server.close();
      assert.deepEqual(outcome, expected);
    });
  }
});

import { cpSync } from 'node:fs';
import path from 'node:path';
import { after, before, describe, test } from 'node:test';
import assert from 'node:assert/strict';
import { launch, serve, visit } from './browser.mjs';
import { expected, inEnvironment, smallPage } from './environment.mjs';
import { project } from './installed.mjs';

const ANYBODY = { 'access-control-allow-origin': '*' };
/** What the README says a policy must allow. */
const policyFor = (cdn) =>
  `default-src 'self'; script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval' ${cdn}; connect-src ${cdn}; worker-src blob: ${cdn}; img-src data:`;

describe('a page without a bundler', () => {
  let browser;
  before(async () => (browser = await launch()));
  after(() => browser.close());

  /** Visits a page whose import map names the package in `vendor`: beside it, or on the origin of a CDN. */
  async function outcomeFrom(elsewhere, policy) {
    const { installed, remove: removeCdn } = project();
    const cdn = await serve(installed, { headers: ANYBODY });
    const from = elsewhere ? cdn.origin : './vendor';
    const map = JSON.stringify({ imports: { 'geose-fmap': `${from}/index.js` } });
    const files = smallPage();
    const html = `<!doctype html><script type="importmap">${map}</script>${files['index.html']}`;
    const { folder, remove } = project({ ...files, 'index.html': html });
    if (!elsewhere) cpSync(installed, path.join(folder, 'vendor'), { recursive: true });
    const { origin, close } = await serve(folder, { headers: policy ? { 'content-security-policy': policy(cdn.origin) } : {} });
    try {
      const { outcome } = await visit(browser, origin);
      return outcome.error ? outcome : { outcome };
    } finally {
      await Promise.all([close(), cdn.close()]);
      remove();
      removeCdn();
    }
  }

  inEnvironment('A page without a bundler', () => outcomeFrom(false));
  inEnvironment('A page with an import map to a CDN', () => outcomeFrom(true));

  test('may have a Content-Security-Policy that allows blob: workers and the CDN', async () => {
    assert.deepEqual(await outcomeFrom(true, policyFor), { outcome: await expected() });
  });

  test('says so where the policy does not allow them', async () => {
    const { error } = await outcomeFrom(true, (cdn) => policyFor(cdn).replace('blob: ', ''));
    assert.match(error, /^worker-unavailable: .*worker-src blob:/);
  });
});

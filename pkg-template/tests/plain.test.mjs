import assert from 'node:assert/strict';
import { cpSync } from 'node:fs';
import path from 'node:path';
import { after, before, describe, test } from 'node:test';
import { launch, page, serve, visit } from './browser.mjs';
import { matchScans, run } from './customer.mjs';
import { installedPackage, project } from './installed.mjs';
import { sample } from './samples.mjs';

const CSP = "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; img-src data:";

describe('a page without any bundler', () => {
  let browser, expected;
  before(async () => {
    expected = await run((await installedPackage()).Matcher);
    browser = await launch();
  });
  after(() => browser.close());

  /** Serves the page with the package in its folder `vendor`, visits it and clears up. */
  async function visited(options, { files, ...serving } = {}) {
    const { folder, installed, remove } = project({ ...page(options), ...files });
    cpSync(installed, path.join(folder, 'vendor'), { recursive: true });
    const { origin, close } = await serve(folder, serving);
    try {
      return { origin, ...(await visit(browser, origin)) };
    } finally {
      await close();
      remove();
    }
  }

  /** Visits a page that calls one of the customer's functions with two scans. */
  const visitedWith = (name, bytesA, bytesB) => {
    const main = `
      import { Matcher } from './vendor/index.js';
      import { ${name} } from './customer.mjs';
      const fetched = async (file) => new Uint8Array(await (await fetch(file)).arrayBuffer());
      window.outcome = await ${name}(Matcher, await fetched('a.ply'), await fetched('b.ply')).catch((error) => ({ error: String(error) }));
    `;
    return visited({}, { files: { 'main.js': main, 'a.ply': bytesA, 'b.ply': bytesB } });
  };

  test('expects a map, a cancelled call and a trapped one', () => {
    assert.equal(expected.cancelled, 'cancelled');
    assert.equal(expected.trapped, 'crashed');
    assert.ok(new Set(expected.targetOf).size > 100);
  });

  test('runs under a strict Content-Security-Policy, asks for nothing but its own files, and gives the bytes Node gives', async () => {
    const { outcome, requests, complaints, origin } = await visited(
      { from: './vendor/index.js' },
      { headers: { 'content-security-policy': CSP } },
    );
    assert.deepEqual(outcome, expected);
    assert.deepEqual(complaints, []);
    const asked = requests.filter((url) => !url.startsWith('data:'));
    assert.ok(asked.some((url) => url.endsWith('/vendor/geose_fmap_bg.wasm')));
    for (const url of asked) assert.equal(new URL(url).origin, origin);
  });

  test('gives for two bodies of 5000 points the bytes Node gives', async (t) => {
    const scans = [sample('woman-standing'), sample('man-lunging')];
    const inNode = await matchScans((await installedPackage()).Matcher, ...scans);
    const { outcome } = await visitedWith('matchScans', ...scans);
    assert.deepEqual(outcome.map, inNode.map, outcome.error);
    for (const [where, { seconds, memory }] of Object.entries({ Node: inNode, browser: outcome })) {
      t.diagnostic(`${where}: ${JSON.stringify(seconds)}, ${(memory / 2 ** 20).toFixed(1)} MiB`);
    }
  });

  test('settles within 300 ms when cancelled in the middle of any stage, and loses nothing', async (t) => {
    const { outcome } = await visitedWith('cancelEverywhere', sample('woman-standing'), sample('man-lunging'));
    assert.equal(outcome.error, undefined);
    t.diagnostic(JSON.stringify(outcome));
    assert.ok(Object.keys(outcome).length >= 6);
    for (const [stage, milliseconds] of Object.entries(outcome)) assert.ok(milliseconds < 300, `${stage}: ${milliseconds} ms`);
  });

  test('takes the wasm from a server that does not know its type', async () => {
    const { outcome } = await visited({ from: './vendor/index.js' }, { types: { '.wasm': 'application/octet-stream' } });
    assert.deepEqual(outcome, expected);
  });

  test('runs from another origin, a CDN, with one option', async () => {
    const { installed, remove } = project();
    const cdn = await serve(installed, { headers: { 'access-control-allow-origin': '*' } });
    const { outcome } = await visited({ from: `${cdn.origin}/index.js`, options: `{ worker: '${cdn.origin}/worker.js' }` });
    await cdn.close();
    remove();
    assert.deepEqual(outcome, expected);
  });

  test('says so when the worker is missing', async () => {
    const { outcome } = await visited({ from: './vendor/index.js', options: "{ worker: './nowhere.js' }" });
    assert.match(outcome.error, /^worker-unavailable: /);
  });

  test('says so when the wasm is missing', async () => {
    const { outcome } = await visited({ from: './vendor/index.js', options: "{ wasm: './nowhere.wasm' }" });
    assert.match(outcome.error, /^wasm-unavailable: .*404/);
  });
});

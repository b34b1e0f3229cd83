import assert from 'node:assert/strict';
import { cpSync } from 'node:fs';
import path from 'node:path';
import { after, before, describe, test } from 'node:test';
import { webgpu } from '../../scripts/chromium.mjs';
import { launch, page, serve, visit } from './browser.mjs';
import { run } from './customer.mjs';
import { installedPackage, project } from './installed.mjs';

/** Few points: a GPU in software is slow. */
const SMALL = { points: 250, eigenpairs: 30 };

describe('a page in a browser with WebGPU, in software', () => {
  let browser, expected;
  before(async () => {
    expected = await run((await installedPackage()).Matcher, { device: 'cpu' }, SMALL);
    browser = await launch(webgpu);
  });
  after(() => browser.close());

  /** The outcome of a page whose script is `main`. */
  async function outcomeOf(main) {
    const files = project({
      ...page(),
      'main.js': `import { Matcher } from './vendor/index.js';\nimport { run } from './customer.mjs';\n${main}`,
    });
    cpSync(files.installed, path.join(files.folder, 'vendor'), { recursive: true });
    const { origin, close } = await serve(files.folder);
    try {
      const { outcome, complaints } = await visit(browser, origin);
      assert.deepEqual(complaints, []);
      return outcome;
    } finally {
      await close();
      files.remove();
    }
  }

  test('refuses it by itself, as slower than the CPU, and takes it when asked', async () => {
    const [auto, insisted] = await outcomeOf(`
      const device = async (device) => {
        const matcher = await Matcher.create({ device });
        matcher.dispose();
        return matcher.device;
      };
      window.outcome = [await device('auto'), await device('webgpu')];
    `);
    assert.equal(auto.kind, 'cpu');
    assert.match(auto.reason, /software/);
    assert.equal(insisted.kind, 'webgpu');
    assert.ok(insisted.adapter.length > 0 && insisted.reason.length > 0, JSON.stringify(insisted));
  });

  test('finds the map of the CPU, also after a cancelled and a trapped call', async (t) => {
    const outcome = await outcomeOf(
      `const small = ${JSON.stringify(SMALL)};
      window.outcome = await run(Matcher, { device: 'webgpu' }, small).catch((error) => ({ error: String(error) }));`,
    );
    assert.equal(outcome.cancelled, 'cancelled', JSON.stringify(outcome.error));
    assert.equal(outcome.trapped, 'crashed');
    for (const way of ['targetOf', 'back']) {
      const same = outcome[way].filter((target, i) => target === expected[way][i]).length / expected[way].length;
      t.diagnostic(`${way}: ${(100 * same).toFixed(2)} % the same`);
      assert.ok(same >= 0.995, `${way}: ${same}`);
    }
  });

  test('goes on with the CPU when the GPU is lost on the way, and with another one after that', async () => {
    const told = await outcomeOf(`
      import { lump } from './bodies.mjs';
      const small = ${JSON.stringify(SMALL)};
      const matcher = await Matcher.create({ device: 'webgpu' });
      const lose = (stage) => matcher[Symbol.for('geose-fmap.lose')](stage);
      await lose('features');
      const a = await matcher.prepare(lump(), small);
      const b = await matcher.prepare(lump({ frequency: 7, bend: 0.3 }), small);
      await lose('refine');
      const lost = await matcher.match(a, b);
      const next = await matcher.match(a, b, { refine: 'none' });
      window.outcome = { shapes: [a.info.fallback, b.info.fallback], lost: lost.report, targetOf: [...lost.targetOf], next: next.report, device: matcher.device };
      matcher.dispose();
    `);
    assert.equal(told.shapes[0].stage, 'features');
    assert.match(told.shapes[0].reason, /lost/);
    assert.equal(told.shapes[1], null);
    assert.equal(told.lost.device, 'webgpu');
    assert.equal(told.lost.fallback.stage, 'refine');
    assert.deepEqual(told.targetOf, expected.targetOf);
    assert.equal(told.next.fallback, null);
    assert.ok(told.next.gpu.dispatches > 0);
    assert.equal(told.device.kind, 'webgpu');
    assert.match(told.device.reason, /anew/);
  });

  test('a trap while the GPU is waited for is a crash, and the calls behind it go on', async () => {
    const told = await outcomeOf(`
      import { lump } from './bodies.mjs';
      const matcher = await Matcher.create({ device: 'webgpu' });
      const error = await matcher[Symbol.for('geose-fmap.trap')](true).catch((error) => error);
      const a = await matcher.prepare(lump(), ${JSON.stringify(SMALL)});
      window.outcome = { code: error.code, device: matcher.device, fallback: a.info.fallback };
      matcher.dispose();
    `);
    assert.equal(told.code, 'crashed');
    assert.equal(told.device.kind, 'webgpu');
    assert.equal(told.fallback, null);
  });
});

import assert from 'node:assert/strict';
import { cpSync } from 'node:fs';
import path from 'node:path';
import { after, before, describe, test } from 'node:test';
import { webgpu } from '../../scripts/chromium.mjs';
import { launch, page, serve, visit } from './browser.mjs';
import { run } from './customer.mjs';
import { installedPackage, project } from './installed.mjs';

/** Few points: a GPU in software is slow. */
const SMALL = { points: 400, eigenpairs: 40 };

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
});

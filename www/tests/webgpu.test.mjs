// The page where there is WebGPU: Chromium's own, in software. Environment as in page.test.mjs.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { chromium } from 'playwright-core';
import { switches, webgpu } from '../../scripts/chromium.mjs';

const site = process.env.GEOSE_SITE_URL;
if (!site) throw new Error('GEOSE_SITE_URL is not set; see the top of page.test.mjs');

let browser;
let page;
const complaints = [];

before(async () => {
  browser = await chromium.launch({ executablePath: process.env.CHROME ?? '/usr/bin/chromium', args: [...switches, ...webgpu] });
  page = await browser.newPage();
  page.on('console', (message) => message.type() === 'error' && complaints.push(message.text()));
  page.on('pageerror', (error) => complaints.push(error.message));
  await page.goto(site);
});

after(() => browser?.close());

const note = (pattern) => page.locator('#device-note').filter({ hasText: pattern }).waitFor({ timeout: 60_000 });

const matched = async () => {
  await page.waitForFunction(() => ['matched', 'failed'].includes(window.geose.state()), null, { timeout: 240_000 });
  return page.evaluate(() => {
    const { targetOf, report } = window.geose.match;
    return { targetOf: [...targetOf], report };
  });
};

test('a GPU in software is not taken by itself, and the page says why', async () => {
  await note(/CPU\..*software/);
  assert.equal(await page.locator('#device').textContent(), 'Runs on the CPU');
});

test('the user switches to WebGPU and back, and both give one map', async (t) => {
  // Few points: a GPU in software is slow.
  await page.click('#section-options summary');
  await page.fill('#option-points', '600');
  await page.fill('#option-eigenpairs', '60');
  await page.click('#sample-pair');
  const onCpu = await matched();
  assert.equal(onCpu.report.device, 'cpu');
  assert.equal(onCpu.report.gpu.dispatches, 0);

  await page.selectOption('#device-choice', 'webgpu');
  await note(/WebGPU.*software/);
  await page.click('#match');
  const onGpu = await matched();
  assert.equal(onGpu.report.device, 'webgpu');
  assert.equal(onGpu.report.fallback, null);
  assert.ok(onGpu.report.gpu.dispatches > 100, JSON.stringify(onGpu.report.gpu));
  const same = onGpu.targetOf.filter((target, i) => target === onCpu.targetOf[i]).length / onGpu.targetOf.length;
  t.diagnostic(`${(100 * same).toFixed(2)} % of the points go to the same place; ${JSON.stringify(onGpu.report.gpu)}`);
  assert.ok(same >= 0.995, `only ${same} of the points go to the same place`);
  assert.match(await page.locator('#report').textContent(), /Matched on WebGPU\..*The GPU ran \d+ shaders/);

  await page.selectOption('#device-choice', 'cpu');
  await note(/CPU\. Asked for/);
  await page.click('#match');
  const again = await matched();
  assert.equal(again.report.device, 'cpu');
  assert.deepEqual(again.targetOf, onCpu.targetOf);
  assert.deepEqual(complaints, []);
});

test('without WebGPU the page says so and stays with the device it had', async () => {
  const bare = await chromium.launch({
    executablePath: process.env.CHROME ?? '/usr/bin/chromium',
    args: [...switches, '--disable-features=WebGPU,WebGPUService', '--disable-gpu'],
  });
  try {
    const tab = await bare.newPage();
    await tab.goto(site);
    await tab.locator('#device-note').filter({ hasText: /CPU\./ }).waitFor({ timeout: 60_000 });
    await tab.selectOption('#device-choice', 'webgpu');
    await tab
      .locator('#error-match')
      .filter({ hasText: /WebGPU cannot be used/ })
      .waitFor({ timeout: 60_000 });
    assert.equal(await tab.inputValue('#device-choice'), 'auto');
    await tab.locator('#device-note').filter({ hasText: /CPU\./ }).waitFor();
  } finally {
    await bare.close();
  }
});

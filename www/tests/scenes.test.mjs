// What comes with a body and is none: the floor that it stands on, and the files beside a glTF. Environment as in page.test.mjs.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { chromium } from 'playwright-core';
import { gltfOf, onFloor, thinned } from '../../pkg-template/tests/scenes.mjs';
import { switches } from '../../scripts/chromium.mjs';
import { readPly } from './read-exports.mjs';
import { drop, exported, matched, matchTimeout, samples, stageOf } from './visitor.mjs';

const site = process.env.GEOSE_SITE_URL;
if (!site) throw new Error('GEOSE_SITE_URL is not set; see the top of page.test.mjs');

/** What a point without a match is painted with, as sRGB bytes. */
const grey = '141,144,150';

let browser;
/** Points of the body, of which a floor was put under the feet, and of both. */
let body, scene;
const complaints = [];

before(async () => {
  browser = await chromium.launch({ executablePath: process.env.CHROME ?? '/usr/bin/chromium', args: switches });
  body = thinned(readPly(await readFile(join(samples, 'woman-standing.ply'))), 3);
  scene = onFloor(body);
});

after(() => browser?.close());

/** The page in a window of its own, for `work`. */
async function visit(options, work) {
  const context = await browser.newContext({ acceptDownloads: true, viewport: { width: 1440, height: 900 }, ...options });
  const page = await context.newPage();
  page.on('pageerror', (error) => complaints.push(String(error)));
  await page.goto(site);
  await page.waitForFunction(() => window.geose !== undefined);
  await work(page);
  await context.close();
}

/** A table of points, as a scanner's program saves it. */
const xyz = ({ positions }) => Buffer.from([...positions].map((value, i) => value.toFixed(5) + (i % 3 === 2 ? '\n' : ' ')).join(''));

const scenes = () => [{ name: 'on-a-floor.xyz', bytes: xyz(scene) }, 'man-standing.ply'];
const points = ({ positions }) => positions.length / 3;
const unmatchedOf = (page) => page.evaluate(() => [...window.geose.shapes[0].unmatched]);
const offers = (page, words) =>
  page
    .locator('#aside-a button')
    .filter({ hasText: words })
    .waitFor({ timeout: matchTimeout })
    .then(() => matched(page));

describe('a body on a floor', () => {
  test('stands on grey points that a notice tells of, and is taken with its floor and without it as the user likes', async () => {
    await visit({}, async (page) => {
      await drop(page, '#drop-a', scenes());
      await matched(page);
      const notice = page.locator('#aside-a');
      const unmatched = await unmatchedOf(page);
      const floor = points(scene) - points(body);
      assert.ok(unmatched.filter((point) => point >= points(body)).length > 0.9 * floor, `${unmatched.length} points`);
      const repairs = await page.evaluate(() => window.geose.shapes[0].repairs);
      const { message } = repairs.find(({ code }) => code === 'floor-set-aside');
      const told = notice.locator('[data-code="floor-set-aside"]');
      assert.equal((await told.textContent()).toLowerCase(), `${message.toLowerCase()}.`);
      assert.match(await notice.textContent(), new RegExp(`The ${unmatched.length} grey points have no match\\.`));
      assert.equal(await page.locator('#aside-b').innerText(), '', 'nothing was set aside of the other scan');
      assert.equal(await page.locator('#aside-b button').isVisible(), false);

      for (const mode of ['plain', 'eigenfunction', 'part', 'overlap', 'confidence', 'correspondence']) {
        await page.selectOption('#colour', mode);
        assert.match(await page.locator('#legend').textContent(), /grey/i, mode);
        const { colours } = readPly(await exported(page, '#export-a-ply'));
        const colourOf = (point) => colours.slice(3 * point, 3 * point + 3).join();
        assert.ok(
          unmatched.every((point) => colourOf(point) === grey),
          mode,
        );
        const ofBody = Array.from({ length: points(body) }, (_, point) => colourOf(point));
        assert.ok(ofBody.filter((colour) => colour === grey).length < 0.1 * points(body), `the body is grey, too (${mode})`);
      }
      const set = await page.locator('#legend').textContent();
      await page.fill('#point-a', String(unmatched.at(-1)));
      await page.press('#point-a', 'Enter');
      assert.match(await page.locator('#readout').textContent(), /was set aside as no part of the body, and has no match/);
      await page.fill('#point-a', '');
      await page.press('#point-a', 'Enter');

      // With keys alone; what was pressed stays under the finger.
      const before = await stageOf(page);
      await page.locator('#aside-a button').focus();
      await page.keyboard.press('Enter');
      await offers(page, 'Set it aside again');
      assert.equal(await page.evaluate(() => document.activeElement?.textContent), 'Set it aside again');
      assert.match(await notice.textContent(), /All of it is taken for the body/);
      assert.equal(await page.locator('#aside-a [data-code]').count(), 0);
      // Of what repairs and warnings there are, every sentence has its code beside it.
      const there = await page.evaluate(() => ({
        repairs: window.geose.shapes.flatMap((shape) => shape.repairs.map(({ code }) => code)),
        warnings: window.geose.match.report.warnings.map(({ code }) => code),
      }));
      assert.ok(there.repairs.length > 0 && there.warnings.length > 0);
      const codes = (selector) => page.locator(selector).evaluateAll((all) => all.map((each) => each.dataset.code));
      assert.deepEqual(await codes('#scan-facts .repairs li'), there.repairs);
      assert.deepEqual(await codes('#certainty .warnings li'), there.warnings);
      assert.ok((await unmatchedOf(page)).length <= 4, 'the corners of the floor are stray points');
      assert.ok(!before.equals(await stageOf(page)), 'the floor is no longer grey');
      const { a } = JSON.parse(await exported(page, '#export-json', 'utf8'));
      assert.deepEqual(a.prepared, { wholeScan: true });
      assert.ok(!a.repairs.some(({ code }) => code === 'floor-set-aside'));

      await page.locator('#aside-a button').focus();
      await page.keyboard.press('Space');
      await offers(page, 'Keep all of it');
      assert.deepEqual(await unmatchedOf(page), unmatched);
      assert.equal(await page.locator('#legend').textContent(), set);
      assert.deepEqual(JSON.parse(await exported(page, '#export-json', 'utf8')).a.repairs, repairs);
    });
  });

  test('is told of on a phone, where nothing is cut off and a tap keeps it; it goes along when A and B change places', async () => {
    await visit({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 }, async (page) => {
      await drop(page, '#drop-a', scenes().slice(0, 1));
      await page.tap('#aside-a button');
      await page.locator('#aside-a button').filter({ hasText: 'Set it aside again' }).waitFor({ timeout: matchTimeout });
      const { width, height } = await page.locator('#aside-a button').boundingBox();
      assert.ok(width >= 32 && height >= 32, `${width} × ${height}: too small for a finger`);
      assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390);
      await page.tap('#swap');
      assert.match(await page.locator('#aside-b').textContent(), /All of it is taken for the body/);
      assert.equal(await page.locator('#aside-a').innerText(), '');
    });
  });
});

describe('a glTF with its data in another file', () => {
  /** A sheet of 20 × 20 points, bent: enough for a scan. */
  const sheet = () => {
    const side = 20;
    const all = Array.from({ length: side * side }, (_, i) => i);
    const corners = all.filter((i) => i % side < side - 1 && i + side < all.length);
    return {
      positions: all.flatMap((i) => [i % side, Math.floor(i / side), 2 * Math.sin(i / 50)]),
      faces: corners.flatMap((i) => [i, i + 1, i + side + 1, i, i + side + 1, i + side]),
    };
  };
  const made = gltfOf(sheet(), { uri: 'scans/the%20body.bin' });
  const document = { name: 'body.gltf', bytes: made.document };
  const data = { name: 'the body.bin', bytes: made.data };
  const skin = { name: 'skin.png', bytes: Buffer.from('no picture') };

  const names = (page) => page.evaluate(() => window.geose.shapes.map((shape) => shape?.info.name ?? null));
  const shown = (page, side) => page.waitForFunction((at) => window.geose.shapes[at] !== null, side, { timeout: matchTimeout });

  test('is one scan when the two are dropped together, whatever pictures come along', async () => {
    await visit({}, async (page) => {
      await drop(page, 'html', [skin, data, document]);
      await shown(page, 0);
      assert.deepEqual(await names(page), ['body.gltf', null]);
      assert.equal(await page.evaluate(() => window.geose.shapes[0].info.points), 400);
      assert.equal(await page.locator('#remark p').count(), 0);
      await drop(page, '#view-b', [
        { ...document, name: 'Another.GLTF' },
        { ...data, name: 'The Body.bin' },
      ]);
      await shown(page, 1);
      assert.deepEqual(await names(page), ['body.gltf', 'Another.GLTF']);
    });
  });

  test('fills one side and a third file the other', async () => {
    await visit({}, async (page) => {
      await drop(page, '#drop-b', ['man-standing.ply', document, data]);
      await Promise.all([shown(page, 0), shown(page, 1)]);
      assert.deepEqual(await names(page), ['body.gltf', 'man-standing.ply']);
    });
  });

  test('names what is missing when it comes alone, and so does the data', async () => {
    await visit({}, async (page) => {
      await drop(page, '#drop-a', [document]);
      const trouble = page.locator('#error-a p');
      await trouble.waitFor({ timeout: matchTimeout });
      assert.match(await trouble.textContent(), /another file, “scans\/the body\.bin”/);
      await drop(page, '#drop-a', [data]);
      const remark = page.locator('#remark p');
      await remark.waitFor();
      assert.equal(await remark.textContent(), 'the body.bin holds the data of a .gltf file that is not here: drop the two together.');
      assert.deepEqual(await names(page), [null, null]);
      await drop(page, '#drop-a', ['man-standing.ply', data]);
      await shown(page, 0);
      assert.deepEqual(await names(page), ['man-standing.ply', null]);
      assert.match(await remark.textContent(), /^the body\.bin holds the data/);
    });
  });
});

test('nothing complained', () => assert.deepEqual(complaints, []));

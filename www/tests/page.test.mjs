// The page as a visitor meets it, in a real Chromium. Environment:
//   GEOSE_SITE_URL  address at which dist/site is served
//   GEOSE_NATIVE    the native binary, to hold the page's map against
//   CHROME          the browser, default /usr/bin/chromium
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { mkdtemp, readFile, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';
import { chromium } from 'playwright-core';
import { meanError, surfaceOf } from './mean-error.mjs';

const site = required('GEOSE_SITE_URL');
const native = required('GEOSE_NATIVE');
const samples = fileURLToPath(new URL('../public/samples/', import.meta.url));
const pair = ['woman-standing.ply', 'man-lunging.ply'];
/** Long enough for a match on two busy cores. */
const matchTimeout = 120_000;

const flags = [
  '--disable-quic --no-first-run --disable-background-networking --disable-component-update --disable-sync',
  '--use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader',
];

let browser;
/** A page on which the pair has been matched; each test leaves it so. */
let page;
let folder;
const requested = new Set();
const complaints = [];

before(async () => {
  browser = await chromium.launch({
    executablePath: process.env.CHROME ?? '/usr/bin/chromium',
    args: flags.join(' ').split(' '),
    chromiumSandbox: false,
  });
  folder = await mkdtemp(join(tmpdir(), 'geose-page-'));
  page = await open({ viewport: { width: 1440, height: 900 } });
  await drop(page, '#drop-a', pair);
  await matched(page);
});

after(async () => {
  await browser?.close();
  if (folder) await rm(folder, { recursive: true });
});

test('two files dropped at once are matched as the native program matches them', async (t) => {
  const { names, targetOf, positions, faces } = await page.evaluate(() => {
    const { match, shapes } = window.geose;
    const { positions, faces } = shapes[1].geometry();
    return {
      names: shapes.map(({ info }) => info.name),
      targetOf: [...match.targetOf],
      positions: [...positions],
      faces: [...faces],
    };
  });
  assert.deepEqual(names, pair);
  const file = join(folder, 'native.csv');
  await promisify(execFile)(native, ['match', ...pair.map((name) => join(samples, name)), '-o', file]);
  const nativeTargets = parseCsv(await readFile(file, 'utf8')).map(({ target }) => target);
  assert.equal(targetOf.length, nativeTargets.length);
  const matchedShare = targetOf.filter((target) => target !== unmatched).length / targetOf.length;
  assert.ok(matchedShare > 0.95, `only ${matchedShare} of the points are matched`);
  const same = targetOf.filter((target, i) => target === nativeTargets[i]).length / targetOf.length;
  t.diagnostic(`${(100 * same).toFixed(2)} % of the points go where the native program sends them`);
  assert.ok(same >= 0.995, `only ${same} of the points go where the native program sends them`);

  const surface = surfaceOf(positions, faces);
  const ofPage = meanError(surface, targetOf);
  const ofNative = meanError(surface, nativeTargets);
  assert.ok(Number.isFinite(ofPage) && Math.abs(ofPage - ofNative) < 0.01, `page ${ofPage}, native ${ofNative}`);
});

test('pointing at a body shows the line to its match and says which point it is', async () => {
  await page.mouse.move(...(await centre(page, '#view-a', 0.5, 0.4)));
  await page.locator('#line line.tie.shown').waitFor();
  const [i, j] = await Promise.all([page.inputValue('#point-a'), page.inputValue('#point-b')]);
  assert.equal(await page.evaluate((index) => window.geose.match.targetOf[index], Number(i)), Number(j));
  assert.match(await page.locator('#readout').textContent(), new RegExp(`Point ${i} of A is point ${j} of B; confidence [01]\\.\\d\\d`));
  await page.mouse.move(2, 2);
  await page.locator('#line line.tie.shown').waitFor({ state: 'hidden' });
});

test('a point can be found with the keyboard alone', async () => {
  await page.locator('#reset-views').focus();
  await page.locator('#view-a').focus();
  await page.keyboard.press('Enter');
  const first = await page.inputValue('#point-a');
  assert.notEqual(first, '');
  await page.keyboard.press('ArrowUp');
  await page.keyboard.press('ArrowUp');
  assert.notEqual(await page.inputValue('#point-a'), first);
  await page.locator('#line line.tie.shown').waitFor();
  assert.match(await page.locator('#readout-live').textContent(), /^Point \d+ of A is point \d+ of B/);

  const before = await stageOf(page);
  await page.keyboard.press('Shift+ArrowLeft');
  assert.ok(!before.equals(await stageOf(page)), 'shift and an arrow turn the body');
  await page.keyboard.press('0');
  await page.keyboard.press('Escape');
  assert.equal(await page.inputValue('#point-a'), '');

  await page.locator('#point-b').focus();
  await page.keyboard.type('1234');
  await page.keyboard.press('Enter');
  assert.match(await page.locator('#readout').textContent(), /^Point 1234 of B/);
  await page.locator('#point-b').fill('');
  await page.keyboard.press('Enter');
});

test('every colour mode has its own picture and a legend', async () => {
  const seen = [];
  for (const mode of ['plain', 'eigenfunction', 'part', 'confidence', 'correspondence']) {
    await page.selectOption('#colour', mode);
    if (mode !== 'plain') assert.notEqual((await page.locator('#legend').textContent()).trim(), '', mode);
    const stage = await stageOf(page);
    assert.ok(
      seen.every((other) => !other.equals(stage)),
      `${mode} looks like another mode`,
    );
    seen.push(stage);
  }
  await page.selectOption('#colour', 'eigenfunction');
  await page.fill('#eigen', '2');
  const second = await stageOf(page);
  await page.fill('#eigen', '7');
  assert.ok(!second.equals(await stageOf(page)), 'eigenfunctions 2 and 7 look alike');
  await page.selectOption('#colour', 'correspondence');
});

test('what is exported is the map on show', async () => {
  const { targetOf, confidence } = await mapOf(page);
  const fromCsv = parseCsv(await exported(page, '#export-csv', 'utf8'));
  assert.deepEqual(
    fromCsv.map(({ source }) => source),
    targetOf.map((_, i) => i),
  );
  assert.deepEqual(
    fromCsv.map(({ target }) => target),
    targetOf,
  );
  assert.deepEqual(
    fromCsv.map((row) => Math.fround(row.confidence)),
    confidence,
  );

  const { a, b, map } = JSON.parse(await exported(page, '#export-json', 'utf8'));
  assert.deepEqual([a.name, b.name], pair);
  assert.deepEqual(
    map.map(({ target }) => target ?? unmatched),
    targetOf,
  );

  const picture = await exported(page, '#export-png');
  assert.deepEqual([...picture.subarray(0, 8)], [0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
});

test('a file that is no scan is told in a sentence, and the scans and the result stay', async () => {
  const before = await mapOf(page);
  await drop(page, '#drop-a', [{ name: 'holiday.txt', bytes: Buffer.from('We had a lovely time at the sea.\n'.repeat(40)) }]);
  const message = page.locator('#error-a p');
  await message.waitFor({ timeout: matchTimeout });
  assert.match(await message.textContent(), /\w+ .*\w+/);
  assert.equal(await page.locator('#error-b').isVisible(), false);
  assert.deepEqual(await mapOf(page), before);
  assert.deepEqual(await page.evaluate(() => window.geose.shapes.map(({ info }) => info.name)), pair);
  await page.click('#error-a button');
  assert.equal(await page.locator('#error-a').isVisible(), false);
});

test('a match can be cancelled and done again', async () => {
  const before = await mapOf(page);
  await page.click('#match');
  await page.waitForFunction(() => window.geose.state() === 'working');
  const started = performance.now();
  await page.click('#cancel');
  await page.waitForFunction(() => window.geose.state() === 'cancelled');
  assert.ok(performance.now() - started < 2000, 'cancelling is felt at once');
  assert.deepEqual(await mapOf(page), before);
  await page.click('#match');
  await matched(page);
  assert.deepEqual(await mapOf(page), before);
});

test('a landmark given by hand goes into the next match, and swapping turns everything round', async () => {
  await page.fill('#point-a', '100');
  await page.press('#point-a', 'Enter');
  await page.click('#add-landmark');
  await page.fill('#point-b', '100');
  await page.press('#point-b', 'Enter');
  assert.match(await page.locator('#landmarks').textContent(), /A 100 is B 100/);
  await page.click('#match');
  await matched(page);
  await page.click('#landmarks button');

  const { targetOf, reverse } = await mapOf(page);
  await page.click('#swap');
  const swapped = await mapOf(page);
  assert.deepEqual(swapped.targetOf, reverse);
  assert.deepEqual(swapped.reverse, targetOf);
  await page.click('#swap');
  await page.click('#match');
  await matched(page);
});

test('it goes on working when the network is gone, a cancelled match included', async () => {
  await page.context().setOffline(true);
  try {
    await page.click('#match');
    await page.waitForFunction(() => window.geose.state() === 'working');
    await page.click('#cancel');
    await page.click('#match');
    await matched(page);
  } finally {
    await page.context().setOffline(false);
  }
});

test('on a phone nothing is cut off, and a tap finds a point', async () => {
  const phone = await open({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 });
  await phone.tap('#sample-pair');
  await matched(phone);
  const width = await phone.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(width <= 390, `${width} pixels wide`);
  await phone.locator('#view-a').scrollIntoViewIfNeeded();
  await phone.touchscreen.tap(...(await centre(phone, '#view-a', 0.5, 0.4)));
  await phone.locator('#line line.tie.shown').waitFor();
  await phone.context().close();
});

test('nothing was fetched from elsewhere, and nothing complained', () => {
  const { origin } = new URL(site);
  const elsewhere = [...requested].filter((address) => !/^(blob|data):/.test(address) && new URL(address).origin !== origin);
  assert.deepEqual(elsewhere, []);
  assert.ok(requested.size > 3);
  assert.deepEqual(complaints, []);
});

async function open(options) {
  const context = await browser.newContext({ acceptDownloads: true, ...options });
  context.on('request', (request) => requested.add(request.url()));
  const opened = await context.newPage();
  opened.on('pageerror', (error) => complaints.push(String(error)));
  await opened.goto(site);
  await opened.waitForFunction(() => window.geose !== undefined);
  return opened;
}

const matched = (on) => on.waitForFunction(() => window.geose.state() === 'matched', null, { timeout: matchTimeout });

/** A real drop event with real files: names among the samples, or name and bytes. */
async function drop(on, selector, files) {
  const given = await Promise.all(
    files.map(async (file) => {
      const { name, bytes } = typeof file === 'string' ? { name: file, bytes: await readFile(join(samples, file)) } : file;
      return { name, base64: bytes.toString('base64') };
    }),
  );
  const transfer = await on.evaluateHandle((list) => {
    const data = new DataTransfer();
    for (const { name, base64 } of list) {
      data.items.add(new File([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], name));
    }
    return data;
  }, given);
  for (const type of ['dragenter', 'dragover', 'drop']) await on.dispatchEvent(selector, type, { dataTransfer: transfer });
}

const mapOf = (on) =>
  on.evaluate(() => {
    const { targetOf, confidence, reverse } = window.geose.match;
    return { targetOf: [...targetOf], confidence: [...confidence], reverse: [...reverse.targetOf] };
  });

/** A pixel of an element, by shares of its width and height. */
async function centre(on, selector, across, down) {
  const { x, y, width, height } = await on.locator(selector).boundingBox();
  return [x + across * width, y + down * height];
}

/** The pixels of both views once what was asked for is drawn. */
async function stageOf(on) {
  await on.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  return on.locator('#stage').screenshot();
}

async function exported(on, button, encoding) {
  const [download] = await Promise.all([on.waitForEvent('download'), on.click(button)]);
  return readFile(await download.path(), encoding);
}

const unmatched = 0xffffffff;

function parseCsv(text) {
  const [header, ...lines] = text.trimEnd().split(/\r?\n/);
  assert.equal(header, 'source,target,confidence');
  return lines.map((line) => {
    const [source, target, confidence] = line.split(',');
    return { source: Number(source), target: target === '' ? unmatched : Number(target), confidence: Number(confidence) };
  });
}

function required(name) {
  const value = process.env[name];
  if (!value) throw new Error(`${name} is not set; see the top of this file`);
  return value;
}

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
import { promisify } from 'node:util';
import { chromium } from 'playwright-core';
import { ringPly } from './large-scan.mjs';
import { meanError, surfaceOf } from './mean-error.mjs';
import { readGlb, readPly } from './read-exports.mjs';
import { drop, exported, matched, matchTimeout, samples, stageOf } from './visitor.mjs';

const site = required('GEOSE_SITE_URL');
const native = required('GEOSE_NATIVE');
const pair = ['woman-standing.ply', 'man-lunging.ply'];

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
  await promisify(execFile)(native, ['match', '--device', 'cpu', ...pair.map((name) => join(samples, name)), '-o', file]);
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
  for (const mode of ['plain', 'eigenfunction', 'part', 'overlap', 'confidence', 'correspondence']) {
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

test('a scan that is cancelled or broken leaves no trace in the next match', async () => {
  const before = await mapOf(page);
  const status = page.locator('#status');
  // A match ended by a new scan, and that one cancelled.
  await page.click('#match');
  await page.waitForFunction(() => window.geose.state() === 'working');
  await page.selectOption('#sample-a', 'woman-striding.ply');
  await page.click('#cancel');
  await page.waitForFunction(() => window.geose.state() === 'cancelled');
  await page.click('#match');
  await matched(page);
  assert.match(await status.textContent(), /points of A have their point on B/);
  assert.deepEqual(await mapOf(page), before);
  // One good and one bad at once: nothing is matched, and then what is there is.
  await drop(page, '#drop-a', ['woman-striding.ply', { name: 'broken.ply', bytes: Buffer.from('ply\nformat ascii 1.0\n') }]);
  await page.locator('#error-b p').waitFor({ timeout: matchTimeout });
  await page.waitForFunction(() => window.geose.state() === 'failed');
  await page.click('#match');
  await matched(page);
  assert.match(await status.textContent(), /points of A have their point on B/);
  await drop(page, '#drop-a', pair);
  await matched(page);
  assert.deepEqual(await mapOf(page), before);
});

test('parts that came with the scans are coloured and named', async () => {
  await page.selectOption('#colour', 'part');
  const names = await page.locator('#legend li').allTextContents();
  assert.deepEqual(names, await page.evaluate(() => window.geose.shapes[0].parts.names));
  assert.equal(names.length, 14);
  const swatches = await page.locator('#legend .swatch').evaluateAll((all) => all.map((each) => each.style.background));
  assert.equal(new Set(swatches).size, 14, 'two parts share a colour');
  assert.match(await page.locator('#legend').textContent(), /A: given with the scan\. B: given with the scan\./);
  await page.selectOption('#colour', 'correspondence');
});

test('parts that the network predicts are coloured, named and said to be so, and how sure it is of a point', async () => {
  const other = await open({ viewport: { width: 1440, height: 900 } });
  await drop(other, '#drop-a', ['woman-greeting-cloud.ply', pair[1]]);
  await matched(other);
  await other.selectOption('#colour', 'part');
  const lists = await other.locator('#legend ul').evaluateAll((all) => all.map((list) => [...list.children].map((li) => li.textContent)));
  const parts = await other.evaluate(() => window.geose.shapes.map(({ parts: { names, source } }) => ({ names, source })));
  assert.deepEqual(
    parts.map(({ source }) => source),
    ['predicted', 'given'],
  );
  assert.deepEqual(
    lists,
    parts.map(({ names }) => names),
  );
  assert.ok(lists[0].includes('left hand') && lists[0].includes('right hand'), lists[0].join());
  const words = await other.locator('#legend .facts').allTextContents();
  assert.deepEqual(words, ['A: predicted by the network.', 'B: given with the scan.']);
  const swatches = await other.locator('#legend ul:first-child .swatch').evaluateAll((all) => all.map((each) => each.style.background));
  assert.equal(new Set(swatches).size, 14, 'two parts share a colour');

  const { name, sure } = await other.evaluate(() => {
    const { labels, names, probabilities } = window.geose.shapes[0].parts;
    return { name: names[labels[700]], sure: probabilities[700 * names.length + labels[700]] };
  });
  const readout = other.locator('#readout');
  await other.fill('#point-a', '700');
  await other.press('#point-a', 'Enter');
  const told = (await readout.textContent()).toLowerCase();
  assert.ok(told.endsWith(`${name}, says the network, at ${sure.toFixed(2)}.`), told);
  await other.fill('#point-b', '700');
  await other.press('#point-b', 'Enter');
  assert.match(await readout.textContent(), /Part \d+, as given\.$/);
  await other.selectOption('#colour', 'correspondence');
  assert.doesNotMatch(await readout.textContent(), /as given/);
  await other.context().close();
});

test('which weights took part is in the report and the export, what they were made from on the page', async () => {
  const weights = await page.evaluate(() => window.geose.match.report.weights);
  assert.ok((await page.locator('#report').textContent()).includes(`Weights ${weights.name}, version ${weights.version}.`));
  const { match } = JSON.parse(await exported(page, '#export-json', 'utf8'));
  assert.deepEqual([match.weights, match.parts], [weights, 'predicted']);
  assert.match(await page.locator('footer').textContent(), /weights were trained on bodies made from MakeHuman data \(CC0\)/);
});

test('how sure the match is stands in sentences, its warnings with it', async () => {
  const { targetOf, confidence } = await mapOf(page);
  const matched = targetOf.flatMap((target, i) => (target === unmatched ? [] : [i]));
  const doubted = matched.filter((i) => confidence[i] < 0.5).length / matched.length;
  const text = await page.locator('#certainty').textContent();
  const told = /([\d.]+) % of them are below 0\.5 confidence|None of them is below/.exec(text);
  assert.ok(told && Math.abs(Number(told[1] ?? 0) - 100 * doubted) <= (doubted < 0.1 ? 0.051 : 0.51), `${text} (${doubted})`);
  assert.match(text, /Taken to B and back, half of A’s points end .* where they began/);
  const warnings = await page.evaluate(() => window.geose.match.report.warnings);
  const shown = await page.locator('#certainty .warnings li').allTextContents();
  assert.deepEqual(
    shown.map((each) => each.toLowerCase().replace(/\.$/, '')),
    warnings.map(({ message }) => message.toLowerCase().replace(/\.$/, '')),
  );
});

test('a bust, a body without legs and one view of a depth camera are matched as what they are', async (t) => {
  for (const piece of ['woman-bust', 'man-without-legs', 'man-one-view-cloud']) {
    const other = await open();
    try {
      await drop(other, '#drop-a', [`${piece}.ply`, 'woman-standing.ply']);
      await matched(other);
      const { targetOf, overlap, positions, extents } = await other.evaluate(() => {
        const { match, shapes } = window.geose;
        const positions = [...shapes[1].geometry().positions];
        const extents = shapes.map(({ extent }) => extent);
        return { targetOf: [...match.targetOf], overlap: [...match.reverse.overlap], positions, extents };
      });
      assert.match(extents[0] ?? '', /^\d+ % of a body: head/, piece);
      assert.equal(extents[1] ?? null, null, 'she is whole');
      assert.match(await other.locator('#scan-facts').textContent(), new RegExp(extents[0]));
      const { vertices } = JSON.parse(await readFile(join(samples, `${piece}.truth.json`), 'utf8'));
      assert.equal(targetOf.length, vertices.length);
      const place = (i) => positions.slice(3 * i, 3 * i + 3);
      const apart = targetOf.flatMap((target, i) => {
        if (target === unmatched) return [];
        const [p, q] = [place(target), place(vertices[i])];
        return [Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2])];
      });
      assert.ok(apart.length > 0.9 * vertices.length, `${piece}: ${apart.length} of ${vertices.length} are matched`);
      const mean = apart.reduce((sum, each) => sum + each, 0) / apart.length;
      t.diagnostic(`${piece}: ${extents[0]}; ${(100 * mean).toFixed(1)} cm off`);
      assert.ok(mean < 0.06, `${piece} is ${mean} m off`);
      // What the piece lacks has no partner on it.
      const there = new Set(vertices);
      const [lacking, present] = [false, true].map((wanted) => overlap.filter((_, i) => there.has(i) === wanted));
      const share = (of) => of.filter((each) => each < 0.5).length / of.length;
      t.diagnostic(
        `${(100 * share(lacking)).toFixed(0)} % of what it lacks has no partner, ${(100 * share(present)).toFixed(0)} % of the rest`,
      );
      assert.ok(share(lacking) > 0.5 && share(present) < share(lacking) - 0.3, `${piece}: ${share(lacking)} and ${share(present)}`);
      await other.selectOption('#colour', 'overlap');
      assert.match(await other.locator('#legend').textContent(), /has a partner/);
    } finally {
      await other.context().close();
    }
  }
});

test('the bodies are exported with the colours on show, in their own order, place and unit', async () => {
  const { targetOf } = await mapOf(page);
  const a = readPly(await exported(page, '#export-a-ply'));
  const b = readPly(await exported(page, '#export-b-ply'));
  const sample = readPly(await readFile(join(samples, pair[0])));
  assert.deepEqual(a.positions, sample.positions);
  assert.equal(a.faces, sample.faces);
  const colourOf = (body, i) => body.colours.slice(3 * i, 3 * i + 3).join();
  assert.ok(new Set(targetOf.map((_, i) => colourOf(a, i))).size > 1000, 'one colour for all');
  for (const [i, j] of targetOf.entries()) if (j !== unmatched) assert.equal(colourOf(a, i), colourOf(b, j), `point ${i} of A, ${j} of B`);

  const glb = readGlb(await exported(page, '#export-b-glb'));
  const [{ attributes, indices }] = glb.meshes[0].primitives;
  assert.equal(glb.accessors[attributes.POSITION].count, b.positions.length / 3);
  assert.equal(glb.accessors[attributes.COLOR_0].count, b.positions.length / 3);
  assert.equal(glb.accessors[indices].count, 3 * b.faces);
  assert.equal(glb.nodes[0].name, pair[1]);
});

test('numbers out of range are refused beside their field, and the choices go into the next match and back', async () => {
  const before = await mapOf(page);
  await page.locator('#section-options summary').click();
  await page.fill('#option-eigenpairs', '5');
  assert.match(await page.locator('#refusal-eigenpairs').textContent(), /from 10 to 1,000; 120 stays in force/);
  assert.equal(await page.getAttribute('#option-eigenpairs', 'aria-invalid'), 'true');
  await page.press('#option-eigenpairs', 'Enter');
  assert.equal(await page.locator('#options-note').textContent(), '', 'a refused number changes nothing');
  await page.fill('#option-eigenpairs', '60');
  await page.press('#option-eigenpairs', 'Enter');
  assert.equal(await page.locator('#refusal-eigenpairs').isVisible(), false);
  assert.match(await page.locator('#options-note').textContent(), /A and B will be prepared anew/);
  await page.selectOption('#options [name=parts]', 'given');
  await page.click('#match');
  await matched(page);
  const { a, b, match } = JSON.parse(await exported(page, '#export-json', 'utf8'));
  assert.deepEqual([a.prepared, b.prepared, match.parts], [{ eigenpairs: 60 }, { eigenpairs: 60 }, 'given']);
  assert.deepEqual(await page.evaluate(() => window.geose.shapes.map(({ info }) => info.eigenpairs)), [60, 60]);
  assert.equal(await page.locator('#options-note').textContent(), '');

  await page.fill('#option-points', '12');
  await page.locator('#options button[type=reset]').click();
  assert.equal(await page.locator('#refusal-points').isVisible(), false);
  assert.equal(await page.inputValue('#option-eigenpairs'), '');
  await page.click('#match');
  await matched(page);
  assert.deepEqual(await mapOf(page), before);
  await page.locator('#section-options summary').click();
});

test('landmarks are made by clicking pairs, by keys and by numbers, and the next match keeps to them', async () => {
  const markers = (side) => page.locator(`#line .marker.shown[data-side=${side}] text`).allTextContents();
  await page.click('#add-landmark');
  await page.mouse.click(...(await centre(page, '#view-a', 0.5, 0.4)));
  assert.match(await page.locator('#pairing-words').textContent(), /^Landmark 1: point \d+ of A; now the same place on B/);
  assert.deepEqual([await markers('a'), await markers('b')], [['1'], []]);
  await page.mouse.click(...(await centre(page, '#view-b', 0.52, 0.4)));
  assert.deepEqual([await markers('a'), await markers('b')], [['1'], ['1']]);
  assert.match(await page.locator('#landmarks li').textContent(), /A \d+ is B \d+/);

  await page.fill('#point-b', '2000');
  await page.press('#point-b', 'Enter');
  await page.fill('#point-a', '100');
  await page.press('#point-a', 'Enter');
  assert.match(await page.locator('#landmarks').textContent(), /A 100 is B 2000/);

  await page.locator('#view-a').focus();
  await page.keyboard.press('ArrowUp');
  await page.keyboard.press('ArrowUp');
  assert.equal(await page.locator('#landmarks li').count(), 2, 'walking chooses nothing');
  await page.keyboard.press('Enter');
  await page.keyboard.press('Tab');
  await page.keyboard.press('ArrowLeft');
  await page.keyboard.press('Enter');
  assert.equal(await page.locator('#landmarks li').count(), 3);
  assert.deepEqual(
    [(await markers('a')).sort(), (await markers('b')).sort()],
    [
      ['1', '2', '3'],
      ['1', '2', '3'],
    ],
  );
  const fills = await page
    .locator('#line .marker')
    .evaluateAll((all) => all.map((each) => each.querySelector('circle').getAttribute('fill')));
  assert.equal(new Set(fills).size, 3, 'both ends of a landmark have one colour');
  await page.keyboard.press('Escape');
  assert.equal(await page.locator('#pairing.shown').count(), 0);

  await page.locator('#landmarks button').last().click();
  assert.equal(await page.locator('#landmarks li').count(), 2);
  await page.click('#match');
  await matched(page);
  const { match } = JSON.parse(await exported(page, '#export-json', 'utf8'));
  assert.equal(match.landmarks.length, 2);
  assert.deepEqual(match.landmarks[1], [100, 2000]);
  const warned = async (words) => (await page.locator('#certainty .warnings').textContent()).includes(words);
  assert.ok(await warned('point 100 of A with point 2000 of B'));
  await page.click('#swap');
  assert.ok(await warned('point 100 of B with point 2000 of A'), 'a swap turns the warnings too');
  await page.click('#swap');
  for (let left = 2; left > 0; left--) await page.locator('#landmarks button').first().click();
});

test('swapping turns everything round', async () => {
  const { targetOf, reverse } = await mapOf(page);
  await page.click('#swap');
  const swapped = await mapOf(page);
  assert.deepEqual(swapped.targetOf, reverse);
  assert.deepEqual(swapped.reverse, targetOf);
  await page.click('#swap');
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

test('drops that are too many, known already or come while it works are told in a sentence', async () => {
  const other = await open({ viewport: { width: 1440, height: 900 } });
  const remark = () => other.locator('#remark p').textContent();
  await drop(other, '#view-b', []);
  assert.match(await remark(), /no file/);
  await drop(other, '#drop-a', [...pair, 'man-standing.ply']);
  assert.equal(await remark(), `A match takes two scans: ${pair[0]} and ${pair[1]} were taken, man-standing.ply was left out.`);
  await drop(other, '#drop-a', [pair[0]]);
  assert.equal(await remark(), `${pair[0]} is scan A already.`);
  await other.waitForFunction(() => document.querySelector('#step-match').dataset.status === 'running', null, { timeout: matchTimeout });
  await drop(other, '#drop-b', ['man-standing.ply']);
  assert.equal(await remark(), 'The match under way was stopped; it begins anew with man-standing.ply.');
  await matched(other);
  assert.deepEqual(await other.evaluate(() => window.geose.shapes.map(({ info }) => info.name)), [pair[0], 'man-standing.ply']);
  await drop(other, '#drop-b', ['man-standing.ply']);
  assert.equal(await remark(), 'man-standing.ply is scan B already.');
  assert.equal(await other.evaluate(() => window.geose.state()), 'matched', 'nothing was done anew');
  await other.click('#remark button');
  await drop(other, '#drop-b', [pair[0]]);
  assert.match(await remark(), /^Both scans are the same file/);
  await other.context().close();
});

test('what was repaired is folded away under its number, and what needs given labels is greyed with a reason', async () => {
  const other = await open({ viewport: { width: 1440, height: 900 } });
  const side = 12;
  const grid = Array.from({ length: side * side }, (_, i) => `v ${i % side} ${Math.floor(i / side)} ${Math.sin(i)}`);
  const squares = grid.flatMap((_, i) => {
    const corner = i + 1;
    return i % side < side - 1 && corner + side < grid.length ? [`f ${corner} ${corner + 1} ${corner + side + 1} ${corner + side}`] : [];
  });
  await drop(other, '#drop-a', [{ name: 'grid.obj', bytes: Buffer.from([...grid, ...squares, 'f 1 1 2', ''].join('\n')) }]);
  await other.waitForFunction(() => window.geose.shapes[0] !== null, null, { timeout: matchTimeout });
  const messages = await other.evaluate(() => window.geose.shapes[0].repairs.map(({ message }) => message));
  assert.ok(messages.length > 0);
  assert.equal(await other.locator('#repairs-a ul').isVisible(), false);
  assert.match(await other.locator('#repairs-a summary').textContent(), new RegExp(`^A: ${messages.length} repair`));
  await other.locator('#repairs-a summary').click();
  const shown = await other.locator('#repairs-a li').allTextContents();
  messages.forEach((message, k) => assert.ok(shown[k].toLowerCase().startsWith(message.toLowerCase()), shown[k]));
  for (const fact of ['Points144', 'Pieces1', 'Laplaciancotangent']) {
    assert.ok((await other.locator('#scan-facts tr').allTextContents()).includes(fact), fact);
  }

  await other.locator('#section-options summary').click();
  assert.equal(await other.inputValue('#options [name=parts]'), 'predicted');
  assert.equal(await other.locator('#parts-given').isDisabled(), true);
  assert.match(await other.locator('#parts-note').textContent(), /^A came without labels/);

  await other.selectOption('#sample-b', 'woman-standing.ply');
  await other.waitForFunction(() => window.geose.shapes[1] !== null, null, { timeout: matchTimeout });
  await other.selectOption('#colour', 'part');
  const names = await other.locator('#legend li').allTextContents();
  assert.ok(names.includes('left hand') && names.includes('right hand'), names.join());
  assert.equal(names.length, 14, 'parts of equal names share colours');
  assert.match(await other.locator('#legend').textContent(), /A: predicted by the network\. B: given with the scan\./);
  for (const [side, source] of Object.entries({ a: 'predicted', b: 'given' })) {
    assert.ok((await other.locator('#scan-facts td').allTextContents()).includes(source), `${side}: ${source}`);
  }
  await other.context().close();
});

for (const kind of ['mesh', 'cloud']) {
  test(`pointing at a ${kind} of 200 000 points keeps up with the mouse`, async (t) => {
    const other = await open({ viewport: { width: 1440, height: 900 } });
    await drop(other, '#drop-a', [{ name: `ring-${kind}.ply`, bytes: ringPly(450, 450, kind === 'mesh') }]);
    await other.waitForFunction(() => window.geose.shapes[0] !== null, null, { timeout: 2 * matchTimeout });
    await other.evaluate(() => {
      window.waits = [];
      const frame = window.requestAnimationFrame.bind(window);
      window.requestAnimationFrame = (call) =>
        frame((now) => {
          const started = performance.now();
          call(now);
          window.waits.push(performance.now() - started);
        });
    });
    const picked = [];
    for (let k = 0; k < 30; k++) {
      await other.evaluate(() => (window.waits.length = 0));
      await other.mouse.move(...(await centre(other, '#view-a', 0.2 + 0.02 * k, 0.3)));
      await other.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
      const [index, waits] = [await other.inputValue('#point-a'), await other.evaluate(() => window.waits)];
      if (index !== '') picked.push({ index: Number(index), wait: Math.max(...waits) });
    }
    const waits = picked.map(({ wait }) => wait).sort((left, right) => left - right);
    t.diagnostic(`a hover takes ${waits[waits.length >> 1].toFixed(2)} ms (median), at most ${waits.at(-1).toFixed(1)} ms`);
    assert.ok(picked.length > 10, `only ${picked.length} points were found`);
    const places = await other.evaluate(
      (indices) => {
        const { positions } = window.geose.shapes[0].geometry();
        return indices.map((i) => [...positions.subarray(3 * i, 3 * i + 3)]);
      },
      picked.map(({ index }) => index),
    );
    places.slice(1).forEach(([x], k) => assert.ok(x > places[k][0], 'the mouse went right, and so did the point'));
    assert.ok(Math.max(...places.map(([, y]) => y)) - Math.min(...places.map(([, y]) => y)) < 0.15, 'at one height');
    assert.ok(
      places.every(([, , z]) => z > -0.05),
      'on the side that is seen',
    );
    await other.context().close();
  });
}

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

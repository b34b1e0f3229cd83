import assert from 'node:assert/strict';
import { test } from 'node:test';
import { lump, off } from './bodies.mjs';
import { installedPackage } from './installed.mjs';

const { Matcher } = await installedPackage();
const OPTIONS = { eigenpairs: 60 };
const trap = (matcher) => matcher[Symbol.for('geose-fmap.trap')]();

test('a trap is an error, the calls behind it go on, and no prepared shape is lost', async () => {
  const matcher = await Matcher.create();
  const a = await matcher.prepare(lump(), OPTIONS);
  const b = await matcher.prepare(lump({ bend: 0.3 }), OPTIONS);
  const { targetOf } = await matcher.match(a, b);
  const started = performance.now();
  await assert.rejects(trap(matcher), { name: 'GeoSeError', code: 'crashed' });
  assert.ok(performance.now() - started < 300);
  const [first, second, third] = await Promise.allSettled([matcher.match(a, b), trap(matcher), matcher.match(a, b)]);
  assert.deepEqual(first.value.targetOf, targetOf);
  assert.equal(second.reason.code, 'crashed');
  assert.deepEqual(third.value.targetOf, targetOf);
  matcher.dispose();
});

test('thirty matches need no more memory than three', async (t) => {
  const matcher = await Matcher.create();
  const a = await matcher.prepare(lump(), OPTIONS);
  const b = await matcher.prepare(off(lump({ bend: 0.3 })), OPTIONS);
  const peaks = [];
  for (let i = 0; i < 30; i++) peaks.push((await matcher.match(a, b)).report.peakMemoryBytes);
  t.diagnostic(`${peaks[2]} bytes after 3, ${peaks[29]} after 30`);
  assert.ok(peaks[2] > 0);
  assert.equal(peaks[29], peaks[2]);
  matcher.dispose();
});

test('a worker or a wasm that is not there is said to be so', async () => {
  await assert.rejects(Matcher.create({ worker: '/nowhere/worker.js' }), { name: 'GeoSeError', code: 'worker-unavailable' });
  await assert.rejects(Matcher.create({ wasm: '/nowhere/geose.wasm' }), { name: 'GeoSeError', code: 'wasm-unavailable' });
  await assert.rejects(Matcher.create({ wasm: new Uint8Array([1, 2, 3]) }), { name: 'GeoSeError', code: 'wasm-unavailable' });
  await assert.rejects(Matcher.create({ wasm: new Response('', { status: 404 }) }), { name: 'GeoSeError', code: 'wasm-unavailable' });
});

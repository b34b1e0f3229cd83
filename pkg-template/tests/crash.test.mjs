import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { describe, test } from 'node:test';
import { lump, off } from './bodies.mjs';
import { installedPackage } from './installed.mjs';

const { Matcher, installed } = await installedPackage();
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
  const [frequency, eigenpairs] = [6, 30];
  const a = await matcher.prepare(lump({ frequency }), { eigenpairs });
  const b = await matcher.prepare(off(lump({ frequency, bend: 0.3 })), { eigenpairs });
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

describe('a scan that memory cannot hold', () => {
  test('is refused by name before any work on it', async (t) => {
    const matcher = await Matcher.create();
    const positions = Float64Array.from({ length: 6_000_000 }, (_, i) => Math.sin(i * 1.7) + i * 1e-7);
    const started = performance.now();
    await assert.rejects(matcher.prepare({ positions }, { points: 2_000_000, eigenpairs: 1000 }), {
      name: 'GeoSeError',
      code: 'too-large',
    });
    t.diagnostic(`${Math.round(performance.now() - started)} ms`);
    assert.equal((await matcher.prepare(lump(), OPTIONS)).info.kind, 'mesh');
    matcher.dispose();
  });

  test('that runs out in the middle of the work is an error, and the calls behind it go on', async (t) => {
    const wasm = withMemoryLimit(await readFile(`${installed}/geose_fmap_bg.wasm`), 24 * 2 ** 20);
    const matcher = await Matcher.create({ wasm });
    const large = await matcher.prepare(lump({ frequency: 30 }), { eigenpairs: 120 }).then(
      () => null,
      (error) => error,
    );
    assert.equal(large?.name, 'GeoSeError');
    assert.equal(large.code, 'out-of-memory', large.message);
    assert.ok(large.details.refusedBytes > 0 && large.details.memoryBytes <= 24 * 2 ** 20);
    t.diagnostic(`${large.message} ${JSON.stringify(large.details)}`);
    const a = await matcher.prepare(lump({ frequency: 6 }), { eigenpairs: 20 });
    assert.equal((await matcher.match(a, a)).targetOf.length, a.info.points);
    matcher.dispose();
  });
});

/** The module with a limit to what its memory may grow to: to it, the machine is that small. */
function withMemoryLimit(module, bytes) {
  const leb = (value) => (value < 128 ? [value] : [(value & 127) | 128, ...leb(value >>> 7)]);
  const read = (at) => {
    let [value, shift, byte] = [0, 0, 0];
    do {
      byte = module[at++];
      value |= (byte & 127) << shift;
      shift += 7;
    } while (byte & 128);
    return [value, at];
  };
  const MEMORY = 5;
  for (let at = 8; at < module.length;) {
    const [size, body] = read(at + 1);
    if (module[at] === MEMORY) {
      // One memory: how many, whether it has a limit, at least so many pages of 64 KiB.
      const [least] = read(body + 2);
      const limited = [1, 1, ...leb(least), ...leb(bytes / 65_536)];
      return Buffer.concat([
        module.subarray(0, at),
        Buffer.from([MEMORY, ...leb(limited.length), ...limited]),
        module.subarray(body + size),
      ]);
    }
    at = body + size;
  }
  throw new Error('the module has no memory of its own');
}

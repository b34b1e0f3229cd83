import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { lump } from './bodies.mjs';
import { installedPackage } from './installed.mjs';

const { Matcher, STAGES } = await installedPackage();
const OPTIONS = { eigenpairs: 60 };
/** Longest time from abort to rejection, in milliseconds. */
const LIMIT = 300;

/** Aborts when `stage` is heard of; returns how long the call then took to settle. */
async function cancelAt(stage, call) {
  const controller = new AbortController();
  let aborted;
  const onProgress = (progress) => {
    if (progress.stage !== stage || aborted) return;
    aborted = performance.now();
    controller.abort('enough');
  };
  const error = await call({ signal: controller.signal, onProgress }).then(
    () => null,
    (reason) => reason,
  );
  assert.equal(error?.name, 'GeoSeError');
  assert.equal(error.code, 'cancelled');
  assert.equal(error.cause, 'enough');
  return performance.now() - aborted;
}

describe('cancelling', () => {
  let matcher, a, b, expected;
  const heard = { prepare: new Set(), match: new Set() };
  before(async () => {
    matcher = await Matcher.create();
    a = await matcher.prepare(lump(), { ...OPTIONS, onProgress: ({ stage }) => heard.prepare.add(stage) });
    b = await matcher.prepare(lump({ bend: 0.3 }), OPTIONS);
    expected = await matcher.match(a, b, { onProgress: ({ stage }) => heard.match.add(stage) });
  });
  after(() => matcher.dispose());

  test('progress tells of known stages, in order, with fractions from 0 to 1', async () => {
    const told = [];
    await matcher.prepare(lump(), { ...OPTIONS, onProgress: (progress) => told.push(progress) });
    assert.deepEqual(
      [...heard.prepare],
      STAGES.filter((stage) => heard.prepare.has(stage)),
    );
    assert.ok(
      ['sample', 'laplacian', 'spectrum', 'features'].every((stage) => heard.prepare.has(stage)),
      [...heard.prepare].join(),
    );
    assert.ok(
      ['functional-map', 'refine', 'correspondence'].every((stage) => heard.match.has(stage)),
      [...heard.match].join(),
    );
    for (const { stage, fraction } of told) assert.ok(STAGES.includes(stage) && fraction >= 0 && fraction <= 1);
  });

  test('at any stage settles within 300 ms, and the next call gives what it gave before', async (t) => {
    const calls = {
      prepare: (control) => matcher.prepare(lump(), { ...OPTIONS, ...control }),
      match: (control) => matcher.match(a, b, control),
    };
    for (const [name, call] of Object.entries(calls)) {
      for (const stage of heard[name]) {
        const milliseconds = await cancelAt(stage, call);
        t.diagnostic(`${name}, ${stage}: ${milliseconds.toFixed(1)} ms`);
        assert.ok(milliseconds < LIMIT, `${name} at ${stage} took ${milliseconds} ms`);
        const { targetOf } = await matcher.match(a, b);
        assert.deepEqual(targetOf, expected.targetOf);
      }
    }
  });

  test('at any moment, not only between progress messages', async () => {
    for (const delay of [0, 1, 3, 10, 30, 100]) {
      const controller = new AbortController();
      const call = matcher.prepare(lump({ frequency: 30 }), { signal: controller.signal });
      await new Promise((resolve) => setTimeout(resolve, delay));
      const aborted = performance.now();
      controller.abort();
      await assert.rejects(call, { code: 'cancelled' });
      assert.ok(performance.now() - aborted < LIMIT);
    }
  });

  test('a signal that is already aborted rejects at once and disturbs nobody', async () => {
    const running = matcher.match(a, b);
    await assert.rejects(matcher.match(a, b, { signal: AbortSignal.abort() }), { name: 'GeoSeError', code: 'cancelled' });
    assert.deepEqual((await running).targetOf, expected.targetOf);
  });

  test('one of several calls leaves the others alone', async () => {
    const controllers = [0, 1, 2, 3].map(() => new AbortController());
    const calls = controllers.map(({ signal }) => matcher.match(a, b, { signal }));
    controllers[2].abort();
    controllers[0].abort();
    const outcomes = await Promise.allSettled(calls);
    assert.deepEqual(
      outcomes.map(({ status, reason }) => reason?.code ?? status),
      ['cancelled', 'fulfilled', 'cancelled', 'fulfilled'],
    );
    assert.deepEqual(outcomes[3].value.targetOf, expected.targetOf);
  });

  test('after the end changes nothing', async () => {
    const controller = new AbortController();
    const { targetOf } = await matcher.match(a, b, { signal: controller.signal });
    controller.abort();
    assert.deepEqual((await matcher.match(a, b)).targetOf, targetOf);
  });

  test('calls are answered in the order they were made', async () => {
    const order = [];
    await Promise.all([0, 1, 2, 3].map((i) => matcher.match(a, b).then(() => order.push(i))));
    assert.deepEqual(order, [0, 1, 2, 3]);
  });

  test('a listener that throws is reported and left alone, and the call goes on', async (t) => {
    const reported = t.mock.method(console, 'error', () => {});
    let heardOf = 0;
    const onProgress = () => {
      heardOf++;
      throw new Error('my own fault');
    };
    assert.deepEqual((await matcher.match(a, b, { onProgress })).targetOf, expected.targetOf);
    assert.equal(heardOf, 1);
    assert.equal(reported.mock.calls[0].arguments[0].message, 'my own fault');
  });
});

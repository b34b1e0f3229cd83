// The small program that every test of a page runs; in Node it gives the outcome to expect.
import { lump } from './bodies.mjs';

/** Matches two lumps, prepared as said, after a cancelled and a trapped call, with a matcher made with `options`. */
export async function run(Matcher, options = {}, preparing = { eigenpairs: 60 }) {
  const matcher = await Matcher.create(options);
  const a = await matcher.prepare(lump(), preparing);
  const b = await matcher.prepare(lump({ frequency: 7, bend: 0.3 }), preparing);
  const controller = new AbortController();
  const onProgress = () => controller.abort();
  const cancelled = await matcher.match(a, b, { signal: controller.signal, onProgress }).catch((error) => error.code);
  const trapped = await matcher[Symbol.for('geose-fmap.trap')]().catch((error) => error.code);
  const { targetOf, reverse } = await matcher.match(a, b);
  matcher.dispose();
  return { cancelled, trapped, targetOf: [...targetOf], back: [...reverse.targetOf] };
}

/** Matches two scans, files as they are; tells the whole map, the seconds of each stage and the memory it took. */
export async function matchScans(Matcher, bytesA, bytesB) {
  const matcher = await Matcher.create();
  const a = await matcher.prepare(bytesA);
  const b = await matcher.prepare(bytesB);
  const { targetOf, confidence, reverse, report } = await matcher.match(a, b);
  matcher.dispose();
  const seconds = { prepare: [a.info.seconds, b.info.seconds], match: report.seconds };
  return { map: [[...targetOf], [...reverse.targetOf], [...confidence]], seconds, memory: report.peakMemoryBytes };
}

/**
 * Matches two scans, each stage cancelled once in the middle of its work; tells the milliseconds from abort to rejection.
 * What is matched in the end is the same as before.
 */
export async function cancelEverywhere(Matcher, bytesA, bytesB) {
  const matcher = await Matcher.create();
  const heard = new Set();
  const a = await matcher.prepare(bytesA, { onProgress: ({ stage }) => heard.add(`prepare ${stage}`) });
  const b = await matcher.prepare(bytesB);
  const before = await matcher.match(a, b, { onProgress: ({ stage }) => heard.add(`match ${stage}`) });
  const times = {};
  for (const place of heard) {
    const [call, wanted] = place.split(' ');
    const controller = new AbortController();
    let [heardOf, aborted] = [false, null];
    const abort = () => {
      aborted = performance.now();
      controller.abort();
    };
    const onProgress = ({ stage }) => {
      if (stage !== wanted || heardOf) return;
      heardOf = true;
      // Reading is over at once; in the other stages 20 ms later a piece of work is under way that no message interrupts.
      if (stage === 'read') abort();
      else setTimeout(abort, 20);
    };
    const control = { signal: controller.signal, onProgress };
    const code = await (call === 'prepare' ? matcher.prepare(bytesA, control) : matcher.match(a, b, control)).then(
      () => 'settled before it was cancelled',
      (error) => error.code,
    );
    if (code !== 'cancelled') throw new Error(`${place}: ${code}`);
    times[place] = performance.now() - aborted;
  }
  const { targetOf } = await matcher.match(a, b);
  matcher.dispose();
  if (targetOf.some((target, i) => target !== before.targetOf[i])) throw new Error('another map after cancelling');
  return times;
}

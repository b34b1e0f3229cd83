// The small program that every test of a page runs; in Node it gives the outcome to expect.
import { lump } from './bodies.mjs';

/** Matches two lumps, after a cancelled and a trapped call, with a matcher made with `options`. */
export async function run(Matcher, options = {}) {
  const matcher = await Matcher.create(options);
  const a = await matcher.prepare(lump(), { eigenpairs: 60 });
  const b = await matcher.prepare(lump({ frequency: 11, bend: 0.3 }), { eigenpairs: 60 });
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

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

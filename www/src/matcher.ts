import { Matcher, type MatcherOptions } from 'geose-fmap';
import wasmAddress from 'geose-fmap/geose_fmap_bg.wasm?url';
import workerAddress from 'geose-fmap/worker.js?worker&url';

/** Which device the user wants. */
export type DeviceChoice = NonNullable<MatcherOptions['device']>;

/** What every matcher is made from, fetched once. */
let kept: Promise<Pick<MatcherOptions, 'wasm' | 'worker'>> | undefined;

/**
 * The package's matcher with its files kept in memory. Cancelling ends the worker and starts another, and another device takes another matcher; the package
 * would fetch its files again, which an open page must not need: the network may be gone by then.
 */
export async function createMatcher(device: DeviceChoice): Promise<Matcher> {
  // The development server hands out modules that import each other by path, which only works from where they are.
  if (import.meta.env.DEV) return Matcher.create({ device, worker: workerAddress });
  kept ??= fetchFiles();
  kept.catch(() => (kept = undefined));
  return Matcher.create({ device, ...(await kept) });
}

async function fetchFiles(): Promise<Pick<MatcherOptions, 'wasm' | 'worker'>> {
  const [module, worker] = await Promise.all([fetched('program', wasmAddress), fetched('worker', workerAddress)]);
  const text = new Blob([await worker.blob()], { type: 'text/javascript' });
  return { wasm: await WebAssembly.compile(await module.arrayBuffer()), worker: URL.createObjectURL(text) };
}

async function fetched(what: string, address: string): Promise<Response> {
  const response = await fetch(address);
  if (!response.ok) throw new Error(`the ${what} could not be fetched (status ${response.status})`);
  return response;
}

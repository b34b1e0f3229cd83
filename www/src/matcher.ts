import { Matcher } from 'geose-fmap';
import workerAddress from 'geose-fmap/worker.js?worker&url';

/**
 * The package's matcher with its worker kept in memory. Cancelling ends the worker and starts another; the package would fetch
 * its file again, which an open page must not need: the network may be gone by then.
 */
export async function createMatcher(): Promise<Matcher> {
  // The development server hands out modules that import each other by path, which only works from where they are.
  if (import.meta.env.DEV) return Matcher.create({ device: 'auto', worker: workerAddress });
  const response = await fetch(workerAddress);
  if (!response.ok) throw new Error(`the worker could not be fetched (status ${response.status})`);
  const kept = new Blob([await response.blob()], { type: 'text/javascript' });
  return Matcher.create({ device: 'auto', worker: URL.createObjectURL(kept) });
}

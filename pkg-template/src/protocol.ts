import type { ErrorDetails } from './error.js';
import type { LaplacianOptions, MatcherOptions, MatchOptions, PrepareOptions, Progress, ReadOptions, SpectrumOptions } from './options.js';
import type { Device, Laplacian, Match, SolvedSpectrum, Stage } from './results.js';

/** A shape on its way into the worker. */
export type Source =
  | {
      from: 'file';
      file: Uint8Array<ArrayBuffer> | Blob;
      name: ReadOptions['name'];
      format: ReadOptions['format'];
      pose: ReadOptions['pose'];
      companions: Record<string, Uint8Array<ArrayBuffer>> | undefined;
    }
  | {
      from: 'arrays';
      positions: Float64Array<ArrayBuffer>;
      faces: Uint32Array<ArrayBuffer> | undefined;
      labels: Uint32Array<ArrayBuffer> | undefined;
      name: ReadOptions['name'];
    };

/** The block of a prepared shape: its owner keeps it, the worker gets a copy. */
export interface Prepared {
  from: 'prepared';
  block: Uint8Array<ArrayBuffer>;
}

/** What the worker can be asked, and what it answers. */
export interface Calls {
  device: { ask: object; answer: Device };
  prepare: {
    ask: { source: Source; options: Pick<PrepareOptions, 'points' | 'faces' | 'laplacian' | 'eigenpairs' | 'up' | 'wholeScan' | 'share'> };
    answer: Uint8Array<ArrayBuffer>;
  };
  laplacian: {
    ask: { source: Source | Prepared; options: Pick<LaplacianOptions, 'kind' | 'k0' | 'k' | 'tau' | 'iterations' | 'sigma'> };
    answer: Laplacian;
  };
  spectrum: { ask: { laplacian: Omit<Laplacian, 'kind'>; options: Pick<SpectrumOptions, 'eigenpairs'> }; answer: SolvedSpectrum };
  match: {
    ask: { a: Prepared['block']; b: Prepared['block']; options: Pick<MatchOptions, 'parts' | 'refine' | 'landmarks'> };
    answer: Match;
  };
  lose: { ask: { stage: Stage }; answer: void };
  trap: { ask: { waiting: boolean }; answer: never };
}

export type CallName = keyof Calls;
export type Answer = Calls[CallName]['answer'];
export type CallOf<N extends CallName> = { name: N } & Calls[N]['ask'];
export type Call = { [N in CallName]: CallOf<N> }[CallName];

/** Which device a matcher is to run on. */
export type DeviceChoice = NonNullable<MatcherOptions['device']>;

/** Messages to the worker. `start` comes once and first; then one `call` at a time. `again` says that an earlier worker had this device. */
export type ToWorker =
  | { type: 'start'; module: WebAssembly.Module; device: DeviceChoice; weights: Uint8Array<ArrayBuffer>[] | undefined; again: boolean }
  | { type: 'call'; id: number; call: Call };

/** Messages from the worker. After `crashed` it must be ended. `device` is the one in use by then, when it was opened. */
export type FromWorker =
  | { type: 'ready' }
  | ({ type: 'progress'; id: number } & Progress)
  | { type: 'done'; id: number; answer: Answer; device: Device | undefined }
  | { type: 'failed'; id: number; error: { code: string; message: string; details: ErrorDetails } }
  | { type: 'crashed'; code: 'crashed' | 'out-of-memory'; message: string; details: ErrorDetails };

/** The buffers of all typed arrays in a private copy: they move to the other side instead of being copied again. */
export function buffersOf(value: unknown): ArrayBuffer[] {
  if (ArrayBuffer.isView(value)) return value.buffer instanceof ArrayBuffer ? [value.buffer] : [];
  if (typeof value !== 'object' || value === null || value instanceof Blob) return [];
  return Object.values(value).flatMap(buffersOf);
}

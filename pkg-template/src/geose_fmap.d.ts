// What wasm-bindgen puts into geose_fmap.js, typed as tightly as the crate promises it. All of it but the GPU is synchronous; a typed
// error is a plain `{ code, message, details }`, anything else thrown is a trap.
import type { Device as DeviceInfo, Laplacian, Match, SolvedSpectrum, Stage } from './results.js';
import type { LaplacianOptions, MatcherOptions, MatchOptions, PrepareOptions } from './options.js';

type Bytes = Uint8Array<ArrayBuffer>;
type Progress = (stage: Stage, fraction: number) => void;

export function initSync(module: { module: WebAssembly.Module }): unknown;

/** A shape in wasm memory. */
export class RawShape {
  free(): void;
}

export function read_file(
  bytes: Uint8Array,
  name: string | undefined,
  format: string | undefined,
  pose: string | undefined,
  companions: Record<string, Uint8Array> | undefined,
): RawShape;
export function read_arrays(
  positions: Float64Array,
  faces: Uint32Array | undefined,
  labels: Uint32Array | undefined,
  name: string | undefined,
): RawShape;
/** Opens the device; rejects with a typed error where it is insisted on and not there. `again` opens one that was opened before, or else goes on without it. */
export function open_device(
  choice: NonNullable<MatcherOptions['device']>,
  again: boolean,
  weights: Uint8Array[] | undefined,
): Promise<Device>;

type LaplacianGiven = Pick<LaplacianOptions, 'kind' | 'k0' | 'k' | 'tau' | 'iterations' | 'sigma'>;
type PrepareGiven = Pick<PrepareOptions, 'points' | 'faces' | 'laplacian' | 'eigenpairs' | 'up' | 'wholeScan' | 'share'>;
type MatchGiven = Pick<MatchOptions, 'parts' | 'refine' | 'landmarks'>;

/** The network on a device. */
export class Device {
  info(): DeviceInfo;
  /** Whether calls have to be waited for; the others need not be. */
  waits(): boolean;
  /** Loses a GPU in a stage of the next call, to test recovery with. */
  lose_at(stage: Stage): void;
  /** Consumes `shape`, also when it throws. */
  prepare(shape: RawShape, options: PrepareGiven, progress: Progress): Bytes;
  prepare_waiting(shape: RawShape, options: PrepareGiven, progress: Progress): Promise<Bytes>;
  match_pair(a: Uint8Array, b: Uint8Array, options: MatchGiven, progress: Progress): Match;
  match_pair_waiting(a: Uint8Array, b: Uint8Array, options: MatchGiven, progress: Progress): Promise<Match>;
}

/** Consumes `shape`, also when it throws. */
export function laplacian(shape: RawShape, options: LaplacianGiven, progress: Progress): Laplacian;
export function laplacian_of_prepared(block: Uint8Array, options: LaplacianGiven, progress: Progress): Laplacian;
export function spectrum(
  indptr: Uint32Array,
  indices: Uint32Array,
  values: Float64Array,
  mass: Float64Array,
  options: { eigenpairs?: number | undefined },
  progress: Progress,
): SolvedSpectrum;
export function version(): string;
/** Size of the wasm memory. */
export function memory_bytes(): number;
/** Size of the last request for memory that was refused; 0 when none was. */
export function refused_bytes(): number;
/** Message of the panic that the instance died of. */
export function last_panic(): string | undefined;
/** A real trap, to test recovery with. */
export function trap(): never;
/** The same after waiting: the promise never settles. */
export function trap_waiting(): Promise<never>;

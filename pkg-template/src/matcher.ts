/// <reference lib="esnext.disposable" preserve="true" />
import { disposable } from './disposable.js';
import { WorkerHost } from './host.js';
import { laplacianOf, nothingElse, optionsOf, sourceOf, weightsOf, wrong } from './input.js';
import type {
  LaplacianOptions,
  MatcherOptions,
  MatchOptions,
  PrepareOptions,
  ReadOptions,
  ShapeInput,
  SpectrumOptions,
} from './options.js';
import { blockOf, PreparedShape, preparedFrom } from './prepared.js';
import { buffersOf, type Prepared, type Source } from './protocol.js';
import type { Device, Laplacian, Match, SolvedSpectrum, Stage } from './results.js';
import { isObject } from './tag.js';
import { spawner } from './thread.js';
import { compile } from './wasm.js';

const DEVICES: readonly unknown[] = ['auto', 'cpu', 'webgpu'];

/**
 * Finds which point of one scan is which point of another. One worker does the work, one call after another. Inputs are
 * copied when a call is made; results belong to the caller. Every rejection is a `GeoSeError`.
 */
export class Matcher {
  readonly #host: WorkerHost;

  static {
    disposable(Matcher.prototype, 'dispose');
  }

  private constructor(host: WorkerHost) {
    this.#host = host;
  }

  /** Where the work happens, and why there. Changes when a GPU is lost, or comes back. */
  get device(): Device {
    return this.#host.device;
  }

  /** Loads the wasm, starts the worker and opens the device. In Node the worker keeps the process alive only while a call is open. */
  static async create(options: MatcherOptions = {}): Promise<Matcher> {
    if (!isObject(options)) throw wrong('the options', 'an object', options);
    const { device = 'auto', weights, wasm, worker, ...rest } = options;
    nothingElse('the options', rest, ['device', 'weights', 'wasm', 'worker']);
    if (!DEVICES.includes(device)) throw wrong('device', "'auto', 'cpu' or 'webgpu'", device);
    const files = weightsOf(weights);
    const [module, spawn] = await Promise.all([compile(wasm), spawner(worker)]);
    const host = new WorkerHost(module, device, files, spawn);
    try {
      await host.run<'device'>({ name: 'device' });
    } catch (error) {
      host.dispose();
      throw error;
    }
    return new Matcher(host);
  }

  /** Reads a scan, a file or arrays, and computes everything a match needs to know of it. */
  async prepare(scan: ShapeInput, options?: PrepareOptions): Promise<PreparedShape> {
    const { call, rest } = optionsOf(options);
    const { source, others } = sourceAnd(scan, rest);
    return preparedFrom(await this.#host.run<'prepare'>({ name: 'prepare', source, options: others }, call, buffersOf(source)));
  }

  /** Finds for every point of `a` its point of `b`, and back. */
  async match(a: PreparedShape, b: PreparedShape, options?: MatchOptions): Promise<Match> {
    const { call, rest } = optionsOf(options);
    return this.#host.run<'match'>({ name: 'match', a: preparedBlock('a', a), b: preparedBlock('b', b), options: rest }, call);
  }

  /** The Laplacian of a scan or of a prepared shape. Every point counts, none is left out. */
  async laplacian(shape: ShapeInput | PreparedShape, options?: LaplacianOptions): Promise<Laplacian> {
    const { call, rest } = optionsOf(options);
    if (shape instanceof PreparedShape) {
      const source: Prepared = { from: 'prepared', block: blockOf(shape) };
      return this.#host.run<'laplacian'>({ name: 'laplacian', source, options: rest }, call);
    }
    const { source, others } = sourceAnd(shape, rest);
    return this.#host.run<'laplacian'>({ name: 'laplacian', source, options: others }, call, buffersOf(source));
  }

  /** The smallest eigenpairs of a Laplacian under its mass. For some hundreds of them: thousands take minutes. */
  async spectrum(laplacian: Omit<Laplacian, 'kind'>, options?: SpectrumOptions): Promise<SolvedSpectrum> {
    const { call, rest } = optionsOf(options);
    const copy = laplacianOf(laplacian);
    return this.#host.run<'spectrum'>({ name: 'spectrum', laplacian: copy, options: rest }, call, buffersOf(copy));
  }

  /** Ends the worker. Open and later calls reject with code `'disposed'`; prepared shapes stay usable with another matcher. */
  dispose(): void {
    this.#host.dispose();
  }

  /** @internal For tests: traps inside the wasm, at once or while it is waited for. */
  async [Symbol.for('geose-fmap.trap')](waiting = false): Promise<never> {
    return this.#host.run<'trap'>({ name: 'trap', waiting });
  }

  /** @internal For tests: loses the GPU in a stage of the next call. */
  async [Symbol.for('geose-fmap.lose')](stage: Stage): Promise<void> {
    return this.#host.run<'lose'>({ name: 'lose', stage });
  }
}

/** `using` disposes of a matcher, where the engine knows `Symbol.dispose`. */
export interface Matcher extends Disposable {}

/** The scan on its way into the worker, and the options that are not about reading it. */
function sourceAnd<T extends ReadOptions>(
  scan: ShapeInput,
  { name, format, pose, companions, ...others }: T,
): { source: Source; others: Omit<T, keyof ReadOptions> } {
  if (name !== undefined && typeof name !== 'string') throw wrong('name', 'a string', name);
  if (format !== undefined && typeof format !== 'string') throw wrong('format', 'a string', format);
  return { source: sourceOf(scan, { name, format, pose, companions }), others };
}

function preparedBlock(what: string, shape: PreparedShape): Prepared['block'] {
  if (!(shape instanceof PreparedShape)) throw wrong(what, 'a prepared shape', shape);
  return blockOf(shape);
}

import { advice } from './advice.js';
import { bytesOf } from './blob.js';
import { GeoSeError } from './error.js';
import { isNode } from './node.js';
import type { CallOptions } from './options.js';
import type { Call, CallName, CallOf, Calls, DeviceChoice, FromWorker, Source } from './protocol.js';
import type { Device } from './results.js';
import { is } from './tag.js';
import type { Spawn, Thread } from './thread.js';

/** A call that has not been settled. */
interface Job {
  readonly id: number;
  readonly call: Call;
  readonly transfer: ArrayBuffer[];
  onProgress: CallOptions['onProgress'];
  resolve(answer: unknown): void;
  reject(error: GeoSeError): void;
  /** Stops listening to the signal. */
  forget(): void;
}

/**
 * Runs calls one after another in a worker of its own. wasm cannot be interrupted, so a cancelled call ends the worker, and
 * a crash does too; the next call starts another one from the compiled module. Nothing that outlives a call is kept there.
 */
export class WorkerHost {
  readonly #module: WebAssembly.Module;
  #choice: DeviceChoice;
  /** Kept here, because every worker needs them. */
  readonly #weights: Uint8Array<ArrayBuffer>[] | undefined;
  /** The one in use, once it was opened. */
  #device: Device | undefined;
  readonly #spawn: Spawn;
  /** The first one runs, the others wait. */
  readonly #jobs: Job[] = [];
  #thread: Thread | undefined;
  /** Whether the thread has ever said anything. */
  #ready = false;
  #lastId = 0;
  /** Why the CPU took the place of a GPU, when one crashed. */
  #withoutGpu: string | undefined;
  #disposed = false;

  constructor(module: WebAssembly.Module, device: DeviceChoice, weights: Uint8Array<ArrayBuffer>[] | undefined, spawn: Spawn) {
    this.#module = module;
    this.#choice = device;
    this.#weights = weights;
    this.#spawn = spawn;
  }

  /** The device in use. */
  get device(): Device {
    if (!this.#device) throw new Error('no device was opened yet');
    return this.#device;
  }

  /** Settles once. The buffers in `transfer` move to the worker: they must be private copies. */
  run<N extends CallName>(
    call: CallOf<N>,
    { signal, onProgress }: CallOptions = {},
    transfer: ArrayBuffer[] = [],
  ): Promise<Calls[N]['answer']> {
    if (this.#disposed) return Promise.reject(disposed());
    if (signal?.aborted) return Promise.reject(cancelled(signal));
    return new Promise((resolve, reject) => {
      const abort = () => this.#cancel(job, cancelled(signal));
      signal?.addEventListener('abort', abort);
      const job: Job = {
        id: ++this.#lastId,
        call: call as Call,
        transfer,
        onProgress,
        resolve: resolve as (answer: unknown) => void,
        reject,
        forget: () => signal?.removeEventListener('abort', abort),
      };
      this.#jobs.push(job);
      if (this.#jobs[0] === job) this.#begin();
    });
  }

  /** Ends the worker; every open and later call rejects. */
  dispose(): void {
    this.#disposed = true;
    this.#stop();
    for (const job of this.#jobs.splice(0)) {
      job.forget();
      job.reject(disposed());
    }
  }

  #begin(): void {
    const job = this.#jobs[0];
    this.#thread?.keepAlive(job !== undefined);
    if (!job) return;
    try {
      this.#thread ??= this.#start();
    } catch (error) {
      return this.#end(unavailable(messageOf(error)));
    }
    const unread = isNode ? unreadIn(job.call) : undefined;
    if (unread) void this.#readFirst(job, unread);
    else this.#post(job, this.#thread);
  }

  /** Reads a file on this side. Node's workers do not know every `Blob`: one of jsdom would arrive there as an empty object. */
  async #readFirst(job: Job, source: Unread): Promise<void> {
    const running = () => job === this.#jobs[0];
    try {
      const bytes = await bytesOf(source.file);
      if (!running()) return;
      Object.assign(source, { file: bytes });
      job.transfer.push(bytes.buffer);
      if (this.#thread) this.#post(job, this.#thread);
    } catch (error) {
      if (!running()) return;
      this.#remove(job);
      job.reject(error as GeoSeError);
    }
  }

  #post(job: Job, thread: Thread): void {
    try {
      thread.post({ type: 'call', id: job.id, call: job.call }, job.transfer);
    } catch (error) {
      // Everything in a call can be cloned, so only memory can be short.
      this.#end(new GeoSeError('out-of-memory', `the call could not be handed to the worker: ${messageOf(error)}`));
    }
  }

  #start(): Thread {
    this.#ready = false;
    const thread = this.#spawn({
      message: (message) => this.#hear(message),
      died: (reason) => (this.#ready ? this.#crash(crashed(reason)) : this.#end(unavailable(reason))),
    });
    // A choice that ended with the CPU is made anew: no GPU was found good.
    const again = this.#device !== undefined && (this.#choice === 'webgpu' || this.#device.kind === 'webgpu');
    thread.post({ type: 'start', module: this.#module, device: this.#choice, weights: this.#weights, again });
    return thread;
  }

  #stop(): void {
    this.#thread?.stop();
    this.#thread = undefined;
  }

  #hear(message: FromWorker): void {
    this.#ready = true;
    if (message.type === 'ready') return;
    if (message.type === 'crashed') return this.#crash(new GeoSeError(message.code, message.message, message.details));
    const job = this.#jobs[0];
    if (job?.id !== message.id) return;
    if (message.type === 'progress') return tell(job, message);
    this.#remove(job);
    if (message.type === 'done') {
      if (message.device) this.#device = { ...message.device, reason: this.#withoutGpu ?? message.device.reason };
      job.resolve(message.answer);
    } else job.reject(new GeoSeError(message.error.code, message.error.message, message.error.details));
  }

  /** A crash while a GPU was opened or used may be that of its driver: who left the choice to the package goes on without it. */
  #crash(error: GeoSeError): void {
    const opening = this.#device === undefined;
    if (this.#choice === 'auto' && this.#device?.kind !== 'cpu') {
      this.#choice = 'cpu';
      this.#withoutGpu = `there is a GPU, with which ${error.message}`;
      if (opening) {
        this.#stop();
        return this.#begin();
      }
    }
    this.#end(error);
  }

  #cancel(job: Job, error: GeoSeError): void {
    if (job === this.#jobs[0]) return this.#end(error);
    this.#remove(job);
    job.reject(error);
  }

  /** Ends the worker and with it the running call. */
  #end(error: GeoSeError): void {
    this.#stop();
    const job = this.#jobs[0];
    if (!job) return;
    this.#remove(job);
    job.reject(error);
  }

  /** Takes a call off the list; after the running one the next begins. */
  #remove(job: Job): void {
    const at = this.#jobs.indexOf(job);
    this.#jobs.splice(at, 1);
    job.forget();
    if (at === 0) this.#begin();
  }
}

/** A file of which only a handle is there. */
type Unread = Extract<Source, { from: 'file' }> & { file: Blob };

function unreadIn(call: Call): Unread | undefined {
  if (!('source' in call) || call.source.from !== 'file') return undefined;
  return is<Blob>(call.source.file, 'Blob', 'File') ? (call.source as Unread) : undefined;
}

/** A listener that throws is its owner's problem, not the call's: the error is reported as uncaught and the listener left alone. */
function tell(job: Job, { stage, fraction }: Extract<FromWorker, { type: 'progress' }>): void {
  try {
    job.onProgress?.({ stage, fraction });
  } catch (error) {
    job.onProgress = undefined;
    if (typeof reportError === 'function') reportError(error);
    else console.error(error);
  }
}

const messageOf = (error: unknown): string => (error instanceof Error ? error.message : String(error));

const disposed = () => new GeoSeError('disposed', 'the matcher was disposed of');

const cancelled = (signal: AbortSignal | undefined) => new GeoSeError('cancelled', 'the call was cancelled', {}, { cause: signal?.reason });

const crashed = (reason: string) => new GeoSeError('crashed', `the worker died: ${reason}`, { reason });

const unavailable = (reason: string) =>
  new GeoSeError('worker-unavailable', `the worker could not be started: ${reason}. ${advice()}`, { reason });

// Runs in a worker of a browser or of Node: holds one wasm instance with its device and answers one call at a time.
import { bytesOf } from './blob.js';
import { GeoSeError } from './error.js';
import * as raw from './geose_fmap.js';
import { isNode, workerThreads } from './node.js';
import { buffersOf, type Answer, type Call, type DeviceChoice, type FromWorker, type Source, type ToWorker } from './protocol.js';
import type { Stage } from './results.js';

type Post = (message: FromWorker, transfer?: ArrayBuffer[]) => void;
type Progress = (stage: Stage, fraction: number) => void;

/** Shortest time between two progress messages of one stage, in milliseconds. */
const PROGRESS_INTERVAL = 33;

/** Most bytes that one array in wasm memory may have. */
const LARGEST_ARRAY = 2 ** 31 - 1;

// A browser's worker must listen before its script has run; Node keeps messages until somebody listens.
if (!isNode) {
  const post: Post = (message, transfer = []) => postMessage(message, { transfer });
  addEventListener('message', (event: MessageEvent<ToWorker>) => void hear(event.data, post));
  // A trap while a GPU is waited for rejects nothing.
  addEventListener('error', (event) => {
    event.preventDefault();
    post(crashOf(event.error ?? event.message));
  });
  addEventListener('unhandledrejection', (event) => {
    event.preventDefault();
    post(crashOf(event.reason));
  });
} else {
  void workerThreads().then(({ parentPort }) => {
    const post: Post = (message, transfer = []) => parentPort?.postMessage(message, transfer);
    parentPort?.on('message', (message: ToWorker) => void hear(message, post));
  });
}

let wanted: DeviceChoice = 'auto';
let again = false;
let weights: Uint8Array<ArrayBuffer>[] | undefined;
let opened: raw.Device | undefined;

/** The device, opened when it is first needed. */
async function device(): Promise<raw.Device> {
  return (opened ??= await raw.open_device(wanted, again, weights));
}

async function hear(message: ToWorker, post: Post): Promise<void> {
  try {
    if (message.type === 'start') {
      raw.initSync({ module: message.module });
      ({ device: wanted, again, weights } = message);
      post({ type: 'ready' });
    } else {
      const answer = await answerTo(message.call, progressOf(message.id, post));
      post({ type: 'done', id: message.id, answer, device: opened?.info() }, buffersOf(answer));
    }
  } catch (error) {
    if (message.type === 'call' && isTyped(error)) {
      const { code, message: sentence, details } = error;
      post({ type: 'failed', id: message.id, error: { code, message: sentence, details } });
    } else {
      post(crashOf(error));
    }
  }
}

async function answerTo(call: Call, progress: Progress): Promise<Answer> {
  switch (call.name) {
    case 'device':
      return (await device()).info();
    case 'prepare': {
      const on = await device();
      const scan = await read(call.source);
      return on.waits() ? on.prepare_waiting(scan, call.options, progress) : on.prepare(scan, call.options, progress);
    }
    case 'laplacian':
      return call.source.from === 'prepared'
        ? raw.laplacian_of_prepared(call.source.block, call.options, progress)
        : raw.laplacian(await read(call.source), call.options, progress);
    case 'spectrum': {
      const { indptr, indices, values, mass } = call.laplacian;
      return raw.spectrum(indptr, indices, values, mass, call.options, progress);
    }
    case 'match': {
      const on = await device();
      return on.waits()
        ? on.match_pair_waiting(call.a, call.b, call.options, progress)
        : on.match_pair(call.a, call.b, call.options, progress);
    }
    case 'lose':
      return (await device()).lose_at(call.stage);
    case 'trap':
      return call.waiting ? raw.trap_waiting() : raw.trap();
  }
}

async function read(source: Source): Promise<raw.RawShape> {
  const largest = source.from === 'arrays' ? Math.max(source.positions.byteLength, source.faces?.byteLength ?? 0) : sizeOf(source.file);
  if (largest > LARGEST_ARRAY) {
    const message = `the scan has an array or a file of ${largest} bytes; at most ${LARGEST_ARRAY} can be taken`;
    throw { code: 'too-large', message, details: { bytes: largest, limit: LARGEST_ARRAY } };
  }
  if (source.from === 'arrays') return raw.read_arrays(source.positions, source.faces, source.labels, source.name);
  const bytes = source.file instanceof Blob ? await bytesOf(source.file) : source.file;
  return raw.read_file(bytes, source.name, source.format, source.pose, source.companions);
}

const sizeOf = (file: Uint8Array | Blob): number => (file instanceof Blob ? file.size : file.byteLength);

/** Every new stage and every finished one is told; in between, no more than a person can see. */
function progressOf(id: number, post: Post): Progress {
  let last: Stage | undefined;
  let told = 0;
  return (stage, fraction) => {
    const now = performance.now();
    if (stage === last && fraction < 1 && now - told < PROGRESS_INTERVAL) return;
    last = stage;
    told = now;
    post({ type: 'progress', id, stage, fraction });
  };
}

function isTyped(error: unknown): error is Extract<FromWorker, { type: 'failed' }>['error'] {
  if (error instanceof GeoSeError) return true;
  return typeof error === 'object' && error !== null && !(error instanceof Error) && 'code' in error && typeof error.code === 'string';
}

function crashOf(error: unknown): FromWorker {
  const { panic, ...memory } = remains();
  const reason = panic ?? (error instanceof Error ? error.message : String(error));
  const details = { ...memory, reason };
  // JavaScript's own arrays can be refused too, and Rust calls what no memory could hold a capacity overflow.
  const refused = (error instanceof RangeError && /alloc|memory/i.test(reason)) || /capacity overflow/.test(reason);
  if (!refused && memory.refusedBytes === 0)
    return { type: 'crashed', code: 'crashed', message: `the matcher crashed: ${reason}`, details };
  const megabytes = (bytes: number) => `${Math.ceil(bytes / 2 ** 20)} MiB`;
  const more = memory.refusedBytes > 0 ? `${megabytes(memory.refusedBytes)} more` : 'more';
  const message = `the matcher ran out of memory: it had ${megabytes(memory.memoryBytes)} and could not get ${more}`;
  return { type: 'crashed', code: 'out-of-memory', message, details };
}

/** What a dead instance still tells; nothing when there never was one. */
function remains(): { memoryBytes: number; refusedBytes: number; panic: string | undefined } {
  const told = { memoryBytes: 0, refusedBytes: 0, panic: undefined as string | undefined };
  try {
    told.memoryBytes = raw.memory_bytes();
    told.refusedBytes = raw.refused_bytes();
    told.panic = raw.last_panic();
  } catch {
    // Then it is known only in part.
  }
  return told;
}

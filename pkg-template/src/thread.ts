import { isNode, workerThreads } from './node.js';
import { foreignOrigin, isElsewhere } from './origin.js';
import type { Address } from './ambient.js';
import type { FromWorker, ToWorker } from './protocol.js';

/** A worker of a browser or of Node. */
export interface Thread {
  post(message: ToWorker, transfer?: ArrayBuffer[]): void;
  /** Ends it at once, whatever it does; its listener hears nothing more. */
  stop(): void;
  /** Whether it keeps a Node process alive; a browser does not ask. */
  keepAlive(wanted: boolean): void;
}

/** Hears of everything a thread does until it is stopped. */
export interface ThreadListener {
  message(message: FromWorker): void;
  /** The thread ended by itself, or could not be started. */
  died(reason: string): void;
}

/** Starts a thread; throws where the platform refuses at once. */
export type Spawn = (listener: ThreadListener) => Thread;

/** Prepares to start threads that run `worker.js`, or the file at `address` instead. */
export async function spawner(address: string | Address | undefined): Promise<Spawn> {
  if (!isNode) return (listener) => browserThread(browserWorker(address), listener);
  const { Worker: NodeWorker } = await workerThreads();
  return (listener) => nodeThread(new NodeWorker(nodeFile(address), { execArgv: [] }), listener);
}

function browserWorker(address: string | Address | undefined): Worker {
  if (address === undefined) {
    if (foreignOrigin()) return foreignWorker(new URL(WORKER, import.meta.url));
    // Bundlers recognise this very expression.
    return new Worker(new URL('./worker.js', import.meta.url), { type: 'module' });
  }
  const url = new URL(address, location.href);
  return isElsewhere(url) ? foreignWorker(url) : new Worker(url, { type: 'module' });
}

/** A worker's own file must share the page's origin; what it imports need not. */
function foreignWorker(url: URL): Worker {
  const stub = URL.createObjectURL(new Blob([`import ${JSON.stringify(url.href)};`], { type: 'text/javascript' }));
  const worker = new Worker(stub, { type: 'module' });
  worker.addEventListener('message', () => URL.revokeObjectURL(stub), { once: true });
  return worker;
}

/** A name that bundlers cannot follow: they would carry the file along a second time. */
const WORKER = ['.', 'worker.js'].join('/');

function nodeFile(address: string | Address | undefined): string | URL {
  if (address === undefined) return new URL(WORKER, import.meta.url);
  const text = String(address);
  return text.startsWith('file:') ? new URL(text) : text;
}

function browserThread(worker: Worker, listener: ThreadListener): Thread {
  worker.onmessage = (event: MessageEvent<FromWorker>) => listener.message(event.data);
  worker.onerror = (event) => listener.died(event.message || 'its file could not be loaded');
  worker.onmessageerror = () => listener.died('a message could not be read');
  return {
    post: (message, transfer = []) => worker.postMessage(message, transfer),
    stop() {
      worker.onmessage = worker.onerror = worker.onmessageerror = null;
      worker.terminate();
    },
    keepAlive() {},
  };
}

function nodeThread(worker: import('node:worker_threads').Worker, listener: ThreadListener): Thread {
  let stopped = false;
  const died = (reason: string) => stopped || listener.died(reason);
  worker.on('message', (message: FromWorker) => stopped || listener.message(message));
  worker.on('messageerror', () => died('a message could not be read'));
  worker.on('error', (error) => died(error instanceof Error ? error.message : String(error)));
  worker.on('exit', (code) => died(`it ended with code ${code}`));
  return {
    post: (message, transfer = []) => worker.postMessage(message, transfer),
    stop() {
      stopped = true;
      void worker.terminate();
    },
    keepAlive: (wanted) => (wanted ? worker.ref() : worker.unref()),
  };
}

// The modules of Node that this package needs, asked for in a way that bundlers for browsers do not follow.

/** Not by its bare name: bundlers for browsers would put something of theirs in its place. */
const node: NodeJS.Process | undefined = globalThis.process;

/** Node, or what has its modules: Bun and Deno. A window of Electron may have them too, but its workers are a browser's. */
export const isNode = typeof node?.versions?.node === 'string' && !['renderer', 'worker'].includes(String(Reflect.get(node, 'type')));

/** Whether this is the server of Next.js. */
export const isNext = (): boolean => isNode && node?.env['NEXT_RUNTIME'] !== undefined;

/** `node:worker_threads`. */
export const workerThreads = (): Promise<typeof import('node:worker_threads')> => builtin('worker_threads');

/** `node:fs/promises`. */
export const files = (): Promise<typeof import('node:fs/promises')> => builtin('fs/promises');

async function builtin<M>(name: string): Promise<M> {
  // Since Node 20.16; a bundler for servers may have made the import below impossible.
  const found = typeof node?.getBuiltinModule === 'function' ? node.getBuiltinModule(`node:${name}`) : undefined;
  return (found ?? (await import(/* @vite-ignore */ /* webpackIgnore: true */ `node:${name}`))) as M;
}

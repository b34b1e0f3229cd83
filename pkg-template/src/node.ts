// The two modules of Node this package needs, imported under a name that bundlers for browsers cannot follow.

/** Browsers, and whatever behaves like one, have workers of their own; Node keeps them in a module. */
export const isNode = typeof Worker !== 'function';

/** `node:worker_threads`. */
export const workerThreads = (): Promise<typeof import('node:worker_threads')> => builtin('worker_threads');

/** `node:fs/promises`. */
export const files = (): Promise<typeof import('node:fs/promises')> => builtin('fs/promises');

function builtin<M>(name: string): Promise<M> {
  return import(/* @vite-ignore */ /* webpackIgnore: true */ `node:${name}`) as Promise<M>;
}

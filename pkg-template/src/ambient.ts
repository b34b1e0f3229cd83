// Types of the platform for a project that may have none of its library: TypeScript with DOM or with Node's types has them all, with the bare language it has
// none, and what this package says of them then stands in.

/** `typeof X.prototype` where there is a global class X, else `Otherwise`. */
type InstanceOf<X extends string, Otherwise> = typeof globalThis extends { [name in X]: { prototype: infer Instance } }
  ? Instance
  : Otherwise;

/** A `Blob` or a `File`. */
export type BlobInput = InstanceOf<'Blob', { readonly size: number; arrayBuffer(): Promise<ArrayBuffer> }>;

/** A `URL`. */
export type Address = InstanceOf<'URL', { readonly href: string }>;

/** What `fetch` resolves to. */
export type Fetched = InstanceOf<'Response', { readonly ok: boolean; readonly url: string; arrayBuffer(): Promise<ArrayBuffer> }>;

/** The `signal` of an `AbortController`. */
export type Signal = InstanceOf<'AbortSignal', { readonly aborted: boolean; addEventListener(type: 'abort', listener: () => void): void }>;

/** A compiled `WebAssembly.Module`. */
export type CompiledModule = typeof globalThis extends { WebAssembly: { Module: { prototype: infer Module } } } ? Module : object;

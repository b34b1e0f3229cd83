import { tagOf } from './tag.js';

/**
 * A copy of plain data: primitives, arrays and objects of them, which may name each other in circles. Throws where anything else is in it. Written out, as
 * test runners with a page of their own (Jest with jsdom) have no `structuredClone`.
 */
export function plainCopy<T>(value: T): T {
  return copy(value, new Map()) as T;
}

function copy(value: unknown, copies: Map<object, unknown>): unknown {
  if (typeof value === 'function' || typeof value === 'symbol') throw new TypeError(`a ${typeof value} is no data`);
  if (typeof value !== 'object' || value === null) return value;
  if (copies.has(value)) return copies.get(value);
  if (!Array.isArray(value) && tagOf(value) !== 'Object') throw new TypeError(`a ${tagOf(value)} is no plain data`);
  const made: object = Array.isArray(value) ? Array<unknown>(value.length) : {};
  copies.set(value, made);
  for (const [key, part] of Object.entries(value)) {
    Object.defineProperty(made, key, { value: copy(part, copies), writable: true, enumerable: true, configurable: true });
  }
  return made;
}

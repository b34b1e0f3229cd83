// The type of a value by its name, so that objects of another realm (a frame, a test runner) count too.

/** Neither a primitive nor null. */
export const isObject = (value: unknown): value is object => typeof value === 'object' && value !== null;

/** `'Float32Array'`, `'Blob'`, … */
export const tagOf = (value: unknown): string => Object.prototype.toString.call(value).slice(8, -1);

/** Whether a value has one of the names; the caller vouches for the type. */
export const is = <T>(value: unknown, ...tags: string[]): value is T => isObject(value) && tags.includes(tagOf(value));

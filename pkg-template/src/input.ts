// What callers hand in: checked for its type and copied before the call returns. Whether it makes a shape is the matcher's to say.
import { GeoSeError } from './error.js';
import type { ArrayInput, BytesInput, CallOptions, MatcherOptions, ReadOptions, ShapeInput } from './options.js';
import { plainCopy } from './plain.js';
import type { Calls, Source } from './protocol.js';
import type { Laplacian } from './results.js';
import { is, isObject, tagOf } from './tag.js';

/** A private copy of a scan. */
export function sourceOf(input: ShapeInput, { name, format, pose, companions }: ReadOptions): Source {
  const how = { from: 'file', name, format, pose, companions: companionsOf(companions) } as const;
  if (is<Blob>(input, 'Blob', 'File')) return { ...how, file: input, name: name ?? ('name' in input ? String(input.name) : undefined) };
  if (is<Uint8Array>(input, 'Uint8Array')) return { ...how, file: copied('the scan', () => new Uint8Array(input)) };
  if (is<ArrayBuffer>(input, 'ArrayBuffer')) return { ...how, file: copied('the scan', () => new Uint8Array(input.slice(0))) };
  if (!isObject(input) || !('positions' in input)) {
    throw wrong('the scan', 'the bytes of a file (Uint8Array, ArrayBuffer or Blob) or { positions, faces, labels }', input);
  }
  const { positions, faces, labels, ...rest } = input;
  nothingElse('the scan', rest, ['positions', 'faces', 'labels']);
  return { from: 'arrays', positions: coordinates(positions), faces: indices('faces', faces), labels: indices('labels', labels), name };
}

/** Private copies of the files beside a scan. */
function companionsOf(given: ReadOptions['companions']): Record<string, Uint8Array<ArrayBuffer>> | undefined {
  if (given === undefined) return undefined;
  if (!isObject(given)) throw wrong('companions', 'an object of file names and bytes', given);
  const files = Object.entries(given).map(([name, file]) => {
    if (!isFile(file)) throw wrong(`companions[${JSON.stringify(name)}]`, 'the bytes of a file (Uint8Array or ArrayBuffer)', file);
    return [name, copied(name, () => new Uint8Array(is<Uint8Array>(file, 'Uint8Array') ? file : file.slice(0)))] as const;
  });
  return Object.fromEntries(files);
}

const isFile = (file: unknown): file is BytesInput => is<Uint8Array>(file, 'Uint8Array') || is<ArrayBuffer>(file, 'ArrayBuffer');

/** Private copies of files of weights; nothing for those that ship. */
export function weightsOf(given: MatcherOptions['weights'] | null): Uint8Array<ArrayBuffer>[] | undefined {
  if (given === undefined || given === null) return undefined;
  const files: readonly unknown[] = Array.isArray(given) ? given : [given];
  if (files.length === 0) throw wrong('weights', 'the bytes of at least one file', given);
  return files.map((file) => {
    if (!isFile(file)) throw wrong('weights', 'the bytes of a file (Uint8Array or ArrayBuffer), or several', file);
    return copied('the weights', () => new Uint8Array(is<Uint8Array>(file, 'Uint8Array') ? file : file.slice(0)));
  });
}

/** A private copy of a Laplacian's arrays. */
export function laplacianOf(input: Omit<Laplacian, 'kind'>): Calls['spectrum']['ask']['laplacian'] {
  if (!isObject(input) || !('indptr' in input)) {
    throw wrong('the laplacian', 'what matcher.laplacian() gives, { indptr, indices, values, mass }', input);
  }
  const { indptr, indices, values, mass } = input;
  for (const [what, array] of Object.entries({ indptr, indices })) {
    if (!is<Uint32Array>(array, 'Uint32Array')) throw wrong(what, 'a Uint32Array', array);
  }
  for (const [what, array] of Object.entries({ values, mass })) {
    if (!is<Float64Array>(array, 'Float64Array')) throw wrong(what, 'a Float64Array', array);
  }
  return copied('the laplacian', () => ({
    indptr: indptr.slice(),
    indices: indices.slice(),
    values: values.slice(),
    mass: mass.slice(),
  }));
}

/** Options taken apart: what concerns the call, and a private copy of the rest, in which null is as good as nothing. Files are copied where they are read. */
export function optionsOf<T extends CallOptions>(options: T | undefined): { call: CallOptions; rest: Omit<T, keyof CallOptions> } {
  if (options !== undefined && !isObject(options)) throw wrong('the options', 'an object', options);
  const { signal, onProgress, ...others } = options ?? ({} as T);
  if (signal !== undefined && !is<AbortSignal>(signal, 'AbortSignal')) throw wrong('signal', 'an AbortSignal', signal);
  if (onProgress !== undefined && typeof onProgress !== 'function') throw wrong('onProgress', 'a function', onProgress);
  const given = Object.entries(others).filter(([, value]) => value !== undefined && value !== null);
  const [files, plain] = [given.filter(([key]) => key === 'companions'), given.filter(([key]) => key !== 'companions')];
  let rest: Omit<T, keyof CallOptions>;
  try {
    rest = { ...plainCopy(Object.fromEntries(plain)), ...Object.fromEntries(files) } as Omit<T, keyof CallOptions>;
  } catch (cause) {
    throw new GeoSeError('invalid-argument', `the options must be plain data: ${plain.map(([key]) => key).join(', ')}`, {}, { cause });
  }
  for (const [option, value] of Object.entries(rest)) OPTIONS.get(option)?.(option, value);
  return { call: { signal, onProgress }, rest };
}

/** Throws where an option is not what it can be. */
type Check = (option: string, value: unknown) => void;

const refuse = (option: string, wanted: string, value: unknown): never => {
  const got = shown(value);
  throw new GeoSeError('invalid-option', `${option} must be ${wanted}, not ${got}`, { option, wanted, got });
};
const oneOf =
  (...values: readonly string[]): Check =>
  (option, value) =>
    values.includes(value as string) || refuse(option, values.map((value) => `'${value}'`).join(' or '), value);
const count: Check = (option, value) => Number.isInteger(value) || refuse(option, 'a whole number', value);
const yesOrNo: Check = (option, value) => typeof value === 'boolean' || refuse(option, 'true or false', value);
const number: Check = (option, value) => (typeof value === 'number' && Number.isFinite(value)) || refuse(option, 'a finite number', value);
const laplacian = oneOf('geodesic', 'geodesic-literal', 'euclidean', 'gaussian', 'cotangent');
const pairs: Check = (option, value) => {
  if (!Array.isArray(value)) return refuse(option, 'an array of pairs [point of a, point of b]', value);
  for (const [at, pair] of value.entries()) {
    if (!Array.isArray(pair) || pair.length !== 2) refuse(`${option}[${at}]`, 'a pair [point of a, point of b]', pair);
    for (const [side, index] of pair.entries()) isIndex(index) || refuse(`${option}[${at}][${side}]`, 'the index of a point', index);
  }
};

/** What an option can be, by its name. Unknown names and numbers out of range are the matcher's to refuse. */
const OPTIONS = new Map<string, Check>([
  ['points', count],
  ['eigenpairs', count],
  ['faces', oneOf('use', 'ignore')],
  ['laplacian', laplacian],
  ['kind', laplacian],
  ['k0', count],
  ['k', count],
  ['tau', number],
  ['iterations', count],
  ['sigma', number],
  ['up', oneOf('x', 'y', 'z')],
  ['wholeScan', yesOrNo],
  ['share', number],
  ['pose', oneOf('saved', 'rest')],
  ['parts', oneOf('predicted', 'given', 'none')],
  ['refine', oneOf('best', 'zoomout', 'none')],
  ['landmarks', pairs],
]);

/** A typo would otherwise be a silent default. */
export function nothingElse(what: string, rest: object, known: readonly string[]): void {
  const unknown = Object.keys(rest);
  if (unknown.length === 0) return;
  throw new GeoSeError('invalid-argument', `${what} may have ${known.join(', ')}, but not ${unknown.join(', ')}`, { unknown, known });
}

/** The error for an argument of the wrong type. */
export function wrong(what: string, wanted: string, found: unknown): GeoSeError {
  const got = shown(found);
  return new GeoSeError('invalid-argument', `${what} must be ${wanted}, not ${got}`, { argument: what, wanted, got });
}

/** A value in a sentence: an object by its type. */
function shown(value: unknown): string {
  if (isObject(value)) return tagOf(value);
  if (typeof value === 'string') return JSON.stringify(value.slice(0, 40));
  return typeof value === 'bigint' ? `the BigInt ${value}` : String(value);
}

/** A copy; of a detached buffer there is none, and of a huge one perhaps not. */
function copied<T>(what: string, copy: () => T): T {
  try {
    return copy();
  } catch (cause) {
    if (cause instanceof RangeError) throw new GeoSeError('out-of-memory', `there is no memory for a copy of ${what}`, {}, { cause });
    throw new GeoSeError('invalid-argument', `${what} cannot be copied: ${(cause as Error).message}`, { argument: what }, { cause });
  }
}

function coordinates(positions: ArrayInput['positions']): Float64Array<ArrayBuffer> {
  if (is<Float32Array | Float64Array>(positions, 'Float32Array', 'Float64Array'))
    return copied('positions', () => new Float64Array(positions));
  if (!Array.isArray(positions)) throw wrong('positions', 'a Float32Array, a Float64Array or an array of numbers', positions);
  const at = positions.findIndex((value) => typeof value !== 'number');
  if (at >= 0) throw wrong(`positions[${at}]`, 'a number', positions[at]);
  return copied('positions', () => new Float64Array(positions));
}

function indices(what: 'faces' | 'labels', values: ArrayInput['faces' | 'labels']): Uint32Array<ArrayBuffer> | undefined {
  if (values === undefined || values === null) return undefined;
  if (is<Uint32Array | Uint16Array | Uint8Array>(values, 'Uint32Array', 'Uint16Array', 'Uint8Array'))
    return copied(what, () => new Uint32Array(values));
  if (!is<Int32Array>(values, 'Int32Array') && !Array.isArray(values)) {
    throw wrong(what, 'a Uint32Array, Uint16Array, Uint8Array, Int32Array or an array of numbers', values);
  }
  const at = values.findIndex((value: unknown) => !isIndex(value));
  if (at >= 0) throw wrong(`${what}[${at}]`, 'a whole number from 0 to 4294967295', values[at]);
  return copied(what, () => new Uint32Array(values));
}

const isIndex = (value: unknown): boolean => typeof value === 'number' && value >>> 0 === value;

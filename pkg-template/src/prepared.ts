/// <reference lib="esnext.disposable" preserve="true" />
import { Block } from './block.js';
import { disposable } from './disposable.js';
import { GeoSeError } from './error.js';
import type { Geometry, Parts, Repair, ShapeInfo, Spectrum } from './results.js';

let create: (block: Block) => PreparedShape;
let open: (shape: PreparedShape) => Block;

/**
 * A scan with everything a match needs to know of it: one flat block of bytes that belongs to JavaScript. It outlives the
 * worker that made it, and any matcher of the same version can use it.
 */
export class PreparedShape {
  /** What was found out about the scan. */
  readonly info: ShapeInfo;
  /** What the reader or the sanitiser changed. */
  readonly repairs: readonly Repair[];
  #block: Block | null;
  #parts: Parts | null | undefined;

  static {
    create = (block) => new PreparedShape(block);
    open = (shape) => shape.#open();
    disposable(PreparedShape.prototype, 'free');
  }

  private constructor(block: Block) {
    this.#block = block;
    this.info = block.json<ShapeInfo>('info');
    this.repairs = block.json<Repair[] | null>('repairs') ?? [];
  }

  /** Body parts of the uploaded points, as given with the scan or else as predicted; null when there are neither. */
  get parts(): Parts | null {
    const block = this.#open();
    return (this.#parts ??= partsOf(block));
  }

  /** Of a piece, how much of a body it is and of which parts: `47 % of a body: head, torso, left arm`; null of a whole body. */
  get extent(): string | null {
    return this.#open().json<string | null>('extent');
  }

  /** Uploaded points that stay without a partner in any match, ascending: what was set aside and strays, if they are far from the body. */
  get unmatched(): Uint32Array<ArrayBuffer> {
    const { points } = this.info;
    // A scan with points put between the uploaded ones names some of those, too.
    return (this.#open().uint32('unmatched') ?? new Uint32Array()).filter((point) => point < points);
  }

  /** The scan as it was read. */
  geometry(): Geometry {
    const block = this.#open();
    const faces = block.uint32('faces');
    return {
      positions: block.float64('positions') ?? new Float64Array(),
      faces: faces?.length ? faces : null,
      labels: block.uint32('labels'),
    };
  }

  /**
   * The spectral basis at the uploaded points. Where it was solved for fewer (samples of a cloud, a simplified mesh), the others have the value
   * of the nearest one, and no mass. Where it was solved for points between them as well (a body put together from shells), uploaded points have the mass
   * of those they stand for too, and ΦᵀMΦ = I holds only roughly. The arrays are as large as the scan: n × k numbers of 8 bytes.
   */
  spectrum(): Spectrum {
    const block = this.#open();
    const eigenvalues = block.float64('eigenvalues') ?? new Float64Array();
    const eigenvectors = block.float64('eigenvectors') ?? new Float64Array();
    const mass = block.float64('mass') ?? new Float64Array();
    const samples = sampling(block);
    if (!samples) return { eigenvalues, eigenvectors, mass };
    return {
      eigenvalues,
      eigenvectors: rows(Float64Array, eigenvectors, eigenvalues.length, samples.nearest),
      mass: scattered(mass, samples.indices, samples.nearest.length),
    };
  }

  /** One eigenfunction of the basis at the uploaded points: a column of `spectrum().eigenvectors`. */
  eigenfunction(index: number): Float64Array<ArrayBuffer> {
    const block = this.#open();
    const [length = 0, k = 0] = block.shape('eigenvectors') ?? [];
    if (!Number.isInteger(index) || index < 0 || index >= k) {
      throw new GeoSeError('invalid-argument', `there is no eigenfunction ${index}: the basis has ${k}`, { index, eigenpairs: k });
    }
    const eigenvectors = block.float64('eigenvectors') ?? new Float64Array();
    const column = Float64Array.from({ length }, (_, row) => eigenvectors[row * k + index] ?? 0);
    const samples = sampling(block);
    return samples ? rows(Float64Array, column, 1, samples.nearest) : column;
  }

  /** Lets go of the block. Calls that are already under way finish. */
  free(): void {
    this.#block = null;
    this.#parts = null;
  }

  #open(): Block {
    if (!this.#block) throw new GeoSeError('freed', 'the prepared shape was freed', { name: this.info.name });
    return this.#block;
  }
}

/** `using` frees a prepared shape, where the engine knows `Symbol.dispose`. */
export interface PreparedShape extends Disposable {}

/** Takes over the bytes of a block. */
export const preparedFrom = (bytes: Uint8Array<ArrayBuffer>): PreparedShape => create(new Block(bytes));

/** The bytes of a block, to be read only. Throws a `GeoSeError` when the shape was freed. */
export const blockOf = (shape: PreparedShape): Uint8Array<ArrayBuffer> => open(shape).bytes;

function partsOf(block: Block): Parts | null {
  const parts = block.json<Pick<Parts, 'names' | 'source' | 'groups'> | null>('parts');
  const table = parts && (parts.source === 'given' ? givenParts(block, parts.names.length) : predictedParts(block, parts.names.length));
  if (!table) return null;
  let probabilities: Parts['probabilities'] | undefined;
  return {
    ...parts,
    labels: table.labels,
    get probabilities() {
      return (probabilities ??= table.probabilities());
    },
  };
}

/** Labels per uploaded point, and how to make the matrix of probabilities: for a large scan it is large, and few ask for it. */
type PartTable = Pick<Parts, 'labels'> & { probabilities(): Parts['probabilities'] };

function givenParts(block: Block, count: number): PartTable | null {
  const given = block.uint32('labels');
  if (!given) return null;
  return {
    labels: Uint8Array.from(given),
    probabilities() {
      const certain = new Float32Array(given.length * count);
      given.forEach((label, point) => (certain[point * count + label] = 1));
      return certain;
    },
  };
}

function predictedParts(block: Block, count: number): PartTable | null {
  const [labels, probabilities] = [block.uint8('partLabels'), block.float32('partProbabilities')];
  if (!labels || !probabilities) return null;
  const used = rowsUsed(block);
  if (!used) return { labels, probabilities: () => probabilities };
  return { labels: rows(Uint8Array, labels, 1, used), probabilities: () => rows(Float32Array, probabilities, count, used) };
}

/** For each uploaded point the row of the point used that stands for it; null when every point is used, and no others. */
function rowsUsed(block: Block): Uint32Array | null {
  const [nearest, used] = [sampling(block)?.nearest, block.uint32('usedOf')];
  if (!used) return nearest ?? null;
  return nearest ? rows(Uint32Array, used, 1, nearest) : used;
}

type Table = Float64Array<ArrayBuffer> | Float32Array<ArrayBuffer> | Uint32Array<ArrayBuffer> | Uint8Array<ArrayBuffer>;

/**
 * The uploaded point that has the mass of each row of the basis, and the row that stands for each uploaded point; null when every point has a row of its own,
 * and there are no others.
 */
function sampling(block: Block): { indices: Uint32Array; nearest: Uint32Array } | null {
  const [points = 0] = block.shape('positions') ?? [];
  // Points that were put between the uploaded ones are numbered after them.
  const added = block.uint32('standsFor') ?? new Uint32Array();
  const [carriers, carrierOf] = [block.uint32('carriers'), block.uint32('carrierOf')];
  if (!carriers && added.length === 0) return null;
  const uploaded = (point: number) => (point < points ? point : (added[point - points] ?? 0));
  return {
    indices: (carriers ?? numbers(points + added.length)).map(uploaded),
    nearest: (carrierOf ?? numbers(points)).subarray(0, points),
  };
}

/** 0, 1, 2, … */
const numbers = (length: number): Uint32Array => Uint32Array.from({ length }, (_, i) => i);

/** For each index the row of a (·, `width`) matrix, in an array of the type `Kind`. */
function rows<A extends Table>(Kind: new (length: number) => A, matrix: A, width: number, indices: Uint32Array): A {
  const out = new Kind(indices.length * width);
  indices.forEach((row, i) => out.set(matrix.subarray(row * width, (row + 1) * width), i * width));
  return out;
}

/** Sums of the values at each index below `length`. */
function scattered(values: Float64Array, indices: Uint32Array, length: number): Float64Array<ArrayBuffer> {
  const out = new Float64Array(length);
  indices.forEach((index, i) => (out[index] = (out[index] ?? 0) + (values[i] ?? 0)));
  return out;
}

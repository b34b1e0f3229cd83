/** The steps a caller can wait for, in the order of the pipeline. */
export const STAGES = [
  'read',
  'sample',
  'graph',
  'laplacian',
  'spectrum',
  'features',
  'functional-map',
  'refine',
  'correspondence',
] as const;

/** One step of the pipeline. */
export type Stage = (typeof STAGES)[number];

/** Seconds spent per stage; stages that did not run are absent. */
export type StageSeconds = Readonly<Partial<Record<Stage, number>>>;

/** Something to know before trusting a match. */
export interface Warning {
  /** Stable name: `'out-of-distribution'`, `'several-pieces'`, … */
  readonly code: string;
  /** A sentence for a person. */
  readonly message: string;
}

/** What a point of `targetOf` holds when it has no partner. */
export const UNMATCHED = 0xffffffff;

/**
 * How the Laplacian of a shape is built: `'gaussian'` is the traditional one of the paper, and of it and `'geodesic-literal'` every point has mass 1, as
 * printed there; the mass of the others sums to the area.
 */
export type LaplacianKind = 'geodesic' | 'geodesic-literal' | 'euclidean' | 'gaussian' | 'cotangent';

/** A coordinate axis. */
export type Axis = 'x' | 'y' | 'z';

/** Where the work happens, and why there. */
export interface Device {
  readonly kind: 'cpu' | 'webgpu';
  /** A sentence for a person. */
  readonly reason: string;
  /** Name of the graphics adapter, when there is one. */
  readonly adapter?: string;
}

/** A device failed, and the CPU did its work again. */
export interface Fallback {
  /** The stage in which it failed. */
  readonly stage: Stage;
  /** A sentence for a person. */
  readonly reason: string;
}

/** What was found out about a scan while it was prepared. */
export interface ShapeInfo {
  readonly kind: 'mesh' | 'cloud';
  /** As given to `prepare`; null when there was none. */
  readonly name: string | null;
  /** Points as uploaded. */
  readonly points: number;
  /** Triangles as read; 0 for a cloud. */
  readonly faces: number;
  /** Connected pieces. */
  readonly pieces: number;
  /** Points that take part in the matching; more than `points` where some were put between the uploaded ones, as in a body put together from shells. */
  readonly pointsUsed: number;
  /** Unit of length in which the scan has the size of a body; null when none fits. */
  readonly unit: 'm' | 'cm' | 'mm' | null;
  /** Axis a standing body would have upright, given or clearly the longest; null when it is not clear. */
  readonly upAxis: Axis | null;
  /** √area of the whole body in the unit of the file: what lengths are divided by. */
  readonly scale: number;
  /** Share of the body's surface that the scan has; 1 unless a network took it for a piece. */
  readonly share: number;
  /** Whether the mesh ends somewhere, as where something was cut off or is hidden. A cloud does not say. */
  readonly borders: boolean;
  /** How far the scan can be relied on, in (0, 1]: confidence is multiplied by it. It is below 1 where coordinates are coarse or points few, as repairs say. */
  readonly reliability: number;
  readonly laplacian: LaplacianKind;
  /** Eigenpairs k of the spectral basis. */
  readonly eigenpairs: number;
  /** Largest residual of the eigenpairs, relative to the largest eigenvalue. */
  readonly residual: number;
  readonly seconds: StageSeconds;
  /** Where and why the CPU took over from a device that failed; null when none did. */
  readonly fallback: Fallback | null;
}

/** One kind of thing the reader or the sanitiser changed. */
export interface Repair {
  /** Stable name: `'zero-area-faces'`, `'floor-set-aside'`, … */
  readonly code: string;
  /** How many times; of what was set aside, how many points. */
  readonly count: number;
  /** A sentence for a person. */
  readonly message: string;
}

/** A scan as it was read, in its own unit and order. */
export interface Geometry {
  /** (n, 3), row-major. */
  positions: Float64Array<ArrayBuffer>;
  /** (m, 3), row-major, indices of points; null for a cloud. */
  faces: Uint32Array<ArrayBuffer> | null;
  /** One per point; null when none were given. */
  labels: Uint32Array<ArrayBuffer> | null;
}

/**
 * Body parts of every uploaded point. Labels that came with the scan, each below 256, go before what the network predicts, and hide it: prepare the scan
 * without labels to see it. Points that take no part in the matching have the prediction of the one that stands for them.
 */
export interface Parts {
  /** (n): index into `names`; of predicted parts the likeliest. */
  labels: Uint8Array<ArrayBuffer>;
  /** (n, `names.length`), row-major, each row sums to 1. Given labels are certain: 1 at the label, 0 elsewhere. Made when first asked for. */
  readonly probabilities: Float32Array<ArrayBuffer>;
  /** Predicted: 14, with a side where they have one, which is the person's own. Given labels have numbers for names. */
  names: string[];
  source: 'given' | 'predicted';
  /** Of predicted parts: 8 coarser ones (an arm with its hand, a shank with its foot), and for each of `names` the index of its group. */
  groups?: { names: string[]; of: number[] };
}

/** A sparse symmetric operator L with its mass M: compressed rows of an (n, n) matrix. */
export interface Laplacian {
  kind: LaplacianKind;
  /** (n + 1): where each row starts in `indices` and `values`. */
  indptr: Uint32Array<ArrayBuffer>;
  /** Column of each entry. */
  indices: Uint32Array<ArrayBuffer>;
  /** Value of each entry. */
  values: Float64Array<ArrayBuffer>;
  /** (n): area per point, in squared units of the scan; for `'geodesic-literal'` 1 each. */
  mass: Float64Array<ArrayBuffer>;
}

/** The first k solutions of L φ = λ M φ, smallest λ first; ΦᵀMΦ = I. */
export interface Spectrum {
  /** (k), in 1 / squared units. */
  eigenvalues: Float64Array<ArrayBuffer>;
  /** (n, k), row-major. */
  eigenvectors: Float64Array<ArrayBuffer>;
  /** (n): area per point; for `'geodesic-literal'` 1 each. */
  mass: Float64Array<ArrayBuffer>;
}

/** How eigenpairs were found, and how good they are. */
export interface SpectrumReport {
  /** Solves with the factorised matrix, in blocks. */
  readonly applications: number;
  /** Restarts of the iteration. */
  readonly restarts: number;
  /** Largest residual, relative to the largest eigenvalue. */
  readonly residual: number;
  /** Connected pieces, each with an eigenvalue 0 of its own. */
  readonly pieces: number;
  /** Whether it was proved that no eigenvalue in between is missing. */
  readonly complete: boolean;
}

/** A spectrum just computed. */
export interface SolvedSpectrum extends Spectrum {
  report: SpectrumReport;
}

/** A linear map between the spectral bases of two shapes: functions on the first → functions on the second. */
export interface FunctionalMap {
  /** Eigenpairs of the shape that functions arrive on. */
  rows: number;
  /** Eigenpairs of the shape that functions come from. */
  cols: number;
  /** (rows, cols), row-major. */
  data: Float64Array<ArrayBuffer>;
}

/** A map from the points of one shape to the points of another. */
export interface DirectedMap {
  /** For each point of the first shape, as uploaded, the index of its point in the second, as uploaded; `UNMATCHED` if none. */
  targetOf: Uint32Array<ArrayBuffer>;
  /** One per point of the first shape: the probability that its point is within 5 % of √area of the right one, a hand’s width on a person; 0 where unmatched. */
  confidence: Float32Array<ArrayBuffer>;
  /** One per point of the first shape: the probability that it has a partner at all; below 0.1 it is left unmatched. 1 where both are whole bodies or the second is a closed one; 0 of points set aside. */
  overlap: Float32Array<ArrayBuffer>;
  /** Functions on the first shape → functions on the second. */
  functionalMap: FunctionalMap;
}

/** How a match came about. */
export interface MatchReport {
  /** The device that the match ran on, or began on. */
  device: Device['kind'];
  /** Where and why the run continued on the CPU; null when nothing failed. */
  fallback: Fallback | null;
  seconds: StageSeconds;
  /** Points of a and of b that took part, those put between uploaded ones included. */
  pointsUsed: [number, number];
  /** Largest size of the wasm memory so far, in bytes. */
  peakMemoryBytes: number;
  gpu: { dispatches: number; uploads: number; downloads: number };
  /** What to know before trusting it. */
  warnings: Warning[];
  /** The kind of body that the pair is taken to be of, such as `'people'`; null where no network is at home with it. */
  category: string | null;
  /** The weights of the network that took part; null when none did. */
  weights: { name: string; version: string } | null;
  /**
   * How large the body of a is beside that of b: √area of one whole body over that of the other, each in the unit of its file. Found by `'areas'` where both are whole; for a
   * piece of a body by how much of it the `'network'` takes it for, or by that and then by the lengths that the `'match'` keeps.
   */
  scale: { ratio: number; found: 'areas' | 'network' | 'match' };
}

/** The map from a to b, the map back, and how they came about. */
export interface Match extends DirectedMap {
  /** From b to a. */
  reverse: DirectedMap;
  report: MatchReport;
}

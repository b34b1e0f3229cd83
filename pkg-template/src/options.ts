import type { Address, BlobInput, CompiledModule, Fetched, Signal } from './ambient.js';
import type { Axis, LaplacianKind, Stage } from './results.js';

/** Where the wasm comes from: an address, a response, the bytes, or the compiled module itself. */
export type WasmSource = string | Address | Fetched | Promise<Fetched> | ArrayBuffer | ArrayBufferView<ArrayBuffer> | CompiledModule;

/** The content of a file. */
export type BytesInput = Uint8Array | ArrayBuffer;

/** How a matcher is made. */
export interface MatcherOptions {
  /**
   * `'auto'` (default) takes a graphics card where WebGPU has one that computes rightly, else the CPU. `'cpu'` gives the same bytes everywhere. `'webgpu'`
   * insists, also on an adapter in software, and rejects with `'device-unavailable'` without one.
   */
  device?: 'auto' | 'cpu' | 'webgpu' | undefined;
  /**
   * Files of network weights in place of those that ship, one or one for each category of bodies. Of several the one most at home with a pair matches it, and
   * `report.category` and `report.weights` say which. They are copied.
   */
  weights?: BytesInput | readonly BytesInput[] | undefined;
  /** Instead of `geose_fmap_bg.wasm` beside the package's own files. */
  wasm?: WasmSource | undefined;
  /** Address of the package's `worker.js`, for a CDN or a bundler that does not find it. Another origin is reached through a blob. */
  worker?: string | Address | undefined;
}

/** How far a call has come. */
export interface Progress {
  stage: Stage;
  /** Finished part of the stage, in [0, 1]. */
  fraction: number;
}

/** What every long call understands. */
export interface CallOptions {
  /** Aborting it ends the call within 300 ms with a `GeoSeError` of code `'cancelled'`. */
  signal?: Signal | undefined;
  /** Hears of progress, at most about 30 times a second and stage. If it throws, the error is reported as uncaught and the call goes on without it. */
  onProgress?: ((progress: Progress) => void) | undefined;
}

/** A scan as a file: the bytes, or a `Blob` or `File`, whose name is then used. */
export type FileInput = Uint8Array | ArrayBuffer | BlobInput;

/** A scan as arrays. */
export interface ArrayInput {
  /** (n, 3), row-major, any unit. */
  positions: Float32Array | Float64Array | readonly number[];
  /** (m, 3), row-major, indices of points; absent for a cloud. */
  faces?: Uint32Array | Uint16Array | Uint8Array | Int32Array | readonly number[] | null | undefined;
  /** Part of each point. */
  labels?: Uint8Array | Uint16Array | Uint32Array | Int32Array | readonly number[] | null | undefined;
}

/** A scan to be read. It is copied when the call is made, never detached or changed. */
export type ShapeInput = FileInput | ArrayInput;

/** File formats that can be read. */
export type FileFormat = 'obj' | 'ply' | 'off' | 'stl' | 'glb' | 'gltf' | 'xyz' | 'pts' | 'csv';

/** How a file is to be read. */
export interface ReadOptions {
  /** File name: its ending helps to find the format, and `info.name` repeats it. */
  name?: string | undefined;
  /** Instead of finding it out from the bytes and the name. */
  format?: FileFormat | undefined;
  /** Of a glTF with a skeleton or morph targets: `'saved'` (default), as its nodes and weights stand, or `'rest'`, as its points are stored. */
  pose?: 'saved' | 'rest' | undefined;
  /** Files beside this one, by name: the `.bin` that a `.gltf` keeps its data in. They are copied. */
  companions?: Readonly<Record<string, BytesInput>> | undefined;
}

/** How a scan is prepared. */
export interface PrepareOptions extends CallOptions, ReadOptions {
  /** Points to sample (default 5000); scans of up to 1.5 times as many stay whole. A match compares at most 7500 of them, evenly chosen, and the others follow. */
  points?: number | undefined;
  /** `'ignore'` treats a mesh as a cloud. */
  faces?: 'use' | 'ignore' | undefined;
  /** Default `'cotangent'` for meshes, `'geodesic'` for clouds. */
  laplacian?: LaplacianKind | undefined;
  /** Eigenpairs of the basis (default 120); the network has those that it looks at all the same. */
  eigenpairs?: number | undefined;
  /** Axis that points up, where it is known; shown in `info`, the match does not depend on it. */
  up?: Axis | undefined;
  /**
   * Whether all of the scan is the body. By default (`false`) a floor, furniture, other bodies, loose pieces and garments are set aside where the network is more certain of what is
   * left: `repairs` say so (`'floor-set-aside'`, `'furniture-set-aside'`, `'others-set-aside'`, `'piece-set-aside'`, `'garment-set-aside'`), and points far from the body are among `unmatched`.
   */
  wholeScan?: boolean | undefined;
  /** How much of a body's surface the scan has, 0.05 to 1, where it is known: 1 is a whole body. By default the network says, and `info.share` repeats it. */
  share?: number | undefined;
}

/** How a Laplacian is built. What its kind does not have is refused with `'invalid-option'`; left out, it is as the paper has it. */
export interface LaplacianOptions extends CallOptions, ReadOptions {
  /** Default `'cotangent'` for meshes, `'geodesic'` for clouds. */
  kind?: LaplacianKind | undefined;
  /** k₀ of Algorithm 1 (default 5, from 1 to k): neighbours in the graph that geodesics start from. For the geodesic kinds. */
  k0?: number | undefined;
  /** k of Algorithm 1 (default 20, from 3 to 200): candidate neighbours. For all kinds but `'cotangent'`. */
  k?: number | undefined;
  /** τ of Algorithm 1 (default 3, from 1 to 1000): a candidate stays while geodesic / Euclidean distance is below. For the geodesic kinds. */
  tau?: number | undefined;
  /** T of Algorithm 1 (default 3, from 0 to 100): rounds in which candidates are considered. For the geodesic kinds. */
  iterations?: number | undefined;
  /** σ of the weights, in the unit of the scan (default: mean distance to the k neighbours). For `'gaussian'` and `'geodesic-literal'`. */
  sigma?: number | undefined;
}

/** How eigenpairs are computed. */
export interface SpectrumOptions extends CallOptions {
  /** At most this many (default 120), and at most n − 2. */
  eigenpairs?: number | undefined;
}

/** How two shapes are matched. */
export interface MatchOptions extends CallOptions {
  /**
   * Which body parts keep points of different parts apart: those that the network predicts, as far as it is sure of them (default), the labels
   * that came with both scans, strictly, or none.
   */
  parts?: 'predicted' | 'given' | 'none' | undefined;
  /** How the first map is polished (default `'best'`). */
  refine?: 'best' | 'zoomout' | 'none' | undefined;
  /** Pairs [point of a, point of b] that belong together, as uploaded; they hold exactly, and what lies around them follows. */
  landmarks?: readonly (readonly [number, number])[] | undefined;
}

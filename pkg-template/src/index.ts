export { GeoSeError, type ErrorCode, type ErrorDetails } from './error.js';
export { Matcher } from './matcher.js';
export type {
  ArrayInput,
  CallOptions,
  FileFormat,
  FileInput,
  LaplacianOptions,
  MatcherOptions,
  MatchOptions,
  PrepareOptions,
  Progress,
  ReadOptions,
  ShapeInput,
  SpectrumOptions,
  WasmSource,
} from './options.js';
export { PreparedShape } from './prepared.js';
export {
  STAGES,
  UNMATCHED,
  type Axis,
  type Device,
  type DirectedMap,
  type Fallback,
  type FunctionalMap,
  type Geometry,
  type Laplacian,
  type LaplacianKind,
  type Match,
  type MatchReport,
  type Parts,
  type Repair,
  type ShapeInfo,
  type Spectrum,
  type Stage,
  type StageSeconds,
} from './results.js';

/**
 * Errors this package raises itself. Errors about a scan come from the matcher and carry its own codes (`'truncated-file'`, `'too-few-points'`, …), so the
 * type stays open.
 */
export type ErrorCode =
  /** An argument of the wrong type or shape. */
  | 'invalid-argument'
  /** An option that is not known, not of its kind or out of range. */
  | 'invalid-option'
  /** The `signal` of the call was aborted; `cause` is its reason. */
  | 'cancelled'
  /** The instance trapped or its worker died. The next call runs in a fresh one. */
  | 'crashed'
  /** The instance could not get the memory it asked for. The next call runs in a fresh one. */
  | 'out-of-memory'
  /** The matcher was disposed of. */
  | 'disposed'
  /** The prepared shape was freed. */
  | 'freed'
  /** The device asked for is not part of this build. */
  | 'device-not-in-build'
  /** WebGPU was asked for, and there is none or none that computes rightly. */
  | 'device-unavailable'
  /** The wasm file could not be fetched or compiled. */
  | 'wasm-unavailable'
  /** The worker file could not be fetched or started. */
  | 'worker-unavailable'
  /** Network weights that cannot be used. */
  | 'invalid-weights'
  /** A scan that was prepared with other weights than the matcher's. */
  | 'other-weights'
  /** A `Blob` could not be read. */
  | 'unreadable-file'
  | (string & {});

/** The numbers behind a message: `{ promised: 60000, found: 41232 }`. */
export type ErrorDetails = Readonly<Record<string, unknown>>;

/** What every call of this package rejects with: a stable `code`, a sentence for a person, and the numbers behind it. */
export class GeoSeError extends Error {
  override readonly name = 'GeoSeError';
  readonly code: ErrorCode;
  readonly details: ErrorDetails;

  constructor(code: ErrorCode, message: string, details: ErrorDetails = {}, options?: ErrorOptions) {
    super(message, options);
    this.code = code;
    this.details = details;
  }
}

import type { PreparedShape } from 'geose-fmap';

/** One eigenfunction of a scan's Laplacian at every uploaded point. */
export interface Eigenfunction {
  readonly values: Float64Array;
  /** Largest absolute value, for a scale that is even around zero. */
  readonly largest: number;
}

/** Eigenfunction number `index` (0 is the constant one), or null when fewer were computed. */
export function eigenfunctionOf(shape: PreparedShape, index: number): Eigenfunction | null {
  if (index >= shape.info.eigenpairs) return null;
  const values = shape.eigenfunction(index);
  return { values, largest: values.reduce((most, value) => Math.max(most, Math.abs(value)), Number.MIN_VALUE) };
}

import { UNMATCHED, type Match } from 'geose-fmap';
import type { Scan } from './app-state';

/** Below this a match is called doubtful. */
export const doubtful = 0.5;

/** How far a match agrees with itself. */
export interface Certainty {
  /** Points of A, and how many of them have a point on B. */
  readonly points: number;
  readonly matched: number;
  /** How many of the matched points have a confidence below `doubtful`. */
  readonly doubted: number;
  /**
   * How far from where they began points of A are when they have been taken to B and back, straight, in units of A's √area:
   * the distance that half of them stay below, and the one that nine in ten do. Null when none comes back.
   */
  readonly astray: { readonly half: number; readonly most: number } | null;
}

/** Counts over all points of A. */
export function certaintyOf({ targetOf, confidence, reverse }: Match, a: Scan): Certainty {
  const { positions } = a.shape.geometry();
  const distances: number[] = [];
  let [matched, doubted] = [0, 0];
  targetOf.forEach((j, i) => {
    if (j === UNMATCHED) return;
    matched++;
    if (confidence[i] < doubtful) doubted++;
    const back = reverse.targetOf[j];
    if (back === UNMATCHED) return;
    const along = (axis: number): number => positions[3 * back + axis] - positions[3 * i + axis];
    distances.push(Math.hypot(along(0), along(1), along(2)) / a.shape.info.scale);
  });
  const sorted = Float64Array.from(distances).sort();
  const quantile = (share: number): number => sorted[Math.floor(share * (sorted.length - 1))];
  return { points: targetOf.length, matched, doubted, astray: sorted.length > 0 ? { half: quantile(0.5), most: quantile(0.9) } : null };
}

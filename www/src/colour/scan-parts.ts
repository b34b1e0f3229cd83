import type { Parts, PreparedShape } from 'geose-fmap';
import type { AppState, Scan } from '../app-state';
import { sides, type Side } from '../side';

/** The parts of a scan without their probabilities, which the page does not draw. */
export interface ScanParts {
  /** Per point the number of its part. */
  readonly labels: Uint8Array;
  readonly names: readonly string[];
  readonly source: Parts['source'];
}

const kept = new WeakMap<PreparedShape, ScanParts | null>();

/** Asked for once per scan, because the package makes a matrix of probabilities each time. */
export function partsOf({ shape, source }: Scan): ScanParts | null {
  const known = kept.get(shape);
  if (known !== undefined) return known;
  const { parts } = shape;
  const { partNames = [] } = source;
  const found = parts && {
    labels: parts.labels,
    names: partNames.length >= parts.names.length ? partNames : parts.names,
    source: parts.source,
  };
  kept.set(shape, found);
  return found;
}

/** Whether any scan on show comes with parts, and if there is none, why they cannot be shown. */
export function partsMissing({ scans }: Pick<AppState, 'scans'>): string | null {
  const shown = sides.flatMap((side) => scans[side] ?? []);
  if (shown.length === 0) return 'no scan yet';
  return shown.every((scan) => partsOf(scan) === null) ? 'no labels came with these scans' : null;
}

/** Sides whose scan is there and has no parts. */
export const sidesWithoutParts = ({ scans }: Pick<AppState, 'scans'>): Side[] =>
  sides.filter((side) => {
    const scan = scans[side];
    return scan !== null && partsOf(scan) === null;
  });

/** One name per label number for both scans; where they call a number differently, both names. */
export function jointPartNames({ scans }: Pick<AppState, 'scans'>): readonly string[] {
  const lists = sides.flatMap((side) => {
    const scan = scans[side];
    const parts = scan && partsOf(scan);
    return parts ? [parts.names] : [];
  });
  const longest = Math.max(0, ...lists.map(({ length }) => length));
  return Array.from({ length: longest }, (_, label) => [...new Set(lists.flatMap((names) => names[label] ?? []))].join(' / '));
}

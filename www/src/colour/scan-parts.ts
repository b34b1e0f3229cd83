import type { Parts, PreparedShape } from 'geose-fmap';
import type { AppState, Scan } from '../app-state';
import { opposite, sides, type Side } from '../side';

/** The parts of a scan, under the names that the page knows for given labels. */
export interface ScanParts {
  /** Per point the number of its part. */
  readonly labels: Uint8Array;
  readonly names: readonly string[];
  readonly source: Parts['source'];
  /** How likely a point's part is, in [0, 1]. */
  likelihood(index: number): number;
}

const kept = new WeakMap<PreparedShape, ScanParts | null>();

/** Asked for once per scan. Its matrix of probabilities, large for a large scan, is only made when a likelihood is wanted. */
export function partsOf({ shape, source }: Scan): ScanParts | null {
  const known = kept.get(shape);
  if (known !== undefined) return known;
  const { parts } = shape;
  const { partNames = [] } = source;
  const found = parts && {
    labels: parts.labels,
    names: parts.source === 'given' && partNames.length >= parts.names.length ? partNames : parts.names,
    source: parts.source,
    likelihood: (index: number) => parts.probabilities[index * parts.names.length + parts.labels[index]],
  };
  kept.set(shape, found);
  return found;
}

/** Sides whose scan is there and brought no labels. */
export const sidesWithoutLabels = ({ scans }: Pick<AppState, 'scans'>): Side[] =>
  sides.filter((side) => {
    const scan = scans[side];
    return scan !== null && partsOf(scan)?.source !== 'given';
  });

/**
 * What the part numbers of a scan are called. Labels given with both scans number the same parts: where they call a number differently it has both
 * names. Given and predicted numbers have nothing to do with each other.
 */
export function partNames({ scans }: Pick<AppState, 'scans'>, side: Side): readonly string[] {
  const [own, other] = [side, opposite(side)].map((each) => {
    const scan = scans[each];
    return scan && partsOf(scan);
  });
  if (!own) return [];
  if (other?.source !== own.source) return own.names;
  const lists = side === 'a' ? [own.names, other.names] : [other.names, own.names];
  const longest = Math.max(...lists.map(({ length }) => length));
  return Array.from({ length: longest }, (_, label) => [...new Set(lists.flatMap((names) => names[label] ?? []))].join(' / '));
}

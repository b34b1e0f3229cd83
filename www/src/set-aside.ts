import type { PreparedShape, Repair } from 'geose-fmap';
import type { Scan } from './app-state';

/** Codes of repairs that say that something beside the body was left out; `wholeScan` keeps it. */
const codes: readonly string[] = ['floor-set-aside', 'furniture-set-aside', 'others-set-aside'];

/** What was left out of a scan beside its body. */
export const setAsideOf = ({ shape }: Scan): readonly Repair[] => shape.repairs.filter(({ code }) => codes.includes(code));

const kept = new WeakMap<PreparedShape, ReadonlySet<number>>();

/** Points of a scan that have no partner in any match: those of what was set aside and strays, if they are far from the body. */
export function withoutPartner({ shape }: Scan): ReadonlySet<number> {
  const known = kept.get(shape);
  if (known) return known;
  const points = new Set(shape.unmatched);
  kept.set(shape, points);
  return points;
}

import type { AppState, Selection } from './app-state';
import { partnerOf } from './match-direction';
import { opposite, type Side } from './side';

/** Point i of A is point j of B, said by the user. */
export type Landmark = readonly [i: number, j: number];

/** A landmark in the making: the point chosen so far on each side. */
export type Pairing = Readonly<Record<Side, number | null>>;

export const emptyPairing: Pairing = { a: null, b: null };

/** The landmarks with one more; a point has one place at most, so an older word about it gives way. */
export const withLandmark = (landmarks: readonly Landmark[], added: Landmark): readonly Landmark[] => [
  ...landmarks.filter(([i, j]) => i !== added[0] && j !== added[1]),
  added,
];

/** What a choice of a point does to the landmark in the making: the second side completes it, and the next one begins. */
export function chosenForLandmark(
  { pairing, landmarks }: Pick<AppState, 'pairing' | 'landmarks'>,
  selection: Selection,
): Pick<AppState, 'pairing' | 'landmarks' | 'pinned'> {
  const chosen: Pairing = { ...(pairing ?? emptyPairing), [selection.side]: selection.index };
  const { a, b } = chosen;
  // From the point chosen first, keys on the other body begin at its present match.
  if (a === null || b === null) return { pairing: chosen, landmarks, pinned: selection };
  return { pairing: emptyPairing, landmarks: withLandmark(landmarks, [a, b]), pinned: null };
}

/** A new landmark begins with the point of A on show, if there is one: it is most likely the one to be put right. */
export function firstPairing({ pinned, result }: Pick<AppState, 'pinned' | 'result'>): Pairing {
  if (!pinned) return emptyPairing;
  return { ...emptyPairing, a: pinned.side === 'a' ? pinned.index : result && partnerOf(result.match, 'b', pinned.index) };
}

/** The side that is still to be chosen when the other one is; null while both are open. */
export function sideAwaited({ a, b }: Pairing): Side | null {
  if (a === null && b === null) return null;
  return opposite(a === null ? 'b' : 'a');
}

/** One step back: the point chosen so far is let go, then the whole mode. */
export const releasedPairing = (pairing: Pairing): Pairing | null => (sideAwaited(pairing) ? emptyPairing : null);

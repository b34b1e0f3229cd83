import { UNMATCHED, type DirectedMap, type Match, type Warning } from 'geose-fmap';
import type { Side } from './side';

/** The half of a match that starts on `side`: the match itself from A, its reverse from B. */
export const directionFrom = (match: Match, side: Side): DirectedMap => (side === 'a' ? match : match.reverse);

/** The point of the other scan that `index` of `side` was matched with, or null. */
export function partnerOf(match: Match, side: Side, index: number): number | null {
  const partner = directionFrom(match, side).targetOf[index];
  return partner === undefined || partner === UNMATCHED ? null : partner;
}

/** The same match with A and B exchanged. */
export function reversed(match: Match): Match {
  const { targetOf, confidence, overlap, functionalMap, reverse, report } = match;
  const [usedA, usedB] = report.pointsUsed;
  return {
    ...reverse,
    reverse: { targetOf, confidence, overlap, functionalMap },
    report: {
      ...report,
      pointsUsed: [usedB, usedA],
      scale: { ...report.scale, ratio: 1 / report.scale.ratio },
      warnings: report.warnings.map(exchanged),
    },
  };
}

/** A warning about the scans A and B, which nothing else in its sentence is called, about B and A. */
const exchanged = ({ code, message }: Warning): Warning => ({
  code,
  message: message.replace(/\b[AB]\b/g, (scan) => (scan === 'A' ? 'B' : 'A')),
});

/** How many points of A found a partner. */
export const matchedCount = (match: Match): number => match.targetOf.reduce((count, target) => count + (target === UNMATCHED ? 0 : 1), 0);

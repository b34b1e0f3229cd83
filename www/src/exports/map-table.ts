import { UNMATCHED } from 'geose-fmap';
import type { Result, Scan } from '../app-state';

/** One line per point of A: `source,target,confidence`, the target left empty where there is none. */
export function mapAsCsv({ match }: Result): string {
  const lines = ['source,target,confidence'];
  match.targetOf.forEach((target, source) => {
    lines.push(`${source},${target === UNMATCHED ? '' : target},${match.confidence[source]}`);
  });
  return `${lines.join('\n')}\n`;
}

/** The same with what it was made from; `target` is null where there is none. */
export function mapAsJson({ match, choices, landmarks }: Result, a: Scan, b: Scan): string {
  const scan = ({ source, shape, choices: prepared, whole }: Scan): object => ({
    name: source.name,
    points: shape.info.points,
    kind: shape.info.kind,
    prepared: { ...prepared, ...(whole && { wholeScan: true }) },
    repairs: shape.repairs,
  });
  const { device, category, scale: ratio, warnings, weights } = match.report;
  const map = Array.from(match.targetOf, (target, source) => ({
    source,
    target: target === UNMATCHED ? null : target,
    confidence: match.confidence[source],
    overlap: match.overlap[source],
  }));
  return JSON.stringify({
    a: scan(a),
    b: scan(b),
    match: { ...choices, landmarks, device, weights, category, scale: ratio, warnings },
    map,
  });
}

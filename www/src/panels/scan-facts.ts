import type { AppStore, Scan } from '../app-state';
import { partsOf } from '../colour/scan-parts';
import { byId, create } from '../dom';
import { count, counted } from '../sentences';
import { letter, sides, type Side } from '../side';
import { coded } from './coded';
import { table } from './table';

/** What was found out about each scan, and what had to be repaired. */
export function showScanFacts(store: AppStore): void {
  const place = byId('scan-facts', HTMLElement);
  store.watch(['scans'], ({ scans }) => {
    const shown = sides.flatMap((side) => (scans[side] ? [{ side, scan: scans[side] }] : []));
    if (shown.length === 0) {
      place.replaceChildren(create('p', { className: 'facts', textContent: 'No scan yet.' }));
      return;
    }
    const rows = facts.map(([name, value]) => [name, ...shown.map(({ scan }) => value(scan))]);
    const head = ['', ...shown.map(({ side }) => letter(side))];
    place.replaceChildren(table('What was found out about each scan', head, rows), ...shown.map(({ side, scan }) => repairsOf(side, scan)));
  });
}

const facts: readonly (readonly [string, (scan: Scan) => string])[] = [
  ['Kind', ({ shape: { info } }) => (info.kind === 'cloud' && info.faces > 0 ? 'mesh, taken as cloud' : info.kind)],
  ['Points', ({ shape: { info } }) => count(info.points)],
  ['Faces', ({ shape: { info } }) => count(info.faces)],
  ['Pieces', ({ shape: { info } }) => count(info.pieces)],
  ['Unit', ({ shape: { info } }) => info.unit ?? 'not clear'],
  ['Up', ({ shape: { info } }) => info.upAxis ?? 'not clear'],
  ['Scale (√area)', ({ shape: { info } }) => `${info.scale.toPrecision(3)}${info.unit ? ` ${info.unit}` : ''}`],
  ['Of a body', ({ shape }) => shape.extent ?? 'all'],
  ['Points used', ({ shape: { info } }) => count(info.pointsUsed)],
  ['Laplacian', ({ shape: { info } }) => laplacianWords[info.laplacian]],
  ['Eigenpairs', ({ shape: { info } }) => count(info.eigenpairs)],
  ['Parts', (scan) => partsOf(scan)?.source ?? 'none'],
];

const laplacianWords = {
  geodesic: 'geodesic',
  'geodesic-literal': 'as printed',
  euclidean: 'Euclidean',
  gaussian: 'Gaussian, traditional',
  cotangent: 'cotangent',
} as const;

/** One sentence per kind of repair, folded away under their number. */
function repairsOf(side: Side, { shape: { repairs } }: Scan): HTMLElement {
  if (repairs.length === 0) return create('p', { className: 'facts', textContent: `Nothing in ${letter(side)} had to be repaired.` });
  const summary = create('summary', {}, `${letter(side)}: ${counted(repairs.length, 'repair')}`);
  const list = create('ul', {}, ...repairs.map((repair) => coded('li', repair)));
  return create('details', { className: 'repairs', id: `repairs-${side}` }, summary, list);
}

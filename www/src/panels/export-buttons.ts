import type { AppState, AppStore, Scan } from '../app-state';
import { paintScan } from '../colour/painted-colours';
import { byId } from '../dom';
import { bodyAsGlb, bodyAsPly } from '../exports/coloured-body';
import { download } from '../exports/download';
import { mapAsCsv, mapAsJson } from '../exports/map-table';
import { picture } from '../exports/picture';
import { sentence } from '../sentences';
import { sides, type Side } from '../side';
import type { Stage } from '../views/stage';

/** The map as CSV and JSON, the bodies with the colours on show as PLY and GLB, and the views as a picture. */
export function showExports(store: AppStore, stage: Stage | null): void {
  const csv = byId('export-csv', HTMLButtonElement);
  const json = byId('export-json', HTMLButtonElement);
  const png = byId('export-png', HTMLButtonElement);
  const bodies = sides.flatMap((side) =>
    formats.map((format) => ({ side, format, button: byId(`export-${side}-${format}`, HTMLButtonElement) })),
  );
  const trouble = byId('export-trouble', HTMLElement);
  const save = (write: () => Blob | Promise<Blob>, name: string): void => {
    trouble.textContent = '';
    // A scan may be too large for another copy of it: that is worth a sentence.
    void Promise.resolve()
      .then(write)
      .then((blob) => download(blob, name))
      .catch((error: unknown) => (trouble.textContent = sentence(error)));
  };
  store.watch(['scans', 'result'], ({ scans, result }) => {
    csv.disabled = json.disabled = !result;
    png.disabled = stage === null || (!scans.a && !scans.b);
    for (const { side, button } of bodies) button.disabled = scans[side] === null;
  });
  csv.addEventListener('click', () => {
    const { result } = store.get();
    if (result) save(() => new Blob([mapAsCsv(result)], { type: 'text/csv' }), `${pairName(store.get())}.csv`);
  });
  json.addEventListener('click', () => {
    const { result, scans } = store.get();
    const { a, b } = scans;
    if (!result || !a || !b) return;
    save(() => new Blob([mapAsJson(result, a, b)], { type: 'application/json' }), `${pairName(store.get())}.json`);
  });
  png.addEventListener('click', () => {
    if (stage) save(() => picture(stage, byId('line', SVGSVGElement)), `${pairName(store.get())}.png`);
  });
  for (const { side, format, button } of bodies) {
    button.addEventListener('click', () => {
      const scan = store.get().scans[side];
      if (!scan) return;
      const write = format === 'ply' ? bodyAsPly : bodyAsGlb;
      save(() => write(scan, coloursOf(store.get(), side, scan)), `${stem(scan)}-${store.get().colour}.${format}`);
    });
  }
}

const formats = ['ply', 'glb'] as const;

/** The colours on show, linear RGB per point; they are there also where nothing can be drawn. */
function coloursOf(state: AppState, side: Side, { shape }: Scan): Float32Array {
  const colours = new Float32Array(3 * shape.info.points);
  paintScan(state, side, colours);
  return colours;
}

/** "left.ply" and "right.obj" → "left-right". */
const pairName = ({ scans }: AppState): string => sides.flatMap((side) => (scans[side] ? [stem(scans[side])] : [])).join('-');

const stem = ({ source }: Scan): string => source.name.replace(/\.[^.]+$/, '').replaceAll(/[^\p{L}\p{N}_-]+/gu, '_') || 'scan';

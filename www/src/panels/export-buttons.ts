import type { AppState, AppStore } from '../app-state';
import { byId } from '../dom';
import { download } from '../exports/download';
import { mapAsCsv, mapAsJson } from '../exports/map-table';
import { picture } from '../exports/picture';
import type { Stage } from '../views/stage';

/** The map as CSV and JSON, and the views as a picture. */
export function showExports(store: AppStore, stage: Stage | null): void {
  const csv = byId('export-csv', HTMLButtonElement);
  const json = byId('export-json', HTMLButtonElement);
  const png = byId('export-png', HTMLButtonElement);
  store.watch(['scans', 'result'], ({ scans, result }) => {
    csv.disabled = json.disabled = !result;
    png.disabled = stage === null || (!scans.a && !scans.b);
  });
  csv.addEventListener('click', () => {
    const { result } = store.get();
    if (result) download(new Blob([mapAsCsv(result)], { type: 'text/csv' }), `${pairName(store.get())}.csv`);
  });
  json.addEventListener('click', () => {
    const { result, scans } = store.get();
    if (!result || !scans.a || !scans.b) return;
    const text = mapAsJson(result, scans.a, scans.b);
    download(new Blob([text], { type: 'application/json' }), `${pairName(store.get())}.json`);
  });
  png.addEventListener('click', () => {
    if (!stage) return;
    void picture(stage, byId('line', SVGSVGElement)).then((blob) => download(blob, `${pairName(store.get())}.png`));
  });
}

/** "left.ply" and "right.obj" → "left-right". */
function pairName({ scans }: AppState): string {
  const stems = [scans.a, scans.b].flatMap((scan) => (scan ? [scan.source.name.replace(/\.[^.]+$/, '')] : []));
  return stems.join('-').replaceAll(/[^\p{L}\p{N}_-]+/gu, '_') || 'match';
}

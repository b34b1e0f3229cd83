import { arriving, type AppState, type AppStore } from '../app-state';
import { byId } from '../dom';
import { counted } from '../sentences';
import { letter, sides, type Side } from '../side';

/** Name and counts of each scan. */
export function showScanCards(store: AppStore): void {
  for (const side of sides) {
    const name = byId(`name-${side}`, HTMLElement);
    const facts = byId(`facts-${side}`, HTMLElement);
    const card = byId(`drop-${side}`, HTMLElement);
    store.watch(['scans', 'steps'], (state) => {
      const scan = state.scans[side];
      card.classList.toggle('filled', scan !== null);
      const title = scan?.source.title ?? arriving(state, side)?.title ?? `Scan ${letter(side)}`;
      name.textContent = title;
      name.title = title;
      facts.textContent = factsOf(state, side);
    });
  }
}

function factsOf(state: AppState, side: Side): string {
  const scan = state.scans[side];
  const coming = arriving(state, side);
  if (coming && coming !== scan?.source) return scan ? `${coming.title} is on its way…` : 'On its way…';
  if (!scan) return 'Drop a file here, choose one, or pick a sample.';
  const { kind, points, faces } = scan.shape.info;
  if (faces === 0) return `Cloud, ${counted(points, 'point')}`;
  return `${kind === 'mesh' ? 'Mesh' : 'Mesh taken as cloud'}, ${counted(points, 'point')}, ${counted(faces, 'face')}`;
}

import type { AppState, AppStore } from '../app-state';
import { byId } from '../dom';
import { count, counted } from '../sentences';
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
      name.textContent = scan?.source.title ?? `Scan ${letter(side)}`;
      facts.textContent = factsOf(state, side);
    });
  }
}

function factsOf({ scans, steps }: AppState, side: Side): string {
  const scan = scans[side];
  if (!scan) return steps[side].status === 'running' ? 'On its way…' : 'Drop a file here, choose one, or pick a sample.';
  const { kind, points, faces } = scan.shape.info;
  return kind === 'mesh' ? `Mesh, ${counted(points, 'point')}, ${count(faces)} faces` : `Cloud, ${counted(points, 'point')}`;
}

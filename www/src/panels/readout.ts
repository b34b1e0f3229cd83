import type { AppState, AppStore, Selection } from '../app-state';
import { byId } from '../dom';
import { directionFrom, partnerOf } from '../match-direction';
import { count } from '../sentences';
import { letter, opposite, sides, type Side } from '../side';

/** The point under the finger and its match in numbers and words; the numbers can be typed. */
export function showReadout(store: AppStore, choose: (selection: Selection | null) => void): void {
  const inputs = { a: byId('point-a', HTMLInputElement), b: byId('point-b', HTMLInputElement) };
  const readout = byId('readout', HTMLElement);
  const live = byId('readout-live', HTMLElement);
  for (const side of sides) {
    inputs[side].addEventListener('change', () => {
      const points = store.get().scans[side]?.shape.info.points ?? 0;
      const { value, valueAsNumber: index } = inputs[side];
      if (value === '') choose(null);
      else if (Number.isInteger(index) && index >= 0 && index < points) choose({ side, index });
      else readout.textContent = `Points of scan ${letter(side)} are numbered from 0 to ${count(points - 1)}.`;
    });
  }
  store.watch(['scans', 'result', 'hovered', 'pinned', 'correcting'], (state) => {
    const selection = shownSelection(state);
    for (const side of sides) {
      const points = state.scans[side]?.shape.info.points;
      inputs[side].disabled = points === undefined;
      if (points !== undefined) inputs[side].max = String(points - 1);
      const index = indexOn(state, side, selection);
      inputs[side].value = index === null ? '' : String(index);
    }
    readout.textContent = words(state, selection);
    // Hovering would talk without end; what was chosen on purpose is read out.
    const spoken = state.pinned ? words(state, state.pinned) : '';
    if (live.textContent !== spoken) live.textContent = spoken;
  });
}

/** While a match is corrected, its point of A stays and B waits for its number. */
const shownSelection = ({ hovered, pinned, correcting }: AppState): Selection | null =>
  correcting !== null && hovered?.side !== 'b' ? { side: 'a', index: correcting } : (hovered ?? pinned);

function indexOn({ result, correcting }: AppState, side: Side, selection: Selection | null): number | null {
  if (correcting !== null && side === 'a') return correcting;
  if (!selection) return null;
  if (selection.side === side) return selection.index;
  if (correcting !== null) return null;
  return result && partnerOf(result.match, selection.side, selection.index);
}

function words({ scans, result, correcting }: AppState, selection: Selection | null): string {
  if (correcting !== null) {
    return `Show where point ${correcting} of A belongs: choose a point of B, or type its number. Escape leaves it.`;
  }
  if (!selection) return scans.a || scans.b ? 'Point at either body, or walk over it with the arrow keys.' : '';
  const { side, index } = selection;
  const here = `Point ${index} of ${letter(side)}`;
  if (!result) return `${here}.`;
  const partner = partnerOf(result.match, side, index);
  if (partner === null) return `${here} has no match on ${letter(opposite(side))}: nothing there resembles it enough.`;
  const confidence = directionFrom(result.match, side).confidence[index];
  return `${here} is point ${partner} of ${letter(opposite(side))}; confidence ${confidence.toFixed(2)}.`;
}

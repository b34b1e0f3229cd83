import type { AppState, AppStore, Selection } from '../app-state';
import { byId } from '../dom';
import { partsOf } from '../colour/scan-parts';
import { directionFrom, partnerOf } from '../match-direction';
import { capital, count } from '../sentences';
import { withoutPartner } from '../set-aside';
import { letter, opposite, sides, type Side } from '../side';

/** The point under the finger and its match in numbers and words; the numbers can be typed. */
export function showReadout(store: AppStore, choose: (selection: Selection | null) => void): void {
  const inputs = { a: byId('point-a', HTMLInputElement), b: byId('point-b', HTMLInputElement) };
  const readout = byId('readout', HTMLElement);
  const live = byId('readout-live', HTMLElement);
  for (const side of sides) {
    const input = inputs[side];
    input.addEventListener('change', () => {
      const points = store.get().scans[side]?.shape.info.points ?? 0;
      const { value, valueAsNumber: index } = input;
      const refused = input.validity.badInput || (value !== '' && !(Number.isInteger(index) && index >= 0 && index < points));
      input.setAttribute('aria-invalid', String(refused));
      if (refused) readout.textContent = `Points of scan ${letter(side)} are numbered from 0 to ${count(points - 1)}.`;
      else choose(value === '' ? null : { side, index });
    });
  }
  const chosen: Record<Side, number | null> = { a: null, b: null };
  store.watch(['scans', 'result', 'hovered', 'pinned', 'pairing', 'colour'], (state) => {
    const selection = state.hovered ?? state.pinned;
    for (const side of sides) {
      const input = inputs[side];
      const points = state.scans[side]?.shape.info.points;
      input.disabled = points === undefined;
      if (points !== undefined) input.max = String(points - 1);
      // A number that is being typed is not overwritten by a pointer that happens to lie over a body.
      const before = chosen[side];
      chosen[side] = indexOn(state, side, state.pinned);
      const typing = document.activeElement === input;
      if (typing && chosen[side] === before) continue;
      const index = typing ? chosen[side] : indexOn(state, side, selection);
      input.value = index === null ? '' : String(index);
      input.setAttribute('aria-invalid', 'false');
    }
    readout.textContent = words(state, selection);
    // Hovering would talk without end; what was chosen on purpose is read out.
    const spoken = state.pinned ? words(state, state.pinned) : '';
    if (live.textContent !== spoken) live.textContent = spoken;
  });
}

/** While a landmark is made, each side shows its own point: the one chosen, or the one pointed at. */
function indexOn({ result, pairing }: AppState, side: Side, selection: Selection | null): number | null {
  const pointed = selection?.side === side ? selection.index : null;
  if (pairing) return pairing[side] ?? pointed;
  if (pointed !== null || !selection) return pointed;
  return result && partnerOf(result.match, selection.side, selection.index);
}

function words(state: AppState, selection: Selection | null): string {
  const { a, b } = state.scans;
  if (!selection) return a || b ? 'Point at either body, or walk over it with the arrow keys.' : 'No scan yet.';
  return matchWords(state, selection) + (state.colour === 'part' ? partWords(state, selection) : '');
}

/** Which part the point belongs to, and how sure the network is of it. */
function partWords({ scans }: AppState, { side, index }: Selection): string {
  const scan = scans[side];
  const parts = scan && partsOf(scan);
  if (!parts) return '';
  const name = capital(parts.names[parts.labels[index]]);
  return parts.source === 'given' ? ` ${name}, as given.` : ` ${name}, says the network, at ${parts.likelihood(index).toFixed(2)}.`;
}

function matchWords({ result, scans }: AppState, { side, index }: Selection): string {
  const here = `Point ${index} of ${letter(side)}`;
  if (scans[side] && withoutPartner(scans[side]).has(index)) return `${here} was set aside as no part of the body, and has no match.`;
  if (!result) return `${here}.`;
  const partner = partnerOf(result.match, side, index);
  if (partner === null) return `${here} has no match on ${letter(opposite(side))}: nothing there resembles it enough.`;
  const confidence = directionFrom(result.match, side).confidence[index];
  return `${here} is point ${partner} of ${letter(opposite(side))}; confidence ${confidence.toFixed(2)}.`;
}

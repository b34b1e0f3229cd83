import type { AppStore, Landmark } from '../app-state';
import { byId, create } from '../dom';
import { partnerOf } from '../match-direction';

/** Pairs the user has put right; they guide the next match. */
export function showLandmarks(store: AppStore): void {
  const add = byId('add-landmark', HTMLButtonElement);
  const list = byId('landmarks', HTMLElement);
  store.watch(['pinned', 'correcting', 'scans', 'result'], ({ pinned, correcting, scans, result }) => {
    const start = correcting ?? (pinned?.side === 'b' ? result && partnerOf(result.match, 'b', pinned.index) : pinned?.index);
    add.disabled = !scans.a || !scans.b || (start ?? null) === null;
    add.setAttribute('aria-pressed', String(correcting !== null));
    add.textContent = correcting === null ? 'Correct this match…' : 'Leave it as it is';
  });
  add.addEventListener('click', () => {
    const { pinned, correcting, result } = store.get();
    if (correcting !== null || !pinned) {
      store.set({ correcting: null });
      return;
    }
    const onA = pinned.side === 'a' ? pinned.index : result && partnerOf(result.match, 'b', pinned.index);
    store.set({ correcting: onA, hovered: null });
  });
  store.watch(['landmarks'], ({ landmarks }) => {
    list.replaceChildren(
      ...landmarks.map((landmark) => {
        const remove = create('button', { type: 'button', className: 'dismiss', textContent: '×' });
        remove.setAttribute('aria-label', `Remove the landmark from ${landmark[0]} to ${landmark[1]}`);
        remove.addEventListener('click', () => store.set({ landmarks: store.get().landmarks.filter((other) => other !== landmark) }));
        return create('li', {}, `A ${landmark[0]} is B ${landmark[1]}`, remove);
      }),
    );
  });
}

/** The landmarks with one more; a point has one place at most, so an older word about it gives way. */
export const withLandmark = (landmarks: readonly Landmark[], added: Landmark): readonly Landmark[] => [
  ...landmarks.filter(([i, j]) => i !== added[0] && j !== added[1]),
  added,
];

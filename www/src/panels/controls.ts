import { isBusy, type AppStore } from '../app-state';
import { byId } from '../dom';
import type { Session } from '../session';

/** Match, swap, cancel. */
export function showControls(store: AppStore, session: Session): void {
  const match = byId('match', HTMLButtonElement);
  const swap = byId('swap', HTMLButtonElement);
  const cancel = byId('cancel', HTMLButtonElement);
  match.addEventListener('click', () => void session.match());
  swap.addEventListener('click', () => session.swap());
  cancel.addEventListener('click', () => session.cancel());
  store.watch(['scans', 'steps', 'result'], (state) => {
    const busy = isBusy(state);
    const { a, b } = state.scans;
    match.disabled = busy || !a || !b;
    match.textContent = state.result ? 'Match again' : 'Match';
    swap.disabled = busy || (!a && !b);
    cancel.disabled = !busy;
  });
}

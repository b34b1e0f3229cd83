import type { AppStore } from '../app-state';
import { byId } from '../dom';
import type { Stage } from '../views/stage';

/** Linked cameras, the way back to the front view, and the invitation while there is nothing to look at. */
export function showViewTools(store: AppStore, stage: Stage | null): void {
  const link = byId('link-views', HTMLInputElement);
  link.addEventListener('change', () => store.set({ linked: link.checked }));
  byId('reset-views', HTMLButtonElement).addEventListener('click', () => stage?.resetCameras());
  const invitation = byId('invitation', HTMLElement);
  store.watch(['scans', 'steps'], ({ scans, steps }) => {
    const coming = steps.a.status === 'running' || steps.b.status === 'running';
    invitation.hidden = scans.a !== null || scans.b !== null || coming;
  });
}

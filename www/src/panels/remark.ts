import type { AppStore } from '../app-state';
import { byId, create } from '../dom';

/** What the user should know about what was dropped; its place is always there, so that screen readers hear it change. */
export function showRemark(store: AppStore): void {
  const place = byId('remark', HTMLElement);
  store.watch(['remark'], ({ remark }) => {
    place.classList.toggle('shown', remark !== null);
    if (remark === null) {
      place.replaceChildren();
      return;
    }
    const button = create('button', { type: 'button', className: 'dismiss', textContent: '×' });
    button.setAttribute('aria-label', 'Dismiss this remark');
    button.addEventListener('click', () => store.set({ remark: null }));
    place.replaceChildren(create('p', { textContent: remark }), button);
  });
}

import { stepNames, type AppStore, type StepName } from '../app-state';
import { byId, create } from '../dom';

/** The sentence of what failed, beside what it is about, with a way to put it aside. */
export function showErrors(store: AppStore, dismiss: (name: StepName) => void): void {
  for (const name of stepNames) {
    const place = byId(`error-${name}`, HTMLElement);
    let shown: string | null = null;
    store.watch(['errors'], ({ errors }) => {
      if (errors[name] === shown) return;
      shown = errors[name];
      place.hidden = shown === null;
      if (shown === null) {
        place.replaceChildren();
        return;
      }
      const button = create('button', { type: 'button', className: 'dismiss', textContent: '×' });
      button.setAttribute('aria-label', 'Dismiss this message');
      button.addEventListener('click', () => dismiss(name));
      place.replaceChildren(create('p', { textContent: shown }), button);
    });
  }
}

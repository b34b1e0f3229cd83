import type { AppState, AppStore } from '../app-state';
import { landmarkColour } from '../colour/landmark-colours';
import { byId, create } from '../dom';
import { firstPairing, sideAwaited, type Landmark } from '../landmarks';
import { letter, opposite } from '../side';

/** Pairs of points that the user knows; they guide the next match. */
export function showLandmarks(store: AppStore): void {
  const add = byId('add-landmark', HTMLButtonElement);
  const done = byId('pairing-done', HTMLButtonElement);
  const banner = byId('pairing', HTMLElement);
  const words = byId('pairing-words', HTMLElement);
  const note = byId('landmarks-note', HTMLElement);
  const list = byId('landmarks', HTMLElement);
  const leave = (): void => {
    store.set({ pairing: null });
    add.focus({ preventScroll: true });
  };
  add.addEventListener('click', () => {
    if (store.get().pairing) return leave();
    store.set({ pairing: firstPairing(store.get()), hovered: null });
    // On a phone the bodies may have been scrolled away.
    const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
    byId('stage', HTMLElement).scrollIntoView({ block: 'nearest', behavior: still ? 'auto' : 'smooth' });
  });
  done.addEventListener('click', leave);
  store.watch(['pairing', 'scans', 'landmarks', 'result'], (state) => {
    const { pairing, scans } = state;
    add.disabled = !scans.a || !scans.b;
    add.setAttribute('aria-pressed', String(pairing !== null));
    add.textContent = pairing ? 'Stop adding landmarks' : 'Add landmarks';
    banner.classList.toggle('shown', pairing !== null);
    done.hidden = pairing === null;
    const instruction = instructionOf(state);
    if (words.textContent !== instruction) words.textContent = instruction;
    note.textContent = noteOf(state);
  });
  const remove = (landmark: Landmark): void => {
    const order = store.get().landmarks.indexOf(landmark);
    store.set({ landmarks: store.get().landmarks.filter((other) => other !== landmark) });
    const next = list.querySelectorAll('button')[Math.min(order, store.get().landmarks.length - 1)];
    (next ?? add).focus();
  };
  store.watch(['landmarks'], ({ landmarks }) => {
    list.replaceChildren(...landmarks.map((landmark, order) => item(landmark, order, () => remove(landmark))));
  });
}

function item(landmark: Landmark, order: number, remove: () => void): HTMLLIElement {
  const [i, j] = landmark;
  const { fill, ink } = landmarkColour(order);
  const number = create('span', { className: 'number', textContent: String(order + 1) });
  number.style.background = fill;
  number.style.color = ink;
  const button = create('button', { type: 'button', className: 'dismiss', textContent: '×' });
  button.setAttribute('aria-label', `Remove landmark ${order + 1}, from ${i} to ${j}`);
  button.addEventListener('click', remove);
  return create('li', {}, number, create('span', { className: 'what', textContent: `A ${i} is B ${j}` }), button);
}

/** What to do next while landmarks are being made. */
function instructionOf({ pairing, landmarks }: AppState): string {
  if (!pairing) return '';
  const number = `Landmark ${landmarks.length + 1}`;
  const awaited = sideAwaited(pairing);
  if (!awaited) return `${number}: choose a point on A and the same place on B.`;
  const chosen = opposite(awaited);
  return `${number}: point ${pairing[chosen]} of ${letter(chosen)}; now the same place on ${letter(awaited)}.`;
}

function noteOf({ scans, landmarks, result }: AppState): string {
  if (!scans.a || !scans.b) return 'Once both scans are here, you can say which points belong together.';
  if (result && JSON.stringify(result.landmarks) !== JSON.stringify(landmarks)) {
    return landmarks.length > 0 ? 'The next match keeps to these: match again.' : 'Match again to do without them.';
  }
  return landmarks.length > 0 ? 'The match keeps to these.' : 'Where a limb went astray, one or two pairs of points put it right.';
}

import { arriving, type AppStore, type Scan } from '../app-state';
import { byId, create } from '../dom';
import { count } from '../sentences';
import { setAsideOf, withoutPartner } from '../set-aside';
import { letter, sides, type Side } from '../side';
import { coded } from './coded';

/** What else than the body was found in a scan and set aside, with a way to keep it, and the way back. The texts' places are always there, so that screen readers hear them change. */
export function showSetAside(store: AppStore, prepareAgain: (side: Side, whole: boolean) => void): void {
  for (const side of sides) {
    const place = byId(`aside-${side}`, HTMLElement);
    const words = create('div', { role: 'status' });
    const button = create('button', { type: 'button' });
    place.append(words, button);
    button.addEventListener('click', () => {
      const { scans } = store.get();
      // Not disabled while it works: that would take the focus away.
      if (scans[side] && button.getAttribute('aria-disabled') !== 'true') prepareAgain(side, !scans[side].whole);
    });
    let shown: Scan | null = null;
    store.watch(['scans', 'steps'], (state) => {
      button.setAttribute('aria-disabled', String(arriving(state, side) !== null));
      const scan = state.scans[side];
      if (scan === shown) return;
      shown = scan;
      const sentences = scan ? sentencesOn(scan) : [];
      words.replaceChildren(...sentences);
      place.classList.toggle('shown', sentences.length > 0);
      button.hidden = sentences.length === 0;
      button.textContent = scan?.whole ? 'Set it aside again' : 'Keep all of it';
      button.setAttribute('aria-label', `Scan ${letter(side)}: ${button.textContent.toLowerCase()}`);
    });
  }
}

function sentencesOn(scan: Scan): Node[] {
  if (scan.whole) return [create('p', { textContent: 'All of it is taken for the body; nothing is set aside.' })];
  const aside = setAsideOf(scan);
  const points = withoutPartner(scan).size;
  return [
    ...aside.map((repair) => coded('p', repair)),
    ...(aside.length > 0 && points > 0 ? [create('p', { textContent: `The ${count(points)} grey points have no match.` })] : []),
  ];
}

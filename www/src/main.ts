import { createAppStore, type AppStore, type Selection } from './app-state';
import { byId } from './dom';
import { chosenForLandmark, releasedPairing } from './landmarks';
import { showCertainty } from './panels/certainty';
import { showColours } from './panels/colour-legend';
import { showControls } from './panels/controls';
import { showDevice } from './panels/device';
import { showErrors } from './panels/errors';
import { showExports } from './panels/export-buttons';
import { takeScans } from './panels/intake';
import { showLandmarks } from './panels/landmarks';
import { showOptions } from './panels/options';
import { showProgress } from './panels/progress-line';
import { showReadout } from './panels/readout';
import { showRemark } from './panels/remark';
import { showReport } from './panels/report';
import { showScanCards } from './panels/scan-card';
import { showScanFacts } from './panels/scan-facts';
import { showSetAside } from './panels/set-aside';
import { showViewTools } from './panels/view-tools';
import { offerReadBack } from './read-back';
import { listSamples } from './samples';
import { Session } from './session';
import type { Stage } from './views/stage';
import { createViews } from './views/views';

const store = createAppStore();
const session = new Session(store);

/** A point was chosen by click, tap, key or number: to be looked at, or as one half of a landmark. */
function choose(selection: Selection | null): void {
  const state = store.get();
  if (!state.pairing) store.set({ pinned: selection, hovered: null });
  else if (selection) store.set({ ...chosenForLandmark(state, selection), hovered: null });
}

/** Escape lets go of the half of a landmark, then of making landmarks; otherwise of the point on show. */
function release(): void {
  const { pairing } = store.get();
  if (pairing) store.set({ pairing: releasedPairing(pairing) });
  else choose(null);
}

/** Without WebGL there is nothing to see, but scans can still be matched and maps saved. */
function viewsIfPossible(store: AppStore): Stage | null {
  try {
    return createViews(store, { choose, release });
  } catch (error) {
    const notice = byId('no-webgl', HTMLElement);
    notice.textContent = 'This browser offers no WebGL, so the bodies cannot be drawn. Matching and exports work all the same.';
    notice.hidden = false;
    console.warn(error);
    return null;
  }
}

const stage = viewsIfPossible(store);
takeScans(store, (loads) => void session.load(loads), listSamples());
showScanCards(store);
showErrors(store, (name) => session.dismiss(name));
showSetAside(store, (side, whole) => void session.prepareAgain(side, whole));
showRemark(store);
showProgress(store);
showControls(store, session);
showColours(store);
showReadout(store, choose);
showLandmarks(store);
showCertainty(store);
showOptions(store);
showDevice(store, session);
showScanFacts(store);
showReport(store);
showExports(store, stage);
showViewTools(store, stage);
offerReadBack(store);

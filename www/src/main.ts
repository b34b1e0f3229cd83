import { createAppStore, type AppStore, type Selection } from './app-state';
import { byId } from './dom';
import { showColours } from './panels/colour-legend';
import { showControls } from './panels/controls';
import { showErrors } from './panels/errors';
import { showExports } from './panels/export-buttons';
import { takeScans } from './panels/intake';
import { showLandmarks, withLandmark } from './panels/landmarks';
import { showOptions } from './panels/options';
import { showProgress } from './panels/progress-line';
import { showReadout } from './panels/readout';
import { showReport } from './panels/report';
import { showScanCards } from './panels/scan-card';
import { showViewTools } from './panels/view-tools';
import { offerReadBack } from './read-back';
import { listSamples } from './samples';
import { Session } from './session';
import type { Stage } from './views/stage';
import { createViews } from './views/views';

const store = createAppStore();
const session = new Session(store);

/** A point was chosen by click, tap, key or number. While a match is being corrected, a point of B ends that. */
function choose(selection: Selection | null): void {
  const { correcting, landmarks } = store.get();
  if (correcting !== null && selection?.side === 'b') {
    const pinned = { side: 'a', index: correcting } as const;
    store.set({ landmarks: withLandmark(landmarks, [correcting, selection.index]), correcting: null, pinned });
    return;
  }
  store.set({ pinned: selection, hovered: null, correcting: null });
}

/** Without WebGL there is nothing to see, but scans can still be matched and maps saved. */
function viewsIfPossible(store: AppStore): Stage | null {
  try {
    return createViews(store, choose);
  } catch (error) {
    const notice = byId('no-webgl', HTMLElement);
    notice.textContent = 'This browser offers no WebGL, so the bodies cannot be drawn. Matching and exports work all the same.';
    notice.hidden = false;
    console.warn(error);
    return null;
  }
}

const stage = viewsIfPossible(store);
takeScans(store, (side, source) => void session.load(side, source), listSamples());
showScanCards(store);
showErrors(store, (name) => session.dismiss(name));
showProgress(store);
showControls(store, session);
showColours(store);
showReadout(store, choose);
showLandmarks(store);
showOptions(store);
showReport(store);
showExports(store, stage);
showViewTools(store, stage);
offerReadBack(store);

import type { Match, PreparedShape } from 'geose-fmap';
import type { AppStore } from './app-state';
import { standing, type Standing } from './panels/progress-line';

/** What the console and tests may ask the page. */
export interface ReadBack {
  readonly match: Match | null;
  readonly shapes: readonly [PreparedShape | null, PreparedShape | null];
  state(): Standing;
}

declare global {
  interface Window {
    geose: ReadBack;
  }
}

/** Puts the page's result where the console can reach it: `geose.match.targetOf`. */
export function offerReadBack(store: AppStore): void {
  window.geose = {
    get match() {
      return store.get().result?.match ?? null;
    },
    get shapes() {
      const { a, b } = store.get().scans;
      return [a?.shape ?? null, b?.shape ?? null] as const;
    },
    state: () => standing(store.get()),
  };
}

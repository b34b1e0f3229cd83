import type { Device, Match, MatchOptions, PreparedShape, PrepareOptions, Stage } from 'geose-fmap';
import type { ScanSource } from './scan-source';
import type { Side } from './side';
import { createStore, type Store } from './store';

/** What the user may choose about preparing a scan; a missing key leaves the choice to the package. */
export type PrepareChoices = Pick<PrepareOptions, 'points' | 'faces' | 'laplacian' | 'eigenpairs' | 'up'>;

/** What the user may choose about matching; landmarks are kept apart because they belong to one pair. */
export type MatchChoices = Pick<MatchOptions, 'refine' | 'parts'>;

/** A scan that could be read, with where it came from and the choices it was prepared with. */
export interface Scan {
  readonly source: ScanSource;
  readonly shape: PreparedShape;
  readonly choices: PrepareChoices;
}

/** A match and the choices that led to it. */
export interface Result {
  readonly match: Match;
  readonly choices: MatchChoices;
  readonly landmarks: readonly Landmark[];
}

/** Point i of A is point j of B, said by the user. */
export type Landmark = readonly [i: number, j: number];

/** One of the three pieces of work, as the progress line shows it. */
export type Step =
  | { readonly status: 'waiting' | 'done' | 'failed' | 'cancelled' }
  | { readonly status: 'running'; readonly stage: Stage | null; readonly fraction: number };

export type StepName = Side | 'match';

export const stepNames: readonly StepName[] = ['a', 'b', 'match'];

export type ColourMode = 'correspondence' | 'confidence' | 'part' | 'eigenfunction' | 'plain';

/** A point of one scan, by its index as uploaded. */
export interface Selection {
  readonly side: Side;
  readonly index: number;
}

export interface AppState {
  readonly device: Device | null;
  readonly scans: Readonly<Record<Side, Scan | null>>;
  /** Sentences for the person with the scans, until dismissed or overtaken. */
  readonly errors: Readonly<Record<StepName, string | null>>;
  readonly steps: Readonly<Record<StepName, Step>>;
  readonly result: Result | null;
  readonly prepareChoices: PrepareChoices;
  readonly matchChoices: MatchChoices;
  readonly landmarks: readonly Landmark[];
  /** The point of A whose true place on B the user is about to show. */
  readonly correcting: number | null;
  /** Under the mouse; wins over `pinned` while it is there. */
  readonly hovered: Selection | null;
  /** Chosen by click, tap, key or number. */
  readonly pinned: Selection | null;
  readonly colour: ColourMode;
  readonly eigenfunction: number;
  readonly linked: boolean;
}

export type AppStore = Store<AppState>;

export function createAppStore(): AppStore {
  return createStore<AppState>({
    device: null,
    scans: { a: null, b: null },
    errors: { a: null, b: null, match: null },
    steps: { a: { status: 'waiting' }, b: { status: 'waiting' }, match: { status: 'waiting' } },
    result: null,
    prepareChoices: {},
    matchChoices: { refine: 'best' },
    landmarks: [],
    correcting: null,
    hovered: null,
    pinned: null,
    colour: 'correspondence',
    eigenfunction: 1,
    linked: true,
  });
}

export const isBusy = (state: AppState): boolean => stepNames.some((name) => state.steps[name].status === 'running');

/** Whether re-matching would do anything else than what was done. */
export function optionsChanged(state: AppState): boolean {
  const same = (left: object, right: object): boolean => JSON.stringify(left) === JSON.stringify(right);
  const { result, scans } = state;
  if (!result) return false;
  return (
    !same(result.choices, state.matchChoices) ||
    !same(result.landmarks, state.landmarks) ||
    [scans.a, scans.b].some((scan) => scan !== null && !same(scan.choices, state.prepareChoices))
  );
}

import type { Device, Match, MatchOptions, PreparedShape, PrepareOptions, Stage } from 'geose-fmap';
import type { Landmark, Pairing } from './landmarks';
import type { DeviceChoice } from './matcher';
import type { ScanSource } from './scan-source';
import { sides, type Side } from './side';
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
  /** Whether all of it was to be the body, floors and furniture included. */
  readonly whole: boolean;
}

/** A match and the choices that led to it. */
export interface Result {
  readonly match: Match;
  readonly choices: MatchChoices;
  readonly landmarks: readonly Landmark[];
}

/** One of the three pieces of work, as the progress line shows it. */
export type Step =
  | { readonly status: 'waiting' | 'done' | 'failed' | 'cancelled' }
  | {
      readonly status: 'running';
      readonly stage: Stage | null;
      readonly fraction: number;
      /** The scan being prepared; null while matching. */
      readonly source: ScanSource | null;
    };

export type StepName = Side | 'match';

export const stepNames: readonly StepName[] = ['a', 'b', 'match'];

export type ColourMode = 'correspondence' | 'confidence' | 'overlap' | 'part' | 'eigenfunction' | 'plain';

/** A point of one scan, by its index as uploaded. */
export interface Selection {
  readonly side: Side;
  readonly index: number;
}

export interface AppState {
  readonly deviceChoice: DeviceChoice;
  /** The device in use; null while it is being opened. */
  readonly device: Device | null;
  readonly scans: Readonly<Record<Side, Scan | null>>;
  /** What the user should know about what was dropped, until dismissed or overtaken. */
  readonly remark: string | null;
  /** Sentences for the person with the scans, until dismissed or overtaken. */
  readonly errors: Readonly<Record<StepName, string | null>>;
  readonly steps: Readonly<Record<StepName, Step>>;
  readonly result: Result | null;
  readonly prepareChoices: PrepareChoices;
  readonly matchChoices: MatchChoices;
  readonly landmarks: readonly Landmark[];
  /** The landmark that the user is making; null while points are only looked at. */
  readonly pairing: Pairing | null;
  /** Under the mouse; wins over `pinned` while it is there. */
  readonly hovered: Selection | null;
  /** Chosen by click, tap, key or number. */
  readonly pinned: Selection | null;
  readonly colour: ColourMode;
  readonly eigenfunction: number;
  readonly linked: boolean;
}

export type AppStore = Store<AppState>;

/** The choices of a fresh page. */
export const defaultChoices: Pick<AppState, 'prepareChoices' | 'matchChoices'> = {
  prepareChoices: {},
  matchChoices: { refine: 'best', parts: 'predicted' },
};

export function createAppStore(): AppStore {
  return createStore<AppState>({
    deviceChoice: 'auto',
    device: null,
    scans: { a: null, b: null },
    remark: null,
    errors: { a: null, b: null, match: null },
    steps: { a: { status: 'waiting' }, b: { status: 'waiting' }, match: { status: 'waiting' } },
    result: null,
    ...defaultChoices,
    landmarks: [],
    pairing: null,
    hovered: null,
    pinned: null,
    colour: 'correspondence',
    eigenfunction: 1,
    linked: true,
  });
}

export const isBusy = (state: AppState): boolean => stepNames.some((name) => state.steps[name].status === 'running');

const same = (left: object, right: object): boolean => JSON.stringify(left) === JSON.stringify(right);

/** The scan on its way to a side, if one is. */
export function arriving(state: AppState, side: Side): ScanSource | null {
  const step = state.steps[side];
  return step.status === 'running' ? step.source : null;
}

/** Sides whose scan was prepared with other choices than those of now. */
export const outdatedSides = ({ scans, prepareChoices }: AppState): Side[] =>
  sides.filter((side) => {
    const scan = scans[side];
    return scan !== null && !same(scan.choices, prepareChoices);
  });

/** Whether re-matching would do anything else than what was done. */
export function optionsChanged(state: AppState): boolean {
  const { result } = state;
  if (!result) return false;
  return !same(result.choices, state.matchChoices) || !same(result.landmarks, state.landmarks) || outdatedSides(state).length > 0;
}

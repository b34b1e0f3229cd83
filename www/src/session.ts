import type { Matcher, Progress } from 'geose-fmap';
import { isBusy, outdatedSides, stepNames, type AppStore, type Step, type StepName } from './app-state';
import { reversed } from './match-direction';
import { createMatcher, type DeviceChoice } from './matcher';
import { companionsOf, type ScanSource } from './scan-source';
import { sentence } from './sentences';
import { sides, type Side } from './side';

/** What became of a step: `'ended'` when it was cancelled or newer work took its place. */
type Outcome = 'done' | 'failed' | 'ended';

/**
 * The page's dealings with the package: scans are prepared as they come, and once both are there the match runs by itself.
 * What fails or is cancelled changes nothing but its own step and error; the scans and the result on show stay.
 */
export class Session {
  readonly #store: AppStore;
  #matcher: Promise<Matcher>;
  /** The work under way, by step; newer work on a step takes the older one's place. */
  readonly #tasks = new Map<StepName, AbortController>();
  /** Scans arrived since the last match began: match when nothing is being prepared any more. */
  #matchIsDue = false;

  constructor(store: AppStore) {
    this.#store = store;
    this.#matcher = createMatcher(store.get().deviceChoice);
    this.#matcher.then(
      (matcher) => store.set({ device: matcher.device }),
      (error: unknown) => this.#setError('match', `The matching program could not start. ${sentence(error)}`),
    );
  }

  /** Goes on with another device, from the next step on. If there is none the one before stays. */
  async use(choice: DeviceChoice): Promise<void> {
    const before = this.#store.get().deviceChoice;
    if (choice === before) return;
    this.cancel();
    this.#setError('match', null);
    this.#store.set({ deviceChoice: choice, device: null });
    const [old, next] = [this.#matcher, createMatcher(choice)];
    const matcher = next.catch(() => old);
    this.#matcher = matcher;
    // A later choice may have overtaken this one by the time it is opened.
    const current = () => this.#matcher === matcher;
    try {
      const { device } = await next;
      void old.then((matcher) => matcher.dispose());
      if (current()) this.#store.set({ device });
    } catch (error) {
      const device = await old.then(
        (matcher) => matcher.device,
        () => null,
      );
      if (!current()) return;
      this.#store.set({ deviceChoice: before, device });
      this.#setError('match', sentence(error));
    }
  }

  /** Prepares scans that came together, then matches if both sides have one, prepared with the same choices. If one of them cannot be read nothing is matched. */
  async load(loads: readonly (readonly [side: Side, source: ScanSource])[]): Promise<void> {
    this.#putMatchOff();
    const loaded = loads.map(([side, source]) => this.#prepare(side, source));
    await this.#prepared([...loaded, ...this.#prepareOutdated()]);
  }

  /** Prepares a scan again, all of it or without what is no part of the body, and matches anew. */
  async prepareAgain(side: Side, whole: boolean): Promise<void> {
    const scan = this.#store.get().scans[side];
    if (!scan || this.#tasks.has(side)) return;
    this.#putMatchOff();
    await this.#prepared([this.#prepare(side, scan.source, whole), ...this.#prepareOutdated()]);
  }

  /** A match under way ends, and begins anew when the scans are there. */
  #putMatchOff(): void {
    if (!this.#end('match')) return;
    this.#matchIsDue = true;
    this.#setStep('match', { status: 'waiting' });
  }

  /** Matches anew; scans that were prepared with other choices are prepared again first. */
  async match(): Promise<void> {
    if (this.#end('match')) this.#setStep('match', { status: 'waiting' });
    await this.#prepared(this.#prepareOutdated());
  }

  /** Waits for what is being prepared; what others took the place of is for them to go on with. */
  async #prepared(running: readonly Promise<Outcome>[]): Promise<void> {
    const outcomes = await Promise.all(running);
    if (outcomes.includes('failed')) this.#matchIsDue = false;
    else if (!outcomes.includes('ended')) this.#matchIsDue = true;
    await this.#matchIfDue();
  }

  cancel(): void {
    this.#matchIsDue = false;
    for (const name of stepNames) if (this.#end(name)) this.#setStep(name, { status: 'cancelled' });
  }

  /** Exchanges A and B. The match is read the other way round, which needs no new one. */
  swap(): void {
    const state = this.#store.get();
    if (isBusy(state)) return;
    const { result } = state;
    const landmarks = state.landmarks.map(([i, j]) => [j, i] as const);
    this.#store.set({
      scans: { a: state.scans.b, b: state.scans.a },
      errors: { a: state.errors.b, b: state.errors.a, match: state.errors.match },
      steps: { a: state.steps.b, b: state.steps.a, match: state.steps.match },
      remark: null,
      result: result && {
        ...result,
        match: reversed(result.match),
        landmarks: result.landmarks.map(([i, j]) => [j, i] as const),
      },
      landmarks,
      pairing: null,
      hovered: null,
      pinned: state.pinned && { side: state.pinned.side === 'a' ? 'b' : 'a', index: state.pinned.index },
    });
  }

  dismiss(name: StepName): void {
    this.#setError(name, null);
  }

  /** Prepares again what was prepared with other choices, apart from what is being prepared anyway. */
  #prepareOutdated(): Promise<Outcome>[] {
    const { scans } = this.#store.get();
    return outdatedSides(this.#store.get()).flatMap((side) => {
      const source = scans[side]?.source;
      return source && !this.#tasks.has(side) ? [this.#prepare(side, source)] : [];
    });
  }

  /** When it is done the scan is on show. Of a scan that is there already the user may have wanted all. */
  async #prepare(side: Side, source: ScanSource, wanted?: boolean): Promise<Outcome> {
    const { prepareChoices: choices, scans } = this.#store.get();
    const whole = wanted ?? (scans[side]?.source.identity === source.identity && scans[side].whole);
    return this.#run(side, source, async (matcher, call) => {
      const [data, companions] = await Promise.all([source.data(), companionsOf(source)]);
      call.signal.throwIfAborted();
      const shape = await matcher.prepare(data, { ...choices, ...call, name: source.name, companions, wholeScan: whole });
      if (call.signal.aborted) {
        shape.free();
        return;
      }
      const { scans, errors, steps } = this.#store.get();
      const before = scans[side];
      this.#store.set({
        scans: { ...scans, [side]: { source, shape, choices, whole } },
        errors: { ...errors, match: null },
        steps: { ...steps, match: { status: 'waiting' } },
        // The same file prepared with other choices has the same points: what was found about them still holds.
        ...(before?.source.identity !== source.identity && { result: null, landmarks: [], pairing: null, hovered: null, pinned: null }),
      });
      before?.shape.free();
    });
  }

  async #matchIfDue(): Promise<void> {
    const { scans, matchChoices, landmarks } = this.#store.get();
    const { a, b } = scans;
    if (!this.#matchIsDue || this.#tasks.size > 0 || !a || !b) return;
    this.#matchIsDue = false;
    // Both scans on show are prepared, whatever became of others since.
    for (const side of sides) this.#setStep(side, { status: 'done' });
    await this.#run('match', null, async (matcher, call) => {
      const match = await matcher.match(a.shape, b.shape, {
        ...matchChoices,
        landmarks,
        ...call,
      });
      if (!call.signal.aborted) this.#store.set({ result: { match, choices: matchChoices, landmarks } });
    });
  }

  /** Runs one step with its progress line. */
  async #run(
    name: StepName,
    source: ScanSource | null,
    work: (matcher: Matcher, call: { signal: AbortSignal; onProgress: (progress: Progress) => void }) => Promise<void>,
  ): Promise<Outcome> {
    this.#end(name);
    const task = new AbortController();
    this.#tasks.set(name, task);
    this.#setError(name, null);
    this.#setStep(name, { status: 'running', stage: null, fraction: 0, source });
    const finish = (step: Step): void => {
      this.#tasks.delete(name);
      this.#setStep(name, step);
    };
    try {
      const matcher = await this.#matcher;
      await work(matcher, {
        signal: task.signal,
        onProgress: ({ stage, fraction }) => {
          if (!task.signal.aborted) this.#setStep(name, { status: 'running', stage, fraction, source });
        },
      });
      // A GPU may have been lost on the way.
      if (this.#store.get().device) this.#store.set({ device: matcher.device });
      if (task.signal.aborted) return 'ended';
      finish({ status: 'done' });
      return 'done';
    } catch (error) {
      if (task.signal.aborted) return 'ended';
      finish({ status: 'failed' });
      this.#setError(name, sentence(error));
      return 'failed';
    }
  }

  /** Ends what runs for a step, if anything does. */
  #end(name: StepName): boolean {
    const task = this.#tasks.get(name);
    if (!task) return false;
    this.#tasks.delete(name);
    task.abort();
    return true;
  }

  #setStep(name: StepName, step: Step): void {
    this.#store.set({ steps: { ...this.#store.get().steps, [name]: step } });
  }

  #setError(name: StepName, message: string | null): void {
    this.#store.set({ errors: { ...this.#store.get().errors, [name]: message } });
  }
}

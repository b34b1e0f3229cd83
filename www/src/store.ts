/** A value that tells its watchers which of its keys changed. */
export interface Store<State extends object> {
  get(): Readonly<State>;
  set(patch: Partial<State>): void;
  /** Calls `listener` now, and again after every `set` that replaces one of `keys`. */
  watch(keys: readonly (keyof State)[], listener: (state: Readonly<State>) => void): void;
}

export function createStore<State extends object>(initial: State): Store<State> {
  let state: Readonly<State> = initial;
  const watchers: { keys: readonly (keyof State)[]; listener: (state: Readonly<State>) => void }[] = [];
  return {
    get: () => state,
    set(patch) {
      const before = state;
      state = { ...before, ...patch };
      for (const { keys, listener } of watchers) {
        if (keys.some((key) => !Object.is(state[key], before[key]) && key in patch)) listener(state);
      }
    },
    watch(keys, listener) {
      watchers.push({ keys, listener });
      listener(state);
    },
  };
}

/** Lets `using` call `method`, where the engine knows `Symbol.dispose`; elsewhere it changes nothing. */
export function disposable<M extends string>(prototype: { [name in M]: () => void }, method: M): void {
  // Engines without explicit resource management lack the symbol, whatever its type says.
  const symbol: symbol | undefined = Symbol.dispose;
  if (symbol) Object.defineProperty(prototype, symbol, { value: prototype[method], writable: true, configurable: true });
}

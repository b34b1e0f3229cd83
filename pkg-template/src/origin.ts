import { isNode } from './node.js';

/** The origin that this package was fetched from, where it is not that of the page: a CDN. Bundlers put `file:` addresses here, and none is told of by them. */
export function foreignOrigin(): string | undefined {
  const here: string | undefined = import.meta.url;
  if (isNode || !here || !/^https?:/.test(here)) return undefined;
  return isElsewhere(new URL(here)) ? new URL(here).origin : undefined;
}

/** Whether a page has to ask another origin for it. */
export const isElsewhere = (url: URL): boolean => url.origin !== globalThis.origin;

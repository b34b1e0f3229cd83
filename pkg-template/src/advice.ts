// What to do when a file of this package is not where its modules look for it: programs that rewrite modules know nothing of the files beside them, or are to be
// told of them in a line.
import { isNext, isNode } from './node.js';
import { foreignOrigin } from './origin.js';

/** The name that this module has until a bundler puts it into another. */
const OWN_NAME = /\/advice\.js(\?|$)/;

/** The line to add, as a sentence, where it is known who moved the modules; else where to look. */
export function advice(): string {
  // Bundles of CommonJS have no address.
  const here: string | undefined = import.meta.url;
  if (isNext()) return "Next.js has bundled the package into the server: add serverExternalPackages: ['geose-fmap'] to next.config.";
  if (here?.includes('/.vite/'))
    return "Vite 7 and older move the package in development: add optimizeDeps: { exclude: ['geose-fmap'] } to vite.config.";
  const cdn = foreignOrigin();
  if (cdn !== undefined)
    return `The package comes from ${cdn}: is all of it there, and does the page's Content-Security-Policy allow worker-src blob: ${cdn} and connect-src ${cdn}?`;
  if (here !== undefined && OWN_NAME.test(here))
    return "Are worker.js and geose_fmap_bg.wasm beside the package's other files, or named in the options `worker` and `wasm`?";
  const copy =
    'copy worker.js and geose_fmap_bg.wasm from node_modules/geose-fmap beside the bundle, or name them in the options `worker` and `wasm`';
  return isNode
    ? `A bundler has put the package into another file: keep it out (esbuild: --external:geose-fmap, Rollup: external: ['geose-fmap']), or ${copy}.`
    : `A bundler has put the package into another file: ${copy}.`;
}

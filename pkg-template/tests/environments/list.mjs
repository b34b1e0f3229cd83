// Where the package is tried, and what has to be added there: tests hold each of these to be true, and the table in the package's README is written from them.
import { readFileSync } from 'node:fs';

const json = (name) => JSON.parse(readFileSync(new URL(name, import.meta.url), 'utf8'));
const pinned = json('package.json').dependencies;
const { packages } = json('../../../package-lock.json');

/** The version of a program that customers have. */
const pin = (name) => ({ name, version: pinned[name] ?? fail(name) });
/** The version of one that this workspace has, too. */
const own = (name) => ({ name, version: packages[`node_modules/${name}`]?.version ?? fail(name) });
const fail = (name) => {
  throw new Error(`no version of ${name} is pinned`);
};

const COPY = 'copy worker.js and geose_fmap_bg.wasm from node_modules/geose-fmap beside the bundle';

/**
 * `line` is what has to be added, `to` the file or the command it belongs to, if it is no whole sentence; without a line nothing has to be. Without the line the failure names `named`,
 * which is the line itself unless said otherwise.
 */
export const ENVIRONMENTS = [
  { name: 'Node', versions: ['20 or later'] },
  { name: 'Bun', versions: [pin('bun')] },
  { name: 'Deno', versions: [pin('deno')], line: '--allow-read', to: 'deno run' },
  { name: 'A page without a bundler', versions: ['Chromium'] },
  { name: 'A page with an import map to a CDN', versions: ['Chromium'] },
  { name: 'Vite', versions: [own('vite')] },
  {
    name: 'Vite 7 and older, in development',
    versions: [pin('vite')],
    line: "optimizeDeps: { exclude: ['geose-fmap'] }",
    to: 'vite.config',
  },
  { name: 'Vite 7 and older, built', versions: [pin('vite')] },
  { name: 'webpack', versions: [own('webpack')] },
  { name: 'Parcel', versions: [pin('parcel')] },
  { name: 'Rollup with an asset plugin', versions: [pin('rollup'), pin('@web/rollup-plugin-import-meta-assets')] },
  { name: 'Rollup without one', versions: [pin('rollup')], line: COPY },
  { name: 'esbuild', versions: [own('esbuild')], line: COPY },
  { name: 'esbuild for Node', versions: [own('esbuild')], line: '--external:geose-fmap', to: 'esbuild' },
  {
    name: 'Next.js with webpack, in a server route',
    versions: [pin('next')],
    line: "serverExternalPackages: ['geose-fmap']",
    to: 'next.config',
  },
  { name: 'Next.js with Turbopack, in a server route', versions: [pin('next')] },
  {
    name: 'Jest with jsdom',
    versions: [pin('jest'), pin('jest-environment-jsdom')],
    line: 'NODE_OPTIONS=--experimental-vm-modules',
    to: 'the environment of jest',
    named: 'https://jestjs.io/docs/ecmascript-modules',
  },
  { name: 'Vitest with jsdom', versions: [pin('vitest'), pin('jsdom')] },
  { name: 'TypeScript', versions: [own('typescript'), pin('typescript')] },
  { name: 'TypeScript without the DOM library', versions: [own('typescript'), pin('typescript')] },
];

export const environmentNamed = (name) => ENVIRONMENTS.find((entry) => entry.name === name) ?? fail(name);

/** The table as the README has it. */
export function table() {
  const version = (of) => (typeof of === 'string' ? of : `${of.name} ${of.version}`);
  const rows = ENVIRONMENTS.map(({ name, versions, line, to }) => [
    name,
    versions.map(version).join(', '),
    line === undefined ? 'nothing' : to === undefined ? line : `\`${line}\` (${to})`,
  ]);
  return [['where', 'tried with', 'what to add'], ['---', '---', '---'], ...rows].map((cells) => `| ${cells.join(' | ')} |`).join('\n');
}

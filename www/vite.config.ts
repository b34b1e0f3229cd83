import { fileURLToPath } from 'node:url';
import { defineConfig, type Plugin } from 'vite';

const fromHere = (path: string): string => fileURLToPath(new URL(path, import.meta.url));

/**
 * The built page forbids itself every address but its own, so "sends nothing anywhere" is enforced by the browser.
 * The development server injects its own inline styles and scripts and therefore goes without.
 */
const contentSecurityPolicy: Plugin = {
  name: 'content-security-policy',
  apply: 'build',
  transformIndexHtml: () => [
    {
      tag: 'meta',
      injectTo: 'head-prepend',
      attrs: {
        'http-equiv': 'Content-Security-Policy',
        content:
          "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self' blob:; img-src 'self' blob: data:; object-src 'none'; base-uri 'none'; form-action 'none'",
      },
    },
  ],
};

export default defineConfig({
  root: fromHere('.'),
  base: './',
  plugins: [contentSecurityPolicy],
  resolve: { alias: { 'geose-fmap': fromHere('../dist/package') } },
  worker: { format: 'es' },
  build: {
    outDir: fromHere('../dist/site'),
    emptyOutDir: true,
    target: 'es2022',
    // three.js alone is larger than Vite's default warning.
    chunkSizeWarningLimit: 1000,
  },
});

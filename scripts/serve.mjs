// Serves the built page on 127.0.0.1: on PORT, or on the first free port from 4173.
import path from 'node:path';
import { Failure, main, root } from './run.mjs';
import { buildSite } from './site.mjs';

/** Starts a server of dist/site; `port` 0 means any. Close it when done. Returns its address with it. */
export async function serveSite({ port, strictPort = true }) {
  // Not at the top: this script is also what installs it.
  const { preview } = await import('vite');
  const www = path.join(root, 'www');
  const server = await preview({
    root: www,
    configFile: path.join(www, 'vite.config.ts'),
    // A file that is not there is a 404, not the page again.
    appType: 'mpa',
    preview: { host: '127.0.0.1', port, strictPort, open: false },
  });
  return { address: server.resolvedUrls.local[0], close: () => server.close() };
}

/** A signal that ends npm ends the shell between us too, but is not passed on to us: be gone when they are. */
function endWithNpm() {
  const parent = process.ppid;
  setInterval(() => process.ppid !== parent && process.exit(), 500);
}

await main(import.meta, async () => {
  await buildSite();
  const { PORT } = process.env;
  const { address } = await serveSite({ port: Number(PORT ?? 4173), strictPort: PORT !== undefined }).catch((error) => {
    throw new Failure(error.message);
  });
  console.log(`GeoSe-FMap is at ${address} (Ctrl+C ends it)`);
  endWithNpm();
});

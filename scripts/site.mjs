// The static page: www/ and the package → dist/site.
import { writeFileSync } from 'node:fs';
import path from 'node:path';
import { once } from './fresh.mjs';
import { shippedLicences } from './licences.mjs';
import { buildPackage } from './package.mjs';
import { environment, main, root, run } from './run.mjs';
import { toolFolders } from './tools.mjs';

/** npm packages whose code ends up in the page. */
const BUNDLED = ['three', 'three-mesh-bvh'];

export async function buildSite() {
  await buildPackage();
  const inputs = ['www', 'dist/package', 'package-lock.json', 'scripts/site.mjs', 'scripts/licences.mjs'];
  await once('site', { inputs, outputs: ['dist/site/index.html'] }, () => {
    run('vite', ['build', 'www', '--logLevel', 'warn'], { env: environment(toolFolders) });
    writeFileSync(path.join(root, 'dist/site/THIRD-PARTY-LICENSES.txt'), shippedLicences(BUNDLED));
  });
}

await main(import.meta, buildSite);

// The package as a customer gets it: the packed tarball, unpacked into the node_modules of an empty project.
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

/** Makes the project in a folder of `parent`; `files` maps further file names to their text. Whoever calls it removes it. */
export function project(files = {}, parent = tmpdir()) {
  const tarball = process.env.GEOSE_TARBALL;
  if (!tarball) throw new Error('GEOSE_TARBALL must name the packed tarball: `npm run pack` makes it');
  const folder = mkdtempSync(path.join(parent, 'geose-fmap-'));
  const installed = path.join(folder, 'node_modules', 'geose-fmap');
  mkdirSync(installed, { recursive: true });
  execFileSync('tar', ['-xzf', path.resolve(tarball), '-C', installed, '--strip-components=1']);
  const all = { 'package.json': JSON.stringify({ private: true, type: 'module', dependencies: { 'geose-fmap': '*' } }), ...files };
  for (const [name, text] of Object.entries(all)) {
    mkdirSync(path.dirname(path.join(folder, name)), { recursive: true });
    writeFileSync(path.join(folder, name), text);
  }
  return { folder, installed, remove: () => rmSync(folder, { recursive: true, force: true }) };
}

/** Imports the package the way Node does for a customer: by its name, from inside a project. */
export async function installedPackage() {
  const { folder, installed, remove } = project({ 'entry.mjs': "export * from 'geose-fmap';\n" });
  process.on('exit', remove);
  return { ...(await import(pathToFileURL(path.join(folder, 'entry.mjs')).href)), installed };
}

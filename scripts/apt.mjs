// Debian packages: installed when we are root, named and left to the person when we are not.
import { existsSync } from 'node:fs';
import { Failure, environment, output, run, say, which } from './run.mjs';

/** Whether this is a Debian-like machine, where the fallbacks below can work. */
export const isDebian = () => existsSync('/etc/debian_version') && which(['apt-get']) !== null;

export const isRoot = () => process.getuid?.() === 0;

const installed = (name) => output('dpkg-query', ['-W', '-f', '${db:Status-Status}', name]) === 'installed';

/** Makes sure the packages are there; without root prints the line that installs them and stops. */
export function ensurePackages(names, why) {
  const missing = names.filter((name) => !installed(name));
  if (missing.length === 0) return;
  const install = ['install', '-y', '--no-install-recommends', ...missing];
  if (!isRoot()) throw new Failure(`${why}. Run this once, then try again:\n  sudo apt-get update && sudo apt-get ${install.join(' ')}`);
  say(`${why}: apt-get ${install.join(' ')}`);
  const env = environment([], { DEBIAN_FRONTEND: 'noninteractive' });
  run('apt-get', ['update', '-q'], { env });
  run('apt-get', [...install, '-q'], { env });
}

// A Chrome or Chromium to test in, its driver, and the switches both need.
import { existsSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { ensurePackages, isDebian, isRoot } from './apt.mjs';
import { Failure, output, root, which } from './run.mjs';

const BROWSERS = ['google-chrome-stable', 'google-chrome', 'chrome', 'chromium', 'chromium-browser'];
const MACOS = '/Applications/Google Chrome.app/Contents/MacOS/Google Chrome';

/** Switches of a browser that is only there to be tested: nothing but the page talks to anybody. Its sandbox refuses to run as root. */
export const switches = [
  '--headless=new',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
  ...(isRoot() ? ['--no-sandbox'] : []),
];

/** Switches under which Chromium has WebGPU, in software, where there is no graphics card. */
export const webgpu = ['--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader'];

/**
 * Finds a browser (`CHROME`, then the PATH) and its driver (`CHROMEDRIVER`, then the PATH); installs Debian's when there is none.
 * `driver` is null when there is only a browser, which is enough for all but the crate's tests in it.
 */
export function ensureChromium() {
  const found = findBrowser();
  if (!found || isDebians(found)) {
    if (!isDebian()) throw new Failure('No Chrome or Chromium found: install one, or name it in CHROME.');
    if (!found || !findDriver()) ensurePackages(['chromium', 'chromium-driver'], 'Chromium or its driver is missing');
  }
  return { browser: findBrowser(), driver: findDriver() };
}

function findBrowser() {
  if (process.env.CHROME) return process.env.CHROME;
  return which(BROWSERS) ?? (existsSync(MACOS) ? MACOS : null);
}

const findDriver = () => process.env.CHROMEDRIVER ?? which(['chromedriver']);

const isDebians = (browser) => browser === '/usr/bin/chromium' && output('dpkg-query', ['-S', browser]) !== null;

/** Tells wasm-bindgen's test runner, which reads this file in the crate's folder, how to start the browser. */
export function writeWebdriver(browser, more = []) {
  const capabilities = { 'goog:chromeOptions': { binary: browser, args: [...switches, ...more] } };
  writeFileSync(path.join(root, 'webdriver.json'), `${JSON.stringify(capabilities, null, 2)}\n`);
}

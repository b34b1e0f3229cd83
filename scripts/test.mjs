// Every test there is, one suite after the other; `npm test -- rust page` runs only those.
import { readdirSync } from 'node:fs';
import path from 'node:path';
import { check } from './check.mjs';
import { ensureChromium, writeWebdriver } from './chromium.mjs';
import { buildNative, nativeProgram } from './native.mjs';
import { packPackage } from './package.mjs';
import { Failure, environment, main, root, say } from './run.mjs';
import { serveSite } from './serve.mjs';
import { buildSite } from './site.mjs';
import { runSuite } from './suite.mjs';
import { wasmEnvironment } from './toolchain.mjs';

/** Each makes what it needs and resolves to `{ passed, failed, skipped }`. */
const SUITES = {
  check,
  scripts: () => runNode('scripts/tests'),
  rust: testCrate,
  wasm: testInBrowser,
  package: testPackage,
  page: testPage,
};

/** The crate natively. Tests that read evaluation sets run where there are some, and count as skipped elsewhere. */
function testCrate() {
  const all = process.env.GEOSE_EVAL_DIR ? ['--', '--include-ignored'] : [];
  return runSuite('cargo', ['test', '--locked', '--no-fail-fast', '--features', 'train', ...all], environment());
}

/** The crate in a real browser. A release build, because the module has already made its dependencies. */
async function testInBrowser() {
  const { browser, driver } = ensureChromium();
  writeWebdriver(browser);
  const drive = driver ? ['--chromedriver', driver] : [];
  const args = ['test', '--release', '--headless', '--chrome', ...drive, '--', '--locked', '--test', 'wasm'];
  return runSuite('wasm-pack', args, { ...wasmEnvironment(), WASM_BINDGEN_TEST_TIMEOUT: '600' });
}

/** The tarball as customers install it: in Node, in bundlers, in a browser. */
async function testPackage() {
  const tarball = await packPackage();
  const { browser } = ensureChromium();
  return runNode('pkg-template/tests', { GEOSE_TARBALL: tarball, CHROME: browser });
}

/** The built page in a real browser, its maps held against the native program's. */
async function testPage() {
  await buildSite();
  buildNative();
  const { browser } = ensureChromium();
  const { address, close } = await serveSite({ port: 0 });
  try {
    return await runNode('www/tests', { GEOSE_SITE_URL: address, GEOSE_NATIVE: nativeProgram, CHROME: browser });
  } finally {
    await close();
  }
}

/** Runs the `*.test.mjs` of a folder, one after the other: they measure time and share two cores. */
function runNode(folder, variables = {}) {
  const files = readdirSync(path.join(root, folder)).filter((name) => name.endsWith('.test.mjs'));
  if (files.length === 0) throw new Failure(`${folder} holds no *.test.mjs: nothing ran`);
  const runner = ['--test', '--test-reporter=spec', '--test-concurrency=1'];
  const paths = files.sort().map((name) => path.join(folder, name));
  return runSuite(process.execPath, [...runner, ...paths], environment([], variables));
}

await main(import.meta, async (names) => {
  const unknown = names.filter((name) => !(name in SUITES));
  if (unknown.length > 0) throw new Failure(`No such suite: ${unknown.join(', ')}. There are ${Object.keys(SUITES).join(', ')}.`);
  wasmEnvironment();
  const total = { passed: 0, failed: 0, skipped: 0 };
  const lines = [];
  for (const name of names.length > 0 ? names : Object.keys(SUITES)) {
    say(`suite ${name}`);
    const started = performance.now();
    const counts = await SUITES[name]().catch((failure) => {
      console.error(`✖ ${failure instanceof Failure ? failure.message : failure.stack}`);
      return { passed: 0, failed: 1, skipped: 0 };
    });
    for (const kind of Object.keys(total)) total[kind] += counts[kind];
    const seconds = Math.round((performance.now() - started) / 1000);
    lines.push(`${counts.failed > 0 ? '✖' : '✔'} ${name}: ${tell(counts)} in ${seconds} s`);
  }
  console.log(`\n${lines.join('\n')}\n${tell(total)}`);
  if (total.failed > 0) process.exitCode = 1;
});

function tell({ passed, failed, skipped }) {
  return `${passed} passed, ${failed} failed${skipped > 0 ? `, ${skipped} skipped` : ''}`;
}

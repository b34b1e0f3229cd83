// Every test there is, one suite after the other; `npm test -- rust page` runs only those.
import { readFileSync, readdirSync } from 'node:fs';
import path from 'node:path';
import { ensurePackages, isDebian } from './apt.mjs';
import { check } from './check.mjs';
import { ensureChromium, webgpu, writeWebdriver } from './chromium.mjs';
import { buildNative, nativeProgram } from './native.mjs';
import { packPackage } from './package.mjs';
import { Failure, environment, main, root, say } from './run.mjs';
import { serveSite } from './serve.mjs';
import { buildSite } from './site.mjs';
import { runSuite } from './suite.mjs';
import { wasmEnvironment } from './toolchain.mjs';
import { presentBodyData } from './train.mjs';
import { buildWasm } from './wasm.mjs';

/** Where data lies that is not part of the crate: variables that the ignored tests name. */
export const DATA = ['GEOSE_EVAL_DIR', 'GEOSE_BODY_DATA'];

/** Each makes what it needs and resolves to `{ passed, failed, skipped }`, and what is to be remarked, if anything. */
const SUITES = {
  check,
  scripts: () => runNode('scripts/tests'),
  rust: testCrate,
  wasm: testInBrowser,
  package: testPackage,
  page: testPage,
};

/** The crate natively. Tests that read data which is not part of it run where that is, and count as skipped elsewhere. */
async function testCrate() {
  // A Vulkan driver in software; other systems bring one of their own.
  if (isDebian()) ensurePackages(['libvulkan1', 'mesa-vulkan-drivers'], 'A Vulkan driver to test the GPU with is missing');
  const bodies = presentBodyData();
  const env = environment([], bodies ? { GEOSE_BODY_DATA: bodies } : {});
  const test = (...args) => runSuite('cargo', ['test', '--locked', '--no-fail-fast', '--features', 'train,gpu', ...args], env);
  const counts = await test();
  const remarks = [];
  for (const variable of DATA) {
    const names = readersOf(variable);
    if (!env[variable]) {
      remarks.push(`not run, as ${variable} is not set: the ignored tests in ${names.join(', ')}`);
      continue;
    }
    const ran = await test(...names.flatMap((name) => ['--test', name]), '--', '--ignored');
    counts.passed += ran.passed;
    counts.failed += ran.failed;
    counts.skipped = Math.max(0, counts.skipped - ran.passed - ran.failed);
  }
  return { ...counts, remarks };
}

/** Integration tests of which some, in the file of that name or in its folder, are ignored because they read what `variable` names. */
export function readersOf(variable) {
  const folder = path.join(root, 'tests');
  const files = readdirSync(folder, { recursive: true }).filter((name) => name.endsWith('.rs'));
  const reads = (name) => readFileSync(path.join(folder, name), 'utf8').includes(`: set ${variable} and pass`);
  const names = files.filter(reads).map((name) => name.split(path.sep)[0].replace(/\.rs$/, ''));
  return [...new Set(names)].sort();
}

/** The crate in a real browser, without WebGPU and with it. Release builds, because the module has already made their dependencies. */
async function testInBrowser() {
  const { browser, driver } = ensureChromium();
  const drive = driver ? ['--chromedriver', driver] : [];
  const env = { ...wasmEnvironment(), WASM_BINDGEN_TEST_TIMEOUT: '600' };
  const test = async (switches, args) => {
    writeWebdriver(browser, switches);
    return runSuite(
      'wasm-pack',
      ['test', '--release', '--headless', '--chrome', ...drive, '--', '--locked', '--features', 'gpu', ...args],
      env,
    );
  };
  const sizes = [await buildWasm('with WebGPU'), await buildWasm('without WebGPU')];
  if (sizes[0].raw <= sizes[1].raw) throw new Failure('The module without WebGPU is no smaller than the one with it.');
  // One build for both: a browser without WebGPU has to get along with a module that has it.
  const runs = [await test([], ['--test', 'wasm']), await test(webgpu, ['--test', 'gpu_in_browser'])];
  return runs.reduce((sum, counts) => ({
    passed: sum.passed + counts.passed,
    failed: sum.failed + counts.failed,
    skipped: sum.skipped + counts.skipped,
  }));
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
    const remarks = (counts.remarks ?? []).map((remark) => `\n  ${remark}`);
    lines.push(`${counts.failed > 0 ? '✖' : '✔'} ${name}: ${tell(counts)} in ${seconds} s${remarks.join('')}`);
  }
  console.log(`\n${lines.join('\n')}\n${tell(total)}`);
  if (total.failed > 0) process.exitCode = 1;
});

function tell({ passed, failed, skipped }) {
  return `${passed} passed, ${failed} failed${skipped > 0 ? `, ${skipped} skipped` : ''}`;
}

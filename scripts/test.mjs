// Every test there is, in suites, each with a table of what took longest. `npm test` runs them in two lanes beside each other, and what measures time after
// that, alone; `npm test -- crate page` runs only those, one after the other.
import { fork } from 'node:child_process';
import { readFileSync, readdirSync } from 'node:fs';
import path from 'node:path';
import { ensurePackages, isDebian } from './apt.mjs';
import { check } from './check.mjs';
import { ensureChromium, webgpu, writeWebdriver } from './chromium.mjs';
import { ofProcessor, note, slowest, step, stopwatch, takeCosts } from './costs.mjs';
import { crateFolder, unpackCrate } from './crate.mjs';
import { ensureEnvironments } from './environments.mjs';
import { packPackage } from './package.mjs';
import { Failure, environment, main, root, run, say } from './run.mjs';
import { serveSite } from './serve.mjs';
import { buildSite } from './site.mjs';
import { runSuite, sumOf } from './suite.mjs';
import { wasmCompiler, wasmEnvironment } from './toolchain.mjs';
import { presentBodyData } from './train.mjs';
import { buildWasm } from './wasm.mjs';

/** Where data lies that is not part of the crate: variables that the ignored tests name. */
export const DATA = ['GEOSE_EVAL_DIR', 'GEOSE_BODY_DATA'];

/** Each makes what it needs and resolves to `{ passed, failed, skipped }`, and what is to be remarked, if anything. */
const SUITES = {
  check,
  scripts: () => runNode('scripts/tests'),
  crate: testCrate,
  wasm: testInBrowser,
  package: testPackage,
  page: testPage,
  times: testTimes,
};

/**
 * Suites that run beside each other, each lane in its order: the one builds natively, the other for wasm32 and waits for browsers. The native program of the second
 * is built last, from what the first has built by then.
 */
const LANES = [
  ['check', 'scripts', 'crate'],
  ['wasm', 'package', 'page'],
];
/** What measures time runs after that, alone. */
const LAST = ['times'];
/** A variable that is set in the process of a lane. */
const LANE = 'GEOSE_TEST_LANE';

/** The tests of `crate`, run where one works on them. Only when asked for: they pass if those do. */
const ON_REQUEST = { rust: () => testRust(root) };

/** What cargo tests. Everything that is built for it natively is built so, and once. */
const TESTED = ['--locked', '--features', 'train,gpu'];

/** The crate as it is published: the packed files, and no others, pass their tests. */
async function testCrate() {
  await step('packing the crate', unpackCrate);
  return testRust(crateFolder, ONCE);
}

/** For what is built from the packed crate: it is seldom built twice, and the first time is quicker so. A panic tells its line all the same. */
const ONCE = { CARGO_INCREMENTAL: '0', CARGO_PROFILE_DEV_DEBUG: 'none' };
/** For unit tests, which take a second: most of the time goes into building them. */
const UNIT = { CARGO_PROFILE_DEV_OPT_LEVEL: '1' };

/** The crate in `folder` natively. Tests that read data which is not part of it run where that is, and count as skipped elsewhere. */
async function testRust(folder, more = {}) {
  // A Vulkan driver in software; other systems bring one of their own.
  if (isDebian()) ensurePackages(['libvulkan1', 'mesa-vulkan-drivers'], 'A Vulkan driver to test the GPU with is missing');
  const data = { GEOSE_BODY_DATA: presentBodyData(), GEOSE_EVAL_DIR: process.env.GEOSE_EVAL_DIR };
  const present = Object.entries(data).filter(([, place]) => place);
  const env = environment([], { ...more, ...Object.fromEntries(present.map(([name, place]) => [name, path.resolve(place)])) });
  const testWith = (env, ...args) => runSuite('cargo', ['test', '--no-fail-fast', ...TESTED, ...args], env, { cwd: folder });
  const test = (...args) => testWith(env, ...args);
  await step('building the programs and examples', () => run('cargo', ['build', ...TESTED, '--bins', '--examples'], { cwd: folder, env }));
  const counts = sumOf([await test('--test', '*'), await testWith({ ...env, ...UNIT }, '--lib'), await test('--doc')]);
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
  if (!driver) throw new Failure('A chromedriver for the browser is missing: install one, or name it in CHROMEDRIVER.');
  const sizes = {};
  for (const kind of ['without WebGPU', 'with WebGPU']) sizes[kind] = await step(`the module ${kind}`, () => buildWasm(kind));
  if (sizes['with WebGPU'].raw <= sizes['without WebGPU'].raw)
    throw new Failure('The module without WebGPU is no smaller than the one with it.');
  const env = {
    ...wasmEnvironment(),
    CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUNNER: 'wasm-bindgen-test-runner',
    CHROMEDRIVER: driver,
    WASM_BINDGEN_TEST_ONLY_WEB: '1',
    WASM_BINDGEN_TEST_TIMEOUT: '600',
  };
  // One build for both: a browser without WebGPU has to get along with a module that has it.
  const test = ['test', '--release', '--target', 'wasm32-unknown-unknown', '--locked', '--features', 'gpu', '--test', 'wasm'];
  await step('building the tests for wasm32', () => run('cargo', [...test, '--no-run'], { env }));
  const runs = [];
  for (const [name, switches] of Object.entries({ cpu: [], gpu: webgpu })) {
    writeWebdriver(browser, switches);
    runs.push(await runSuite('cargo', [...test, '--', `${name}::`], env));
  }
  return sumOf(runs);
}

/** Tests of the package that measure time: nothing else runs beside them. */
const MEASURED = ['cancel.test.mjs', 'crash.test.mjs', 'plain.test.mjs', 'samples.test.mjs'];

/** The tarball as customers install it: in Node and other runtimes, in bundlers, test runners and frameworks, in a browser. What measures time is the suite `times`. */
async function testPackage() {
  const tarball = await step('packing the package', packPackage);
  const GEOSE_ENVIRONMENTS = await step('installing what customers run it in', environments);
  const variables = { ...installed(tarball), GEOSE_ENVIRONMENTS };
  return runNode('pkg-template/tests', variables, (name) => !MEASURED.includes(name));
}

/** How soon the package answers, and what else is in the same files. */
async function testTimes() {
  const missing = MEASURED.filter((name) => !testsIn('pkg-template/tests').includes(name));
  if (missing.length > 0) throw new Failure(`pkg-template/tests holds no ${missing.join(', ')}`);
  const tarball = await step('packing the package', packPackage);
  return runNode('pkg-template/tests', installed(tarball), (name) => MEASURED.includes(name), 1);
}

/** Where they are installed; the tests that need them fail where they could not be, and the others run. */
function environments() {
  try {
    return ensureEnvironments();
  } catch (failure) {
    console.error(failure.message);
    return '';
  }
}

const installed = (tarball) => ({ GEOSE_TARBALL: tarball, CHROME: ensureChromium().browser });

/** The built page in a real browser, its maps held against those of the native program that the crate was tested with. */
async function testPage() {
  await step('building the page', buildSite);
  await step('building the native program', () => {
    unpackCrate();
    run('cargo', ['build', ...TESTED, '--bin', 'geose-fmap'], { cwd: crateFolder, env: environment([], ONCE) });
  });
  const { browser } = ensureChromium();
  const { address, close } = await serveSite({ port: 0 });
  try {
    const native = path.join(root, 'target/debug/geose-fmap');
    return await runNode('www/tests', { GEOSE_SITE_URL: address, GEOSE_NATIVE: native, CHROME: browser });
  } finally {
    await close();
  }
}

const testsIn = (folder) => readdirSync(path.join(root, folder)).filter((name) => name.endsWith('.test.mjs'));

/** Runs the `*.test.mjs` of a folder that are `wanted`, `beside` of them at a time. */
async function runNode(folder, variables = {}, wanted = () => true, beside = 2) {
  const files = testsIn(folder).filter(wanted);
  if (files.length === 0) throw new Failure(`${folder} holds no *.test.mjs that is wanted: nothing ran`);
  const env = environment([], variables);
  const results = [];
  const queue = files.sort();
  const work = async () => {
    while (queue.length > 0) {
      const file = path.join(folder, queue.shift());
      const elapsed = stopwatch();
      results.push(await runSuite(process.execPath, ['--test', '--test-reporter=spec', file], env, { quiet: beside > 1 }));
      note(`all of ${file}`, elapsed().seconds);
    }
  };
  await Promise.all(Array.from({ length: beside }, work));
  return sumOf(results);
}

/** Runs suites one after the other; resolves to a line about each, and all counts. */
async function runSuites(names) {
  const results = [];
  const lines = [];
  for (const name of names) {
    say(`suite ${name}`);
    const elapsed = stopwatch();
    const counts = await { ...SUITES, ...ON_REQUEST }[name]().catch((failure) => {
      console.error(`✖ ${failure instanceof Failure ? failure.message : failure.stack}`);
      return { passed: 0, failed: 1, skipped: 0 };
    });
    results.push(counts);
    const took = elapsed();
    const costs = slowest(takeCosts());
    if (costs.length > 0) console.log(`\nwhat took longest in suite ${name}:\n${costs.join('\n')}`);
    const remarks = (counts.remarks ?? []).map((remark) => `\n  ${remark}`);
    const seconds = `${Math.round(took.seconds)} s${ofProcessor(took)}`;
    lines.push(`${counts.failed > 0 ? '✖' : '✔'} ${name}: ${tell(counts)} in ${seconds}${remarks.join('')}`);
  }
  return { lines, counts: sumOf(results) };
}

/** A lane: a process of its own, because builds would block the other one. What it prints comes when it is through, unless it is `heard` at once. */
function runLane(names, heard) {
  return new Promise((resolve) => {
    const lane = fork(import.meta.filename, names, {
      env: { ...process.env, [LANE]: '1' },
      stdio: ['ignore', heard ? 'inherit' : 'pipe', heard ? 'inherit' : 'pipe', 'ipc'],
    });
    const text = [];
    for (const stream of [lane.stdout, lane.stderr]) stream?.setEncoding('utf8').on('data', (chunk) => text.push(chunk));
    let found = null;
    lane.on('message', (message) => (found = message));
    lane.on('close', (code, signal) => {
      process.stdout.write(text.join(''));
      const failed = {
        lines: [`✖ ${names.join(', ')}: ended with ${signal ?? `exit code ${code}`}`],
        counts: { passed: 0, failed: 1, skipped: 0 },
      };
      if (!found) resolve(failed);
      else if (code !== 0 && found.counts.failed === 0)
        resolve({ lines: [...found.lines, ...failed.lines], counts: sumOf([found.counts, failed.counts]) });
      else resolve(found);
    });
  });
}

await main(import.meta, async (names) => {
  const all = { ...SUITES, ...ON_REQUEST };
  const unknown = names.filter((name) => !(name in all));
  if (unknown.length > 0) throw new Failure(`No such suite: ${unknown.join(', ')}. There are ${Object.keys(all).join(', ')}.`);
  const planned = [...LANES.flat(), ...LAST];
  const forgotten = Object.keys(SUITES).filter((name) => !planned.includes(name));
  if (forgotten.length > 0) throw new Failure(`In no lane: ${forgotten.join(', ')}.`);
  const elapsed = stopwatch();
  wasmCompiler();
  const found = [];
  if (names.length > 0) found.push(await runSuites(names));
  else {
    // What both lanes would install is there before either begins. Suites that cannot do without it say so themselves.
    try {
      ensureChromium();
    } catch (failure) {
      console.error(failure.message);
    }
    found.push(...(await Promise.all(LANES.map((lane, i) => runLane(lane, i === 0)))));
    found.push(await runSuites(LAST));
  }
  const total = { lines: found.flatMap(({ lines }) => lines), counts: sumOf(found.map(({ counts }) => counts)) };
  if (process.env[LANE]) process.send(total);
  else console.log(`\n${total.lines.join('\n')}\n${tell(total.counts)} in ${Math.round(elapsed().seconds)} s`);
  if (total.counts.failed > 0) process.exitCode = 1;
});

function tell({ passed, failed, skipped }) {
  return `${passed} passed, ${failed} failed${skipped > 0 ? `, ${skipped} skipped` : ''}`;
}

// A test program, run with its output shown, and its results and times read from that output.
import { spawn } from 'node:child_process';
import { stripVTControlCharacters } from 'node:util';
import { note } from './costs.mjs';
import { root } from './run.mjs';

/** How each runner closes: cargo and wasm-bindgen one line per binary, Node one line per count. */
const CLOSINGS = [
  {
    passed: /^test result: .*?(\d+) passed/gm,
    failed: /^test result: .*?(\d+) failed/gm,
    skipped: /^test result: .*?(\d+) ignored/gm,
  },
  { passed: /^ℹ pass (\d+)/gm, failed: /^ℹ (?:fail|cancelled) (\d+)/gm, skipped: /^ℹ (?:skipped|todo) (\d+)/gm },
];
/** No suite may hang: milliseconds. */
const LIMIT = 30 * 60_000;

/** Runs a test program and notes what its parts took; resolves to `{ passed, failed, skipped }`. */
export async function runSuite(program, args, env, { cwd = root, quiet = false } = {}) {
  const { status, text } = await tee(program, args, { env, cwd, quiet });
  const { complaint, ...counts } = countResults(text, status);
  if (complaint) console.log(`✖ ${complaint}`);
  for (const { name, seconds } of timesIn(text)) note(name, seconds);
  return counts;
}

/** Adds results up. */
export function sumOf(results) {
  const sum = { passed: 0, failed: 0, skipped: 0 };
  for (const counts of results) for (const kind of Object.keys(sum)) sum[kind] += counts[kind];
  return sum;
}

/** Sums the closing lines in `text`. A program that ran nothing, or failed without saying so, counts as a failure, with a complaint. */
export function countResults(text, status) {
  const sum = (kind) =>
    CLOSINGS.flatMap((closing) => [...text.matchAll(closing[kind])]).reduce((total, [, count]) => total + Number(count), 0);
  const counts = { passed: sum('passed'), failed: sum('failed'), skipped: sum('skipped') };
  if (counts.passed + counts.failed === 0) return { ...counts, failed: 1, complaint: `nothing ran (exit code ${status})` };
  if (status !== 0 && counts.failed === 0) {
    return { ...counts, failed: 1, complaint: `ended with exit code ${status} though no test failed` };
  }
  return counts;
}

/** The times that a runner tells of: cargo's of its build and of each binary, Node's of each test. */
export function timesIn(text) {
  const builds = [...text.matchAll(/^ *Finished `(.*)` profile .* in (?:(\d+)m )?([\d.]+)s$/gm)];
  const binaries = [...text.matchAll(/^ *(?:Running (?:unittests )?(\S+\.rs) \(|(Doc-tests) )/gm)];
  const results = [...text.matchAll(/^test result: .* finished in ([\d.]+)s$/gm)];
  return [
    ...builds.map(([, profile, minutes, seconds]) => ({
      name: `cargo build, profile ${profile}`,
      seconds: 60 * Number(minutes ?? 0) + Number(seconds),
    })),
    // Each binary that is told of closes with one result, and they run one after the other.
    ...(binaries.length === results.length
      ? results.map(([, seconds], i) => ({ name: binaries[i][1] ?? binaries[i][2], seconds: Number(seconds) }))
      : []),
    ...testsOfNode(text),
  ];
}

/** Lines of Node's reporter; a group of tests, which is opened by a line of its own, is not counted beside its tests. */
function testsOfNode(text) {
  const groups = new Set([...text.matchAll(/^ *▶ (.+?)(?: \([\d.]+ms\))?$/gm)].map(([, name]) => name));
  const [tests] = text.split(/^ℹ tests /m);
  return [...tests.matchAll(/^ *[✔✖] (.+) \(([\d.]+)ms\)/gm)]
    .map(([, name, milliseconds]) => ({ name, seconds: Number(milliseconds) / 1000 }))
    .filter(({ name }) => !groups.has(name));
}

/** Runs a program; its output is kept, and shown as it comes or, if `quiet`, in one piece at the end. */
function tee(program, args, { env, cwd, quiet }) {
  return new Promise((resolve) => {
    const child = spawn(program, args, { cwd, env, stdio: ['ignore', 'pipe', 'pipe'], timeout: LIMIT });
    let text = '';
    for (const [from, to] of [
      [child.stdout, process.stdout],
      [child.stderr, process.stderr],
    ]) {
      from.setEncoding('utf8').on('data', (chunk) => {
        text += chunk;
        if (!quiet) to.write(chunk);
      });
    }
    const end = (status) => {
      if (quiet) process.stdout.write(text);
      resolve({ status, text: stripVTControlCharacters(text) });
    };
    child.on('error', (error) => end(error.message));
    child.on('close', (code, signal) => end(code ?? signal));
  });
}

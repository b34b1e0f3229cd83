// A test program, run with its output shown and its results counted from that output.
import { spawn } from 'node:child_process';
import { stripVTControlCharacters } from 'node:util';
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

/** Runs a test program; resolves to `{ passed, failed, skipped }`. */
export async function runSuite(program, args, env) {
  const { status, text } = await tee(program, args, env);
  const { complaint, ...counts } = countResults(text, status);
  if (complaint) console.log(`✖ ${complaint}`);
  return counts;
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

/** Runs a program; its output is shown and kept. */
function tee(program, args, env) {
  return new Promise((resolve) => {
    const child = spawn(program, args, { cwd: root, env, stdio: ['ignore', 'pipe', 'pipe'], timeout: LIMIT });
    let text = '';
    for (const [from, to] of [
      [child.stdout, process.stdout],
      [child.stderr, process.stderr],
    ]) {
      from.setEncoding('utf8').on('data', (chunk) => {
        text += chunk;
        to.write(chunk);
      });
    }
    child.on('error', (error) => resolve({ status: error.message, text: stripVTControlCharacters(text) }));
    child.on('close', (code, signal) => resolve({ status: code ?? signal, text: stripVTControlCharacters(text) }));
  });
}

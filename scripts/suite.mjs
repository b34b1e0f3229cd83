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

/** Runs a test program; resolves to `{ passed, failed, skipped }`. A program that fails, or runs nothing, has at least one failure. */
export async function runSuite(program, args, env) {
  const { status, text } = await tee(program, args, env);
  const sum = (kind) => CLOSINGS.flatMap((closing) => [...text.matchAll(closing[kind])]).reduce((total, [, n]) => total + Number(n), 0);
  const counts = { passed: sum('passed'), failed: sum('failed'), skipped: sum('skipped') };
  if (counts.passed + counts.failed === 0) {
    console.log(`✖ nothing ran (exit code ${status})`);
    counts.failed = 1;
  } else if (status !== 0 && counts.failed === 0) {
    console.log(`✖ ended with exit code ${status} though no test failed`);
    counts.failed = 1;
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

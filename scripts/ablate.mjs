// What each piece of the method is worth (the paper's Table 3, on our data) → benches/results/ablations.md. Every variant trains for the same time, from
// nothing: `npm run ablate -- --minutes 10`. What an earlier call trained or measured is not done again.
import { existsSync, mkdirSync, readFileSync, renameSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { evaluationSets, markdown, number, share } from './evaluate.mjs';
import { buildNative, nativeProgram } from './native.mjs';
import { Failure, main, output, root, run, say } from './run.mjs';
import { bodyData, runTrainer } from './train.mjs';

const TABLE = path.join(root, 'benches/results/ablations.md');
const losses = (changes) => ({ run: { losses: changes } });

/** What differs from what ships. `laplacian` is the one of every cloud, in training and in matching. */
const VARIANTS = {
  'as it ships': {},
  'without L_sem': losses({ semantic: 0 }),
  'without orthogonality': losses({ orthogonality: 0 }),
  'without bijectivity': losses({ bijectivity: 0 }),
  'without coupling to the point map': losses({ coupling: 0 }),
  'without cross-entropy of parts': losses({ parts: 0 }),
  'without attention': { network: { attention: 0 } },
  'without moments': { network: { moments: 0 } },
  'Euclidean Laplacian': { laplacian: 'euclidean' },
  "the paper's losses": losses({
    ...{ parts: 0, bijectivity: 0, orthogonality: 0, coupling: 0, semantic: 0.5, eigen: 1, features_orthogonal: 50 },
    ...{ temperature: 0.1, semantic_temperature: 0.1 },
  }),
  'the paper as printed': { paper: true, laplacian: 'geodesic-literal' },
};

/** Trains a variant; returns its weights. */
function train(name, { run: changes = {}, network = {}, laplacian, paper }, { minutes, bodies, folder }) {
  const out = path.join(folder, name.replaceAll(/\W+/g, '-'));
  const weights = path.join(out, 'weights.safetensors');
  const done = path.join(out, 'done');
  if (existsSync(done)) return weights;
  const samples = path.join(root, 'runs', paper ? 'samples-paper' : `samples${laplacian ? `-${laplacian}` : ''}`);
  const trainer = (...more) =>
    runTrainer('train', [
      ...['--data', bodyData(), '--out', out, '--samples', samples, '--bodies', bodies],
      ...['--run', JSON.stringify({ ...changes, minutes, name }), '--network', JSON.stringify(network)],
      ...(laplacian ? ['--laplacian', laplacian] : []),
      ...(paper ? ['--paper'] : []),
      ...more,
    ]);
  say(`${name}: ${bodies} bodies`);
  trainer('--only-samples');
  say(`${name}: ${minutes} minutes`);
  trainer();
  writeFileSync(done, '');
  return weights;
}

/** One measurement of weights. */
function measure(weights, dataset, mode, laplacian, limit) {
  const file = path.join(path.dirname(weights), `${path.basename(dataset)}-${mode}-${limit}.json`);
  if (!existsSync(file)) {
    const operator = laplacian && mode === 'cloud' ? ['--laplacian', laplacian] : [];
    const what = ['--dataset', dataset, '--mode', mode, '--limit', limit, '--weights', weights, ...operator];
    run(nativeProgram, ['evaluate', ...what, '--json', `${file}.part`]);
    renameSync(`${file}.part`, file);
  }
  return JSON.parse(readFileSync(file, 'utf8'));
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
        only: { type: 'string', multiple: true },
      },
    }).values;
  } catch (error) {
    throw new Failure(
      `${error.message}\nOptions: --minutes N for each variant, --bodies N to train on, --limit N pairs of each set, --only NAME of a variant (more than once).`,
    );
  }
  const minutes = Number(options.minutes ?? 10);
  if (!(minutes > 0)) throw new Failure(`--minutes must be a number above 0, and is ${options.minutes}.`);
  const [limit, bodies] = [options.limit ?? '20', options.bodies ?? '1500'];
  const folder = path.join(root, `runs/ablations-${minutes}`);
  const held = path.join(root, 'runs/held-out');
  if (!existsSync(path.join(held, 'pairs.txt')))
    runTrainer('bodies', ['set', '--data', bodyData(), '--out', held, '--seed', '900001', '--count', '24']);
  const sets = [held, path.join(evaluationSets(), 'faust_r')];
  buildNative();
  const unknown = options.only?.filter((name) => !(name in VARIANTS)) ?? [];
  if (unknown.length > 0) throw new Failure(`--only must be one of: ${Object.keys(VARIANTS).join(', ')}.`);
  const rows = [];
  for (const name of options.only ?? Object.keys(VARIANTS)) {
    const variant = VARIANTS[name];
    const weights = train(name, variant, { minutes, bodies, folder });
    const found = sets.flatMap((set) => ['mesh', 'cloud'].map((mode) => measure(weights, set, mode, variant.laplacian, limit)));
    rows.push([name, ...found.flatMap((f) => [number(f.age_raw, 2), number(f.age, 2)]), share(found[3].part_agreement)]);
    // After every variant, so that what was measured is there whenever the run ends.
    writeTable(sets, rows, { minutes, bodies, limit });
  }
});

function writeTable(sets, rows, { minutes, bodies, limit }) {
  const head = [
    '',
    ...sets.flatMap((set) => ['mesh', 'cloud'].flatMap((mode) => [`${path.basename(set)}, ${mode}`, 'refined'])),
    'parts kept',
  ];
  const text = `# What each piece is worth

\`npm run ablate -- --minutes ${minutes} --bodies ${bodies} --limit ${limit}\` at commit ${output('git', ['rev-parse', '--short', 'HEAD']) ?? 'unknown'}: every variant trained from nothing for
${minutes} minutes. Mean geodesic errors ×100/√area of ${limit} pairs each, before and after refinement; "parts kept" is the share of points of faust_r clouds matched to
their own part.

${markdown(head, rows)}
`;
  mkdirSync(path.dirname(TABLE), { recursive: true });
  writeFileSync(TABLE, text);
  say(TABLE);
}

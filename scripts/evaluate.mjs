// Every evaluation set in every mode it allows → benches/results/accuracy.md. `npm run evaluate -- --limit 10` for a quick one.
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readFileSync, readdirSync, renameSync, writeFileSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { buildNative, nativeProgram } from './native.mjs';
import { Failure, main, output, root, run, say } from './run.mjs';

const TABLE = path.join(root, 'benches/results/accuracy.md');
// By default the geodesic one, limbs in contact told apart by their parts; the one called geodesic knows no parts.
const CLOUD_LAPLACIANS = ['default', 'geodesic', 'euclidean', 'geodesic-literal'];
/** The set that is measured in any orientation too, and on how many pairs. */
const TURNED = { set: 'faust_r', rotate: 'so3', most: 40 };
/** How many pairs, and from how many sources, a figure should come from. */
const ENOUGH = { pairs: 40, sources: 10 };

/** Folder of the evaluation sets. */
export function evaluationSets() {
  const given = process.env.GEOSE_EVAL_DIR;
  const folder = path.resolve(root, given ?? '../shared/eval');
  if (existsSync(folder)) return folder;
  if (given) throw new Failure(`GEOSE_EVAL_DIR is ${given}, where there is nothing.`);
  throw new Failure('There are no evaluation sets in ../shared/eval: say in GEOSE_EVAL_DIR where they are.');
}

/** What to measure on the sets in `folder`: `{ set, mode, parts, rotate, most, laplacian, oracle }` each, by what files a set has. */
export function plan(folder) {
  const sets = readdirSync(folder).filter((name) => existsSync(path.join(folder, name, 'shapes')));
  return sets.sort().flatMap((set) => {
    const at = (name) => path.join(folder, set, name);
    const truths = existsSync(at('corres')) ? readdirSync(at('corres')) : [];
    const paired = existsSync(at('pairs.txt')) && readFileSync(at('pairs.txt'), 'utf8').trim() !== '';
    // Clouds that were sampled independently have no faces, and no points in common that an oracle could use.
    const clouds = truths.some((name) => name.endsWith('.tpl'));
    const modes = clouds ? ['cloud'] : paired ? ['mesh', 'cloud', 'mesh-cloud'] : ['mesh', 'cloud'];
    const given = paired && existsSync(at('labels')) ? ['given'] : [];
    const parts = paired ? ['predicted', 'none', ...given] : ['predicted'];
    const upright = modes.flatMap((mode) => parts.map((parts) => ({ set, mode, parts, oracle: false })));
    const turned = set === TURNED.set ? modes.map((mode) => ({ ...TURNED, mode, parts: 'predicted', oracle: false })) : [];
    const matches = [...upright, ...turned];
    if (!truths.some((name) => name.endsWith('.vts')) || clouds) return matches;
    const oracles = [['mesh', 'cotangent'], ...CLOUD_LAPLACIANS.map((laplacian) => ['cloud', laplacian])];
    return [...matches, ...oracles.map(([mode, laplacian]) => ({ set, mode, laplacian, oracle: true }))];
  });
}

/** How many pairs a set has, and from how many sources. */
export function sizeOf(folder, set) {
  const list = path.join(folder, set, 'pairs.txt');
  const lines = existsSync(list) ? readFileSync(list, 'utf8').split('\n') : [];
  const pairs = lines.map((line) => line.trim()).filter((line) => line !== '');
  return { pairs: pairs.length, sources: new Set(pairs.map((pair) => pair.split(/\s+/)[0])).size };
}

/** What tells the native program from those built before and after. */
export const programHash = () => createHash('sha256').update(readFileSync(nativeProgram)).digest('hex').slice(0, 12);

/** The commit that the native program was built at. */
export function programCommit() {
  const commit = output('git', ['rev-parse', '--short', 'HEAD']) ?? 'unknown';
  return output('git', ['status', '--porcelain', '--', 'src', 'Cargo.toml', 'Cargo.lock']) ? `${commit} with changes` : commit;
}

/** The name of a task's measurement and the options that make it. */
export function asked({ set, mode, parts, rotate, most, laplacian, oracle }, all) {
  const limit = most ? Math.min(most, all ?? most) : all;
  const what = oracle ? `oracle-${laplacian}` : `parts-${parts}`;
  const name = [set, mode, what, ...(rotate ? [`rotate-${rotate}`] : []), limit ? `limit-${limit}` : 'all'].join('_');
  const operator = laplacian === 'default' ? [] : ['--laplacian', laplacian];
  const how = oracle ? ['--oracle', ...operator] : ['--parts', parts];
  const turned = rotate ? ['--rotate', rotate] : [];
  return { name, options: ['--mode', mode, ...how, ...turned, ...(limit ? ['--limit', `${limit}`] : [])] };
}

/** Runs one measurement, unless this very program has done it before; resolves to its JSON. */
function measure(folder, task, limit) {
  const { name, options } = asked(task, limit);
  const file = path.join(root, 'dist/evaluate', programHash(), `${name}.json`);
  if (!existsSync(file)) {
    say(name);
    mkdirSync(path.dirname(file), { recursive: true });
    // Moved when it is complete, so that a run that was stopped leaves nothing half-written.
    run(nativeProgram, ['evaluate', '--dataset', path.join(folder, task.set), ...options, '--json', `${file}.part`]);
    renameSync(`${file}.part`, file);
  }
  return { ...task, found: JSON.parse(readFileSync(file, 'utf8')) };
}

export const number = (value, digits) => (value === null ? '–' : value.toFixed(digits));
/** The mean error and its 95 % interval. */
export const meanError = ({ age, age_interval: interval }) =>
  interval ? `${number(age, 2)} (${interval.map((end) => number(end, 1)).join('–')})` : number(age, 2);
export const share = (value) => (value === null ? '–' : `${(100 * value).toFixed(1)} %`);
const accuracies = ({ accuracy }) => ['0.01', '0.02', '0.05'].map((within) => share(accuracy?.[within] ?? null));

export const markdown = (head, rows) =>
  [head, head.map((_, column) => (column < 3 ? '---' : '---:')), ...rows].map((row) => `| ${row.join(' | ')} |`).join('\n');

const modeOf = ({ mode, rotate }) => (rotate ? `${mode}, ${rotate}` : mode);

/** A sentence that names the cells with fewer pairs or sources than they should have although the set, of the size `sizeOf(set)`, has more; else nothing. */
export function warning(measured, sizeOf) {
  const short = measured.filter(({ set, found }) =>
    Object.entries(ENOUGH).some(([what, enough]) => found[what] < Math.min(enough, sizeOf(set)[what])),
  );
  if (short.length === 0) return '';
  const named = short.map((task) => {
    const { set, parts, laplacian, oracle, found } = task;
    return `${set} ${modeOf(task)}, ${oracle ? laplacian : `parts ${parts}`} (${found.pairs} from ${found.sources})`;
  });
  return `**Small samples**, though the sets have more: fewer than ${ENOUGH.pairs} pairs or ${ENOUGH.sources} sources stand behind ${named.join('; ')}.`;
}

/** The tables of what was found: matches, and what the bases allow. */
export function tables(measured) {
  const within = ['≤ 0.01', '≤ 0.02', '≤ 0.05'];
  const matches = measured
    .filter(({ oracle }) => !oracle)
    .map(({ set, mode, parts, rotate, found }) => [
      ...[set, modeOf({ mode, rotate }), parts, found.pairs, found.sources],
      ...[meanError(found), number(found.age_raw, 2), ...accuracies(found)],
      ...[found.flips ?? '–', share(found.flipped_points), number(found.part_miou, 3), share(found.part_agreement)],
      ...[number(found.confidence_auc, 3), number(found.ece, 3)],
      ...[number(found.seconds_per_shape, 2), number(found.seconds_per_pair, 2)],
    ]);
  const oracles = measured
    .filter(({ oracle }) => oracle)
    .map(({ set, mode, laplacian, found }) => [set, mode, laplacian, found.pairs, found.sources, meanError(found), ...accuracies(found)]);
  const head = ['set', 'mode', 'parts', 'pairs', 'sources', 'error', 'before refinement', ...within];
  return [
    markdown([...head, 'flips', 'flipped points', 'part mIoU', 'part agreement', 'confidence AUC', 'ECE', 's/shape', 's/pair'], matches),
    markdown(['set', 'mode', 'Laplacian', 'pairs', 'sources', 'error', ...within], oracles),
  ];
}

function page(measured, sizeOf, command) {
  const [matches, oracles] = tables(measured);
  const short = warning(measured, sizeOf);
  return `# Accuracy

\`${command}\` at commit ${programCommit()}. Data and protocol are those of the evaluation sets' README; errors are mean geodesic errors
×100/√area with the 95 % interval of a bootstrap in brackets that draws sources (first shapes of pairs), each with all its pairs; "≤ ε" is the share of
points with an error of at most ε. Pairs are a fair sample where a set has more. In rows of so3 every shape was turned by a random rotation first. Seconds were taken on
${os.cpus()[0]?.model ?? 'an unknown processor'}, ${os.availableParallelism()} pairs at a time.
${short && `\n${short}\n`}
${matches}

## What the bases allow

The functional map of the true match itself (\`--oracle\`, k = 120), which no refinement takes part in, and no feature but one: on a cloud the
default is the geodesic Laplacian with limbs in contact told apart by the parts that the network predicts; the one called geodesic knows none.

${oracles}
`;
}

await main(import.meta, async (args) => {
  let limit;
  try {
    limit = parseArgs({ args, options: { limit: { type: 'string' } } }).values.limit;
  } catch (error) {
    throw new Failure(`${error.message}\nThe only option is --limit N: so many pairs of each set.`);
  }
  if (limit !== undefined && !/^[1-9]\d*$/.test(limit)) throw new Failure(`--limit must be a whole number from 1, and is ${limit}.`);
  const folder = evaluationSets();
  buildNative();
  const measured = plan(folder).map((task) => measure(folder, task, limit));
  mkdirSync(path.dirname(TABLE), { recursive: true });
  writeFileSync(
    TABLE,
    page(measured, (set) => sizeOf(folder, set), ['npm run evaluate', ...(limit ? [`-- --limit ${limit}`] : [])].join(' ')),
  );
  say(TABLE);
});

// Laplacian and 120 eigenpairs of clouds of 5000 points: the package in Node, the same crate natively, and
// robust_laplacian with SciPy, in turns.
import { spawn } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { createInterface } from 'node:readline';
import { pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';
import { Failure, environment, main, root, run, say } from '../../scripts/run.mjs';

const POINTS = 5000;
const EIGENPAIRS = 120;

/** A repeatable number in [0, 1) at each call (mulberry32). */
function random(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), seed | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

/** `count` points spread evenly over the area of a mesh at random, x y z each. */
function scatter({ positions, faces }, count) {
  const corner = (f, s) => [0, 1, 2].map((c) => positions[3 * faces[3 * f + s] + c]);
  const upTo = new Float64Array(faces.length / 3);
  for (let f = 0, sum = 0; f < upTo.length; f++) {
    const [a, b, c] = [0, 1, 2].map((s) => corner(f, s));
    const [u, v] = [b, c].map((p) => p.map((x, i) => x - a[i]));
    sum += Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
    upTo[f] = sum;
  }
  const next = random(1);
  const points = new Float64Array(3 * count);
  for (let i = 0; i < count; i++) {
    const at = next() * upTo.at(-1);
    const f = upTo.findIndex((sum) => sum > at);
    const [r, t] = [Math.sqrt(next()), next()];
    const weights = [1 - r, r * (1 - t), r * t];
    for (let c = 0; c < 3; c++) {
      points[3 * i + c] = weights.reduce((sum, w, s) => sum + w * positions[3 * faces[3 * f + s] + c], 0);
    }
  }
  return points;
}

/** `count` of the points, each as far as possible from those before it. */
function farthest(points, count) {
  const nearest = new Float64Array(points.length / 3).fill(Infinity);
  const chosen = new Float64Array(3 * count);
  for (let k = 0, at = 0; k < count; k++) {
    const [x, y, z] = points.subarray(3 * at, 3 * at + 3);
    chosen.set([x, y, z], 3 * k);
    at = 0;
    for (let i = 0; i < nearest.length; i++) {
      const d = (points[3 * i] - x) ** 2 + (points[3 * i + 1] - y) ** 2 + (points[3 * i + 2] - z) ** 2;
      if (d < nearest[i]) nearest[i] = d;
      if (nearest[i] > nearest[at]) at = i;
    }
  }
  return chosen;
}

/**
 * One thread for the BLAS of SciPy, as the others have. It is also its best: matrices are small, and on a busy machine threads that
 * wait for one another made 0.4 s into anything from 0.8 to 4.6 s.
 */
const ONE_THREAD = { OPENBLAS_NUM_THREADS: '1', OMP_NUM_THREADS: '1', MKL_NUM_THREADS: '1' };

/** A program that answers each path on its standard input with a line of JSON. */
function peer(program, args) {
  const env = environment([], ONE_THREAD);
  const child = spawn(program, args, { cwd: root, env, stdio: ['pipe', 'pipe', 'inherit'] });
  const lines = createInterface({ input: child.stdout })[Symbol.asyncIterator]();
  const failed = new Promise((_, reject) => child.once('error', reject));
  return {
    measure: async ({ file }) => {
      child.stdin.write(`${file}\n`);
      const { value, done } = await Promise.race([lines.next(), failed]);
      if (done) throw new Failure(`${program} ${args.join(' ')} ended without an answer.`);
      return JSON.parse(value);
    },
    end: () => child.stdin.end(),
  };
}

/** The package, in its worker; what goes there and back counts too. */
async function packaged(folder) {
  const { Matcher } = await import(pathToFileURL(path.join(folder, 'index.js')).href);
  const matcher = await Matcher.create();
  return {
    matcher,
    measure: async ({ positions }) => {
      const started = performance.now();
      const l = await matcher.laplacian({ positions }, { kind: 'geodesic' });
      const built = performance.now();
      const { eigenvalues } = await matcher.spectrum(l, { eigenpairs: EIGENPAIRS });
      if (eigenvalues.length !== EIGENPAIRS) throw new Failure(`${eigenvalues.length} eigenvalues`);
      return { seconds: (performance.now() - started) / 1000, laplacian: (built - started) / 1000 };
    },
    end: () => matcher.dispose(),
  };
}

/** The clouds, written to target/peers for the other programs. */
async function clouds(matcher) {
  const geometry = async (name) => {
    const scan = await matcher.prepare(readFileSync(path.join(root, 'www/public/samples', name)), { name, points: 500 });
    const read = scan.geometry();
    scan.free();
    return read;
  };
  const shapes = {
    'woman-greeting-cloud': (await geometry('woman-greeting-cloud.ply')).positions,
    'man-lunging, sampled': farthest(scatter(await geometry('man-lunging.ply'), 10 * POINTS), POINTS),
  };
  const folder = path.join(root, 'target/peers');
  mkdirSync(folder, { recursive: true });
  return Object.entries(shapes).map(([name, given], i) => {
    const positions = Float64Array.from(given);
    const file = path.join(folder, `${i}.f64`);
    writeFileSync(file, positions);
    return { name, positions, file };
  });
}

const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];

await main(import.meta, async () => {
  const { values: given } = parseArgs({
    options: {
      python: { type: 'string', default: 'python3' },
      package: { type: 'string', default: path.join(root, 'dist/package') },
      rounds: { type: 'string', default: '5' },
    },
  });
  const folder = path.resolve(given.package);
  if (!existsSync(path.join(folder, 'index.js'))) throw new Failure(`No package in ${folder}: npm run pack builds it.`);
  run('cargo', ['build', '--release', '--locked', '--quiet', '--example', 'peer']);
  const wasm = await packaged(folder);
  const peers = {
    wasm,
    native: peer(path.join(root, 'target/release/examples/peer'), []),
    python: peer(given.python, [path.join(import.meta.dirname, 'peer.py')]),
  };
  for (const cloud of await clouds(wasm.matcher)) {
    const rounds = [];
    // The first round warms up and does not count.
    for (let round = 0; round <= Number(given.rounds); round++) {
      const measured = {};
      for (const [name, { measure }] of Object.entries(peers)) measured[name] = await measure(cloud);
      if (round > 0) rounds.push(measured);
    }
    say(`${cloud.name}, ${cloud.positions.length / 3} points, median of ${rounds.length}:`);
    for (const name of Object.keys(peers)) {
      const of = (key) => median(rounds.map((round) => round[name][key]));
      const ratio = median(rounds.map((round) => round[name].seconds / round.python.seconds));
      const residual = rounds[0][name].residual;
      say(
        `  ${name.padEnd(7)} ${of('seconds').toFixed(2)} s (Laplacian ${of('laplacian').toFixed(2)} s), ${ratio.toFixed(2)} × python` +
          (residual === undefined ? '' : `, residual ${residual.toExponential(1)}`),
      );
    }
  }
  Object.values(peers).forEach(({ end }) => end());
});

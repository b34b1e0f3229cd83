import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { createRequire } from 'node:module';
import { after, describe, test } from 'node:test';
import path from 'node:path';
import { project } from './installed.mjs';

const tsc = path.join(path.dirname(createRequire(import.meta.url).resolve('typescript/package.json')), 'bin', 'tsc');

const PROGRAM = `
  import { GeoSeError, Matcher, UNMATCHED, type Match, type Parts, type PreparedShape, type Stage } from 'geose-fmap';

  export async function use(bytes: Uint8Array, signal: AbortSignal | undefined): Promise<Match> {
    using matcher = await Matcher.create({ device: 'auto' });
    const seen: Stage[] = [];
    using a: PreparedShape = await matcher.prepare(bytes, { name: 'a.ply', signal, onProgress: ({ stage }) => seen.push(stage) });
    const b = await matcher.prepare({ positions: [0, 0, 0], faces: new Uint16Array(3), labels: null }, { laplacian: 'geodesic', points: undefined });
    const again = await matcher.prepare(b.geometry());
    const match = await matcher.match(a, again, { refine: 'best', parts: 'predicted', landmarks: [[0, 1]] });
    const targets: Uint32Array = match.targetOf;
    const unmatched: number = targets.filter((target) => target === UNMATCHED).length;
    const parts: Parts | null = a.parts;
    const sure: Float32Array | undefined = parts?.source === 'predicted' ? parts.probabilities : undefined;
    const version: string | undefined = match.report.weights?.version;
    const { eigenvectors } = await matcher.spectrum(await matcher.laplacian(b, { kind: 'euclidean' }), { eigenpairs: 20 });
    new Blob([eigenvectors, match.reverse.confidence, String(unmatched + (parts?.labels[0] ?? 0) + (sure?.[0] ?? 0)), version ?? '']);
    return match;
  }

  export const codeOf = (error: unknown): string => (error instanceof GeoSeError ? error.code : 'unknown');

  export async function misuse(matcher: Matcher, a: PreparedShape): Promise<void> {
    // @ts-expect-error no such device
    await Matcher.create({ device: 'gpu' });
    // @ts-expect-error no such option
    await matcher.prepare(new Uint8Array(), { eigenparis: 20 });
    // @ts-expect-error not a scan
    await matcher.prepare('a.ply');
    // @ts-expect-error a scan is not prepared yet
    await matcher.match(a, { positions: [] });
    // @ts-expect-error no such stage
    await matcher.match(a, a, { onProgress: ({ stage }) => stage === 'done' });
  }
`;

describe('the types of the package', () => {
  const { folder, remove } = project({ 'program.ts': PROGRAM });
  after(remove);

  for (const [what, flags] of Object.entries({
    'a bundler': ['--module', 'esnext', '--moduleResolution', 'bundler', '--lib', 'es2022,dom,esnext.disposable'],
    Node: ['--module', 'nodenext', '--lib', 'es2022,dom,esnext.disposable'],
  })) {
    test(`check for ${what}, strictly and without skipping declarations`, () => {
      const strict = [
        '--strict',
        '--exactOptionalPropertyTypes',
        '--noUncheckedIndexedAccess',
        '--noEmit',
        '--target',
        'es2022',
        '--types',
        '',
      ];
      const { status, stdout } = spawnSync(process.execPath, [tsc, ...strict, ...flags, 'program.ts'], { cwd: folder, encoding: 'utf8' });
      assert.equal(status, 0, stdout);
    });
  }
});

import { createRequire } from 'node:module';
import path from 'node:path';
import { after, describe } from 'node:test';
import { inEnvironment, installedFile, ran } from './environment.mjs';
import { project } from './installed.mjs';

const tsc = path.join(path.dirname(createRequire(import.meta.url).resolve('typescript/package.json')), 'bin', 'tsc');

const PROGRAM = `
  import { GeoSeError, Matcher, UNMATCHED, type Match, type Parts, type PreparedShape, type Stage } from 'geose-fmap';

  export async function use(bytes: Uint8Array, signal: AbortSignal | undefined): Promise<Match> {
    using matcher = await Matcher.create({ device: 'auto' });
    const seen: Stage[] = [];
    using a: PreparedShape = await matcher.prepare(bytes, { name: 'a.ply', signal, onProgress: ({ stage }) => seen.push(stage) });
    const b = await matcher.prepare({ positions: [0, 0, 0], faces: new Uint16Array(3), labels: null }, { laplacian: 'geodesic', points: undefined });
    const again = await matcher.prepare(b.geometry(), { wholeScan: true });
    const posed = await matcher.prepare(bytes, { name: 'a.gltf', pose: 'rest', companions: { 'a.bin': bytes } });
    const aside: Uint32Array = posed.unmatched;
    const match = await matcher.match(a, again, { refine: 'best', parts: 'predicted', landmarks: [[0, 1]] });
    const targets: Uint32Array = match.targetOf;
    const unmatched: number = aside.length + targets.filter((target) => target === UNMATCHED).length;
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
    // @ts-expect-error neither true nor false
    await matcher.prepare(new Uint8Array(), { wholeScan: 'yes' });
    // @ts-expect-error not a scan
    await matcher.prepare('a.ply');
    // @ts-expect-error a scan is not prepared yet
    await matcher.match(a, { positions: [] });
    // @ts-expect-error no such stage
    await matcher.match(a, a, { onProgress: ({ stage }) => stage === 'done' });
  }
`;

/** The same for a project that has the bare language: no page, no Node, and yet every call. */
const BARE = `
  import { Matcher, type FileInput, type Match, type MatcherOptions } from 'geose-fmap';

  interface Controller { abort(): void; readonly signal: { readonly aborted: boolean; addEventListener(type: 'abort', listener: () => void): void } }

  export async function use(file: FileInput, bytes: Uint8Array, { signal }: Controller, options: MatcherOptions): Promise<Match> {
    using matcher = await Matcher.create({ ...options, wasm: 'geose_fmap_bg.wasm', worker: 'worker.js' });
    const a = await matcher.prepare(file, { signal });
    const b = await matcher.prepare(bytes);
    return matcher.match(a, b, { signal });
  }

  export async function misuse(matcher: Matcher): Promise<void> {
    // @ts-expect-error not a signal
    await matcher.prepare(new Uint8Array(), { signal: {} });
    // @ts-expect-error not a scan
    await matcher.prepare(7);
    // @ts-expect-error not an address
    await Matcher.create({ worker: 7 });
  }
`;

const STRICT = '--strict --exactOptionalPropertyTypes --noUncheckedIndexedAccess --skipLibCheck false --noEmit --target es2022'.split(' ');
const NODENEXT = ['--module', 'nodenext'];
const BUNDLER = ['--module', 'esnext', '--moduleResolution', 'bundler'];

describe('the types of the package, strictly and without skipping declarations', () => {
  const { folder, remove } = project({ 'program.ts': PROGRAM, 'bare.ts': BARE });
  after(remove);

  /** What the compiler of this workspace and the oldest that will do complain of, for Node and for bundlers. */
  async function complaints(file, lib) {
    const told = [];
    for (const compiler of [tsc, installedFile('typescript', 'bin', 'tsc')]) {
      for (const flags of [NODENEXT, BUNDLER]) {
        const args = [compiler, ...STRICT, ...flags, '--lib', lib, '--typeRoots', 'none', file];
        const { status, stdout } = await ran(process.execPath, args, { cwd: folder });
        if (status !== 0) told.push(stdout);
      }
    }
    return told.length > 0 ? { error: told.join('\n') } : { outcome: 'no complaint' };
  }

  inEnvironment(
    'TypeScript',
    () => complaints('program.ts', 'es2022,dom,esnext.disposable'),
    () => 'no complaint',
  );
  inEnvironment(
    'TypeScript without the DOM library',
    () => complaints('bare.ts', 'es2022'),
    () => 'no complaint',
  );
});

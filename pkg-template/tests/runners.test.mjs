import { existsSync, readFileSync, rmSync } from 'node:fs';
import path from 'node:path';
import { after, describe } from 'node:test';
import { inEnvironment, installedFile, program, projectInside, ran } from './environment.mjs';

/** A test that writes down what the program tells, and what becomes of a file that is the page's own. */
const TEST = `
  import { writeFileSync } from 'node:fs';
  import { lump, offText } from './bodies.mjs';
  ${program('(told) => (globalThis.told = told)')}
  test('it matches', async () => {
    const matcher = await Matcher.create({ device: 'cpu' });
    for (const file of [new File([offText(lump())], 'Körper 😀.off'), new Blob([offText(lump())])]) {
      const order = [];
      const read = matcher.prepare(file, { eigenpairs: 20, points: 200 }).then((shape) => [order.push('first'), shape]);
      const other = matcher.laplacian({ positions: lump().positions }).then(() => order.push('second'));
      const [[, { info }]] = await Promise.all([read, other]);
      expect([info.name, info.points, ...order]).toEqual([file.name ?? null, 642, 'first', 'second']);
    }
    const gone = new Blob(['x']);
    Object.defineProperty(gone, 'arrayBuffer', { value: () => Promise.reject(new Error('gone')) });
    await expect(matcher.prepare(gone)).rejects.toMatchObject({ code: 'unreadable-file' });
    const controller = new AbortController();
    const cancelled = matcher.prepare(new Blob([offText(lump())]), { signal: controller.signal });
    controller.abort();
    await expect(cancelled).rejects.toMatchObject({ code: 'cancelled' });
    await expect(matcher.prepare({ positions: lump().positions }, { eigenpairs: 20, points: 200 })).resolves.toBeDefined();
    expect(told.error).toBeUndefined();
    writeFileSync('outcome.json', JSON.stringify(told));
  });
`;
/** Milliseconds that a test may take. The runners stop one after five seconds, which a busy machine needs for it. */
const PATIENCE = 60_000;
const CONFIGURATIONS = {
  'map.test.js': TEST,
  'jest.config.js': `export default { testEnvironment: 'jsdom', testTimeout: ${PATIENCE}, transform: {} };\n`,
  'vitest.config.js': `
    const shared = { environment: 'jsdom', globals: true, include: ['map.test.js'], testTimeout: ${PATIENCE} };
    const inPool = (pool) => ({ test: { ...shared, name: pool, pool } });
    export default { test: { projects: ['forks', 'vmThreads'].map(inPool) } };
  `,
};

describe('test runners with a page of their own', () => {
  const { folder, remove } = projectInside(CONFIGURATIONS);
  after(remove);

  /** What the test wrote, or everything that the runner said. */
  async function outcomeOf(name, args, env = {}) {
    const file = path.join(folder, 'outcome.json');
    rmSync(file, { force: true });
    const { status, stdout, stderr } = await ran(process.execPath, [installedFile(...name), ...args], { cwd: folder, env });
    return status === 0 && existsSync(file) ? JSON.parse(readFileSync(file, 'utf8')) : { error: `${status}: ${stdout}\n${stderr}` };
  }

  inEnvironment('Jest with jsdom', (line) => {
    const [name, value] = line?.split('=') ?? ['NODE_OPTIONS', ''];
    return outcomeOf(['jest', 'bin', 'jest.js'], [], { [name]: value });
  });
  inEnvironment('Vitest with jsdom', () => outcomeOf(['vitest', 'vitest.mjs'], ['run']));
});

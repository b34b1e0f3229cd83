import { after, describe } from 'node:test';
import { inEnvironment, installedFile, program, projectInside, ran } from './environment.mjs';

// Another matcher is left as it is: the process has to end all the same.
const MAIN = `
  ${program('(told) => console.log(JSON.stringify(told))')}
  const left = await Matcher.create({ device: 'cpu' }).catch(() => undefined);
  await left?.laplacian({ positions: Float64Array.from({ length: 300 }, (_, i) => Math.sin(i * i + 1)) });
`;

describe('a process that ends by itself though its matcher was not disposed of', () => {
  const { folder, remove } = projectInside({ 'main.mjs': MAIN });
  after(remove);

  async function outcomeIn(file, args) {
    const { status, stdout, stderr } = await ran(file, [...args, 'main.mjs'], { cwd: folder });
    if (status !== 0) throw new Error(`ended with ${status}: ${stderr}`);
    return JSON.parse(stdout);
  }

  inEnvironment('Node', () => outcomeIn(process.execPath, []));
  inEnvironment('Bun', () => outcomeIn(installedFile('.bin', 'bun'), ['run']));
  inEnvironment('Deno', (line) => outcomeIn(installedFile('.bin', 'deno'), ['run', ...(line ? [line] : [])]));
});

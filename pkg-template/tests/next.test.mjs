import { spawn } from 'node:child_process';
import { createServer } from 'node:net';
import { after, describe } from 'node:test';
import { setTimeout as wait } from 'node:timers/promises';
import { inEnvironment, installedFile, projectInside, PREPARING } from './environment.mjs';

const ROUTE = `
  import { Matcher } from 'geose-fmap';
  import { run } from '../../customer.mjs';
  export const dynamic = 'force-dynamic';
  export const GET = () =>
    run(Matcher, { device: 'cpu' }, ${JSON.stringify(PREPARING)})
      .then((outcome) => ({ outcome }), (error) => ({ error: error.code + ': ' + error.message }))
      .then((told) => Response.json(told));
`;

describe('a server route of Next.js', () => {
  const removals = [];
  after(() => removals.forEach((remove) => remove()));

  /** Asks the route of a server for development, made with the line in its configuration. */
  async function outcomeWith(bundler, line) {
    const { folder, remove } = projectInside({
      'app/map/route.js': ROUTE,
      'next.config.mjs': `export default { ${line ?? ''} };\n`,
    });
    removals.push(remove);
    const port = await freePort();
    const args = [installedFile('next', 'dist', 'bin', 'next'), 'dev', bundler, '--port', port, '--hostname', '127.0.0.1'];
    const env = { ...process.env, NODE_ENV: 'development', NEXT_TELEMETRY_DISABLED: '1' };
    // A group of its own: the server is a child of the program that is started.
    const server = spawn(process.execPath, args, { cwd: folder, env, detached: true, stdio: ['ignore', 'pipe', 'pipe'] });
    const said = [];
    for (const stream of [server.stdout, server.stderr]) stream.setEncoding('utf8').on('data', (chunk) => said.push(chunk));
    const ended = new Promise((resolve) => server.on('close', resolve));
    try {
      const response = await answerOf(`http://127.0.0.1:${port}/map`, server);
      const text = await response.text();
      if (!response.ok) throw new Error(`status ${response.status}`);
      return JSON.parse(text);
    } catch (cause) {
      throw new Error(`${cause.message}: ${said.join('')}`, { cause });
    } finally {
      if (server.exitCode === null) process.kill(-server.pid, 'SIGKILL');
      await ended;
    }
  }

  inEnvironment('Next.js with webpack, in a server route', (line) => outcomeWith('--webpack', line));
  inEnvironment('Next.js with Turbopack, in a server route', (line) => outcomeWith('--turbopack', line));
});

/** Asks again until the server listens; it has a minute. */
async function answerOf(url, server) {
  const limit = Date.now() + 60_000;
  for (;;) {
    const response = await fetch(url).catch(() => undefined);
    if (response) return response;
    if (server.exitCode !== null || Date.now() > limit) throw new Error('the server does not answer');
    await wait(200);
  }
}

function freePort() {
  return new Promise((resolve) => {
    const server = createServer().listen(0, '127.0.0.1', () => {
      const { port } = server.address();
      server.close(() => resolve(String(port)));
    });
  });
}

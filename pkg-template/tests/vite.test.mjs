import assert from 'node:assert/strict';
import path from 'node:path';
import { after, before, describe, test } from 'node:test';
import { build, createServer, preview } from 'vite';
import { launch, page, visit } from './browser.mjs';
import { run } from './customer.mjs';
import { importInstalled, inEnvironment, projectInside, smallPage } from './environment.mjs';
import { environmentNamed } from './environments/list.mjs';
import { installedPackage, project } from './installed.mjs';

let browser;
before(async () => (browser = await launch()));
after(() => browser.close());

const toVisit = async (server) => {
  try {
    return await visit(browser, server.resolvedUrls.local[0]);
  } finally {
    await server.close();
  }
};
const vite = (folder, more = {}) => ({ root: folder, configFile: false, logLevel: 'warn', ...more });
const local = { port: 0, host: '127.0.0.1' };
const outcomeOf = async (server) => {
  const { outcome } = await toVisit(server);
  return outcome.error ? outcome : { outcome };
};

describe('a Vite project without any configuration', () => {
  let expected, installation;
  before(async () => {
    expected = await run((await installedPackage()).Matcher);
    installation = project(page());
  });
  after(() => installation.remove());

  test('builds, and the built page gives the bytes Node gives', async () => {
    const { output } = await build(vite(installation.folder));
    const names = output.map(({ fileName }) => path.basename(fileName));
    assert.equal(names.filter((name) => name.endsWith('.wasm')).length, 1, names.join(' '));
    assert.equal(names.filter((name) => name.startsWith('worker')).length, 1, names.join(' '));
    const { outcome, complaints } = await toVisit(await preview(vite(installation.folder, { preview: local })));
    assert.deepEqual(outcome, expected);
    assert.deepEqual(complaints, []);
  });
});

describe('Vite in development', () => {
  const removals = [];
  after(() => removals.forEach((remove) => remove()));

  async function served(createServer, line) {
    const { folder, remove } = projectInside(smallPage());
    removals.push(remove);
    // The line as the README has it.
    const more = line ? (0, eval)(`({ ${line} })`) : {};
    const server = await createServer(vite(folder, { ...more, server: local }));
    await server.listen();
    return outcomeOf(server);
  }

  inEnvironment('Vite', () => served(createServer));
  test('Vite: does not mind the line for older ones', async () => {
    const { line } = environmentNamed('Vite 7 and older, in development');
    const { outcome, error } = await served(createServer, line);
    assert.equal(error, undefined);
    assert.ok(outcome.targetOf.length > 0);
  });
  inEnvironment('Vite 7 and older, in development', async (line) => served((await importInstalled('vite')).createServer, line));
  inEnvironment('Vite 7 and older, built', async () => {
    const { build, preview } = await importInstalled('vite');
    const { folder, remove } = projectInside(smallPage());
    removals.push(remove);
    await build(vite(folder));
    return outcomeOf(await preview(vite(folder, { preview: local })));
  });
});

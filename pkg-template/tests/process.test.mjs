import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { after, describe, test } from 'node:test';
import { project } from './installed.mjs';

const CLOUD = 'const positions = Float64Array.from({ length: 900 }, (_, i) => Math.sin(i * i + 1));';

describe('a process that uses the package', () => {
  const { folder, remove } = project();
  after(remove);
  const run = (script) =>
    spawnSync(process.execPath, ['--input-type=module', '-e', script], { cwd: folder, encoding: 'utf8', timeout: 60_000 });

  test('ends by itself though its matcher was not disposed of', () => {
    const { status, stdout, stderr } = run(`
      import { Matcher } from 'geose-fmap';
      ${CLOUD}
      const matcher = await Matcher.create();
      const shape = await matcher.prepare({ positions }, { eigenpairs: 10 });
      console.log(shape.info.points);
    `);
    assert.equal(status, 0, stderr);
    assert.equal(stdout.trim(), '300');
  });

  test('ends by itself after a cancelled call and after a trap', () => {
    const { status, stdout, stderr } = run(`
      import { Matcher } from 'geose-fmap';
      ${CLOUD}
      const matcher = await Matcher.create();
      const controller = new AbortController();
      const call = matcher.prepare({ positions }, { signal: controller.signal });
      controller.abort();
      console.log(await call.catch((error) => error.code));
      console.log(await matcher[Symbol.for('geose-fmap.trap')]().catch((error) => error.code));
    `);
    assert.equal(status, 0, stderr);
    assert.equal(stdout, 'cancelled\ncrashed\n');
  });

  test('stays alive while a call is open', () => {
    const { status, stdout, stderr } = run(`
      import { Matcher } from 'geose-fmap';
      ${CLOUD}
      Matcher.create().then((matcher) => matcher.prepare({ positions }, { eigenpairs: 10 })).then((shape) => console.log(shape.info.kind));
    `);
    assert.equal(status, 0, stderr);
    assert.equal(stdout.trim(), 'cloud');
  });
});

// Network weights in place of those that ship: what they know of bodies is in their file.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, describe, test } from 'node:test';
import { installedPackage } from './installed.mjs';
import { sample } from './samples.mjs';

const { GeoSeError, Matcher } = await installedPackage();
const OPTIONS = { points: 800 };
const shipped = readFileSync(new URL('../../data/weights/people.safetensors', import.meta.url));

/** What the header of the weights that ship says, and where it ends. */
function header() {
  const length = Number(shipped.readBigUInt64LE(0));
  return { length, values: JSON.parse(shipped.toString('utf8', 8, 8 + length)) };
}

/** The weights that ship under another name, and their parts under other names. */
function renamed() {
  const { length, values } = header();
  const category = JSON.parse(values.__metadata__.category);
  category.name = 'Leute';
  for (const part of category.parts) part.name = part.name.replace('left', 'links').replace('right', 'rechts');
  Object.assign(values.__metadata__, { name: 'eigene', version: '7', category: JSON.stringify(category) });
  const text = Buffer.from(JSON.stringify(values));
  const size = Buffer.alloc(8);
  size.writeBigUInt64LE(BigInt(text.length));
  return new Uint8Array(Buffer.concat([size, text, shipped.subarray(8 + length)]));
}

describe("weights of one's own", () => {
  let own, usual;
  before(async () => {
    [own, usual] = await Promise.all([Matcher.create({ weights: renamed() }), Matcher.create()]);
  });
  after(() => {
    own.dispose();
    usual.dispose();
  });

  test('name the parts and the kind of body, make the same map, and are refused by a matcher with others', async () => {
    const bodies = ['woman-standing', 'man-lunging'].map(sample);
    const both = async (matcher) => Promise.all(bodies.map((body) => matcher.prepare(body, OPTIONS)));
    const [[a, b], [c, d]] = await Promise.all([both(own), both(usual)]);
    const [mine, theirs] = await Promise.all([own.match(a, b), usual.match(c, d)]);
    assert.deepEqual(mine.targetOf, theirs.targetOf);
    assert.equal(mine.report.category, 'Leute');
    assert.deepEqual(mine.report.weights, { name: 'eigene', version: '7' });
    assert.equal(theirs.report.category, 'people');
    await assert.rejects(usual.match(c, b), (error) => {
      assert.ok(error instanceof GeoSeError && error.code === 'other-weights', error.message);
      const { name, version } = header().values.__metadata__;
      assert.match(error.message, new RegExp(`"eigene" 7.*"${name}" ${version}`));
      return true;
    });
  });

  test('that are none are refused', async () => {
    const refused = (weights, code) => assert.rejects(Matcher.create({ weights }), (error) => error.code === code);
    await refused(new Uint8Array(100), 'invalid-weights');
    await refused(shipped.subarray(0, shipped.length / 2), 'invalid-weights');
    await refused([], 'invalid-argument');
    await refused('weights.safetensors', 'invalid-argument');
  });
});

import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { installedPackage } from './installed.mjs';
import { sample } from './samples.mjs';
import { gltfOf, onFloor, thinned } from './scenes.mjs';

const { Matcher, UNMATCHED } = await installedPackage();
const OPTIONS = { points: 1500, eigenpairs: 60 };
const points = ({ positions }) => positions.length / 3;

describe('what is in a scan beside the body', () => {
  let matcher, woman, body, scene;
  before(async () => {
    matcher = await Matcher.create();
    woman = await matcher.prepare(sample('woman-standing'), OPTIONS);
    body = thinned(woman.geometry(), 3);
    scene = onFloor(body);
  });
  after(() => matcher.dispose());

  test('a floor is set aside and said to be, and its points have no partner in any match', async () => {
    const shape = await matcher.prepare(scene, OPTIONS);
    const floor = points(scene) - points(body);
    const said = shape.repairs.find(({ code }) => code === 'floor-set-aside');
    assert.ok(said.count > 0.9 * floor, `${said.count} of ${floor}`);
    assert.match(said.message, /a floor or a wall was set aside, \d+ % of the surface/);
    const { unmatched } = shape;
    assert.ok(unmatched instanceof Uint32Array);
    assert.ok(unmatched.every((point, k) => point < points(scene) && (k === 0 || point > unmatched[k - 1])));
    const ofFloor = unmatched.filter((point) => point >= points(body)).length;
    assert.ok(ofFloor > 0.9 * floor, `${ofFloor} of the floor’s ${floor} points`);
    assert.ok(unmatched.length - ofFloor < 0.1 * points(body), `${unmatched.length - ofFloor} of the body’s points`);

    const { targetOf, confidence, reverse } = await matcher.match(shape, woman);
    const without = Uint32Array.from(targetOf.keys()).filter((point) => targetOf[point] === UNMATCHED);
    assert.deepEqual(without, unmatched);
    assert.ok(unmatched.every((point) => confidence[point] === 0));
    const gone = new Set(unmatched);
    assert.ok(reverse.targetOf.every((target) => !gone.has(target)));
  });

  test('all of it is kept where that is asked for', async () => {
    const shape = await matcher.prepare(scene, { ...OPTIONS, wholeScan: true });
    const codes = shape.repairs.map(({ code }) => code);
    for (const code of ['floor-set-aside', 'furniture-set-aside', 'others-set-aside']) assert.ok(!codes.includes(code), code);
    // The corners of the floor hang together with nothing; stray points are set aside in any case.
    assert.ok(shape.unmatched.length <= 4, `${shape.unmatched.length} points`);
    const { targetOf } = await matcher.match(shape, woman);
    assert.equal(targetOf.filter((target) => target === UNMATCHED).length, shape.unmatched.length);
  });

  test('of a body alone nothing is set aside, whatever is asked for', async () => {
    const [byDefault, whole] = [
      await matcher.prepare(body, { ...OPTIONS, wholeScan: false }),
      await matcher.prepare(body, { ...OPTIONS, wholeScan: true }),
    ];
    assert.deepEqual(byDefault.repairs, whole.repairs);
    assert.deepEqual(byDefault.spectrum(), whole.spectrum());
    assert.deepEqual(byDefault.unmatched, new Uint32Array());
  });

  test('repairs and warnings have a code beside their sentence', async () => {
    const shape = await matcher.prepare(scene, { ...OPTIONS, wholeScan: true });
    const { warnings } = (await matcher.match(shape, woman)).report;
    assert.ok(warnings.length > 0, 'a body with a floor is doubted');
    for (const { code, message } of [...warnings, ...shape.repairs, ...woman.repairs]) {
      assert.match(code, /^[a-z]+(-[a-z]+)+$/);
      assert.ok(message.length > 20, message);
    }
  });

  test('what is neither true nor false, and a name nearly right, are refused by name', async () => {
    await assert.rejects(matcher.prepare(scene, { wholeScan: 'yes' }), {
      code: 'invalid-option',
      message: 'wholeScan must be true or false, not "yes"',
    });
    await assert.rejects(matcher.prepare(scene, { wholeScan: 1 }), {
      code: 'invalid-option',
      details: { option: 'wholeScan', wanted: 'true or false', got: '1' },
    });
    await assert.rejects(matcher.prepare(scene, { wholescan: true }), { code: 'invalid-option', message: /wholescan.*wholeScan/ });
    await assert.rejects(matcher.match(woman, woman, { wholeScan: true }), { code: 'invalid-option', message: /wholeScan/ });
    assert.equal((await matcher.prepare(body, { ...OPTIONS, wholeScan: null })).info.points, points(body), 'null is as good as nothing');
  });
});

describe('a glTF with its data in another file', () => {
  let matcher, woman, file;
  before(async () => {
    matcher = await Matcher.create();
    woman = (await matcher.prepare(sample('woman-standing'), OPTIONS)).geometry();
    file = gltfOf(woman, { uri: 'scans/the%20body.bin', moved: [2, 0, 0] });
  });
  after(() => matcher.dispose());

  test('is read with that file, named by its path or its last part, and neither is changed', async () => {
    const data = Uint8Array.from(file.data);
    for (const companions of [{ 'scans/the body.bin': data }, { 'The Body.BIN': data.buffer, 'skin.png': new Uint8Array(4) }]) {
      const { info, geometry } = await matcher
        .prepare(file.document, { ...OPTIONS, name: 'body.gltf', companions })
        .then((shape) => ({ info: shape.info, geometry: shape.geometry() }));
      assert.equal(info.name, 'body.gltf');
      assert.deepEqual(geometry.faces, woman.faces);
      assert.ok(Buffer.from(data).equals(file.data));
    }
    const laplacian = await matcher.laplacian(file.document, { companions: { 'the body.bin': data } });
    assert.equal(laplacian.mass.length, points(woman));
  });

  test('stands as it was saved, or as its points are stored', async () => {
    const companions = { 'the body.bin': file.data };
    const placed = async (pose) => (await matcher.prepare(file.document, { ...OPTIONS, ...pose, companions })).geometry().positions;
    const [byDefault, saved, rest] = [await placed({}), await placed({ pose: 'saved' }), await placed({ pose: 'rest' })];
    assert.deepEqual(byDefault, saved);
    assert.deepEqual(rest, woman.positions);
    saved.forEach((value, i) => assert.ok(Math.abs(value - rest[i] - (i % 3 === 0 ? 2 : 0)) < 1e-6));
  });

  test('without that file, or with another, is refused by the name of what is missing', async () => {
    for (const options of [{}, { companions: {} }, { companions: { 'another.bin': file.data } }]) {
      await assert.rejects(matcher.prepare(file.document, options), (error) => {
        assert.equal(error.name, 'GeoSeError');
        assert.equal(error.code, 'external-buffer');
        assert.match(error.message, /the body\.bin/);
        return error.details.uri === 'scans/the body.bin';
      });
    }
    const short = { companions: { 'the body.bin': file.data.subarray(0, 1000) } };
    await assert.rejects(matcher.prepare(file.document, short), { code: 'truncated-file' });
  });

  test('and with options that are none is refused by their names', async () => {
    const refused = [
      [{ companions: 'body.bin' }, 'invalid-argument', /^companions must be an object of file names and bytes, not "body\.bin"/],
      [{ companions: { 'body.bin': [1, 2] } }, 'invalid-argument', /^companions\["body\.bin"\] must be the bytes of a file/],
      [{ companion: { 'body.bin': file.data } }, 'invalid-argument', /companion/],
      [{ pose: 'stored' }, 'invalid-option', /^pose must be 'saved' or 'rest', not "stored"/],
      [{ poses: 'rest' }, 'invalid-option', /poses/],
    ];
    for (const [options, code, message] of refused) {
      await assert.rejects(matcher.prepare(file.document, { companions: { 'the body.bin': file.data }, ...options }), {
        name: 'GeoSeError',
        code,
        message,
      });
    }
  });
});

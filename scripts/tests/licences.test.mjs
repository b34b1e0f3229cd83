import assert from 'node:assert/strict';
import { test } from 'node:test';
import { allows, shippedLicences } from '../licences.mjs';

test('a licence expression is allowed when it can be satisfied with permissive licences', () => {
  const allowed = [
    'MIT',
    'MIT/Apache-2.0',
    'LGPL-3.0 OR MIT',
    '(MIT OR GPL-2.0) AND Unicode-3.0',
    'GPL-2.0 OR Apache-2.0 WITH LLVM-exception',
  ];
  for (const expression of allowed) assert.ok(allows(expression), expression);
  const refused = [
    'LGPL-3.0',
    'MIT AND GPL-2.0',
    'GPL-3.0 WITH GCC-exception-3.1',
    '(MIT OR ISC) AND MPL-2.0',
    'UNLICENSED',
    '',
    undefined,
  ];
  for (const expression of refused) assert.ok(!allows(expression), String(expression));
});

test('what is shipped names every crate that is linked and no macro, with the texts', () => {
  const text = shippedLicences(['three']);
  for (const name of ['faer', 'wasm-bindgen', 'three']) assert.match(text, new RegExp(`^${name} \\d+\\.\\d+`, 'm'));
  for (const name of ['serde_derive', 'syn', 'criterion']) assert.doesNotMatch(text, new RegExp(`^${name} `, 'm'));
  assert.match(text, /Permission is hereby granted, free of charge/);
});

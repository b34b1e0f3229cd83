// The size of the module is a budget: going over it fails the build.
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { brotliCompressSync, gzipSync } from 'node:zlib';
import { Failure, root } from './run.mjs';

/** Bytes: as it lies on the disk, and as most servers send it. 592 kB of them are the network's weights, which gzip to 545 kB. */
const BUDGET = { raw: 2_900_000, gzip: 1_400_000 };

/** Prints the size of a built module against the budget. */
export function checkSize(file) {
  const module = readFileSync(path.join(root, file));
  const size = {
    raw: module.length,
    gzip: gzipSync(module, { level: 9 }).length,
    brotli: brotliCompressSync(module).length,
  };
  const kilobytes = (bytes) => `${Math.ceil(bytes / 1000)} kB`;
  const told = Object.entries(size).map(
    ([kind, bytes]) => `${kind} ${kilobytes(bytes)}${kind in BUDGET ? ` of ${kilobytes(BUDGET[kind])}` : ''}`,
  );
  console.log(`${path.basename(file)}: ${told.join(', ')}`);
  const over = Object.keys(BUDGET).filter((kind) => size[kind] > BUDGET[kind]);
  if (over.length > 0)
    throw new Failure(`${file} is over its budget (${over.join(', ')}): make it smaller, or argue for a new budget in scripts/size.mjs.`);
}

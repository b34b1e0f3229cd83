// The size of the module is a budget: going over it fails the build.
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { brotliCompressSync, gzipSync } from 'node:zlib';
import { Failure, root } from './run.mjs';

/**
 * Bytes: as it lies on the disk, and as most servers send it. 536 kB of them are the network's weights, which gzip to 490 kB. Weights of one's own may be of any
 * category and of the paper's network too: its normalisation, masks and solver, categories read and checked, and landmarks that hold took about 200 kB. Files as
 * people have them (posed skins, compressed views, encodings, headings) and scans as they are (shells, floors, spikes, then what is
 * worn, held or beside a body, and points in the air) took another 340 kB; pieces, their scale, extent and overlap, and the signs of confidence that a
 * network gives 25 kB.
 */
export const BUDGETS = {
  'with WebGPU': { raw: 3_740_000, gzip: 1_665_000 },
  'without WebGPU': { raw: 3_385_000, gzip: 1_540_000 },
};

/** Prints the size of a built module against its budget. */
export function checkSize(file, kind) {
  const budget = BUDGETS[kind];
  const module = readFileSync(path.join(root, file));
  const size = {
    raw: module.length,
    gzip: gzipSync(module, { level: 9 }).length,
    brotli: brotliCompressSync(module).length,
  };
  const kilobytes = (bytes) => `${Math.ceil(bytes / 1000)} kB`;
  const told = Object.entries(size).map(
    ([how, bytes]) => `${how} ${kilobytes(bytes)}${how in budget ? ` of ${kilobytes(budget[how])}` : ''}`,
  );
  console.log(`${path.basename(file)}, ${kind}: ${told.join(', ')}`);
  const over = Object.keys(budget).filter((how) => size[how] > budget[how]);
  if (over.length > 0)
    throw new Failure(
      `${file} ${kind} is over its budget (${over.join(', ')}): make it smaller, or argue for a new budget in scripts/size.mjs.`,
    );
  return size;
}

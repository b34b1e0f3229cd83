// The command line for this machine: target/release/geose-fmap.
import path from 'node:path';
import { main, root, run } from './run.mjs';

export const nativeProgram = path.join(root, 'target/release/geose-fmap');

export function buildNative() {
  run('cargo', ['build', '--release', '--locked', '--bin', 'geose-fmap']);
}

await main(import.meta, buildNative);

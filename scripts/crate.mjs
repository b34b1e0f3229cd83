// The crate as crates.io hands it out: packed by cargo, and unpacked in target/crate, to be built and tested there.
import { copyFileSync, existsSync, mkdirSync, readFileSync, readdirSync, rmSync, statSync } from 'node:fs';
import path from 'node:path';
import { Failure, main, root, run } from './run.mjs';

/** The unpacked crate. What is built from it lies in target/, as for any other crate, and shares the dependencies there. */
export const crateFolder = path.join(root, 'target/crate');

/** Bytes that crates.io takes. */
const LIMIT = 10_000_000;

/** Packs the crate and unpacks it. */
export function unpackCrate() {
  // Cargo refuses a work tree with changes, but those are what is to be tested.
  run('cargo', ['package', '--quiet', '--locked', '--no-verify', '--allow-dirty']);
  const version = /^version = "([^"]+)"/m.exec(readFileSync(path.join(root, 'Cargo.toml'), 'utf8'))[1];
  const packed = path.join(root, `target/package/geose-fmap-${version}.crate`);
  const { size } = statSync(packed);
  console.log(`${path.basename(packed)}: ${Math.ceil(size / 1000)} kB`);
  if (size > LIMIT) throw new Failure(`crates.io takes no more than ${LIMIT} bytes: see \`include\` in Cargo.toml.`);
  const unpacked = `${crateFolder}.new-${process.pid}`;
  rmSync(unpacked, { recursive: true, force: true });
  mkdirSync(unpacked, { recursive: true });
  run('tar', ['-xzf', packed, '-C', unpacked, '--strip-components=1']);
  mirror(unpacked, crateFolder);
  rmSync(unpacked, { recursive: true });
}

/** Makes `to` the same as `from`. A file that is so already keeps its age: cargo builds again what is younger than its result. */
export function mirror(from, to) {
  const filesOf = (folder) => {
    if (!existsSync(folder)) return [];
    const entries = readdirSync(folder, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
    return entries.map(({ parentPath, name }) => path.relative(folder, path.join(parentPath, name)));
  };
  const wanted = filesOf(from);
  for (const name of filesOf(to)) if (!wanted.includes(name)) rmSync(path.join(to, name));
  for (const name of wanted) {
    const [source, target] = [path.join(from, name), path.join(to, name)];
    if (existsSync(target) && readFileSync(target).equals(readFileSync(source))) continue;
    mkdirSync(path.dirname(target), { recursive: true });
    rmSync(target, { force: true });
    copyFileSync(source, target);
  }
}

await main(import.meta, unpackCrate);

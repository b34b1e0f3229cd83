// Licences of what is linked in or bundled: checked against a list of permissive ones, and written out to be shipped.
import { readFileSync, readdirSync } from 'node:fs';
import path from 'node:path';
import { Failure, main, output, root } from './run.mjs';

/** Permissive licences: whoever uses the package owes their holders no more than the notices it ships with. */
const ALLOWED = new Set([
  '0BSD',
  'Apache-2.0',
  'Apache-2.0 WITH LLVM-exception',
  'BSD-2-Clause',
  'BSD-3-Clause',
  'BSL-1.0',
  'BlueOak-1.0.0',
  'CC0-1.0',
  'ISC',
  'MIT',
  'Unicode-3.0',
  'Unlicense',
  'Zlib',
]);
/** Programs that only build or test, and their data: nothing of theirs is shipped. */
const BUILD_ONLY = { 'MPL-2.0': /^lightningcss/, 'CC-BY-4.0': /^caniuse-lite$/ };
const WASM = 'wasm32-unknown-unknown';

/** Throws unless every crate and every npm package, tests and tools included, is under an allowed licence. */
export function checkLicences() {
  const crates = [WASM, hostTriple()].flatMap((platform) => metadata(platform).packages.filter(({ source }) => source));
  const refused = new Set();
  for (const { name, version, license } of crates) {
    if (!allows(license)) refused.add(`crate ${name} ${version}: ${license}`);
  }
  const { packages } = JSON.parse(readFileSync(path.join(root, 'package-lock.json'), 'utf8'));
  const modules = Object.entries(packages).filter(([place]) => place !== '');
  for (const [place, { license, version }] of modules) {
    const name = place.replace(/^.*node_modules\//, '');
    if (!allows(license) && !BUILD_ONLY[license]?.test(name)) refused.add(`npm package ${name} ${version}: ${license}`);
  }
  if (crates.length === 0 || modules.length === 0) throw new Failure('No dependencies found: the licence check looked in the wrong place.');
  if (refused.size > 0) throw new Failure(`Licences that are not on the list in scripts/licences.mjs:\n  ${[...refused].join('\n  ')}`);
  console.log(`licences: ${new Set(crates.map(({ id }) => id)).size} crates and ${modules.length} npm packages, all permissive`);
}

/** Whether an SPDX expression can be satisfied with allowed licences. Old manifests write `/` for OR. */
export function allows(expression) {
  const words = expression?.replace(/\//g, ' OR ').match(/[()]|[^\s()]+/g) ?? [];
  let next = 0;
  const either = () => {
    let allowed = both();
    while (words[next] === 'OR') {
      next++;
      allowed = both() || allowed;
    }
    return allowed;
  };
  const both = () => {
    let allowed = one();
    while (words[next] === 'AND') {
      next++;
      allowed = one() && allowed;
    }
    return allowed;
  };
  const one = () => {
    if (words[next] === '(') {
      next++;
      const allowed = either();
      next++;
      return allowed;
    }
    let id = words[next++];
    if (words[next] === 'WITH') id += ` WITH ${words[(next += 2) - 1]}`;
    return ALLOWED.has(id);
  };
  return either() && next === words.length;
}

/** Names, versions and licence texts of the crates in the module, and of the npm packages in `modules`; equal texts once. */
export function shippedLicences(modules = []) {
  const shipped = [
    ...linkedCrates().map(({ name, version, license, repository, manifest_path }) => {
      return { name, version, license, home: repository, folder: path.dirname(manifest_path) };
    }),
    ...modules.map((name) => {
      const folder = path.join(root, 'node_modules', name);
      const { version, license, homepage } = JSON.parse(readFileSync(path.join(folder, 'package.json'), 'utf8'));
      return { name, version, license, home: homepage, folder };
    }),
  ];
  const holders = new Map();
  for (const one of shipped) {
    for (const text of licenceTexts(one)) holders.set(text, [...(holders.get(text) ?? []), one]);
  }
  const line = ({ name, version, license, home }) => `${name} ${version} (${license})${home ? `, ${home}` : ''}`;
  const blocks = [...holders].map(([text, users]) => `${users.map(line).join('\n')}\n\n${text}`);
  const std = 'The Rust standard library (MIT OR Apache-2.0), https://github.com/rust-lang/rust';
  const head = `Linked in or bundled, each under its own licence.\n\n${[std, ...shipped.map(line)].join('\n')}`;
  return `${[head, ...blocks].join(`\n\n${'─'.repeat(80)}\n`)}\n`;
}

/** The texts that come with a crate or package; of a choice with MIT in it, the MIT text. */
function licenceTexts({ name, folder, license }) {
  const names = readdirSync(folder).filter((file) => /^(licen[cs]e|copying|unlicense)/i.test(file));
  const mit = names.filter((file) => /mit/i.test(file));
  const choice = / OR |\//.test(license) && !/ AND /.test(license);
  const files = choice && mit.length > 0 ? mit : names;
  const texts = files.map((file) => readFileSync(path.join(folder, file), 'utf8').replace(/\r\n/g, '\n').trim());
  if (texts.length > 0) return texts;
  if (allows(license)) return [`(No licence file comes with the above.)\n\n${standardText(license)}`];
  throw new Failure(`${name} has no licence text to ship.`);
}

/** The text of a licence as it stands for this project, without its line on who holds the copyright. */
function standardText(license) {
  if (/\bMIT\b/.test(license))
    return readFileSync(path.join(root, 'LICENSE-MIT'), 'utf8')
      .replace(/^Copyright.*\n\n/m, '')
      .trim();
  if (/Apache-2\.0/.test(license)) return readFileSync(path.join(root, 'LICENSE-APACHE'), 'utf8').trim();
  throw new Failure(`There is no standard text of ${license} here.`);
}

/** Crates whose code is in the module: reached by normal dependencies for wasm32; macros run at build time only. */
function linkedCrates() {
  const { packages, resolve } = metadata(WASM);
  const crateOf = new Map(packages.map((crate) => [crate.id, crate]));
  const nodeOf = new Map(resolve.nodes.map((node) => [node.id, node]));
  const found = new Set();
  const visit = (id) => {
    for (const { pkg, dep_kinds } of nodeOf.get(id).deps) {
      const macro = crateOf.get(pkg).targets.some(({ kind }) => kind.includes('proc-macro'));
      if (found.has(pkg) || macro || !dep_kinds.some(({ kind }) => kind === null)) continue;
      found.add(pkg);
      visit(pkg);
    }
  };
  visit(resolve.root);
  return [...found].map((id) => crateOf.get(id)).sort((a, b) => (a.name < b.name ? -1 : 1));
}

function metadata(platform) {
  const text = output('cargo', ['metadata', '--format-version', '1', '--locked', '--features', 'gpu', '--filter-platform', platform]);
  if (text === null) throw new Failure('cargo metadata failed: is Cargo.lock up to date?');
  return JSON.parse(text);
}

const hostTriple = () => /^host: (.+)$/m.exec(output('rustc', ['-vV']) ?? '')?.[1];

await main(import.meta, checkLicences);

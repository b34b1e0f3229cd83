// A Rust compiler for wasm32: rustup's own target where it can be had, else Debian's compiler with a std built once.
import { cpSync, existsSync, mkdirSync, mkdtempSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { ensurePackages, isDebian, isRoot } from './apt.mjs';
import { Failure, environment, output, run, say } from './run.mjs';

const TARGET = 'wasm32-unknown-unknown';
const PACKAGES = ['rustc-web', 'cargo-web', 'rust-web-src', 'rust-web-clippy', 'lld-22'];
/** Where Debian's compiler looks for the std of a target. */
const DEBIAN_STD = `/usr/lib/rustlib/${TARGET}/lib`;
/** Written last, with what the std beside it was built from and how. */
const MARKER = path.join(DEBIAN_STD, 'built-by');
/** Debian ships no rust-lld, and its compiler is known to rustup by this name. */
const DEBIAN = { RUSTUP_TOOLCHAIN: 'debian', CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER: 'wasm-ld-22' };

/**
 * Variables under which cargo and clippy can build for wasm32: none on a developer's machine.
 * Installs what is missing.
 */
export function wasmRust() {
  if (!output('cargo', ['--version'])) throw new Failure('Rust is missing: install it from https://rustup.rs and try again.');
  if (hasTarget()) return {};
  if (debianIsReady()) return DEBIAN;
  if (output('rustup', ['--version'])) {
    say(`rustup target add ${TARGET}`);
    try {
      // A machine that cannot download should find out soon; one with a slow line needs its minutes.
      run('rustup', ['target', 'add', TARGET], {
        timeout: 5 * 60_000,
        env: environment([], { RUSTUP_MAX_RETRIES: '1' }),
      });
    } catch (failure) {
      if (!isDebian()) throw failure;
      say(`rustup could not add ${TARGET}; Debian's compiler takes its place`);
    }
    if (hasTarget()) return {};
  }
  if (!isDebian()) throw new Failure(`Rust's ${TARGET} target is missing: add it with rustup or your package manager.`);
  installDebian();
  return DEBIAN;
}

function hasTarget() {
  const sysroot = output('rustc', ['--print', 'sysroot']);
  return sysroot !== null && hasStd(path.join(sysroot, 'lib/rustlib', TARGET, 'lib'));
}

/** What the marker says when the std fits the compiler and the way it is built here. */
const mark = (version) => `${version}, paths trimmed`;

const hasStd = (folder) => existsSync(folder) && readdirSync(folder).some((name) => /^libstd-.*\.rlib$/.test(name));

function debianIsReady() {
  const version = output('/usr/bin/rustc', ['--version']);
  const ready = version !== null && existsSync(MARKER) && output('cat', [MARKER]) === mark(version);
  return ready && output('rustc', ['--version'], { env: environment([], DEBIAN) }) === version;
}

function installDebian() {
  ensurePackages(PACKAGES, `A compiler for ${TARGET} is missing`);
  const version = output('/usr/bin/rustc', ['--version']);
  if (!existsSync(MARKER) || output('cat', [MARKER]) !== mark(version)) buildStd(version);
  run('rustup', ['toolchain', 'link', DEBIAN.RUSTUP_TOOLCHAIN, '/usr']);
}

/** Builds std from Debian's sources as a dependency of an empty crate, and puts it where the compiler looks. */
function buildStd(version) {
  if (!isRoot()) throw new Failure(`The standard library for ${TARGET} goes to ${DEBIAN_STD}: run "npm run toolchain" once as root.`);
  say(`building std for ${TARGET} with ${version}`);
  const crate = mkdtempSync(path.join(tmpdir(), 'wasm32-std-'));
  mkdirSync(path.join(crate, 'src'));
  writeFileSync(path.join(crate, 'Cargo.toml'), '[package]\nname = "empty"\nversion = "0.0.0"\nedition = "2024"\n');
  writeFileSync(path.join(crate, 'src/lib.rs'), '#![no_std]\n');
  // Without embedded bitcode a later `lto = true` fails with "Can't find section .llvmbc".
  const env = environment(['/usr/bin'], {
    RUSTC: '/usr/bin/rustc',
    RUSTC_BOOTSTRAP: '1',
    RUSTFLAGS: '-Cembed-bitcode=yes',
    CARGO_TARGET_DIR: path.join(crate, 'target'),
  });
  const std = ['-Z', 'build-std=std,panic_abort,panic_unwind,test'];
  // Its panics would name the folders of this machine in every module linked with it.
  const trimmed = ['-Z', 'trim-paths', '--config', 'profile.release.trim-paths="all"'];
  run('/usr/bin/cargo', ['build', '--release', '--target', TARGET, ...std, ...trimmed], { env, cwd: crate });
  const built = path.join(crate, 'target', TARGET, 'release/deps');
  rmSync(DEBIAN_STD, { recursive: true, force: true });
  mkdirSync(DEBIAN_STD, { recursive: true });
  for (const name of readdirSync(built)) {
    if (name.endsWith('.rlib') && !name.startsWith('libempty-')) cpSync(path.join(built, name), path.join(DEBIAN_STD, name));
  }
  writeFileSync(MARKER, `${mark(version)}\n`);
  rmSync(crate, { recursive: true, force: true });
}

import { advice } from './advice.js';
import type { Address } from './ambient.js';
import { GeoSeError } from './error.js';
import { files, isNode } from './node.js';
import type { WasmSource } from './options.js';
import { is } from './tag.js';

/** Fetches, if need be, and compiles the wasm: once per matcher, whose workers share the module. */
export async function compile(source?: WasmSource): Promise<WebAssembly.Module> {
  let where = '';
  try {
    const given = (await source) ?? new URL('./geose_fmap_bg.wasm', import.meta.url);
    if (isModule(given)) return given;
    if (isResponse(given)) return await compileResponse(given);
    if (!isAddress(given)) return await WebAssembly.compile(given);
    where = ` at ${String(given)}`;
    return await compileAddress(String(given));
  } catch (cause) {
    const reason = cause instanceof Error ? cause.message : String(cause);
    const missing = source === undefined && !(cause instanceof Error && HARDLY_MISSING.includes(cause.name));
    const message = `the wasm${where} could not be loaded: ${reason}${missing ? `. ${advice()}` : ''}`;
    const details = cause instanceof GeoSeError ? cause.details : { reason };
    throw new GeoSeError('wasm-unavailable', message, details, { cause });
  }
}

/** Errors that name the way on themselves: a Content-Security-Policy that forbids to compile, a permission that Deno was not given. */
const HARDLY_MISSING = ['CompileError', 'NotCapable'];

type Given = Awaited<WasmSource>;
const isModule = (given: Given): given is WebAssembly.Module => is(given, 'WebAssembly.Module');
const isResponse = (given: Given): given is Response => is(given, 'Response');
const isAddress = (given: Given): given is string | Address => typeof given === 'string' || is(given, 'URL');

async function compileAddress(address: string): Promise<WebAssembly.Module> {
  if (!isNode || /^(https?|data|blob):/.test(address)) return compileResponse(await fetch(address));
  const { readFile } = await files();
  return WebAssembly.compile(await readFile(address.startsWith('file:') ? new URL(address) : address));
}

/** Compiles while the bytes arrive; a server that names another type costs only that. */
async function compileResponse(response: Response): Promise<WebAssembly.Module> {
  const { ok, status, url } = response;
  if (!ok) throw new GeoSeError('wasm-unavailable', `${url} could not be fetched: status ${status}`, { status, url });
  const type = response.headers.get('content-type')?.split(';')[0]?.trim();
  // Development servers answer with the page of the project where they know no file.
  if (type === 'text/html') throw new GeoSeError('wasm-unavailable', 'the server answers with a page instead of it', { type, url });
  return type === 'application/wasm' ? WebAssembly.compileStreaming(response) : WebAssembly.compile(await response.arrayBuffer());
}

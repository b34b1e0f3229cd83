import { GeoSeError } from './error.js';
import { files, isNode } from './node.js';
import type { WasmSource } from './options.js';

/** Fetches, if need be, and compiles the wasm: once per matcher, whose workers share the module. */
export async function compile(source: WasmSource = new URL('./geose_fmap_bg.wasm', import.meta.url)): Promise<WebAssembly.Module> {
  try {
    const given = await source;
    if (given instanceof WebAssembly.Module) return given;
    if (given instanceof Response) return await compileResponse(given);
    if (typeof given === 'string' || given instanceof URL) return await compileAddress(given);
    return await WebAssembly.compile(given);
  } catch (error) {
    if (error instanceof GeoSeError) throw error;
    const reason = error instanceof Error ? error.message : String(error);
    const where = typeof source === 'string' || source instanceof URL ? ` at ${String(source)}` : '';
    throw new GeoSeError('wasm-unavailable', `the wasm${where} could not be loaded: ${reason}`, { reason }, { cause: error });
  }
}

async function compileAddress(address: string | URL): Promise<WebAssembly.Module> {
  const text = String(address);
  if (!isNode || /^(https?|data|blob):/.test(text)) return compileResponse(await fetch(address));
  const { readFile } = await files();
  return WebAssembly.compile(await readFile(text.startsWith('file:') ? new URL(text) : text));
}

/** Compiles while the bytes arrive; a server that names another type costs only that. */
async function compileResponse(response: Response): Promise<WebAssembly.Module> {
  const { ok, status, url } = response;
  if (!ok) throw new GeoSeError('wasm-unavailable', `the wasm at ${url} could not be fetched: status ${status}`, { status, url });
  const type = response.headers.get('content-type')?.split(';')[0]?.trim();
  return type === 'application/wasm' ? WebAssembly.compileStreaming(response) : WebAssembly.compile(await response.arrayBuffer());
}

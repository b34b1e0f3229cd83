// Files that are not in memory yet.
import { GeoSeError } from './error.js';
import { is } from './tag.js';

/** All of a file; throws `'unreadable-file'`. */
export async function bytesOf(file: Blob): Promise<Uint8Array<ArrayBuffer>> {
  try {
    // Older versions of jsdom can read a file in the old way alone.
    const content: unknown = typeof file.arrayBuffer === 'function' ? await file.arrayBuffer() : await readByReader(file);
    if (!is<ArrayBuffer>(content, 'ArrayBuffer')) throw new Error('it has no bytes');
    return new Uint8Array(content);
  } catch (cause) {
    const reason = cause instanceof Error ? cause.message : String(cause);
    throw new GeoSeError('unreadable-file', `the file could not be read: ${reason}`, { size: file.size }, { cause });
  }
}

function readByReader(file: Blob): Promise<unknown> {
  return new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve(reader.result);
    reader.onerror = () => reject(new Error(reader.error?.message ?? 'no reason was given'));
    reader.readAsArrayBuffer(file);
  });
}

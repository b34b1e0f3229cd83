// The flat block of bytes a prepared shape lives in, in the safetensors format: the length of a JSON header (u64), the
// header, then the numbers, all little-endian.

interface Tensor {
  dtype: 'F64' | 'F32' | 'U32' | 'U8';
  shape: number[];
  /** First and last byte + 1, counted from the end of the header. */
  data_offsets: [number, number];
}

type Header = { readonly __metadata__?: Record<string, string> } & { readonly [name: string]: Tensor | undefined };

/** Named arrays and texts of one block. Whatever it hands out is a copy. */
export class Block {
  readonly bytes: Uint8Array<ArrayBuffer>;
  readonly #header: Header;
  readonly #start: number;

  constructor(bytes: Uint8Array<ArrayBuffer>) {
    const length = Number(new DataView(bytes.buffer, bytes.byteOffset).getBigUint64(0, true));
    this.bytes = bytes;
    this.#start = 8 + length;
    this.#header = JSON.parse(textOf(bytes.subarray(8, this.#start))) as Header;
  }

  /** The JSON text stored under `key`; the writer of the block vouches for its type. */
  json<T>(key: string): T {
    return JSON.parse(this.#header.__metadata__?.[key] ?? 'null') as T;
  }

  /** Size along each axis; null when there is no such array. */
  shape(name: string): readonly number[] | null {
    return this.#header[name]?.shape ?? null;
  }

  float64(name: string): Float64Array<ArrayBuffer> | null {
    const buffer = this.#buffer(name, 'F64');
    return buffer && new Float64Array(buffer);
  }

  float32(name: string): Float32Array<ArrayBuffer> | null {
    const buffer = this.#buffer(name, 'F32');
    return buffer && new Float32Array(buffer);
  }

  uint8(name: string): Uint8Array<ArrayBuffer> | null {
    const buffer = this.#buffer(name, 'U8');
    return buffer && new Uint8Array(buffer);
  }

  uint32(name: string): Uint32Array<ArrayBuffer> | null {
    const buffer = this.#buffer(name, 'U32');
    return buffer && new Uint32Array(buffer);
  }

  #buffer(name: string, dtype: Tensor['dtype']): ArrayBuffer | null {
    const tensor = this.#header[name];
    if (!tensor || tensor.dtype !== dtype) return null;
    const [from, to] = tensor.data_offsets;
    return this.bytes.slice(this.#start + from, this.#start + to).buffer;
  }
}

/** UTF-8 as text. Written out, as test runners with a page of their own (Jest with jsdom) have no `TextDecoder`; a header has some thousand bytes. */
const textOf = (bytes: Uint8Array): string =>
  decodeURIComponent(Array.from(bytes, (byte) => `%${byte.toString(16).padStart(2, '0')}`).join(''));

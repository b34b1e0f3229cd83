/** Where a scan comes from; read again when options change. */
export interface ScanSource {
  /** File name; its extension helps the reader. */
  readonly name: string;
  /** What the page calls it. */
  readonly title: string;
  /** Equal for the same file, unchanged. */
  readonly identity: string;
  /** What its part labels stand for, where the page knows it. */
  readonly partNames?: readonly string[];
  /** Files beside it in which it keeps data. */
  readonly companions?: readonly File[];
  data(): Promise<Blob>;
}

export const fromFile = (file: File, companions: readonly File[] = []): ScanSource => ({
  name: file.name,
  title: file.name,
  identity: [file, ...companions].map(({ name, size, lastModified }) => [name, size, lastModified].join(' ')).join('\n'),
  companions,
  data: () => Promise.resolve(file),
});

/** The bytes of the files beside a scan, by name. */
export async function companionsOf({ companions = [] }: ScanSource): Promise<Readonly<Record<string, ArrayBuffer>>> {
  return Object.fromEntries(await Promise.all(companions.map(async (file) => [file.name, await file.arrayBuffer()] as const)));
}

/** A file of the page's own. Once fetched it is kept, so that it is there when the network is not. */
export function fromAddress(address: string, title: string, partNames: readonly string[] = []): ScanSource {
  let kept: Promise<Blob> | null = null;
  const fetched = async (): Promise<Blob> => {
    const response = await fetch(address);
    if (!response.ok) throw new Error(`the sample "${title}" is not where it should be (status ${response.status})`);
    return response.blob();
  };
  return {
    name: address.slice(address.lastIndexOf('/') + 1),
    title,
    identity: address,
    partNames,
    data: () =>
      (kept ??= fetched().catch((cause: unknown) => {
        kept = null;
        throw new Error(`the sample "${title}" could not be fetched; is this machine offline?`, { cause });
      })),
  };
}

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
  data(): Promise<Blob>;
}

export const fromFile = (file: File): ScanSource => ({
  name: file.name,
  title: file.name,
  identity: [file.name, file.size, file.lastModified].join(' '),
  data: () => Promise.resolve(file),
});

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

/** Where a scan comes from; read again when options change, so nothing is kept twice in memory. */
export interface ScanSource {
  /** File name; its extension helps the reader. */
  readonly name: string;
  /** What the page calls it. */
  readonly title: string;
  data(signal: AbortSignal): Promise<Blob>;
}

export const fromFile = (file: File): ScanSource => ({
  name: file.name,
  title: file.name,
  data: () => Promise.resolve(file),
});

export function fromAddress(address: string, title: string): ScanSource {
  return {
    name: address.slice(address.lastIndexOf('/') + 1),
    title,
    async data(signal) {
      const response = await fetch(address, { signal }).catch((cause: unknown) => {
        throw new Error(`The sample "${title}" could not be fetched; is this machine offline?`, { cause });
      });
      if (!response.ok) throw new Error(`The sample "${title}" is not where it should be (status ${response.status}).`);
      return response.blob();
    },
  };
}

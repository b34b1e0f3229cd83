import { fromFile, type ScanSource } from './scan-source';

/** Scans among files that came together, and what there is to say about files that are none. */
export interface Gathered {
  readonly sources: readonly ScanSource[];
  readonly remarks: readonly string[];
}

/**
 * A glTF document and the files that it names are one scan: its data is read with it, its pictures are not looked at. Data of no document is no scan; every other file
 * is one by itself.
 */
export async function gather(files: readonly File[]): Promise<Gathered> {
  const beside = files.filter((file) => !isDocument(file));
  // A document alone may hold all of its data, and be large: the reader tells what it lacks.
  const documents = beside.length > 0 ? files.filter(isDocument) : [];
  const named = new Map(await Promise.all(documents.map(async (file) => [file, await namedIn(file, beside)] as const)));
  const taken = new Set([...named.values()].flatMap(({ data, pictures }) => [...data, ...pictures]));
  const isPicture = (file: File): boolean => documents.length > 0 && file.type.startsWith('image/');
  const left = files.filter((file) => !taken.has(file) && !isPicture(file));
  return {
    sources: left.filter((file) => !isData(file)).map((file) => fromFile(file, named.get(file)?.data)),
    remarks: left.filter(isData).map(({ name }) => `${name} holds the data of a .gltf file that is not here: drop the two together.`),
  };
}

const isDocument = ({ name }: File): boolean => /\.gltf$/i.test(name);
const isData = ({ name }: File): boolean => /\.bin$/i.test(name);

/** What a document names of the files beside it; nothing where it cannot be read, which the reader will tell. */
async function namedIn(document: File, beside: readonly File[]): Promise<{ data: readonly File[]; pictures: readonly File[] }> {
  let content: unknown;
  try {
    content = JSON.parse(await document.text());
  } catch {
    return { data: [], pictures: [] };
  }
  const found = (list: 'buffers' | 'images'): readonly File[] => [
    ...new Set(addressesIn(content, list).flatMap((uri) => fileAt(uri, beside))),
  ];
  return { data: found('buffers'), pictures: found('images') };
}

const isRecord = (value: unknown): value is Readonly<Record<string, unknown>> => typeof value === 'object' && value !== null;

function addressesIn(document: unknown, list: 'buffers' | 'images'): string[] {
  const entries: unknown = isRecord(document) ? document[list] : null;
  if (!Array.isArray(entries)) return [];
  return entries.flatMap((entry: unknown) => (isRecord(entry) && typeof entry['uri'] === 'string' ? [entry['uri']] : []));
}

/** The file of an address' last part, in any case where none is called exactly so: dropped files have no folders. */
function fileAt(uri: string, files: readonly File[]): readonly File[] {
  if (uri.startsWith('data:')) return [];
  const name = unescaped(uri).split(/[/\\]/).at(-1) ?? '';
  const found = files.find((file) => file.name === name) ?? files.find((file) => file.name.toLowerCase() === name.toLowerCase());
  return found ? [found] : [];
}

function unescaped(uri: string): string {
  try {
    return decodeURIComponent(uri);
  } catch {
    return uri;
  }
}

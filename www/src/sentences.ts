import { GeoSeError, type ShapeInfo, type Stage } from 'geose-fmap';

/** What each stage of the method does, in words for the progress line. */
export const stageWords: Readonly<Record<Stage, string>> = {
  read: 'reading the file',
  sample: 'choosing points',
  graph: 'finding neighbours',
  laplacian: 'building the Laplacian',
  spectrum: 'computing eigenfunctions',
  features: 'describing the surface',
  'functional-map': 'solving the functional map',
  refine: 'refining the map',
  correspondence: 'reading off the points',
};

/** An error as a sentence for the person with the scan. */
export function sentence(error: unknown): string {
  if (error instanceof GeoSeError) return asSentence(error.message);
  if (error instanceof Error) return asSentence(error.message || `something failed (${error.name})`);
  return 'Something failed that the page did not expect. Loading the page anew may help.';
}

/** The package's messages are clauses; on the page they begin and end like sentences. */
export const asSentence = (text: string): string => capital(text) + (/[.!?…]$/.test(text) ? '' : '.');

/** With a capital first letter. */
export const capital = (text: string): string => text.charAt(0).toUpperCase() + text.slice(1);

const whole = new Intl.NumberFormat('en');

/** 12345 → "12,345". */
export const count = (value: number): string => whole.format(value);

/** Plural by number: `counted(2, 'point')` → "2 points". */
export const counted = (value: number, noun: string): string => `${count(value)} ${noun}${value === 1 ? '' : 's'}`;

/** Seconds with as many digits as one can use. */
export function seconds(value: number): string {
  if (value < 0.0995) return `${Math.max(1, Math.round(value * 1000))} ms`;
  return `${value.toFixed(value < 9.95 ? 2 : 1)} s`;
}

/** A share in [0, 1] as a percentage that is never rounded to none or all. */
export function percent(share: number): string {
  if (share > 0 && share < 0.001) return 'less than 0.1 %';
  if (share < 1 && share > 0.999) return 'more than 99.9 %';
  return `${(100 * share).toFixed(share < 0.1 || share > 0.9 ? 1 : 0)} %`;
}

const centimetres = { m: 100, cm: 1, mm: 0.1 } as const;

/** Turns multiples of a scan's √area into words: a length where its unit is known, else a share of its size. */
export const lengthOn =
  ({ unit, scale }: Pick<ShapeInfo, 'unit' | 'scale'>) =>
  (share: number): string => {
    if (unit === null) return `${percent(share)} of its size`;
    const length = share * scale * centimetres[unit];
    return length < 0.95 ? `${Math.round(10 * length)} mm` : `${length.toFixed(length < 9.5 ? 1 : 0)} cm`;
  };

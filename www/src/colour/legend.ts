import type { LinearRgb } from './colour-space';
import type { Ramp } from './ramp';

/** What the colours of the moment mean. */
export type Legend =
  | { readonly kind: 'words'; readonly words: string }
  | { readonly kind: 'places'; readonly words: string }
  | { readonly kind: 'scale'; readonly ramp: Ramp; readonly marks: readonly string[]; readonly words: string }
  | { readonly kind: 'parts'; readonly lists: readonly PartList[] };

/** The parts of one scan, or of both where they are the same ones. */
export interface PartList {
  readonly words: string;
  readonly parts: readonly { name: string; colour: LinearRgb }[];
}

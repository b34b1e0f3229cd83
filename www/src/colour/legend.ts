import type { LinearRgb } from './colour-space';
import type { Ramp } from './ramp';

/** What the colours of the moment mean. */
export type Legend =
  | { readonly kind: 'words'; readonly words: string }
  | { readonly kind: 'places'; readonly words: string }
  | { readonly kind: 'scale'; readonly ramp: Ramp; readonly marks: readonly string[]; readonly words: string }
  | { readonly kind: 'parts'; readonly parts: readonly { name: string; colour: LinearRgb }[]; readonly words: string };

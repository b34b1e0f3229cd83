import { fromHex, mix, toCss, type LinearRgb } from './colour-space';

/** A colour for every number in [0, 1]. */
export interface Ramp {
  at(value: number): LinearRgb;
  /** The same as a CSS gradient from left to right. */
  readonly css: string;
}

function rampThrough(...stops: readonly string[]): Ramp {
  const colours = stops.map(fromHex);
  const last = colours.length - 1;
  const at = (value: number): LinearRgb => {
    const place = Math.min(1, Math.max(0, value)) * last;
    const below = Math.min(last - 1, Math.floor(place));
    return mix(colours[below], colours[below + 1], place - below);
  };
  const samples = Array.from({ length: 17 }, (_, k) => toCss(at(k / 16)));
  return { at, css: `linear-gradient(to right, ${samples.join(', ')})` };
}

/** Low to high: viridis by van der Walt and Smith (CC0), at ninths. Reads the same with any colour vision, and in grey. */
export const sequential = rampThrough(
  '#440154',
  '#482878',
  '#3e4989',
  '#31688e',
  '#26828e',
  '#1f9e89',
  '#35b779',
  '#6ece58',
  '#b5de2b',
  '#fde725',
);

/** Negative to positive: ColorBrewer's PuOr (Apache-2.0), orange below, purple above, light in the middle. */
export const diverging = rampThrough(
  '#7f3b08',
  '#b35806',
  '#e08214',
  '#fdb863',
  '#fee0b6',
  '#f7f7f7',
  '#d8daeb',
  '#b2abd2',
  '#8073ac',
  '#542788',
  '#2d004b',
);

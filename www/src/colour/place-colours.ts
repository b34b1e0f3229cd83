import type { DisplayFrame } from '../views/display-frame';
import { fromOklab, type LinearRgb } from './colour-space';

/**
 * A colour for a place in a body's box, each coordinate in [0, 1]. Left to right runs from blue to yellow and bottom to top
 * from dark to light, both of which every kind of colour vision tells apart; back to front adds green to red.
 */
export function placeColour(x: number, y: number, z: number): LinearRgb {
  const lightness = 0.44 + 0.44 * y;
  const hue = 0.1 * Math.sin(2 * Math.PI * (0.08 + 0.9 * y)) + 0.12 * (z - 0.5);
  return fromOklab(lightness, hue, 0.34 * (x - 0.5));
}

/** Place colours of a body as it is drawn: linear RGB per point. */
export function placeColours({ positions, halfExtent }: DisplayFrame): Float32Array {
  const share = (i: number): number => Math.min(1, Math.max(0, 0.5 + positions[i] / (2 * halfExtent[i % 3] || 1)));
  const colours = new Float32Array(positions.length);
  for (let i = 0; i < positions.length; i += 3) colours.set(placeColour(share(i), share(i + 1), share(i + 2)), i);
  return colours;
}

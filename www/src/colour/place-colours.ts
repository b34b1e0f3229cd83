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

/** Place colours of positions xyz: linear RGB per point. */
export function placeColours(positions: Float32Array): Float32Array {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; i++) {
    low[i % 3] = Math.min(low[i % 3], positions[i]);
    high[i % 3] = Math.max(high[i % 3], positions[i]);
  }
  const share = (i: number): number => (positions[i] - low[i % 3]) / (high[i % 3] - low[i % 3] || 1);
  const colours = new Float32Array(positions.length);
  for (let i = 0; i < positions.length; i += 3) colours.set(placeColour(share(i), share(i + 1), share(i + 2)), i);
  return colours;
}

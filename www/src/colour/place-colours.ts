import type { Scan } from '../app-state';
import { withoutPartner } from '../set-aside';
import { displayFrame, drawnFaces } from '../views/display-frame';
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

/** Place colours of a body as it is drawn, in its box without what was set aside: linear RGB per point. */
export function placeColours(scan: Scan): Float32Array {
  const { positions } = displayFrame(scan);
  const aside = withoutPartner(scan);
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  const include = (point: number): void => {
    if (aside.has(point)) return;
    for (let k = 0; k < 3; k++) {
      low[k] = Math.min(low[k], positions[3 * point + k]);
      high[k] = Math.max(high[k], positions[3 * point + k]);
    }
  };
  const faces = drawnFaces(scan);
  if (faces) faces.forEach(include);
  else for (let point = 0; 3 * point < positions.length; point++) include(point);
  const share = (i: number): number => Math.min(1, Math.max(0, (positions[i] - low[i % 3]) / (high[i % 3] - low[i % 3] || 1)));
  const colours = new Float32Array(positions.length);
  for (let i = 0; i < positions.length; i += 3) colours.set(placeColour(share(i), share(i + 1), share(i + 2)), i);
  return colours;
}

import { UNMATCHED, type PreparedShape } from 'geose-fmap';
import type { AppState, Scan } from '../app-state';
import { directionFrom } from '../match-direction';
import type { Side } from '../side';
import { displayFrame } from '../views/display-frame';
import { fromHex, type LinearRgb } from './colour-space';
import { eigenfunctionOf } from './eigenfunction';
import { partPalette } from './part-palette';
import { placeColours } from './place-colours';
import { diverging, sequential } from './ramp';

/** Linear RGB per point of each scan; null where there is none. */
export type PaintedColours = Readonly<Record<Side, Float32Array | null>>;

/** Grey for what has no answer: unmatched points, parts not known. */
export const unknownColour: LinearRgb = fromHex('#8d9096');
const plainColour: LinearRgb = fromHex('#c3c7cd');

/** The colours that the state asks for. */
export function paintedColours(state: AppState): PaintedColours {
  if (state.colour === 'correspondence' && state.result) return correspondence(state);
  const paint = (side: Side): Float32Array | null => {
    const scan = state.scans[side];
    return scan && ofScan(state, side, scan);
  };
  return { a: paint('a'), b: paint('b') };
}

/** B by place; A by the place on B that each of its points was matched with. */
function correspondence({ scans, result }: AppState): PaintedColours {
  if (!scans.a || !scans.b || !result) return { a: null, b: null };
  const places = placesOf(scans.b.shape);
  const { match } = result;
  const unmatchedOfB = match.reverse.targetOf;
  return {
    a: perPoint(scans.a.shape.info.points, (i) => {
      const j = match.targetOf[i];
      return j === UNMATCHED ? unknownColour : places.subarray(3 * j, 3 * j + 3);
    }),
    b: perPoint(scans.b.shape.info.points, (j) => (unmatchedOfB[j] === UNMATCHED ? unknownColour : places.subarray(3 * j, 3 * j + 3))),
  };
}

function ofScan({ colour, result, eigenfunction }: AppState, side: Side, { shape }: Scan): Float32Array {
  const { points } = shape.info;
  switch (colour) {
    case 'correspondence':
      // Without a match B already shows the colours that it will hand to A.
      return side === 'b' ? placesOf(shape).slice() : perPoint(points, () => plainColour);
    case 'confidence': {
      if (!result) return perPoint(points, () => plainColour);
      const { confidence, targetOf } = directionFrom(result.match, side);
      return perPoint(points, (i) => (targetOf[i] === UNMATCHED ? unknownColour : sequential.at(confidence[i])));
    }
    case 'part': {
      const { parts } = shape;
      if (!parts) return perPoint(points, () => unknownColour);
      const palette = partPalette(parts.names);
      return perPoint(points, (i) => palette[parts.labels[i]] ?? unknownColour);
    }
    case 'eigenfunction': {
      const found = eigenfunctionOf(shape, eigenfunction);
      if (!found) return perPoint(points, () => unknownColour);
      return perPoint(points, (i) => diverging.at(0.5 + (0.5 * found.values[i]) / found.largest));
    }
    case 'plain':
      return perPoint(points, () => plainColour);
  }
}

function perPoint(points: number, colourOf: (index: number) => ArrayLike<number>): Float32Array {
  const colours = new Float32Array(3 * points);
  for (let i = 0; i < points; i++) colours.set(colourOf(i), 3 * i);
  return colours;
}

const placesKept = new WeakMap<PreparedShape, Float32Array>();

function placesOf(shape: PreparedShape): Float32Array {
  const kept = placesKept.get(shape);
  if (kept) return kept;
  const places = placeColours(displayFrame(shape.geometry().positions, shape.info).positions);
  placesKept.set(shape, places);
  return places;
}

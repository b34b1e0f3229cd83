import { UNMATCHED, type PreparedShape } from 'geose-fmap';
import type { AppState, Scan } from '../app-state';
import { directionFrom } from '../match-direction';
import { withoutPartner } from '../set-aside';
import type { Side } from '../side';
import { fromHex, type LinearRgb } from './colour-space';
import { eigenfunctionOf } from './eigenfunction';
import { partPalette } from './part-palette';
import { placeColours } from './place-colours';
import { diverging, sequential } from './ramp';
import { partNames, partsOf } from './scan-parts';

/** Grey for what has no answer: points without a match, parts not known. */
export const unknownColour: LinearRgb = fromHex('#8d9096');
const plainColour: LinearRgb = fromHex('#c3c7cd');

/** Writes the colours that the state asks for into `colours`: linear RGB per point of one scan. What was set aside is grey in all of them. */
export function paintScan(state: AppState, side: Side, colours: Float32Array): void {
  const colourOf = colouring(state, side);
  const scan = state.scans[side];
  for (let i = 0; 3 * i < colours.length; i++) colours.set(colourOf(i), 3 * i);
  if (scan) for (const i of withoutPartner(scan)) colours.set(unknownColour, 3 * i);
}

type Colouring = (index: number) => ArrayLike<number>;

const plainly: Colouring = () => plainColour;
const unknown: Colouring = () => unknownColour;

/** What each point of a scan is painted with. */
function colouring(state: AppState, side: Side): Colouring {
  const { colour, result, eigenfunction, scans } = state;
  const scan = scans[side];
  if (!scan) return plainly;
  switch (colour) {
    case 'correspondence':
      return byPlaceOnB(state, side);
    case 'confidence': {
      if (!result) return plainly;
      const { confidence, targetOf } = directionFrom(result.match, side);
      return (i) => (targetOf[i] === UNMATCHED ? unknownColour : sequential.at(confidence[i]));
    }
    case 'overlap': {
      if (!result) return plainly;
      const { overlap } = directionFrom(result.match, side);
      return (i) => sequential.at(overlap[i]);
    }
    case 'part': {
      const parts = partsOf(scan);
      if (!parts) return unknown;
      const palette = partPalette(partNames(state, side));
      return (i) => palette[parts.labels[i]] ?? unknownColour;
    }
    case 'eigenfunction': {
      const found = eigenfunctionOf(scan.shape, eigenfunction);
      return found ? (i) => diverging.at(0.5 + (0.5 * found.values[i]) / found.largest) : unknown;
    }
    case 'plain':
      return plainly;
  }
}

/** B by place; A by the place on B that each of its points was matched with. Without a match B shows what it will hand to A. */
function byPlaceOnB({ scans, result }: AppState, side: Side): Colouring {
  if (!scans.b || (side === 'a' && !result)) return plainly;
  const places = placesOf(scans.b);
  const placeAt = (j: number): Float32Array => places.subarray(3 * j, 3 * j + 3);
  if (!result) return placeAt;
  const { targetOf } = directionFrom(result.match, side);
  return (i) => (targetOf[i] === UNMATCHED ? unknownColour : placeAt(side === 'a' ? targetOf[i] : i));
}

const placesKept = new WeakMap<PreparedShape, Float32Array>();

function placesOf(scan: Scan): Float32Array {
  const kept = placesKept.get(scan.shape);
  if (kept) return kept;
  const places = placeColours(scan);
  placesKept.set(scan.shape, places);
  return places;
}

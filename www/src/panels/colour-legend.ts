import type { AppState, AppStore, ColourMode } from '../app-state';
import { toCss } from '../colour/colour-space';
import type { Legend, PartList } from '../colour/legend';
import { partPalette } from '../colour/part-palette';
import { placeColour } from '../colour/place-colours';
import { diverging, sequential } from '../colour/ramp';
import { partNames, partsOf } from '../colour/scan-parts';
import { byId, create } from '../dom';
import { withoutPartner } from '../set-aside';
import { letter, sides } from '../side';

/** The colour menu and what the colours mean. */
export function showColours(store: AppStore): void {
  const menu = byId('colour', HTMLSelectElement);
  const part = byId('colour-part', HTMLOptionElement);
  const eigenRow = byId('eigen-row', HTMLElement);
  const eigen = byId('eigen', HTMLInputElement);
  const slider = byId('eigen-slider', HTMLInputElement);
  const place = byId('legend', HTMLElement);
  menu.addEventListener('change', () => store.set({ colour: menu.value as ColourMode }));
  for (const input of [eigen, slider]) {
    input.addEventListener('input', () => {
      if (input.validity.valid && input.value !== '') store.set({ eigenfunction: input.valueAsNumber });
    });
  }
  store.watch(['colour', 'eigenfunction', 'scans', 'result'], (state) => {
    const computed = [state.scans.a, state.scans.b].flatMap((scan) => (scan ? [scan.shape.info.eigenpairs] : []));
    const most = String((computed.length > 0 ? Math.min(...computed) : 120) - 1);
    part.disabled = computed.length === 0;
    part.textContent = part.disabled ? 'Part (no scan yet)' : 'Part';
    eigenRow.hidden = state.colour !== 'eigenfunction';
    for (const input of [eigen, slider]) {
      input.max = most;
      if (input.valueAsNumber !== state.eigenfunction) input.value = String(state.eigenfunction);
    }
    place.replaceChildren(...draw(legendOf(state)), ...wordsOnGrey(state));
  });
}

function legendOf(state: AppState): Legend {
  const { result, scans } = state;
  const hasScan = scans.a !== null || scans.b !== null;
  switch (state.colour) {
    case 'correspondence':
      if (!result) return words(hasScan ? 'After the match, equal colours mean equal places.' : '');
      return { kind: 'places', words: 'Equal colours mean equal places; grey has no match.' };
    case 'confidence':
      if (!result) return words('There is no match yet to be sure of.');
      return { kind: 'scale', ramp: sequential, marks: ['0', '0.5', '1'], words: 'Confidence of the match; grey has none.' };
    case 'overlap': {
      if (!result) return words('There is no match yet that bodies could overlap in.');
      const text = 'Probability that a point has a partner on the other body: near 0 where the other scan lacks it.';
      return { kind: 'scale', ramp: sequential, marks: ['0', '0.5', '1'], words: text };
    }
    case 'part':
      return hasScan ? { kind: 'parts', lists: partLists(state) } : words('No scan yet, so there are no parts to show.');
    case 'eigenfunction': {
      if (!hasScan) return words('');
      const text = 'Each body on its own scale. Number 0 is constant, higher ones swing faster; the sign of each is free.';
      return { kind: 'scale', ramp: diverging, marks: ['−max', '0', '+max'], words: text };
    }
    case 'plain':
      return words('');
  }
}

/** Where the legend itself does not say what grey is, though there is some. */
function wordsOnGrey({ colour, result, scans }: AppState): Node[] {
  const told = result !== null && (colour === 'correspondence' || colour === 'confidence');
  const grey = sides.some((side) => scans[side] && withoutPartner(scans[side]).size > 0);
  return grey && !told ? [create('p', { className: 'facts', textContent: 'Grey was set aside as no part of the body.' })] : [];
}

const origin = { given: 'given with the scan', predicted: 'predicted by the network' } as const;

/** One list for both scans where equal names stand for equal colours, else one each. */
function partLists(state: AppState): PartList[] {
  const scans = sides.flatMap((side) => {
    const scan = state.scans[side];
    const parts = scan && partsOf(scan);
    return parts ? [{ side, source: parts.source, names: partNames(state, side) }] : [];
  });
  const alike = new Set(scans.map(({ names }) => names.join('\n'))).size === 1;
  return (alike ? [scans] : scans.map((scan) => [scan])).map((group) => {
    const { names } = group[0];
    const palette = partPalette(names);
    return {
      words: group.map(({ side, source }) => `${letter(side)}: ${origin[source]}.`).join(' '),
      parts: names.map((name, k) => ({ name: name.replaceAll(/[_-]/g, ' '), colour: palette[k] })),
    };
  });
}

const words = (text: string): Legend => ({ kind: 'words', words: text });

function draw(legend: Legend): Node[] {
  if (legend.kind === 'parts') return legend.lists.flatMap(drawParts);
  const sentence = create('p', { className: 'facts', textContent: legend.words });
  switch (legend.kind) {
    case 'words':
      return [sentence];
    case 'places':
      return [create('div', { className: 'places' }, placeSwatch(), sentence)];
    case 'scale': {
      const bar = create('div', { className: 'ramp' });
      bar.style.background = legend.ramp.css;
      const marks = create('div', { className: 'marks' }, ...legend.marks.map((mark) => create('span', {}, mark)));
      return [bar, marks, sentence];
    }
  }
}

function drawParts({ parts, words }: PartList): Node[] {
  const list = create('ul', { className: 'parts' });
  for (const { name, colour } of parts) {
    const swatch = create('span', { className: 'swatch' });
    swatch.style.background = toCss(colour);
    list.append(create('li', {}, swatch, name));
  }
  return [list, create('p', { className: 'facts', textContent: words })];
}

/** The colours of a body's middle plane, seen from the front. */
function placeSwatch(): HTMLCanvasElement {
  const canvas = create('canvas', { width: 24, height: 36, className: 'place-swatch' });
  canvas.setAttribute('aria-hidden', 'true');
  const context = canvas.getContext('2d');
  if (!context) return canvas;
  for (let x = 0; x < canvas.width; x++) {
    for (let y = 0; y < canvas.height; y++) {
      context.fillStyle = toCss(placeColour(x / (canvas.width - 1), 1 - y / (canvas.height - 1), 0.5));
      context.fillRect(x, y, 1, 1);
    }
  }
  return canvas;
}

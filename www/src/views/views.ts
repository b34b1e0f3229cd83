import type { PreparedShape } from 'geose-fmap';
import { type AppState, type AppStore, type Selection } from '../app-state';
import { paintScan } from '../colour/painted-colours';
import { byId } from '../dom';
import { sideAwaited } from '../landmarks';
import { partnerOf } from '../match-direction';
import { letter, opposite, sides } from '../side';
import { count } from '../sentences';
import { createBody, type Body } from './body';
import { LandmarkMarkers } from './landmark-markers';
import { MatchLine, type Pair } from './match-line';
import { followKeys, followPointer, type PointingEvents } from './pointing';
import { Stage } from './stage';

/** Wires the two views to the state; throws when the browser offers no WebGL. */
export function createViews(store: AppStore, chosen: Pick<PointingEvents, 'choose' | 'release'>): Stage {
  const stage = new Stage(byId('stage', HTMLElement), byId('canvas', HTMLCanvasElement), {
    a: byId('view-a', HTMLElement),
    b: byId('view-b', HTMLElement),
  });
  const overlay = byId('line', SVGSVGElement);
  const line = new MatchLine(stage, overlay);
  const markers = new LandmarkMarkers(stage, overlay);

  const events: PointingEvents = {
    ...chosen,
    hover(hovered) {
      const { hovered: before } = store.get();
      if (before?.side !== hovered?.side || before?.index !== hovered?.index) store.set({ hovered });
    },
    walk: (pinned) => store.set({ pinned, hovered: null }),
    current(side) {
      const { pinned, result } = store.get();
      if (!pinned) return null;
      if (pinned.side === side) return pinned.index;
      return result && partnerOf(result.match, pinned.side, pinned.index);
    },
  };
  for (const side of sides) {
    followPointer(stage, side, events);
    followKeys(stage, side, events);
  }
  const bodies = new Map<PreparedShape, Body>();
  store.watch(['scans'], ({ scans }) => {
    const shapes = new Set(sides.map((side) => scans[side]?.shape));
    let changed = false;
    for (const side of sides) {
      const { element } = stage.views[side];
      const scan = scans[side];
      const what = scan ? `${scan.source.title}, ${count(scan.shape.info.points)} points` : 'empty';
      element.setAttribute('aria-label', `View of scan ${letter(side)}: ${what}`);
      const body = scan && (bodies.get(scan.shape) ?? createBody(scan));
      if (scan && body) bodies.set(scan.shape, body);
      changed ||= stage.views[side].body !== body;
      stage.views[side].body = body;
    }
    for (const [shape, body] of bodies) {
      if (shapes.has(shape)) continue;
      body.dispose();
      bodies.delete(shape);
    }
    if (changed) stage.refit();
  });
  let colourless = false;
  store.watch(['scans', 'result', 'colour', 'eigenfunction'], () => {
    colourless = true;
    stage.invalidate();
  });
  stage.onDrawing(() => {
    if (!colourless) return;
    colourless = false;
    for (const side of sides) stage.views[side].body?.repaint((colours) => paintScan(store.get(), side, colours));
  });
  store.watch(['scans', 'result', 'hovered', 'pinned', 'pairing'], (state) => line.show(pairOf(state)));
  store.watch(['scans', 'landmarks', 'pairing'], ({ landmarks, pairing }) => markers.show(landmarks, pairing));
  store.watch(['linked'], ({ linked }) => {
    stage.linked = linked;
    stage.invalidate();
  });
  return stage;
}

/** The point on show and its match; while a landmark waits for its second point, the first and where it may go. */
function pairOf({ result, hovered, pinned, pairing }: AppState): Pair | null {
  const selection: Selection | null = hovered ?? pinned;
  const awaited = pairing && sideAwaited(pairing);
  if (pairing && awaited) {
    const side = opposite(awaited);
    const index = pairing[side];
    if (index !== null) return { side, index, partner: selection?.side === awaited ? selection.index : null, marked: true };
  }
  return selection && { ...selection, partner: result && partnerOf(result.match, selection.side, selection.index), marked: false };
}

import { type AppStore, type Selection } from '../app-state';
import { paintedColours } from '../colour/painted-colours';
import { byId } from '../dom';
import { partnerOf } from '../match-direction';
import { letter, sides } from '../side';
import { count } from '../sentences';
import { createBody } from './body';
import { MatchLine } from './match-line';
import { followKeys, followPointer, type PointingEvents } from './pointing';
import { Stage } from './stage';

/** Wires the two views to the state; throws when the browser offers no WebGL. */
export function createViews(store: AppStore, choose: (selection: Selection | null) => void): Stage {
  const stage = new Stage(byId('stage', HTMLElement), byId('canvas', HTMLCanvasElement), {
    a: byId('view-a', HTMLElement),
    b: byId('view-b', HTMLElement),
  });
  const line = new MatchLine(stage, byId('line', SVGSVGElement));

  const events: PointingEvents = {
    hover: (hovered) => store.set({ hovered }),
    choose,
    current(side) {
      const { pinned, result } = store.get();
      if (!pinned) return null;
      if (pinned.side === side) return pinned.index;
      return result && partnerOf(result.match, pinned.side, pinned.index);
    },
  };
  const shown: Record<string, unknown> = {};
  for (const side of sides) {
    followPointer(stage, side, events);
    followKeys(stage, side, events);
    const { element } = stage.views[side];
    store.watch(['scans'], ({ scans }) => {
      const scan = scans[side];
      const what = scan ? `${scan.source.title}, ${count(scan.shape.info.points)} points` : 'empty';
      element.setAttribute('aria-label', `View of scan ${letter(side)}: ${what}`);
      if (shown[side] === scan?.shape) return;
      shown[side] = scan?.shape;
      stage.views[side].show(scan ? createBody(scan) : null);
      stage.refit();
    });
  }
  store.watch(['scans', 'result', 'colour', 'eigenfunction'], (state) => {
    const colours = paintedColours(state);
    for (const side of sides) {
      const painted = colours[side];
      if (painted) stage.views[side].body?.paint(painted);
    }
    stage.invalidate();
  });
  store.watch(['scans', 'result', 'hovered', 'pinned'], ({ result, hovered, pinned }) => {
    const selection = hovered ?? pinned;
    line.show(selection && { ...selection, partner: result && partnerOf(result.match, selection.side, selection.index) });
  });
  store.watch(['linked'], ({ linked }) => {
    stage.linked = linked;
    stage.invalidate();
  });
  return stage;
}

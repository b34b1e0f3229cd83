import type { Selection } from '../app-state';
import type { Side } from '../side';
import { middle, pick, step } from './picking';
import type { Stage } from './stage';

/** What the views tell the page about the user's finger. */
export interface PointingEvents {
  hover(selection: Selection | null): void;
  /** A point was chosen on purpose, or a place where there is none. */
  choose(selection: Selection | null): void;
  /** The keys went on to a point. */
  walk(selection: Selection): void;
  /** Enough of it: Escape. */
  release(): void;
  /** The point that keys walk from, if it is on this side. */
  current(side: Side): number | null;
}

/** A press that travels less than this many pixels is a choice; more is a turn of the camera. */
const stillness = 5;

/** Mouse, pen and touch on one view: hover shows, click or tap chooses. */
export function followPointer(stage: Stage, side: Side, events: PointingEvents): void {
  const view = stage.views[side];
  let pressed: { id: number; x: number; y: number } | null = null;
  let pending: PointerEvent | null = null;

  const at = (event: PointerEvent): Selection | null => {
    const box = view.element.getBoundingClientRect();
    const index = pick(view, event.clientX - box.left, event.clientY - box.top);
    return index === null ? null : { side, index };
  };

  view.element.addEventListener('pointermove', (event) => {
    if (event.pointerType === 'touch' || event.buttons !== 0) return;
    if (!pending) {
      requestAnimationFrame(() => {
        if (pending) events.hover(at(pending));
        pending = null;
      });
    }
    pending = event;
  });
  view.element.addEventListener('pointerleave', () => {
    pending = null;
    events.hover(null);
  });
  view.element.addEventListener('pointerdown', (event) => {
    pressed = event.isPrimary && event.button === 0 ? { id: event.pointerId, x: event.clientX, y: event.clientY } : null;
  });
  view.element.addEventListener('pointerup', (event) => {
    const start = pressed;
    pressed = null;
    if (start?.id !== event.pointerId) return;
    if (Math.hypot(event.clientX - start.x, event.clientY - start.y) < stillness) events.choose(at(event));
  });
}

const directions: Readonly<Record<string, readonly [number, number]>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

/** Keys on one view: arrows walk over the points, enter chooses one, arrows with shift turn the body; plus, minus and 0 are for the camera. */
export function followKeys(stage: Stage, side: Side, events: PointingEvents): void {
  const view = stage.views[side];
  view.element.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const direction = directions[event.key];
    if (direction && event.shiftKey) {
      stage.movedByKey();
      view.turn(-0.12 * direction[0], -0.12 * direction[1]);
    } else if (direction) {
      const from = events.current(side);
      const index = from === null ? middle(view) : step(view, from, direction);
      if (index !== null) events.walk({ side, index });
    } else if (event.key === 'Enter' || event.key === ' ') {
      const index = events.current(side) ?? middle(view);
      if (index !== null) events.choose({ side, index });
    } else if (event.key === '+' || event.key === '=' || event.key === '-') {
      stage.movedByKey();
      view.approach(event.key === '-' ? 1.12 : 1 / 1.12);
    } else if (event.key === '0') {
      stage.resetCameras();
    } else if (event.key === 'Escape') {
      events.release();
    } else {
      return;
    }
    event.preventDefault();
  });
}

import type { Side } from '../side';
import { isHidden } from './picking';
import { project } from './projection';
import type { Stage } from './stage';

/** Where on the overlay a point lies, and whether it is on the far side of its body. */
export interface Place {
  readonly x: number;
  readonly y: number;
  readonly hidden: boolean;
}

/** The place of a point over the canvas, kept inside its view; null when there is no such point in front of the camera. */
export function placeOf(stage: Stage, side: Side, index: number): Place | null {
  const view = stage.views[side];
  const point = project(view, index);
  if (!point) return null;
  const x = Math.min(Math.max(point.x, 0), view.width) + view.element.offsetLeft;
  const y = Math.min(Math.max(point.y, 0), view.height) + view.element.offsetTop;
  return { x, y, hidden: isHidden(view, index) };
}

/** A new SVG element of some class. */
export function drawn<Name extends keyof SVGElementTagNameMap>(name: Name, className: string): SVGElementTagNameMap[Name] {
  const element = document.createElementNS('http://www.w3.org/2000/svg', name);
  element.setAttribute('class', className);
  return element;
}

/** Sets several attributes at once. */
export function place(element: SVGElement, attributes: Readonly<Record<string, string | number>>): void {
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
}

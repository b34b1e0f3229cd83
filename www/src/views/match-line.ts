import { opposite, type Side } from '../side';
import { isHidden } from './picking';
import { project } from './projection';
import type { Stage } from './stage';

/** What to show: a point and, unless it is unmatched, its point on the other scan. */
export interface Pair {
  readonly side: Side;
  readonly index: number;
  readonly partner: number | null;
}

/** The overlay that ties a point to its match; a ring drawn dashed lies on the far side of its body. */
export class MatchLine {
  readonly #lines: readonly SVGLineElement[];
  /** Per end, drawn from below to above. */
  readonly #rings: readonly (readonly SVGCircleElement[])[];
  #pair: Pair | null = null;

  constructor(
    private readonly stage: Stage,
    private readonly overlay: SVGSVGElement,
  ) {
    const add = <Name extends 'line' | 'circle'>(name: Name, className: string): SVGElementTagNameMap[Name] => {
      const element = document.createElementNS('http://www.w3.org/2000/svg', name);
      element.setAttribute('class', className);
      return overlay.appendChild(element);
    };
    const ring = (className: string): SVGCircleElement => {
      const circle = add('circle', className);
      circle.setAttribute('r', '6');
      return circle;
    };
    this.#lines = [add('line', 'casing'), add('line', 'tie')];
    this.#rings = [0, 1].map(() => [ring('casing'), ring('ring')]);
    stage.onDrawn(() => this.#place());
  }

  show(pair: Pair | null): void {
    this.#pair = pair;
    this.#place();
  }

  #place(): void {
    const pair = this.#pair;
    const ends = pair && [this.#end(pair.side, pair.index), pair.partner === null ? null : this.#end(opposite(pair.side), pair.partner)];
    this.#rings.forEach((circles, k) => {
      const end = ends?.[k];
      for (const circle of circles) {
        circle.classList.toggle('shown', Boolean(end));
        if (!end) continue;
        circle.setAttribute('cx', String(end.x));
        circle.setAttribute('cy', String(end.y));
        circle.classList.toggle('behind', end.hidden);
      }
    });
    const [from, to] = ends ?? [];
    for (const line of this.#lines) {
      line.classList.toggle('shown', Boolean(from && to));
      if (!from || !to) continue;
      line.setAttribute('x1', String(from.x));
      line.setAttribute('y1', String(from.y));
      line.setAttribute('x2', String(to.x));
      line.setAttribute('y2', String(to.y));
    }
    this.overlay.dataset['pair'] = pair ? `${pair.side}${pair.index}-${pair.partner ?? 'none'}` : '';
  }

  #end(side: Side, index: number): { x: number; y: number; hidden: boolean } | null {
    const view = this.stage.views[side];
    const point = project(view, index);
    if (!point || index * 3 >= (view.body?.positions.length ?? 0)) return null;
    const x = Math.min(Math.max(point.x, 0), view.width) + view.element.offsetLeft;
    const y = Math.min(Math.max(point.y, 0), view.height) + view.element.offsetTop;
    return { x, y, hidden: isHidden(view, index) };
  }
}

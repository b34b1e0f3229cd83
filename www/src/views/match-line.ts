import { opposite, type Side } from '../side';
import { drawn, place, placeOf } from './overlay';
import type { Stage } from './stage';

/** What to show: a point and, unless it is unmatched, its point on the other scan. */
export interface Pair {
  readonly side: Side;
  readonly index: number;
  readonly partner: number | null;
  /** The point has a marker of its own and needs no ring. */
  readonly marked: boolean;
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
    this.#lines = [drawn('line', 'casing'), drawn('line', 'tie')];
    this.#rings = [0, 1].map(() => [drawn('circle', 'casing'), drawn('circle', 'ring')]);
    for (const circle of this.#rings.flat()) place(circle, { r: 6 });
    overlay.append(...this.#lines, ...this.#rings.flat());
    stage.onDrawn(() => this.#place());
  }

  show(pair: Pair | null): void {
    this.#pair = pair;
    this.#place();
  }

  #place(): void {
    const pair = this.#pair;
    const ends = pair && [
      placeOf(this.stage, pair.side, pair.index),
      pair.partner === null ? null : placeOf(this.stage, opposite(pair.side), pair.partner),
    ];
    this.#rings.forEach((circles, k) => {
      const end = pair?.marked && k === 0 ? null : ends?.[k];
      for (const circle of circles) {
        circle.classList.toggle('shown', Boolean(end));
        circle.classList.toggle('behind', end?.hidden ?? false);
        if (end) place(circle, { cx: end.x, cy: end.y });
      }
    });
    const [from, to] = ends ?? [];
    for (const line of this.#lines) {
      line.classList.toggle('shown', Boolean(from && to));
      if (from && to) place(line, { x1: from.x, y1: from.y, x2: to.x, y2: to.y });
    }
    this.overlay.dataset['pair'] = pair ? `${pair.side}${pair.index}-${pair.partner ?? 'none'}` : '';
  }
}

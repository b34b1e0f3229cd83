import { landmarkColour } from '../colour/landmark-colours';
import type { Landmark, Pairing } from '../landmarks';
import { sides, type Side } from '../side';
import { drawn, place, placeOf } from './overlay';
import type { Stage } from './stage';

/** A numbered disc on one body. */
interface Marker {
  readonly side: Side;
  readonly index: number;
  readonly group: SVGGElement;
}

/** Numbered discs on both bodies, one pair per landmark; one that lies on the far side of its body is faint. */
export class LandmarkMarkers {
  #markers: readonly Marker[] = [];
  readonly #layer = drawn('g', 'markers');

  constructor(
    private readonly stage: Stage,
    overlay: SVGSVGElement,
  ) {
    overlay.append(this.#layer);
    stage.onDrawn(() => this.#place());
  }

  show(landmarks: readonly Landmark[], pairing: Pairing | null): void {
    const open = sides.flatMap((side) => {
      const index = pairing?.[side] ?? null;
      return index === null ? [] : [this.#marker(side, index, landmarks.length)];
    });
    const settled = landmarks.flatMap(([i, j], order) => [this.#marker('a', i, order), this.#marker('b', j, order)]);
    this.#markers = [...settled, ...open];
    this.#layer.replaceChildren(...this.#markers.map(({ group }) => group));
    this.#place();
  }

  #marker(side: Side, index: number, order: number): Marker {
    const { fill, ink } = landmarkColour(order);
    const group = drawn('g', 'marker');
    group.dataset['side'] = side;
    const disc = drawn('circle', 'disc');
    place(disc, { r: 9, fill });
    const number = drawn('text', 'number');
    place(number, { fill: ink });
    number.textContent = String(order + 1);
    group.append(disc, number);
    return { side, index, group };
  }

  #place(): void {
    for (const { side, index, group } of this.#markers) {
      const at = placeOf(this.stage, side, index);
      group.classList.toggle('shown', at !== null);
      group.classList.toggle('behind', at?.hidden ?? false);
      if (at) group.setAttribute('transform', `translate(${at.x} ${at.y})`);
    }
  }
}

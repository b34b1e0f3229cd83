import * as THREE from 'three';
import { opposite, sides, type Side } from '../side';
import { Viewport } from './viewport';

/** Both views on one canvas, drawn only when something changed. */
export class Stage {
  readonly views: Readonly<Record<Side, Viewport>>;
  readonly #renderer: THREE.WebGLRenderer;
  readonly #beforeDrawing: (() => void)[] = [];
  readonly #afterDrawing: (() => void)[] = [];
  #frame = 0;
  #linked = true;
  /** The user has moved a camera: keep it when the window or the bodies change. */
  #moved = false;

  /** Throws when the browser offers no WebGL. */
  constructor(
    readonly element: HTMLElement,
    canvas: HTMLCanvasElement,
    viewElements: Readonly<Record<Side, HTMLElement>>,
  ) {
    this.#renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.#renderer.setScissorTest(true);
    this.views = { a: new Viewport(viewElements.a), b: new Viewport(viewElements.b) };
    for (const side of sides) {
      const { controls } = this.views[side];
      controls.addEventListener('start', () => (this.#moved = true));
      controls.addEventListener('change', () => this.#cameraMoved(side));
    }
    new ResizeObserver(() => this.#resize()).observe(element);
    canvas.addEventListener('webglcontextrestored', () => this.invalidate());
    this.#resize();
  }

  /** Draws at the next frame. */
  invalidate(): void {
    this.#frame ||= requestAnimationFrame(() => this.draw());
  }

  /** Draws now, for reading the canvas in the same task. */
  draw(): void {
    cancelAnimationFrame(this.#frame);
    this.#frame = 0;
    for (const listener of this.#beforeDrawing) listener();
    for (const side of sides) this.views[side].draw(this.#renderer);
    for (const listener of this.#afterDrawing) listener();
  }

  /** Whatever is drawn is brought up to date here, once per picture however often it changed. */
  onDrawing(listener: () => void): void {
    this.#beforeDrawing.push(listener);
  }

  /** Whatever lies over the canvas follows it from here. */
  onDrawn(listener: () => void): void {
    this.#afterDrawing.push(listener);
  }

  get canvas(): HTMLCanvasElement {
    return this.#renderer.domElement;
  }

  set linked(linked: boolean) {
    this.#linked = linked;
    if (linked) this.views.b.follow(this.views.a);
  }

  /** Both bodies whole and from the front. */
  resetCameras(): void {
    this.#moved = false;
    const distances = { a: this.views.a.fittingDistance(), b: this.views.b.fittingDistance() };
    const farther = Math.max(distances.a, distances.b) || 3;
    for (const side of sides) this.views[side].look(this.#linked ? farther : distances[side] || farther);
    this.invalidate();
  }

  /** After a body or the room for it changed: keep a view that the user has chosen. */
  refit(): void {
    if (this.#moved) this.invalidate();
    else this.resetCameras();
  }

  /** The user moved a camera other than through the pointer. */
  movedByKey(): void {
    this.#moved = true;
  }

  #following = false;

  #cameraMoved(side: Side): void {
    if (this.#linked && !this.#following) {
      this.#following = true;
      this.views[opposite(side)].follow(this.views[side]);
      this.#following = false;
    }
    this.invalidate();
  }

  #resize(): void {
    const { clientWidth, clientHeight } = this.element;
    this.#renderer.setSize(clientWidth, clientHeight, false);
    this.refit();
  }
}

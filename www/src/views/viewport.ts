import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import type { Body } from './body';

/** Vertical opening of the cameras in degrees: long enough a lens to keep proportions honest. */
const fieldOfView = 28;

/** One of the two views: an element that takes the pointer, a camera, a scene with light and at most one body. */
export class Viewport {
  readonly camera = new THREE.PerspectiveCamera(fieldOfView, 1, 0.02, 100);
  readonly controls: OrbitControls;
  readonly #scene = new THREE.Scene();
  #body: Body | null = null;

  constructor(readonly element: HTMLElement) {
    // A headlight and a soft sky, both tied to the camera: every side that one looks at is lit alike.
    const headlight = new THREE.DirectionalLight(0xffffff, 1.2);
    headlight.position.set(0.4, 0.6, 1);
    this.camera.add(headlight);
    this.#scene.add(this.camera, new THREE.HemisphereLight(0xffffff, 0xc8ccd4, 1.9));
    this.controls = new OrbitControls(this.camera, element);
    this.controls.rotateSpeed = 0.8;
    this.controls.minDistance = 0.1;
    this.controls.maxDistance = 30;
  }

  get body(): Body | null {
    return this.#body;
  }

  /** Shows another body; who made the one before disposes of it. */
  set body(body: Body | null) {
    if (this.#body) this.#scene.remove(this.#body.object);
    this.#body = body;
    if (body) this.#scene.add(body.object);
  }

  get width(): number {
    return this.element.clientWidth;
  }

  get height(): number {
    return this.element.clientHeight;
  }

  /** Distance from which the whole body is in view from the front. */
  fittingDistance(): number {
    if (!this.#body || this.width === 0 || this.height === 0) return 0;
    const [x, y, z] = this.#body.halfExtent;
    const tangent = Math.tan(THREE.MathUtils.degToRad(fieldOfView / 2));
    return 1.16 * Math.max(y / tangent, x / (tangent * (this.width / this.height))) + z;
  }

  /** Looks at the origin from the front. */
  look(distance: number): void {
    this.controls.target.set(0, 0, 0);
    this.camera.position.set(0, 0, distance);
    this.controls.update();
  }

  /** Takes over the other view's camera. */
  follow(other: Viewport): void {
    this.camera.position.copy(other.camera.position);
    this.controls.target.copy(other.controls.target);
    this.controls.update();
  }

  /** Turns around the body by angles in radians. */
  turn(aside: number, upward: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const angles = new THREE.Spherical().setFromVector3(offset);
    angles.theta += aside;
    angles.phi = THREE.MathUtils.clamp(angles.phi + upward, 0.01, Math.PI - 0.01);
    this.camera.position.copy(this.controls.target).add(offset.setFromSpherical(angles));
    this.controls.update();
  }

  /** Goes nearer (factor < 1) or further. */
  approach(factor: number): void {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
  }

  /** Draws into the part of the renderer's canvas that lies under the element. */
  draw(renderer: THREE.WebGLRenderer): void {
    const { width, height } = this;
    if (width === 0 || height === 0) return;
    const canvas = renderer.domElement;
    const left = this.element.offsetLeft;
    const bottom = canvas.clientHeight - this.element.offsetTop - height;
    renderer.setViewport(left, bottom, width, height);
    renderer.setScissor(left, bottom, width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    const tangent = Math.tan(THREE.MathUtils.degToRad(fieldOfView / 2));
    this.#body?.setPixelScale((height * renderer.getPixelRatio()) / (2 * tangent));
    renderer.render(this.#scene, this.camera);
  }
}

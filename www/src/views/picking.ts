import * as THREE from 'three';
import { pixelsAt, project, projectAll } from './projection';
import type { Viewport } from './viewport';

/**
 * Points this much further away than the front one, in units of √area, belong to what lies behind it: a limb is thicker, and
 * the roughness of a cloud smaller.
 */
const layer = 0.045;

/** The point of the body under a pixel of its view (x right, y down), or null. */
export function pick(view: Viewport, x: number, y: number): number | null {
  if (!view.body) return null;
  return view.body.object instanceof THREE.Mesh ? pickCorner(view, view.body.object, x, y) : pickNear(view, x, y, usualReach(view));
}

/** On a mesh: the corner of the face under the pixel that is nearest to it. */
function pickCorner(view: Viewport, mesh: THREE.Mesh, x: number, y: number): number | null {
  const ray = new THREE.Raycaster();
  ray.setFromCamera(new THREE.Vector2((2 * x) / view.width - 1, 1 - (2 * y) / view.height), view.camera);
  const face = ray.intersectObject(mesh, false)[0]?.face;
  if (!face) return null;
  const distance = (index: number): number => {
    const corner = project(view, index);
    return corner ? Math.hypot(corner.x - x, corner.y - y) : Infinity;
  };
  return [face.a, face.b, face.c].reduce((best, corner) => (distance(corner) < distance(best) ? corner : best));
}

/** On a cloud: of the points within reach of the pixel, those of the front layer, and of them the nearest to it. */
function pickNear(view: Viewport, x: number, y: number, reach: number): number | null {
  const near: { index: number; distance: number; depth: number }[] = [];
  let front = Infinity;
  projectAll(view, (index, px, py, depth) => {
    const distance = Math.hypot(px - x, py - y);
    if (distance > reach) return;
    near.push({ index, distance, depth });
    front = Math.min(front, depth);
  });
  let best: (typeof near)[number] | undefined;
  for (const point of near) {
    if (point.depth <= front + layer && point.distance < (best?.distance ?? Infinity)) best = point;
  }
  return best?.index ?? null;
}

/** Pixels around the pointer in which a point of a cloud counts as meant: wider where points are sparse. */
function usualReach(view: Viewport): number {
  const distance = view.camera.position.distanceTo(view.controls.target);
  return Math.max(7, view.body ? pixelsAt(view, view.body.spacing, distance) : 0);
}

/** The neighbour of a point in a direction on the screen (x right, y down) on the same layer of the body, or null at the rim. */
export function step(view: Viewport, from: number, direction: readonly [number, number]): number | null {
  const start = project(view, from);
  const { body } = view;
  if (!start || !body) return null;
  const shortest = Math.max(3, 0.5 * pixelsAt(view, body.spacing, start.depth));
  let best: number | null = null;
  let bestCost = Infinity;
  projectAll(view, (index, px, py, depth) => {
    const dx = px - start.x;
    const dy = py - start.y;
    const along = dx * direction[0] + dy * direction[1];
    const aside = Math.abs(dx * direction[1] - dy * direction[0]);
    if (along < shortest || aside > along) return;
    const cost = along + 2 * aside + pixelsAt(view, Math.abs(depth - start.depth), start.depth);
    if (cost < bestCost) {
      bestCost = cost;
      best = index;
    }
  });
  return best;
}

/** Whether the body itself hides one of its points: something of it lies clearly before the point on the line of sight. */
export function isHidden(view: Viewport, index: number): boolean {
  const point = project(view, index);
  const { body } = view;
  if (!point || !body) return true;
  if (body.object instanceof THREE.Mesh) {
    const eye = view.camera.position;
    const sight = new THREE.Vector3(...body.positions.subarray(3 * index, 3 * index + 3)).sub(eye);
    const distance = sight.length();
    const ray = new THREE.Raycaster(eye, sight.normalize(), 0, distance - layer / 4);
    return ray.intersectObject(body.object, false).length > 0;
  }
  const reach = 0.8 * pixelsAt(view, body.spacing, point.depth);
  let hidden = false;
  projectAll(view, (_, px, py, depth) => {
    hidden ||= depth < point.depth - layer && Math.hypot(px - point.x, py - point.y) < reach;
  });
  return hidden;
}

/** The visible point nearest to the middle of the view, to start walking from. */
export function middle(view: Viewport): number | null {
  const [x, y] = [view.width / 2, view.height / 2];
  const hit = pick(view, x, y);
  if (hit !== null) return hit;
  for (let reach = 16; reach < 2 * (view.width + view.height); reach *= 2) {
    const found = pickNear(view, x, y, reach);
    if (found !== null) return found;
  }
  return null;
}

import * as THREE from 'three';
import { MeshBVH, type PointsBVH } from 'three-mesh-bvh';
import { lengthOfPixel, pixelsAt, project, projectAll, projectEach } from './projection';
import type { Viewport } from './viewport';

/**
 * Points this much further away than the front one, in units of √area, belong to what lies behind it: a limb is thicker, and
 * the roughness of a cloud smaller.
 */
const layer = 0.045;

/** The point of the body under a pixel of its view (x right, y down), or null. */
export function pick(view: Viewport, x: number, y: number): number | null {
  const tree = view.body?.tree;
  if (!tree) return null;
  return tree instanceof MeshBVH ? pickCorner(view, tree, x, y) : frontmost(pointsNear(view, tree, x, y, usualReach(view)));
}

/** On a mesh: the corner of the face under the pixel that is nearest to it. */
function pickCorner(view: Viewport, tree: MeshBVH, x: number, y: number): number | null {
  const face = tree.raycastFirst(sightThrough(view, x, y), THREE.DoubleSide)?.face;
  if (!face) return null;
  const distance = (index: number): number => {
    const corner = project(view, index);
    return corner ? Math.hypot(corner.x - x, corner.y - y) : Infinity;
  };
  return [face.a, face.b, face.c].reduce((best, corner) => (distance(corner) < distance(best) ? corner : best));
}

/** A point near a pixel: how far from it on the screen, and how far from the camera's plane. */
interface Near {
  readonly index: number;
  readonly distance: number;
  readonly depth: number;
}

/** The points of a cloud within `reach` pixels of a pixel. Only boxes that the cone through these pixels meets are opened. */
function pointsNear(view: Viewport, tree: PointsBVH, x: number, y: number, reach: number): Near[] {
  const order = tree.geometry.index?.array ?? [];
  const sight = sightThrough(view, x, y);
  const perDepth = reach * lengthOfPixel(view);
  const [centre, corner, wider] = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Box3()];
  const candidates: number[] = [];
  tree.shapecast({
    intersectsBounds(box) {
      box.getCenter(centre);
      const farthest = centre.distanceTo(sight.origin) + corner.subVectors(box.max, centre).length();
      return sight.intersectsBox(wider.copy(box).expandByScalar(perDepth * farthest));
    },
    intersectsRange(offset, count) {
      for (let k = offset; k < offset + count; k++) candidates.push(order[k]);
      return false;
    },
  });
  const near: Near[] = [];
  projectEach(view, candidates, (index, px, py, depth) => {
    const distance = Math.hypot(px - x, py - y);
    if (distance <= reach) near.push({ index, distance, depth });
  });
  return near;
}

/** Of some points those of the front layer, and of them the nearest to the pixel. */
function frontmost(near: readonly Near[]): number | null {
  const front = near.reduce((least, { depth }) => Math.min(least, depth), Infinity);
  let best: Near | undefined;
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
  const pixelsPerLength = pixelsAt(view, 1, start.depth);
  const shortest = Math.max(3, 0.5 * body.spacing * pixelsPerLength);
  let best: number | null = null;
  let bestCost = Infinity;
  projectAll(view, (index, px, py, depth) => {
    const dx = px - start.x;
    const dy = py - start.y;
    const along = dx * direction[0] + dy * direction[1];
    const aside = Math.abs(dx * direction[1] - dy * direction[0]);
    if (along < shortest || aside > along) return;
    const cost = along + 2 * aside + Math.abs(depth - start.depth) * pixelsPerLength;
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
  if (body.tree instanceof MeshBVH) {
    const eye = view.camera.position;
    const sight = new THREE.Vector3(...body.positions.subarray(3 * index, 3 * index + 3)).sub(eye);
    const distance = sight.length();
    return body.tree.raycastFirst(new THREE.Ray(eye, sight.normalize()), THREE.DoubleSide, 0, distance - layer / 4) !== null;
  }
  const reach = 0.8 * pixelsAt(view, body.spacing, point.depth);
  return pointsNear(view, body.tree, point.x, point.y, reach).some(({ depth }) => depth < point.depth - layer);
}

/** The visible point nearest to the middle of the view, to start walking from. */
export function middle(view: Viewport): number | null {
  const [x, y] = [view.width / 2, view.height / 2];
  const hit = pick(view, x, y);
  if (hit !== null) return hit;
  const around: Near[] = [];
  projectAll(view, (index, px, py, depth) => around.push({ index, distance: Math.hypot(px - x, py - y), depth }));
  for (let reach = 16; reach < 2 * (view.width + view.height); reach *= 2) {
    const found = frontmost(around.filter(({ distance }) => distance <= reach));
    if (found !== null) return found;
  }
  return null;
}

/** The line of sight through a pixel. */
function sightThrough(view: Viewport, x: number, y: number): THREE.Ray {
  view.camera.updateMatrixWorld();
  const caster = new THREE.Raycaster();
  caster.setFromCamera(new THREE.Vector2((2 * x) / view.width - 1, 1 - (2 * y) / view.height), view.camera);
  return caster.ray;
}

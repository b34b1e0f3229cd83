// Mean geodesic error of a map between two bodies with the same order of vertices.

/** Edge graph and area of a mesh. `positions` xyz per vertex, `faces` three indices per face. */
export function surfaceOf(positions, faces) {
  const count = positions.length / 3;
  const neighbours = Array.from({ length: count }, () => new Map());
  let area = 0;
  const point = (i) => positions.slice(3 * i, 3 * i + 3);
  for (let f = 0; f < faces.length; f += 3) {
    const corners = [faces[f], faces[f + 1], faces[f + 2]];
    const [p, q, r] = corners.map(point);
    const [u, v] = [q, r].map((to) => to.map((value, axis) => value - p[axis]));
    area += Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
    corners.forEach((i, k) => {
      const j = corners[(k + 1) % 3];
      const [a, b] = [point(i), point(j)];
      const length = Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
      neighbours[i].set(j, length);
      neighbours[j].set(i, length);
    });
  }
  return { neighbours, area };
}

/** Mean over the matched i of the edge distance between vertex i and where the map puts it, over √area, times 100. */
export function meanError(surface, targetOf) {
  const errors = targetOf.flatMap((target, truth) =>
    target < surface.neighbours.length ? [distance(surface.neighbours, truth, target)] : [],
  );
  return (100 * errors.reduce((sum, error) => sum + error, 0)) / errors.length / Math.sqrt(surface.area);
}

/** Dijkstra from one vertex until the other is reached. */
function distance(neighbours, from, to) {
  if (from === to) return 0;
  const reached = new Map([[from, 0]]);
  const settled = new Set();
  const queue = [{ vertex: from, length: 0 }];
  while (queue.length > 0) {
    const { vertex, length } = pop(queue);
    if (vertex === to) return length;
    if (settled.has(vertex)) continue;
    settled.add(vertex);
    for (const [next, edge] of neighbours[vertex]) {
      const through = length + edge;
      if (through >= (reached.get(next) ?? Infinity)) continue;
      reached.set(next, through);
      push(queue, { vertex: next, length: through });
    }
  }
  return Infinity;
}

function push(heap, item) {
  let at = heap.push(item) - 1;
  while (at > 0) {
    const parent = (at - 1) >> 1;
    if (heap[parent].length <= heap[at].length) return;
    [heap[parent], heap[at]] = [heap[at], heap[parent]];
    at = parent;
  }
}

function pop(heap) {
  const top = heap[0];
  const last = heap.pop();
  if (heap.length === 0) return top;
  heap[0] = last;
  for (let at = 0; ;) {
    const children = [2 * at + 1, 2 * at + 2].filter((child) => child < heap.length);
    const smallest = children.reduce((best, child) => (heap[child].length < heap[best].length ? child : best), at);
    if (smallest === at) return top;
    [heap[smallest], heap[at]] = [heap[at], heap[smallest]];
    at = smallest;
  }
}

#!/usr/bin/env python3
"""Gold values for tests/gold.rs, computed without this project's code.

    python3 -m venv venv && venv/bin/pip install numpy==2.4.6 scipy==1.17.1 robust-laplacian==1.1.0
    venv/bin/python tests/gold/make.py

Reads the sample bodies in www/public/samples and writes tests/gold/*.json. The only seed is eigsh's starting vector, all ones.
"""

import json
import pathlib

import numpy as np
import robust_laplacian
import scipy
from scipy.sparse import coo_matrix, csr_matrix, diags
from scipy.sparse.csgraph import dijkstra
from scipy.sparse.linalg import eigsh
from scipy.spatial import cKDTree

HERE = pathlib.Path(__file__).parent
SAMPLES = HERE.parent.parent / "www/public/samples"
VERSIONS = {"numpy": np.__version__, "scipy": scipy.__version__, "robust_laplacian": "1.1.0"}


def read_ply(name):
    """Float positions, perhaps a byte label, perhaps triangles: the layout of the samples."""
    head, body = (SAMPLES / name).read_bytes().split(b"end_header\n", 1)
    count = {line.split()[1]: int(line.split()[2]) for line in head.decode().splitlines() if line.startswith("element")}
    fields = [("p", "<f4", 3)] + ([("label", "u1")] if b"uchar label" in head else [])
    vertices = np.frombuffer(body, np.dtype(fields), count["vertex"])
    faces = np.frombuffer(body, np.dtype([("n", "u1"), ("v", "<u4", 3)]), count.get("face", 0), vertices.nbytes)
    return vertices["p"].astype(np.float64), faces["v"].astype(np.int64)


def smallest(L, M, k):
    """The k smallest eigenvalues of L x = λ M x, symmetrised so that eigsh solves a standard problem to full accuracy."""
    root = diags(1 / np.sqrt(M.diagonal()))
    A = (root @ L @ root).tocsc()
    values = eigsh(A, k, sigma=-1e-2 * A.diagonal().mean() * k / A.shape[0], tol=0, v0=np.ones(A.shape[0]), return_eigenvectors=False)
    return np.sort(values)


def algorithm_1(P, k0=5, k=20, tau=3.0, T=3):
    """Algorithm 1 of the paper, undirected graphs, σ the mean distance to the k neighbours."""
    n = len(P)
    d, j = (a[:, 1:] for a in cKDTree(P).query(P, k + 1))
    i = np.repeat(np.arange(n), k).reshape(n, k)
    sigma = d.mean()

    def graph(keep):
        G = csr_matrix((d[keep], (i[keep], j[keep])), (n, n))
        return G.maximum(G.T)

    G = graph(np.broadcast_to(np.arange(k) < k0, (n, k)))
    for _ in range(T):
        d_g = np.empty((n, k))
        for rows in np.array_split(np.arange(n), 20):
            d_g[rows] = np.take_along_axis(dijkstra(G, False, rows, limit=1.01 * tau * d.max()), j[rows], 1)
        G = graph(d_g / d < tau)
    W = G.tocoo()
    # d_g on the final graph: an edge is its own shortest path, checked here rather than assumed.
    for rows in np.array_split(np.arange(n), 20):
        inside = np.isin(W.row, rows)
        d_g = dijkstra(G, False, rows, limit=2 * d.max())[W.row[inside] - rows[0], W.col[inside]]
        assert np.allclose(d_g, W.data[inside], rtol=1e-12)
    weights = np.exp(-W.data**2 / (2 * sigma**2)) * np.exp(-W.data**2 / (2 * sigma**2))
    W = coo_matrix((weights, (W.row, W.col)), (n, n)).tocsr()
    pruned = graph(np.ones((n, k), bool)).nnz // 2 - W.nnz // 2
    return diags(np.asarray(W.sum(1)).ravel()) - W, sigma, pruned


def grid(n, m, point, join=None):
    """n by m points of a surface, squares cut along one diagonal; join(j) is where row n meets row 0, if it does."""
    P = np.array([point(i, j) for i in range(n) for j in range(m)], float)
    at = lambda i, j: i * m + j if i < n else join(j)
    squares = [(i, j) for i in range(n if join else n - 1) for j in range(m - 1)]
    corners = [(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)) for i, j in squares]
    return P, np.array([t for a, b, c, d in corners for t in ((a, b, c), (a, c, d))])


def icosphere(level):
    g = (1 + 5**0.5) / 2
    P = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    F = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8)]
    F += [(3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    P = [np.array(p, float) for p in P]
    for _ in range(level):
        middles = {}

        def middle(a, b):
            if (min(a, b), max(a, b)) not in middles:
                P.append((P[a] + P[b]) / 2)
                middles[min(a, b), max(a, b)] = len(P) - 1
            return middles[min(a, b), max(a, b)]

        F = [t for a, b, c in F for ab, bc, ca in [(middle(a, b), middle(b, c), middle(c, a))] for t in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))]
    P = np.array(P)
    return P / np.linalg.norm(P, axis=1)[:, None], np.array(F)


def blob():
    P, F = icosphere(3)
    bumps = [((0.9, 0.3, 0.3), 0.9, 6.0), ((-0.5, 0.8, 0.1), 0.6, 8.0), ((0.1, -0.4, 0.9), 0.45, 10.0)]
    r = 1 + sum(height * np.exp(sharp * (P @ np.array(axis) / np.linalg.norm(axis) - 1)) for axis, height, sharp in bumps)
    return P * r[:, None] * [1.3, 1, 0.8], F


def moebius(i, j):
    u, v = 2 * np.pi * i / 80, 0.1 * (j - 4)
    r = 1 + v * np.cos(u / 2)
    return r * np.cos(u), r * np.sin(u), v * np.sin(u / 2)


def tube(i, j):
    u, v = 2 * np.pi * i / 60, 2 * np.pi * j / 9
    r = 2 + 0.3 * np.cos(v)
    return r * np.cos(u), r * np.sin(u), 0.3 * np.sin(v)


def with_fins(P, F):
    a, b, _ = F[0]
    n = len(P)
    return np.vstack([P, (0.3, 2.0, 1.0), (-0.4, 2.1, 1.2)]), np.vstack([F, (a, b, n), (b, a, n + 1)])


def beside(P, F, Q, G):
    return np.vstack([P, Q]), np.vstack([F, G + len(P)])


def closed_tube():
    P, F = grid(60, 9, tube, lambda j: j)
    last = np.array([(i * 9 + 8, (i + 1) % 60 * 9 + 8, (i + 1) % 60 * 9, i * 9) for i in range(60)])
    return P, np.vstack([F, last[:, [0, 1, 2]], last[:, [0, 2, 3]]])


def write(name, **values):
    text = {key: [float(v) for v in value] if isinstance(value, np.ndarray) else value for key, value in values.items()}
    (HERE / name).write_text(json.dumps({"versions": VERSIONS, **text}, indent=0) + "\n")


for body in ["woman-striding", "man-lunging"]:
    P, F = read_ply(f"{body}.ply")
    L, M = robust_laplacian.mesh_laplacian(P, F)
    C, N = robust_laplacian.point_cloud_laplacian(P)
    write(
        f"{body}.json",
        meshEigenvalues=smallest(L, M, 120),
        meshArea=float(M.sum()),
        meshDiagonalEvery50=L.diagonal()[::50],
        meshMassEvery50=M.diagonal()[::50],
        cloudEigenvalues=smallest(C, N, 120),
        cloudArea=float(N.sum()),
    )

P, _ = read_ply("woman-greeting-cloud.ply")
L, sigma, pruned = algorithm_1(P)
write(
    "woman-greeting-cloud.json",
    sigma=float(sigma),
    edges=int((L.nnz - len(P)) // 2),
    pruned=int(pruned),
    diagonalEvery10=L.diagonal()[::10],
    row1234={int(c): float(v) for c, v in zip(L[1234].tocoo().col, L[1234].tocoo().data)},
    eigenvalues=smallest(L, diags(np.ones(len(P))), 120),
)

# Twelve digits: the test asks for six.
meshes = {
    "woman-standing.ply": read_ply("woman-standing.ply"),
    "man-standing.ply": read_ply("man-standing.ply"),
    "blob": blob(),
    "thin torus": closed_tube(),
    "wavy sheet": grid(25, 20, lambda i, j: (i, j, 3 * np.sin(0.3 * i) * np.cos(0.2 * j))),
    "needles": grid(30, 12, lambda i, j: (i, 0.02 * j, 0.3 * np.sin(0.9 * i))),
    "Möbius strip": grid(80, 9, moebius, lambda j: 8 - j),
    "fins on one edge": with_fins(*blob()),
    "two pieces": beside(*icosphere(2), *[a + b for a, b in zip(icosphere(3), ((5, 0, 0), 0))]),
}
eigenvalues = {name: smallest(*robust_laplacian.mesh_laplacian(P, F), 120) for name, (P, F) in meshes.items()}
write("meshes.json", **{name: [float(f"{v:.12g}") for v in values] for name, values in eigenvalues.items()})

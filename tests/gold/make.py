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

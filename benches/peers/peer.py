"""One side of run.mjs: reads paths of clouds (float64, n by 3) from stdin, answers each with the seconds that
120 eigenpairs took.
"""

import json
import sys
import time

import numpy as np
import robust_laplacian
from scipy.sparse.linalg import eigsh

for line in sys.stdin:
    points = np.fromfile(line.strip(), "<f8").reshape(-1, 3)
    started = time.perf_counter()
    L, M = robust_laplacian.point_cloud_laplacian(points)
    built = time.perf_counter()
    values, vectors = eigsh(L, 120, M, sigma=-0.01)
    done = time.perf_counter()
    residuals = np.sqrt(((L @ vectors - M @ vectors * values) ** 2 / M.diagonal()[:, None]).sum(0))
    # Relative to the largest eigenvalue asked for.
    residual = float(residuals.max() / values.max())
    print(json.dumps({"seconds": done - started, "laplacian": built - started, "residual": residual}), flush=True)

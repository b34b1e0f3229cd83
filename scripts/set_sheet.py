"""Draws shapes of an evaluation set from the front and from the left: python scripts/set_sheet.py SET OUT.png [NAME ...]

Meshes are shaded; colours are the labels. Points that corres/NAME.vts names are counted in the title. Needs numpy and matplotlib.
"""
import sys
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.collections import PolyCollection

folder, out = Path(sys.argv[1]), sys.argv[2]
names = sys.argv[3:] or sorted(p.stem for p in (folder / "shapes").glob("*.off"))
columns = 6
rows = -(-len(names) // columns)
figure, axes = plt.subplots(rows, 2 * columns, figsize=(5 * columns, 5 * rows), squeeze=False)
for axis in axes.flat:
    axis.axis("off")
for k, name in enumerate(names):
    words = (folder / f"shapes/{name}.off").read_text().split()
    n, m = int(words[1]), int(words[2])
    points = np.array(words[4 : 4 + 3 * n], float).reshape(n, 3)
    faces = np.array(words[4 + 3 * n :], int).reshape(m, 4)[:, 1:]
    labels = np.loadtxt(folder / f"labels/{name}.txt", int)
    truth = np.loadtxt(folder / f"corres/{name}.vts", int)
    colours = plt.cm.tab20(np.arange(20))[:, :3]
    for view, (across, depth, sign) in enumerate([(0, 2, 1), (2, 0, 1)]):
        axis = axes[k // columns, 2 * (k % columns) + view]
        if m:
            corners = points[faces]
            normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            normal /= np.linalg.norm(normal, axis=1)[:, None] + 1e-12
            order = np.argsort(corners[:, :, depth].mean(1) * sign)
            shade = 0.35 + 0.65 * np.abs(normal[:, depth])
            colour = colours[labels[faces[:, 0]] % 20] * shade[:, None]
            axis.add_collection(PolyCollection(corners[order][:, :, [across, 1]], facecolors=colour[order], edgecolors="none"))
        else:
            order = np.argsort(points[:, depth] * sign)
            axis.scatter(points[order, across], points[order, 1], s=1, c=colours[labels[order] % 20])
        axis.autoscale()
        axis.set_aspect("equal")
    axes[k // columns, 2 * (k % columns)].set_title(f"{name}: {n} points, {len(set(truth) - {0})} named")
plt.tight_layout()
plt.savefig(out, dpi=45)

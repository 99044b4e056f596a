#!/usr/bin/python3
"""triangulation_pictures.py: remakes the pictures of triangulations in docs/gallery.

delaunay.png voronoi.png alpha.png constrained.png. Needs the package, Matplotlib and Pillow:
`make python`, then `build/python/venv/bin/pip install matplotlib pillow` and run this with
build/python/venv/bin/python.
"""
import io
import os

import matplotlib
import numpy as np
from PIL import Image

import cullhull

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.collections import LineCollection, PolyCollection  # noqa: E402
from matplotlib.path import Path  # noqa: E402
from matplotlib.patches import PathPatch  # noqa: E402

folder = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "docs", "gallery")
BLUE, ORANGE, GREY = "#2b6cb0", "#dd6b20", "#a0aec0"


def page(points):
    figure, axes = plt.subplots(figsize=(7.2, 4.8), dpi=100)
    axes.set_aspect("equal")
    axes.axis("off")
    low, high = points.min(axis=0), points.max(axis=0)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    figure.subplots_adjust(0.01, 0.01, 0.99, 0.99)
    return figure, axes


def save(figure, name):
    picture = io.BytesIO()
    figure.savefig(picture, format="png")
    plt.close(figure)
    path = os.path.join(folder, name)
    Image.open(picture).convert("RGB").quantize(32).save(path, optimize=True)
    print(f"{name}: {os.path.getsize(path) // 1000} kB")


def spread(n, seed):
    """Points that are denser towards the left."""
    x, y = np.random.default_rng(seed).random((2, n))
    return np.stack([1.5 * x**2, y], axis=1)


def draw_delaunay():
    points = spread(700, 1)
    found = cullhull.delaunay(points)
    figure, axes = page(points)
    radii = np.log(cullhull.alpha_radii(found))
    axes.add_collection(PolyCollection(
        points[found.cells], array=radii, cmap="YlGnBu", edgecolors="white", linewidths=0.4,
        clim=np.percentile(radii, [2, 98])))
    save(figure, "delaunay.png")


def draw_voronoi():
    points = spread(350, 2)
    cells = cullhull.voronoi(points).clip([0, 0], [1.5, 1])
    figure, axes = page(np.array([[0, 0], [1.5, 1]]))
    shapes = [cells.corners(i) for i in range(len(points))]
    axes.add_collection(PolyCollection(
        shapes, array=np.sqrt(cells.measures), cmap="Oranges", edgecolors="white", linewidths=0.6))
    axes.plot(*points.T, ".", color="#4a5568", markersize=2)
    save(figure, "voronoi.png")


def letters():
    """Points in the letter C and a disk in it."""
    p = np.random.default_rng(3).random((9000, 2)) * [3, 2] - [1.5, 1]
    r, angle = np.hypot(*p.T), np.abs(np.arctan2(p[:, 1], p[:, 0]))
    return p[((r < 0.95) & (r > 0.5) & (angle > 0.6)) | (r < 0.25)]


def draw_alpha():
    points = letters()
    shape = cullhull.alpha_shape(points, 0.07)
    figure, axes = page(np.array([[-1.5, -1], [1.5, 1]]))
    for rings in shape.polygons():
        corners, codes = [], []
        for ring in rings:
            corners += [*points[ring], points[ring[0]]]
            codes += [Path.MOVETO, *[Path.LINETO] * (len(ring) - 1), Path.CLOSEPOLY]
        axes.add_patch(PathPatch(Path(corners, codes), facecolor="#bee3f8", edgecolor=BLUE))
    tree = cullhull.minimum_spanning_tree(shape.triangulation)
    axes.add_collection(LineCollection(points[tree], colors=ORANGE, linewidths=0.5))
    save(figure, "alpha.png")


def draw_constrained():
    angle = np.linspace(0, 2 * np.pi, 120, endpoint=False)
    outer = np.stack([1.45 * np.cos(angle), np.sin(angle)], 1) * (0.85 + 0.12 * np.cos(9 * angle))[:, None]
    hole = np.stack([np.cos(angle[::4]), np.sin(angle[::4])], 1) * 0.3 + [0.55, 0.05]
    line = np.stack([np.linspace(-1.0, 0.1, 12), 0.25 * np.sin(np.linspace(0, 6, 12))], 1)
    loose = np.random.default_rng(4).random((160, 2)) * [2.8, 1.9] - [1.4, 0.95]
    points, edges = np.concatenate([outer, hole, line, loose]), []
    first = 0
    for ring in (outer, hole):
        ids = first + np.arange(len(ring))
        edges.append(np.stack([ids, np.roll(ids, -1)], 1))
        first += len(ring)
    ids = first + np.arange(len(line))
    edges = np.concatenate([*edges, np.stack([ids[:-1], ids[1:]], 1)])
    found = cullhull.constrained_delaunay(points, edges, inside_only=True)
    figure, axes = page(np.array([[-1.5, -1], [1.5, 1]]))
    axes.add_collection(PolyCollection(
        points[found.cells], facecolors="#ebf8ff", edgecolors=GREY, linewidths=0.6))
    axes.add_collection(LineCollection(points[found.pieces], colors=BLUE, linewidths=1.6))
    save(figure, "constrained.png")


for draw in (draw_delaunay, draw_voronoi, draw_alpha, draw_constrained):
    draw()

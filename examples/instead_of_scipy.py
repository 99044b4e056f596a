"""Code written for SciPy: one import is another."""

import numpy as np

from cullhull import ConvexHull, HalfspaceIntersection  # was: from scipy.spatial import ...

points = np.random.default_rng(0).random((200_000, 3))
hull = ConvexHull(points)
print(f"{hull.nsimplex} triangles, volume {hull.volume:.5f}, area {hull.area:.5f}")
assert (points[hull.vertices] @ hull.equations[:, :3].T + hull.equations[:, 3]).max() < 1e-12

square = np.array([[-1.0, 0, 0], [0, -1, 0], [1, 0, -2], [0, 1, -2]])
corners = HalfspaceIntersection(square, np.array([1.0, 1.0])).intersections
assert sorted(map(tuple, corners)) == [(0, 0), (0, 2), (2, 0), (2, 2)]

# Flat input is no error here, and points on a lattice are no trouble.
flat = ConvexHull(np.column_stack([points[:, :2], np.full(len(points), 0.25)]))
print(f"flat: area {flat.volume:.5f}, perimeter {flat.area:.5f}")

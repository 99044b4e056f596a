"""The filter alone, in front of other code: here Qhull, as SciPy calls it."""

import numpy as np
from scipy.spatial import ConvexHull

import cullhull

points = cullhull.generate("ball", 1_000_000, 3)
kept = cullhull.cull(points)  # indices; every extreme point is among them
hull = ConvexHull(points[kept])
vertices = np.sort(kept[hull.vertices])
print(f"kept {len(kept):,} of {len(points):,} points; volume {hull.volume:.4f}")
assert (vertices == cullhull.convex_hull(points).vertices).all()

"""The filter alone, in front of other code: here a bounding sphere by a simple iteration."""

import numpy as np

import cullhull


def nearly_smallest_sphere(points, steps=2000):
    """Badoiu and Clarkson: walk towards the farthest point by 1, 1/2, 1/3, ... of the way."""
    centre = points[0].astype(float)
    for step in range(1, steps):
        farthest = points[np.argmax(((points - centre) ** 2).sum(axis=1))]
        centre += (farthest - centre) / (step + 1)
    return centre, np.sqrt(((points - centre) ** 2).sum(axis=1).max())


points = cullhull.generate("cube", 1_000_000, 3)
kept = cullhull.cull(points)  # indices; every extreme point is among them
centre, radius = nearly_smallest_sphere(points[kept])
assert (((points - centre) ** 2).sum(axis=1) <= radius**2 * (1 + 1e-12)).all()
print(f"kept {len(kept):,} of {len(points):,} points; radius {radius:.4f}")

"""The hull of an array, what it consists of, and questions to it."""

import numpy as np

import cullhull

points = np.random.default_rng(0).normal(size=(1_000_000, 3)).astype(np.float32)
hull = cullhull.convex_hull(points, certify=True)  # reads the array in place
print(hull)
print(f"volume {hull.volume:.3f}, area {hull.area:.3f}, certified: {bool(hull.certificate)}")

extreme = points[hull.vertices]  # indices into your own array
assert np.abs(extreme).max() == np.abs(points).max()

for facet, plane in zip(hull.facets, hull.facet_planes):  # maximal facets and outward planes
    assert abs(points[facet] @ plane[:3] + plane[3]).max() < 1e-5

asked = np.random.default_rng(1).normal(size=(100_000, 3)) * 2
inside = hull.contains(asked)
distance = hull.distance(asked)
assert np.array_equal(inside, distance <= 0)
print(f"{inside.mean():.1%} of other points are inside, the farthest is {distance.max():.2f} away")

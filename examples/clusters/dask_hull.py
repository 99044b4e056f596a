"""Dask: the hull of an array in chunks, on whatever scheduler is in use."""

import dask.array as da

import cullhull
import cullhull.dask

points = da.random.default_rng(1).normal(size=(1_000_000, 3), chunks=(100_000, 3))
hull = cullhull.dask.convex_hull(points).compute()
assert hull.volume == cullhull.convex_hull(points.compute()).volume
print(f"{hull.point_count:,} points: {len(hull.vertices)} vertices, volume {hull.volume:.6f}")

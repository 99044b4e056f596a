"""Hulls of Dask's collections: a tree of states, on threads, processes or a cluster.

Points stay where they are. Each chunk becomes a `HullState` (its extreme points), states are merged
up a tree, and the hull of what is left is that of all points in one process, bit for bit. Tasks are
pure: a worker that is lost costs its own tasks again and nothing else. Everything is lazy:
``.compute()`` and Dask's schedulers run it, and its dashboard shows the tasks as ``cullhull-...``.

>>> import cullhull, cullhull.dask
>>> import dask.array as da
>>> points = cullhull.generate("ball", 10_000)
>>> lazy = cullhull.dask.convex_hull(da.from_array(points, chunks=(1000, 3)))
>>> hull = lazy.compute(scheduler="threads")
>>> bool((hull.simplices == cullhull.convex_hull(points).simplices).all())
True
"""

from .cluster._dask import convex_hull, cull, extreme_points, state

__all__ = ["convex_hull", "cull", "extreme_points", "state"]

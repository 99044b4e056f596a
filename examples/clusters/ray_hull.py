"""Ray: the hull of arrays in the object store by states of them, and a hull per group."""

import numpy as np
import ray

import cullhull

ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
points = cullhull.generate("ball", 200_000, 3)
blocks = np.array_split(points, 12)
firsts = np.cumsum([0] + [len(block) for block in blocks])


@ray.remote
def state(block, first_id):
    """A block becomes its extreme points: some kilobytes. It is worked on where it lies."""
    return cullhull.HullState(block, int(first_id), threads=1)


@ray.remote
def merged(*states):
    total = states[0]
    for one in states[1:]:
        total = total | one
    return total


# One hull: extreme points of the blocks, four and four merged, until one state is left.
states = [state.remote(ray.put(block), first) for block, first in zip(blocks, firsts)]
while len(states) > 1:
    states = [merged.remote(*states[i : i + 4]) for i in range(0, len(states), 4)]
hull = ray.get(states[0]).hull()
whole = cullhull.convex_hull(points)
assert hull.volume == whole.volume
assert hull.vertices.tolist() == whole.vertices.tolist()
print(f"{len(points):,} rows: {len(hull.vertices)} vertices, volume {hull.volume:.6f}")


@ray.remote
def volumes(block, keys):
    """All hulls of a block in one call; each group lies in one block."""
    names, counts = np.unique(keys, return_counts=True)
    rows = block[np.argsort(keys, kind="stable")]
    batch = cullhull.convex_hulls(rows, np.cumsum([0, *counts]))
    return dict(zip(names.tolist(), batch.volumes.tolist()))


# A hull per group.
keys = [np.arange(len(block)) % 5 + 5 * i for i, block in enumerate(blocks)]
per_group = {}
for found in ray.get([volumes.remote(block, key) for block, key in zip(blocks, keys)]):
    per_group.update(found)
seven = blocks[1][keys[1] == 7]
assert per_group[7] == cullhull.convex_hull(seven).volume
print(f"{len(per_group)} groups; group 7 has volume {per_group[7]:.6f}")
ray.shutdown()

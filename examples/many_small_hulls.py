"""Ten thousand small hulls in one call, and a hull that grows."""

import numpy as np

import cullhull

clouds = np.random.default_rng(0).normal(size=(10_000, 50, 3))
batch = cullhull.convex_hulls(clouds)
print(batch, f"mean volume {batch.volumes.mean():.3f}")
assert batch[123].volume == cullhull.convex_hull(clouds[123]).volume

growing = cullhull.GrowingHull(3)
for cloud in clouds[:100]:
    growing.add(cloud)  # keeps the vertices only
assert np.array_equal(
    growing.hull.simplices, cullhull.convex_hull(clouds[:100].reshape(-1, 3)).simplices
)
print(growing)

"""MPI by mpi4py: mpirun -n 4 python mpi_hull.py"""

import numpy as np
from mpi4py import MPI

import cullhull
import cullhull.mpi

world = MPI.COMM_WORLD
points = cullhull.generate("ball", 50_000, 3, seed=world.Get_rank() + 1)  # this rank's own
hull = cullhull.mpi.convex_hull(world, points)
together = world.gather(points)
if hull is not None:
    assert hull.volume == cullhull.convex_hull(np.concatenate(together)).volume
    print(f"{world.Get_size()} ranks, {hull.point_count:,} points: {len(hull.vertices)} vertices")

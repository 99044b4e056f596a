"""Hulls of points that lie on the ranks of an MPI job, by communicators of mpi4py.

Every rank calls these functions with its own points, which stay where they are; indices count
through the ranks in their order. States of extreme points go up a binomial tree, and the hull is
that of all points in one process, bit for bit. An error on one rank is raised on every rank, with
the rank's number. Run, say, ``mpirun -n 4 python hull.py`` with

    from mpi4py import MPI
    import cullhull.mpi

    hull = cullhull.mpi.convex_hull(MPI.COMM_WORLD, my_points)
    if hull is not None:  # on rank 0
        print(hull.volume)
"""

from .cluster._mpi import convex_hull, extreme_points, state

__all__ = ["convex_hull", "extreme_points", "state"]

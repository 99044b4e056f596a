"""A pytest plugin that puts our classes in the place of SciPy's for libpysal's own tests."""

import os

import scipy.spatial

if os.environ.get("CULLHULL_STAND_IN") != "scipy":  # before libpysal imports them by name
    import cullhull

    for name in ("ConvexHull", "Delaunay", "Voronoi"):
        setattr(scipy.spatial, name, getattr(cullhull, name))
    scipy.spatial.QhullError = cullhull.QhullError

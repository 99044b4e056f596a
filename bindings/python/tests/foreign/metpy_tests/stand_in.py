"""A pytest plugin that puts our tolerant classes in the place of SciPy's for MetPy's own tests."""

import os

import scipy.spatial

WHO = os.environ.get("CULLHULL_STAND_IN")

if WHO != "scipy":  # before MetPy imports them by name
    import cullhull

    prefix = "" if WHO == "exact" else "Tolerant"
    for name in ("ConvexHull", "Delaunay", "Voronoi"):
        setattr(scipy.spatial, name, getattr(cullhull, prefix + name))
    scipy.spatial.QhullError = cullhull.QhullError

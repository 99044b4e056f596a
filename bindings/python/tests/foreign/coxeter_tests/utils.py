"""Stands in for coxeter's own tests/utils.py, which its source archive leaves out: integrals over
convex bodies. That one samples them; these are summed over tetrahedra."""

import numpy as np
from scipy.spatial import Delaunay


def _tetrahedra(vertices):
    corners = np.asarray(vertices)[Delaunay(vertices).simplices]
    return corners, np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6


def compute_centroid_mc(vertices, num_samples):
    corners, volumes = _tetrahedra(vertices)
    return np.average(corners.mean(axis=1), weights=volumes, axis=0)


def compute_inertia_mc(vertices, volume, num_samples):
    corners, volumes = _tetrahedra(vertices)
    sums = corners.sum(axis=1)
    moments = np.einsum("tij,tik,t->jk", corners, corners, volumes)
    moments = (moments + np.einsum("tj,tk,t->jk", sums, sums, volumes)) / 20
    return (np.trace(moments) * np.eye(3) - moments) * volume / volumes.sum()

"""Hulls of points that lie in many places: Dask and MPI."""

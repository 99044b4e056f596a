"""Points in objects of Shapely, GeoPandas, trimesh, PyVista and Open3D, none of which is imported.

Whoever passes such an object has loaded its package.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import numpy.typing as npt

from .._errors import InvalidArgument, NotFinite

_MISSING, _POINT, _MULTIPOINT = -1, 0, 4  # as Shapely numbers the types of geometries


def as_foreign(points: Any, what: str) -> Any:
    """The coordinates that an object of one of these packages has: an array, or what NumPy makes
    one of; None for all other objects."""
    kind = type(points)
    if kind.__module__ == "builtins":
        return None
    packages = {base.__module__.partition(".")[0] for base in kind.__mro__}
    if "geopandas" in packages and hasattr(points, "columns"):
        points = points.geometry  # the column that the frame says has the geometries
        packages = {"geopandas"}
    if "geopandas" in packages or "shapely" in packages:
        geometries = np.asarray(points, dtype=object)
        found = of_geometries(geometries, what)
        return found[0] if found is not None and _is_point(geometries) else found
    if "trimesh" in packages:
        return _member(points, ("vertices",), what, "scene.to_mesh()")
    if "pyvista" in packages:
        return _member(points, ("points",), what, "blocks.combine()")
    if "open3d" in packages:
        return _member(points, ("points", "vertices"), what, "a PointCloud or a TriangleMesh")
    return None


def _member(thing: Any, names: tuple[str, ...], what: str, instead: str) -> Any:
    if isinstance(thing, np.ndarray):
        return None
    for name in names:
        held = getattr(thing, name, None)
        if held is not None and not callable(held):
            return np.asarray(held)
    kind = type(thing).__name__
    raise InvalidArgument(f"`{what}`: a {kind} has no points of its own; pass {instead}")


def _is_point(geometries: npt.NDArray[Any]) -> bool:
    return geometries.ndim == 0 and geometries.item().geom_type == "Point"


def of_geometries(array: npt.NDArray[Any], what: str) -> npt.NDArray[np.float64] | None:
    """(n, d): the coordinates of an array of Points and MultiPoints; None if it has no geometry."""
    shapely = sys.modules.get("shapely")
    geometries = array.ravel()
    if shapely is None or array.ndim > 1 or len(geometries) == 0:
        return None
    if not any(isinstance(geometry, shapely.Geometry) for geometry in geometries):
        return None
    try:
        kinds = shapely.get_type_id(geometries)
    except TypeError:
        raise InvalidArgument(f"`{what}` mixes geometries and other objects") from None
    points = kinds == _POINT
    if (kinds == _MISSING).any():
        raise NotFinite(f"`{what}`: geometry {int((kinds == _MISSING).argmax())} is missing")
    others = ~(points | (kinds == _MULTIPOINT))
    if others.any():
        kind = geometries[int(others.argmax())].geom_type
        raise InvalidArgument(
            f"`{what}`: Points and MultiPoints are taken, not a {kind}; "
            "shapely.get_coordinates(x) gives the corners of any geometry"
        )
    empty = shapely.is_empty(geometries)
    if (empty & points).any():
        raise NotFinite(f"`{what}`: geometry {int((empty & points).argmax())} is an empty point")
    solid = shapely.has_z(geometries[~empty])
    if solid.any() and not solid.all():
        raise InvalidArgument(f"`{what}`: some geometries have a z coordinate and others none")
    rows: npt.NDArray[np.float64] = shapely.get_coordinates(geometries, include_z=bool(solid.any()))
    return rows

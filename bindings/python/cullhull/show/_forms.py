"""What results are made into before they are drawn, written or handed on: surfaces, pictures,
geometries."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from .._errors import InvalidArgument
from .._lists import Lists

Rows = npt.NDArray[np.float64]


class Surface(NamedTuple):
    """Polygons of points in the plane or in space."""

    points: Rows  # (v, d)
    ids: npt.NDArray[Any]  # (v,): the number of each of them in the result
    #: Places among `points`: simple polygons without holes, counter-clockwise seen from outside.
    polygons: Lists
    triangles: npt.NDArray[np.int64]  # (t, 3): the same area
    pieces: npt.NDArray[Any]  # (t,): triangles of one piece, a facet or a cell, share a number
    data: Mapping[str, npt.NDArray[Any]] = {}  # one value a polygon


class Volume(NamedTuple):
    """Cells of points in space."""

    points: Rows  # (v, 3)
    ids: npt.NDArray[Any]  # (v,)
    tetrahedra: npt.NDArray[np.int64]  # (t, 4): places among `points`
    data: dict[str, npt.NDArray[Any]]  # one value a cell


class Picture(NamedTuple):
    """What is drawn of a result."""

    polygons: Sequence[Sequence[Rows]] = ()  # rings: an outline, then holes
    segments: Sequence[Rows] | Rows = ()  # (2, d) each
    dots: Rows | None = None  # (m, d)
    frame: Rows | None = None  # (m, d): the picture reaches as far as these, if given
    surface: bool = False  # the polygons of space are one surface, counter-clockwise from outside


class Table(NamedTuple):
    """What a notebook shows beside the picture."""

    caption: str
    rows: Sequence[tuple[str, str]]


def places(ids: npt.NDArray[Any], numbers: npt.NDArray[Any]) -> npt.NDArray[np.int64]:
    """The place of each of ``numbers`` in ``ids``, which holds all of them, each once."""
    order = np.argsort(ids, kind="stable")
    return order[np.searchsorted(ids, numbers, sorter=order)]


class VertexIndex:
    """From the indices of a hull's vertices among all points to the rows of its `points`."""

    __slots__ = ("_ids",)

    def __init__(self, ids: npt.NDArray[np.int64]) -> None:
        self._ids = ids

    def __getitem__(self, indices: Any) -> Any:
        """The row of an index; of an array or a list of indices an array of rows.

        Raises `IndexError` for an index of no vertex, `TypeError` for one that is no integer.
        """
        asked = np.asarray(indices)
        if asked.size == 0:
            return np.empty(asked.shape, dtype=np.int64)
        if asked.dtype.kind not in "iu":
            raise TypeError("vertex_index takes integers: indices of vertices")
        inside = np.isin(asked, self._ids)
        if not inside.all():
            raise IndexError(f"point {asked[~inside].flat[0]} is not a vertex of the hull")
        rows = places(self._ids, asked)
        return int(rows) if rows.ndim == 0 else rows

    def __len__(self) -> int:
        return len(self._ids)

    def __repr__(self) -> str:
        return f"<VertexIndex of {len(self)} vertices>"


def fan(corners: int) -> npt.NDArray[np.int64]:
    """The triangles of a convex polygon."""
    middle = np.arange(1, max(corners - 1, 1), dtype=np.int64)
    return np.column_stack([np.zeros_like(middle), middle, middle + 1])


def fans(polygons: Lists) -> npt.NDArray[np.int64]:
    """(t, 3): the triangles of convex polygons, those of each one after the other."""
    starts, items = np.asarray(polygons.offsets), np.asarray(polygons.items, dtype=np.int64)
    counts = np.maximum(np.diff(starts) - 2, 0)
    first = np.repeat(starts[:-1], counts)
    step = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts) + first + 1
    return np.column_stack([items[first], items[step], items[step + 1]])


def following(starts: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """The next corner in its ring, for each corner."""
    after = np.arange(1, int(starts[-1]) + 1 if len(starts) else 1, dtype=np.int64)
    filled = np.flatnonzero(np.diff(starts))
    after[starts[filled + 1] - 1] = starts[filled]
    return after


def edges_of(cells: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """(e, 2): the edges of simplices, each once, ascending."""
    width = cells.shape[1]
    pairs = [cells[:, [i, j]] for i in range(width) for j in range(i + 1, width)]
    if not pairs:
        return np.empty((0, 2), dtype=cells.dtype)
    return np.unique(np.sort(np.concatenate(pairs), axis=1), axis=0)


def in_rows(numbers: npt.NDArray[Any]) -> Lists:
    """The rows of an array as lists."""
    count, width = numbers.shape
    return Lists(np.arange(count + 1, dtype=np.int64) * width, numbers.ravel())


def closed(ring: Rows) -> list[list[float]]:
    """A ring as GeoJSON has it: the first corner again at the end."""
    corners: list[list[float]] = ring.tolist()
    return [*corners, corners[0]]


def polygon_geometry(rings: Sequence[Rows]) -> dict[str, Any]:
    return {"type": "Polygon", "coordinates": [closed(ring) for ring in rings]}


def polygons_geometry(polygons: Sequence[Sequence[Rows]]) -> dict[str, Any]:
    """A Polygon for a single polygon, else a MultiPolygon."""
    if len(polygons) == 1:
        return polygon_geometry(polygons[0])
    return multipolygon_geometry(polygons)


def multipolygon_geometry(polygons: Sequence[Sequence[Rows]]) -> dict[str, Any]:
    return {
        "type": "MultiPolygon",
        "coordinates": [[closed(ring) for ring in rings] for rings in polygons],
    }


def features(geometries: Sequence[dict[str, Any]], **properties: Any) -> dict[str, Any]:
    """A collection; each property is a list of one value a geometry."""
    names = list(properties)
    rows = zip(*properties.values()) if names else ((),) * len(geometries)
    return {
        "type": "FeatureCollection",
        "features": [
            {
                "type": "Feature",
                "properties": dict(zip(names, row)),
                "geometry": geometry,
            }
            for geometry, row in zip(geometries, rows)
        ],
    }


def require_polygons(
    path: str | os.PathLike[str], format: str, polygons: bool | None
) -> None:
    """Raises if ``polygons`` is given for a format that has no choice."""
    ending = (format or os.path.splitext(path)[1].lstrip(".")).lower()
    if polygons is not None and ending not in ("ply", "obj", "off", "vtp"):
        raise InvalidArgument(f"polygons is of .ply, .obj, .off and .vtp, not of .{ending}")


def require_plane(dimension: int, what: str) -> None:
    if dimension != 2:
        raise InvalidArgument(f"{what} of 2D points has a geometry; these are {dimension}D")


def require_surface(dimension: int, affine_dimension: int, what: str) -> None:
    """Raises unless there are polygons of points in the plane or in space."""
    if dimension not in (2, 3):
        raise InvalidArgument(f"{what} of 2D and 3D points has a surface; these are {dimension}D")
    if affine_dimension < 2:
        found = "on a line" if affine_dimension == 1 else "all equal or absent"
        raise InvalidArgument(f"{what} of points that are {found} has no surface")


def require_drawable(dimension: int) -> None:
    if dimension not in (2, 3):
        raise InvalidArgument(f"plot() draws results in 2D and 3D, not {dimension}D")

"""Classes that stand in for scipy.spatial.ConvexHull and scipy.spatial.HalfspaceIntersection."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import Progress, as_points, settings
from ._errors import InvalidArgument, qhull_error
from ._hull import Hull
from ._many import GrowingHull
from ._qhull_options import QhullOptions, parse


def _int32(numbers: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """As SciPy's index arrays, unless there are more points than that type can number."""
    if numbers.size and int(numbers.max()) > np.iinfo(np.int32).max:
        return numbers.astype(np.int64)
    return numbers.astype(np.int32)


class _Incremental:
    """What both classes share: points may be added until close()."""

    _open: bool

    def close(self) -> None:
        """Ends incremental use; nothing can be added any more."""
        self._open = False

    def _require_open(self) -> None:
        if not self._open:
            raise RuntimeError("incremental mode not enabled or already closed")

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


class ConvexHull(_Incremental):
    """In place of `scipy.spatial.ConvexHull`: the same attributes, exact, and faster.

    Parameters
    ----------
    points : (n, d) array, d >= 2
        Read in place where `convex_hull` does so.
    incremental : bool
        Allow `add_points`.
    qhull_options : str, optional
        ``Qc``, ``Qi``, ``QGn`` and ``QG-n`` work as in Qhull; options that only steer its
        precision (``Qt``, ``Qx``, ``QbB``, ``Pp``, ...) have no effect; others raise ValueError.
    strict : bool
        Raise `QhullError` for flat input as SciPy does. By default the hull is that of the points
        inside the k-dimensional flat they span: then `simplices` and `neighbors` have k columns,
        and `volume` and `area` are k- and (k-1)-dimensional.
    backend, cull, threads, memory_budget, progress : as in `convex_hull`

    Attributes
    ----------
    points : (n, d) float64
    vertices : (v,) int32, ascending; in 2D counter-clockwise
    simplices : (s, k) int32, oriented outward
    neighbors : (s, k) int32, entry j opposite to vertex j
    equations : (s, d + 1) float64: outward unit normal and offset; <= 0 inside
    coplanar : (c, 3) int32: with ``Qc`` points on the boundary that are no vertices, with ``Qi``
        points inside: index of the point, of the nearest simplex, of its nearest vertex
    good : (s,) bool with ``QGn``, else None
    area, volume : float; in 2D perimeter and area
    ndim, npoints, nsimplex : int
    min_bound, max_bound : (d,) float64
    hull : the native `Hull`, with merged facets and questions
    """

    hull: Hull
    ndim: int

    def __init__(
        self,
        points: Any,
        incremental: bool = False,
        qhull_options: str | None = None,
        *,
        strict: bool = False,
        backend: str = "auto",
        cull: str = "auto",
        threads: int | None = None,
        memory_budget: int | None = None,
        progress: Progress = None,
    ) -> None:
        array = as_points(points)
        if array.shape[1] < 2:
            raise InvalidArgument("Need at least 2-D data")
        if array.shape[0] == 0:
            raise InvalidArgument("No points given")
        self._options: QhullOptions = parse(qhull_options)
        self._choices: dict[str, Any] = {
            "backend": backend,
            "cull": cull,
            "threads": threads,
            "memory_budget": memory_budget,
            "progress": progress,
        }
        self._strict = bool(strict)
        self._open = bool(incremental)
        self.ndim = array.shape[1]
        # Points to be added to must not change under us.
        self._array = np.array(array, dtype=np.float64) if incremental else array
        self._grower: GrowingHull | None = None
        self._compute(self._array, self._array)

    def _compute(self, everything: npt.NDArray[Any], added: npt.NDArray[Any]) -> None:
        """Sets the hull of `everything`, of which the rows `added`, its last, are new."""
        left_out = self._options.good_point
        if left_out is not None and left_out >= len(everything):
            raise InvalidArgument(
                f"QG{left_out}: there is no such point among the {len(everything)}"
            )
        grower = self._grower
        if self._open and left_out is None:
            if grower is None or len(added) == len(everything):
                grower = GrowingHull(self.ndim)
            choices = {k: v for k, v in self._choices.items() if k not in ("backend", "cull")}
            grower.add(added, **choices)
            hull = grower.hull
        else:
            hull = _hull_without(everything, left_out, self._choices)
        if self._strict and hull.affine_dimension < self.ndim:
            raise qhull_error()(
                f"the {len(everything)} points span {hull.affine_dimension} dimensions of "
                f"{self.ndim}: the initial simplex is flat"
            )
        self.hull = Hull._of(self._settle(hull._solid))
        self._array, self._grower = everything, grower
        for name in _LAZY:
            self.__dict__.pop(name, None)

    def _settings(self) -> _core.Settings:
        return settings(**self._choices)

    def _settle(self, solid: _core.Solid) -> _core.Solid:
        """What is shown of the exact hull."""
        return solid

    def add_points(self, points: Any, restart: bool = False) -> None:
        """Adds (m, d) points. `restart` computes the hull anew instead of from its vertices; the
        result is the same."""
        self._require_open()
        array = as_points(points)
        if array.shape[1] != self.ndim:
            raise InvalidArgument(
                f"Adding points of dimension {array.shape[1]} to a hull of dimension {self.ndim}"
            )
        everything = np.concatenate([self._array, array], dtype=np.float64)
        self._compute(everything, everything if restart else everything[len(self._array) :])

    @property
    def npoints(self) -> int:
        return len(self._array)

    @property
    def nsimplex(self) -> int:
        return self.hull.simplex_count

    @property
    def area(self) -> float:
        return self.hull.area

    @property
    def volume(self) -> float:
        return self.hull.volume

    @cached_property
    def points(self) -> npt.NDArray[np.float64]:
        return np.ascontiguousarray(self._array, dtype=np.float64)

    @cached_property
    def vertices(self) -> npt.NDArray[Any]:
        return _int32(self.hull.vertices)

    @cached_property
    def simplices(self) -> npt.NDArray[Any]:
        return _int32(self.hull.simplices)

    @cached_property
    def neighbors(self) -> npt.NDArray[Any]:
        return self.hull.simplex_neighbours.copy()

    @cached_property
    def equations(self) -> npt.NDArray[np.float64]:
        planes: npt.NDArray[np.float64] = self.hull.facet_planes[self.hull.simplex_facets]
        return planes

    @cached_property
    def min_bound(self) -> npt.NDArray[np.float64]:
        return self._bound(np.min)

    @cached_property
    def max_bound(self) -> npt.NDArray[np.float64]:
        return self._bound(np.max)

    def _bound(self, extreme: Any) -> npt.NDArray[np.float64]:
        corners = self.hull.vertex_points
        if self._options.good_point is not None:  # that point counts too
            corners = np.vstack([corners, self._array[self._options.good_point]])
        bound: npt.NDArray[np.float64] = extreme(corners, axis=0)
        return bound

    @cached_property
    def good(self) -> npt.NDArray[np.bool_] | None:
        point = self._options.good_point
        if point is None:
            return None
        visible = np.zeros(self.hull.facet_count, dtype=bool)
        visible[self.hull.visible_from(self._array[point])] = True
        if not self._options.good_if_visible:
            visible = ~visible
        return visible[self.hull.simplex_facets]

    @cached_property
    def coplanar(self) -> npt.NDArray[Any]:
        if not (self._options.coplanar or self._options.interior):
            return np.empty((0, 3), dtype=np.int32)
        return _coplanar(self.hull, self._array, self._sides(), self._options)

    def _sides(self) -> npt.NDArray[np.int8]:
        """-1, 0 or 1 a point: inside, on the boundary, outside."""
        sides: npt.NDArray[np.int8] = self.hull.sides(self._array)
        return sides


_LAZY = [name for name, value in vars(ConvexHull).items() if isinstance(value, cached_property)]


def _hull_without(points: npt.NDArray[Any], left_out: int | None, choices: Any) -> Hull:
    """The hull of all points but one, with the indices of `points`."""
    solid = _core.convex_hull(points, settings(**choices))
    if left_out is None or left_out not in solid.vertices:
        return Hull._of(solid)
    rest = np.delete(points, left_out, axis=0)
    return Hull._of(_core.convex_hull(rest, settings(**choices)).skipping(left_out))


def _coplanar(
    hull: Hull, points: npt.NDArray[Any], sides: npt.NDArray[np.int8], options: QhullOptions
) -> npt.NDArray[Any]:
    wanted = np.zeros(len(points), dtype=bool)
    if options.coplanar:
        wanted |= sides == 0
        wanted[hull.vertices] = False
    if options.interior:
        wanted |= sides < 0
    if options.good_point is not None:
        wanted[options.good_point] = False
    ids = np.flatnonzero(wanted)
    table = np.empty((len(ids), 3), dtype=np.int64)
    table[:, 0] = ids
    if len(ids) == 0:
        return _int32(table)
    facets = hull.nearest_facets(points[ids]).facets
    for facet in np.unique(facets):
        rows = np.flatnonzero(facets == facet)
        simplices = np.flatnonzero(hull.simplex_facets == facet)
        table[rows, 1:] = _nearest(hull, points, ids[rows], simplices)
    return _int32(table)


def _nearest(
    hull: Hull,
    points: npt.NDArray[Any],
    ids: npt.NDArray[np.int64],
    simplices: npt.NDArray[np.int64],
) -> npt.NDArray[np.int64]:
    """For every point the nearest vertex of a facet and its first simplex with that vertex."""
    corners = hull.simplices[simplices]
    vertices, first = np.unique(corners, return_index=True)
    at = points[vertices].astype(np.float64)
    nearest = np.array(
        [np.argmin(((at - points[i]) ** 2).sum(axis=1)) for i in ids], dtype=np.int64
    )
    return np.column_stack([simplices[first[nearest] // corners.shape[1]], vertices[nearest]])


class HalfspaceIntersection(_Incremental):
    """In place of `scipy.spatial.HalfspaceIntersection`.

    Parameters
    ----------
    halfspaces : (m, d + 1) array
        Rows ``[a, b]`` of inequalities ``a @ x + b <= 0``.
    interior_point : (d,) array, optional
        Strictly inside all of them. Found by linear programming if not given.
    incremental : bool
        Allow `add_halfspaces`.
    qhull_options : str, optional
        Options that only steer Qhull's precision are accepted and have no effect; others raise.
    threads, memory_budget, progress : as in `convex_hull`

    Attributes
    ----------
    ndim, nineq, npoints : int: d, m, m
    min_bound, max_bound : (d + 1,) float64: of the rows of halfspaces
    halfspaces : (m, d + 1) float64
    interior_point : (d,) float64
    intersections : (v, d) float64: the vertices of the polyhedron, one a dual facet; not finite
        where the polyhedron is unbounded and has no such vertex
    dual_points : (m, d) float64
    dual_facets : list of lists of int: the dual hull's facets, coplanar pieces merged
    dual_vertices : (w,) int64, ascending: halfspaces that bound the polyhedron
    dual_equations : (v, d + 1) float64
    dual_area, dual_volume : float
    is_bounded : bool
    dual : the dual's native `Hull`
    """

    dual: Hull
    is_bounded: bool
    interior_point: npt.NDArray[np.float64]
    dual_points: npt.NDArray[np.float64]
    intersections: npt.NDArray[np.float64]

    def __init__(
        self,
        halfspaces: Any,
        interior_point: Any = None,
        incremental: bool = False,
        qhull_options: str | None = None,
        *,
        threads: int | None = None,
        memory_budget: int | None = None,
        progress: Progress = None,
    ) -> None:
        array = as_points(halfspaces, "halfspaces")
        if array.shape[0] == 0:
            raise InvalidArgument("No halfspaces given")
        self.ndim = array.shape[1] - 1
        if self.ndim < 2:
            raise InvalidArgument("Need at least 2-D data")
        options = parse(qhull_options)
        if options != QhullOptions():
            raise InvalidArgument("Qc, Qi and QGn have no meaning for halfspaces")
        self._choices: dict[str, Any] = {
            "threads": threads,
            "memory_budget": memory_budget,
            "progress": progress,
        }
        if interior_point is not None:
            point = as_points(np.atleast_1d(interior_point), "interior_point", axes=1)
            if point.shape != (self.ndim,):
                raise InvalidArgument(
                    f"Feasible point must be a (ndim-1,) array: ({self.ndim},), not {point.shape}"
                )
            interior_point = point.astype(np.float64)
        self._open = bool(incremental)
        self._compute(array, interior_point)

    def _compute(
        self, halfspaces: npt.NDArray[Any], interior: npt.NDArray[np.float64] | None
    ) -> None:
        if interior is not None:
            _require_feasible(halfspaces, interior)
        point = None if interior is None else interior[np.newaxis, :]
        result = _core.intersect_halfspaces(halfspaces, point, settings(**self._choices))
        self._array = halfspaces
        self.interior_point, self.dual_points, solid, self.is_bounded, self.intersections = result
        self.dual = Hull._of(solid)
        for name in ("halfspaces", "dual_facets", "dual_vertices"):
            self.__dict__.pop(name, None)

    def add_halfspaces(self, halfspaces: Any, restart: bool = False) -> None:
        """Adds (m, d + 1) rows, or one (d + 1,). The result does not depend on `restart`."""
        self._require_open()
        array = as_points(np.atleast_2d(halfspaces), "halfspaces")
        if array.shape[1] != self.ndim + 1:
            raise InvalidArgument(f"`halfspaces` should have {self.ndim + 1} columns")
        everything = np.concatenate([self._array, array], dtype=np.float64)
        self._compute(everything, self.interior_point)

    @property
    def nineq(self) -> int:
        return len(self._array)

    @property
    def npoints(self) -> int:
        return len(self._array)

    @property
    def min_bound(self) -> npt.NDArray[np.float64]:
        bound: npt.NDArray[np.float64] = self.halfspaces.min(axis=0)
        return bound

    @property
    def max_bound(self) -> npt.NDArray[np.float64]:
        bound: npt.NDArray[np.float64] = self.halfspaces.max(axis=0)
        return bound

    @cached_property
    def halfspaces(self) -> npt.NDArray[np.float64]:
        return np.ascontiguousarray(self._array, dtype=np.float64)

    @cached_property
    def dual_facets(self) -> list[list[int]]:
        return self.dual.facets.tolist()

    @cached_property
    def dual_vertices(self) -> npt.NDArray[Any]:
        return np.sort(self.dual.vertices)

    @property
    def dual_equations(self) -> npt.NDArray[np.float64]:
        return self.dual.facet_planes

    @property
    def dual_area(self) -> float:
        return self.dual.area

    @property
    def dual_volume(self) -> float:
        return self.dual.volume


def _require_feasible(halfspaces: npt.NDArray[Any], interior: npt.NDArray[np.float64]) -> None:
    """SciPy's error, and its name for the row at fault."""
    with np.errstate(all="ignore"):
        values = halfspaces[:, :-1] @ interior + halfspaces[:, -1]
    bad = np.flatnonzero(values >= 0)
    if bad.size:
        raise qhull_error()(
            f"feasible point is not clearly inside halfspace {bad[0]}: {halfspaces[bad[0]]}"
        )

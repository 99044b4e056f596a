"""The class that stands in for scipy.spatial.ConvexHull."""

from __future__ import annotations

import os
from copy import copy
from typing import Any, NoReturn

import numpy as np
import numpy.typing as npt

from .. import _core
from .._answers import Mesh
from .._batches import GrowingHull
from .._errors import InvalidArgument, qhull_error
from .._hull import Hull
from .._options import Filtered, Unpack, documented, require_known, settings, takes
from ..show._shown import Exported
from ._incremental import IncrementalPoints, Lazy
from ._original import of_scipy
from ._qhull_options import QhullOptions, parse


@takes(Filtered)
class ConvexHull(Exported, IncrementalPoints):
    """In place of `scipy.spatial.ConvexHull`: the same attributes, exact, and faster.

    It can be pickled, copied and sent between processes, also while incremental.

    Parameters
    ----------
    points : (n, d) array, d >= 2
        Read in place where `convex_hull` does so.
    incremental : bool
        Allow `add_points`.
    qhull_options : str, optional
        ``Qc``, ``Qi``, ``QGn`` and ``QG-n`` work as in Qhull. Options that only steer Qhull's work
        have no effect (``Qt``, ``Qx``, ``Pp``, ``Q12``, ...). If Qhull's own result would differ,
        as with ``QJ`` and ``QbB``, there is an `OptionWarning`. Options that ask for another result
        raise.
    strict : bool
        Raise `QhullError` for flat input as SciPy does, with its text where SciPy is installed. By
        default the hull of flat input is computed within the k-dimensional flat that the points
        span: then `simplices` and `neighbors` have k columns, and `volume` and `area` are k- and
        (k-1)-dimensional.

    Attributes
    ----------
    points : (n, d) float64
    vertices : (v,) int32: indices of points, ascending; in 2D counter-clockwise
    simplices : (s, k) int32: indices of points, oriented outward
    neighbors : (s, k) int32: entry j is the simplex opposite to vertex j
    equations : (s, d + 1) float64: outward unit normal and offset of each simplex;
        ``normal @ x + offset <= 0`` inside
    coplanar : (c, 3) int32: with ``Qc`` points on the boundary that are no vertices, with ``Qi``
        points inside: index of the point, of the nearest simplex, of its nearest vertex
    good : (s,) bool with ``QGn``, else None
    area, volume : float: surface area and volume; in 2D perimeter and area
    ndim, npoints, nsimplex : int
    min_bound, max_bound : (d,) float64
    hull : the native `Hull`, with merged facets and questions

    Raises
    ------
    InvalidArgument, NotFinite (ValueErrors), TypeError
        For another shape or type, no points, an unknown option, a NaN or an infinity.
    QhullError (a RuntimeError)
        For flat input with ``strict=True``.
    OutOfBudget (a MemoryError), KeyboardInterrupt

    Examples
    --------
    >>> import cullhull
    >>> hull = cullhull.ConvexHull([[0, 0], [2, 0], [2, 1], [0, 1], [1, 0.5]])
    >>> hull
    <ConvexHull of 5 points in 2D: 4 vertices, 4 simplices>
    >>> hull.vertices, hull.volume, hull.area
    (array([0, 1, 2, 3], dtype=int32), 2.0, 6.0)
    >>> hull.equations[0]
    array([-1.,  0.,  0.])
    >>> hull.hull.contains([1, 1])
    True
    """

    _target = "a hull"

    def __init__(
        self,
        points: Any,
        incremental: bool = False,
        qhull_options: str | None = None,
        *,
        strict: bool = False,
        **options: Unpack[Filtered],
    ) -> None:
        require_known(options, Filtered)
        array = self._take(points, incremental)
        self._options = parse(qhull_options)
        self._choices = options
        self._strict = bool(strict)
        self._grower: GrowingHull | None = None
        self._compute(array, array)

    def _compute(self, everything: npt.NDArray[Any], added: npt.NDArray[Any]) -> None:
        left_out = self._options.good_point
        if left_out is not None:
            solid = _solid_without(everything, left_out, settings(self._choices))
        elif self._open:
            solid = self._grow(everything, added)
        else:
            solid = _core.convex_hull(everything, settings(self._choices))
        if self._strict and solid.affine_dimension < self.ndim and not self._options.joggled:
            self._grower = None
            raise_flat(everything, solid.affine_dimension)
        grows = "_array" in self.__dict__
        self._array, self._solid = everything, self._settle(solid)
        if grows:
            self._forget()

    def _grow(self, everything: npt.NDArray[Any], added: npt.NDArray[Any]) -> _core.Solid:
        grower = self._grower
        if len(added) == len(everything):
            grower = GrowingHull(self.ndim)
        elif grower is None:  # this is a copy, or the last call failed
            grower = GrowingHull._of(self.hull)
        steering = ("backend", "cull")
        grower.add(added, **{k: v for k, v in self._choices.items() if k not in steering})
        self._grower = grower
        return grower.hull._solid

    def _settle(self, solid: _core.Solid) -> _core.Solid:
        """What is shown of the exact hull."""
        return solid

    def __getstate__(self) -> dict[str, Any]:
        state = super().__getstate__()
        state["hull"] = self.hull
        del state["_solid"]
        grower = state.pop("_grower")
        if grower is not None and grower.hull._solid is not self._solid:
            state["_grower"] = copy(grower)  # it holds more points than `hull`
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._grower = None
        self.__dict__.update(state)
        self._solid = self.hull._solid

    def __repr__(self) -> str:
        return (
            f"<{type(self).__name__} of {self.npoints} points in {self.ndim}D: "
            f"{len(self._solid.vertices)} vertices, {self.nsimplex} simplices>"
        )

    @property
    def nsimplex(self) -> int:
        """Number of simplices."""
        return self._solid.simplex_count

    @property
    def area(self) -> float:
        """Surface area; in 2D the perimeter."""
        return self._solid.area

    @property
    def volume(self) -> float:
        """Volume; in 2D the area."""
        return self._solid.volume

    @Lazy
    def hull(self) -> Hull:
        """The native hull."""
        return Hull._of(self._solid)

    @Lazy
    def vertices(self) -> npt.NDArray[Any]:
        """(v,) int32: indices of the vertices, ascending; in 2D counter-clockwise."""
        return self._solid.scipy_vertices()

    @Lazy
    def simplices(self) -> npt.NDArray[Any]:
        """(s, k) int32: indices of the simplices' vertices, oriented outward."""
        return self._solid.scipy_simplices()

    @Lazy
    def neighbors(self) -> npt.NDArray[Any]:
        """(s, k) int32: entry j is the simplex opposite to vertex j."""
        return self._solid.scipy_neighbors()

    @Lazy
    def equations(self) -> npt.NDArray[np.float64]:
        """(s, d + 1) float64: outward unit normal and offset of each simplex."""
        return self._solid.scipy_equations()

    def _extreme(self) -> npt.NDArray[np.float64]:
        corners = self._solid.vertex_points
        if self._options.good_point is not None:  # that point counts too
            corners = np.vstack([corners, self._array[self._options.good_point]])
        return corners

    @Lazy
    def good(self) -> npt.NDArray[np.bool_] | None:
        """(s,) bool with ``QGn``: the simplices visible, or not, from point n; else None."""
        point = self._options.good_point
        if point is None:
            return None
        visible = np.zeros(self.hull.facet_count, dtype=bool)
        visible[self.hull.visible_from(self._array[point])] = True
        if not self._options.good_if_visible:
            visible = ~visible
        return visible[self.hull.simplex_facets]

    @Lazy
    def coplanar(self) -> npt.NDArray[Any]:
        """(c, 3) int32: points that ``Qc`` and ``Qi`` ask for, nearest simplices and vertices."""
        if not (self._options.coplanar or self._options.interior):
            return np.empty((0, 3), dtype=np.int32)
        return _coplanar(self.hull, self._array, self._sides(), self._options)

    # As the native hull has it

    def mesh(self) -> Mesh:
        """The boundary as a mesh of its vertices alone: see `Hull.mesh`.

        Returns
        -------
        Mesh

        Examples
        --------
        >>> import cullhull
        >>> cullhull.ConvexHull([[0, 0], [1, 1], [4, 0], [0, 4]]).mesh().faces.tolist()
        [[0, 2], [1, 0], [2, 1]]
        """
        return self.hull.mesh()

    @documented("path", "format", "crs")
    def save(
        self,
        path: str | os.PathLike[str],
        *,
        format: str = "",
        polygons: bool | None = None,
        crs: str | None = None,
    ) -> None:
        """Writes a file of the hull and its points: see `Hull.save`.

        Parameters
        ----------
        polygons : bool, optional
            As in `Hull.save`.

        Raises
        ------
        FileError (an OSError), InvalidArgument or BadFile (ValueErrors)
            As `Hull.save`.

        Examples
        --------
        >>> import cullhull, os, tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     cullhull.ConvexHull([[0, 0], [4, 0], [0, 4]]).save(os.path.join(folder, "a.wkt"))
        ...     print(open(os.path.join(folder, "a.wkt")).read().strip())
        POLYGON ((0 0, 4 0, 0 4, 0 0))
        """
        self.hull.save(path, self._array, format=format, polygons=polygons, crs=crs)

    def _in_place(self) -> Hull:
        return self.hull

    def _page(self) -> str:
        from ..show._pages import page_of_hull

        return page_of_hull(self._solid, self._array)

    def _sides(self) -> npt.NDArray[np.int8]:
        """-1, 0 or 1 a point: inside, on the boundary, outside."""
        sides: npt.NDArray[np.int8] = self.hull.sides(self._array)
        return sides


def raise_flat(
    points: npt.NDArray[Any], affine_dimension: int, their_class: str = "ConvexHull"
) -> NoReturn:
    """In SciPy's words, as programs match them: it names the numbers at fault, and Qhull's state."""
    kind = qhull_error()
    theirs = of_scipy("scipy.spatial", their_class)
    if theirs is not None:
        try:
            theirs(points.astype(np.float64))
        except RuntimeError as error:
            raise kind(*error.args) from None
    count, dimension = points.shape
    if count <= dimension:
        raise kind(
            f"QH6214 qhull input error: not enough points({count}) to construct initial simplex "
            f"(need {dimension + 1})"
        )
    raise kind(
        f"QH6154 Qhull precision error: Initial simplex is flat (the {count} points span "
        f"{affine_dimension} dimensions of {dimension})"
    )


def _int32(numbers: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """As SciPy's index arrays, unless there are more points than that type can number."""
    if numbers.size and int(numbers.max()) > np.iinfo(np.int32).max:
        return numbers.astype(np.int64)
    return numbers.astype(np.int32)


def _solid_without(
    points: npt.NDArray[Any], left_out: int, chosen: _core.Settings | None
) -> _core.Solid:
    """The hull of all points but one, with the indices of `points`."""
    if left_out >= len(points):
        raise InvalidArgument(f"QG{left_out}: there is no such point among the {len(points)}")
    solid = _core.convex_hull(points, chosen)
    if left_out not in solid.vertices:
        return solid
    rest = np.delete(points, left_out, axis=0)
    return _core.convex_hull(rest, chosen).skipping(left_out)


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

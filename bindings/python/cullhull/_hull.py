"""The native face: hulls and the questions one can ask them."""

from __future__ import annotations

import os
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _core, _show
from ._arguments import Progress, as_points, as_questions, settings
from ._device import as_device_points
from ._errors import InvalidArgument, NotCertified
from ._lists import Lists, ids

Certificate = _core.Certificate


class NearestFacets(NamedTuple):
    """Answer of `Hull.nearest_facets`: one entry a point."""

    #: (m,) int64: the facet on which a nearest point of the boundary lies.
    facets: npt.NDArray[np.int64]
    #: (m,) float64: Euclidean distance to the boundary, negative inside; units of the points.
    distances: npt.NDArray[np.float64]


class Rays(NamedTuple):
    """Answer of `Hull.rays`: where the lines origin + t * direction pass through, one entry each."""

    #: (m,) bool: whether the line meets the hull at all.
    hit: npt.NDArray[np.bool_]
    #: (m,) float64: parameters t of entry and exit, enter <= exit; 0 where there is no hit.
    enter: npt.NDArray[np.float64]
    exit: npt.NDArray[np.float64]
    #: (m,) int64: facets of entry and exit; -1 where there is no hit.
    enter_facets: npt.NDArray[np.int64]
    exit_facets: npt.NDArray[np.int64]


class Simplified(NamedTuple):
    """Answer of `Hull.simplify`."""

    #: The exact hull of the vertices that were kept, with the same numbering of points.
    hull: Hull
    #: Vertices that were dropped.
    dropped: int
    #: No point is farther from `hull`: an upper bound, rounding included; units of the points.
    distance: float


class Hull:
    """An exact convex hull, made by `convex_hull`, `convex_hulls`, `GrowingHull` and others.

    The result is the same, bit for bit, whatever the options, threads and layout of the points.
    Below, n is the number of points, d their dimension and k the dimension of the flat they span
    (`affine_dimension`): for k < d the hull is that of the points inside their flat.

    All arrays are read-only views of the result's own memory; ``.copy()`` them to change them. The
    hull keeps nothing of the points but its vertices' coordinates.
    """

    __slots__ = ("__weakref__", "_solid", "certificate")

    _solid: _core.Solid
    #: What ``certify=True`` found, else None.
    certificate: Certificate | None

    def __init__(self) -> None:
        raise TypeError("hulls are made by cullhull.convex_hull")

    @classmethod
    def _of(cls, solid: _core.Solid) -> Hull:
        hull = object.__new__(cls)
        hull._solid = solid
        hull.certificate = None
        return hull

    # What it is

    @property
    def dimension(self) -> int:
        """d, the number of coordinates of a point."""
        return self._solid.dimension

    @property
    def affine_dimension(self) -> int:
        """k, the dimension of the flat the points span: -1 no points, 0 all equal, ..., d full."""
        return self._solid.affine_dimension

    @property
    def point_count(self) -> int:
        """n, the number of points the hull was computed from."""
        return self._solid.point_count

    @property
    def facet_count(self) -> int:
        """Number of maximal facets."""
        return self._solid.facet_count

    @property
    def simplex_count(self) -> int:
        """Number of simplices the facets are cut into."""
        return self._solid.simplex_count

    @property
    def volume(self) -> float:
        """k-dimensional measure: volume, in the plane area, on a line length."""
        return self._solid.volume

    @property
    def area(self) -> float:
        """(k-1)-dimensional measure of the boundary: surface area, in the plane perimeter."""
        return self._solid.area

    @property
    def centroid(self) -> npt.NDArray[np.float64]:
        """(d,) float64: centre of mass of the hull as a solid; empty for an empty hull."""
        return self._solid.centroid

    @property
    def statistics(self) -> dict[str, Any]:
        """How it was computed: survivors of the filter, its method and why that one, backend,
        threads, seconds, and the orientation decisions by rung (cached plane, filter, exact)."""
        return self._solid.statistics

    # What it consists of

    @property
    def vertices(self) -> npt.NDArray[np.int64]:
        """(v,) int64: indices of the extreme points (of equal points the lowest), ascending; for
        k = 2 counter-clockwise from the lowest index."""
        return ids(self._solid.vertices)

    @property
    def vertex_points(self) -> npt.NDArray[np.float64]:
        """(v, d) float64: coordinates of `vertices`, in their order."""
        return self._solid.vertex_points

    @property
    def facets(self) -> Lists:
        """Maximal facets, coplanar pieces merged: for each the indices of its vertices. For k = 3
        counter-clockwise seen from outside, for k = 2 the two ends counter-clockwise, otherwise
        ascending."""
        return Lists(ids(self._solid.facet_offsets), ids(self._solid.facet_vertices))

    @property
    def facet_neighbours(self) -> Lists:
        """For each facet the facets it shares a ridge with. For k = 3 entry j lies across the edge
        from its vertex j to vertex j + 1; otherwise ascending."""
        return Lists(ids(self._solid.facet_neighbour_offsets), self._solid.facet_neighbours)

    @property
    def facet_planes(self) -> npt.NDArray[np.float64]:
        """(f, d + 1) float64: outward unit normal, then offset, in the points' units:
        ``normal @ x + offset <= 0`` for every point of the hull, up to rounding."""
        return self._solid.facet_planes

    @property
    def simplices(self) -> npt.NDArray[np.int64]:
        """(s, k) int64: the facets cut into simplices, oriented outward."""
        return ids(self._solid.simplices)

    @property
    def simplex_neighbours(self) -> npt.NDArray[np.int32]:
        """(s, k) int32: entry j is the simplex across the ridge opposite to vertex j."""
        return self._solid.simplex_neighbours

    @property
    def simplex_facets(self) -> npt.NDArray[np.int32]:
        """(s,) int32: the facet each simplex is part of."""
        return self._solid.simplex_facets

    # Questions

    def contains(
        self, points: Any, *, threads: int | None = None, progress: Progress = None
    ) -> Any:
        """Whether each point lies in the hull or on its boundary; exact.

        points : (m, d) array, giving an (m,) bool array; or (d,), giving a bool. For a flat hull,
        points off the flat are outside.
        """
        array, single = as_questions(points, self.dimension, "points")
        answer = self._solid.contains(array, settings(threads=threads, progress=progress))
        return bool(answer[0]) if single else answer

    def sides(self, points: Any, *, threads: int | None = None, progress: Progress = None) -> Any:
        """-1 inside, 0 on the boundary, 1 outside; exact. (m, d) to (m,) int8; (d,) to int."""
        array, single = as_questions(points, self.dimension, "points")
        answer = self._solid.sides(array, settings(threads=threads, progress=progress))
        return int(answer[0]) if single else answer

    def distance(
        self, points: Any, *, threads: int | None = None, progress: Progress = None
    ) -> Any:
        """Euclidean distance to the hull in the points' units; inside, minus that to the boundary.

        (m, d) to (m,) float64; (d,) to float. Relative error about 2**-40 of the hull's extent.
        """
        array, single = as_questions(points, self.dimension, "points")
        answer = self._solid.distances(array, settings(threads=threads, progress=progress))
        return float(answer[0]) if single else answer

    def nearest_facets(
        self, points: Any, *, threads: int | None = None, progress: Progress = None
    ) -> NearestFacets:
        """The facet nearest to each of (m, d) points, and the signed distance."""
        array, _ = as_questions(points, self.dimension, "points")
        facets, distances = self._solid.nearest_facets(
            array, settings(threads=threads, progress=progress)
        )
        return NearestFacets(ids(facets), distances)

    def support(
        self, directions: Any, *, threads: int | None = None, progress: Progress = None
    ) -> Any:
        """Index of the vertex farthest along each direction; exact, the lowest index of several.

        (m, d) to (m,) int64; (d,) to int.
        """
        array, single = as_questions(directions, self.dimension, "directions")
        answer = self._solid.supports(array, settings(threads=threads, progress=progress))
        return int(answer[0]) if single else ids(answer)

    def visible_from(self, point: Any) -> npt.NDArray[np.int64]:
        """Indices, ascending, of the facets that the point (d,) lies strictly above; exact."""
        array, single = as_questions(point, self.dimension, "point")
        if not single:
            raise InvalidArgument("`point` should be one point, shape (d,)")
        return ids(self._solid.visible_facets(array, settings()))

    def rays(
        self,
        origins: Any,
        directions: Any,
        *,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Rays:
        """Where the lines ``origin + t * direction`` enter and leave the hull.

        Both (m, d), or one of them (d,) to stand for all. Only for full-dimensional hulls.
        """
        from_, _ = as_questions(origins, self.dimension, "origins")
        to, _ = as_questions(directions, self.dimension, "directions")
        count = max(len(from_), len(to)) if min(len(from_), len(to)) > 0 else 0
        if len(from_) == 1:
            from_ = np.broadcast_to(from_, (count, self.dimension))
        if len(to) == 1:
            to = np.broadcast_to(to, (count, self.dimension))
        hit, enter, exit, first, last = self._solid.rays(
            from_, to, settings(threads=threads, progress=progress)
        )
        return Rays(hit, enter, exit, ids(first), ids(last))

    def certify(
        self, points: Any, *, threads: int | None = None, progress: Progress = None
    ) -> Certificate:
        """Checks the hull against the points it is said to be the hull of: see `certify`."""
        return certify(points, self, threads=threads, progress=progress)

    # With fewer vertices and planes

    def simplify(
        self, distance: float, *, threads: int | None = None, progress: Progress = None
    ) -> Simplified:
        """Drops vertices within `distance` (>= 0, units of the points) of the hull of those kept.

        The result is the exact hull of the kept vertices, so it is certified against those, not
        against all points. It spans the same flat, however large the distance; 0 drops nothing.
        """
        solid, dropped, reached = _core.simplify(
            self._solid, float(distance), settings(threads=threads, progress=progress)
        )
        return Simplified(Hull._of(solid), dropped, reached)

    def shared_planes(self, distance: float) -> npt.NDArray[np.int64]:
        """(f,) int64: for each facet one whose plane is within `distance` of all its vertices.

        ``facet_planes[shared_planes(distance)]`` are the planes of facets that are merged where
        they lie in one plane but for that distance; facets of one plane are connected.
        """
        return ids(_core.shared_planes(self._solid, float(distance)))

    def rounding_distance(self) -> float:
        """How far points of the hull of others may leave it by turns and shifts in doubles.

        A distance for `simplify` and `shared_planes` where coordinates are rounded: 64 d^1.5 2^-53
        times the largest coordinate of a vertex.
        """
        return _core.rounding_distance(self._solid)

    # Out of Python

    def save(
        self, path: str | os.PathLike[str], points: Any = None, *, format: str = ""
    ) -> None:
        """Writes a file: .ply .obj .off .stl (2D and 3D), .json (everything), .txt (as qconvex).

        points : the points the hull was computed from. Without them the file is about the vertices
        alone, numbered in the order of their indices.
        format : overrides the path's extension. The file appears whole or not at all.
        """
        array = None if points is None else as_points(points)
        _core.save(os.fspath(path), self._solid, array, format)

    def plot(self, ax: Any = None, **style: Any) -> Any:
        """Draws a hull in 2D or 3D with Matplotlib and returns the axes.

        style : passed to ``PolyCollection`` or ``Poly3DCollection`` (facecolor, alpha, ...).
        """
        return _show.plot(self, ax, style)

    def view(self, points: Any = None, path: Any = None, *, show: bool = True) -> str:
        """Writes an interactive HTML page of the hull and opens it in a browser.

        points : the points the hull was computed from, to be drawn too (a sample of many).
        path : where to write; a temporary file if not given. Returns the path.
        show : False only writes the page.
        """
        return _show.view(self, points, path, show)

    def _repr_html_(self) -> str:
        return _show.html(self)

    def __repr__(self) -> str:
        flat = "" if self.affine_dimension == self.dimension else (
            f", flat (affine dimension {self.affine_dimension})"
        )
        return (
            f"<Hull of {self.point_count} points in {self.dimension}D{flat}: "
            f"{len(self.vertices)} vertices, {self.facet_count} facets>"
        )


def convex_hull(
    points: Any,
    *,
    backend: str = "auto",
    cull: str = "auto",
    threads: int | None = None,
    memory_budget: int | None = None,
    certify: bool = False,
    progress: Progress = None,
) -> Hull:
    """The exact convex hull of any number of points in any dimension.

    No option changes the result, only how it is reached.

    Parameters
    ----------
    points : (n, d) array
        Read in place, without a copy, for float32, float64, booleans and integers up to 32 bits
        of any strides (slices, Fortran order, memory maps, fields of records), and for DLPack
        arrays on the host. Arrays in a CUDA device's memory (``__cuda_array_interface__``, DLPack)
        are culled there, and only survivors are copied. Other real types are converted to doubles
        if that is exact. It must not change during the call.
    backend : 'auto', 'cpu' or 'cuda'
    cull : 'auto', 'gauge', 'pseudo-hull' or 'none'
        The filter that drops points strictly inside before the hull is computed.
    threads : int, optional
        Threads to use; all the machine offers if not given.
    memory_budget : int, optional
        Bytes to allocate beyond the input; half of the machine's memory (of its
        container's, where that is less) if not given.
    certify : bool
        Check the result with an independent exact test, kept as ``hull.certificate``.
    progress : callable or bool
        Called now and then as ``progress(phase, share)``, share in [0, 1]; it may raise, which
        stops the work. True shows a tqdm bar.

    Raises
    ------
    NotFinite (a ValueError)
        For a NaN or an infinity; names the first bad point.
    OutOfBudget (a MemoryError), BackendUnavailable (a RuntimeError), KeyboardInterrupt
    """
    chosen = settings(
        backend=backend,
        cull=cull,
        threads=threads,
        memory_budget=memory_budget,
        progress=progress,
    )
    device = as_device_points(points)
    if device is not None:
        if certify:
            raise InvalidArgument("certify=True needs points on the host")
        return Hull._of(_core.convex_hull_of_device_points(device, chosen))
    array = as_points(points)
    hull = Hull._of(_core.convex_hull(array, chosen))
    if certify:
        hull.certificate = _core.certify(array, hull._solid, chosen)
        if not hull.certificate:
            raise NotCertified(hull.certificate.reason)
    return hull


def cull(
    points: Any,
    *,
    backend: str = "auto",
    method: str = "auto",
    threads: int | None = None,
    memory_budget: int | None = None,
    progress: Progress = None,
) -> npt.NDArray[np.int64]:
    """Indices, ascending, of points that may be extreme: the filter alone, in front of other code.

    Every extreme point and every duplicate of one is among them; what is dropped lies strictly
    inside the hull. ``points[cullhull.cull(points)]`` has the same hull as ``points``.

    points : (n, d) array; method : 'auto', 'gauge', 'pseudo-hull' or 'none'; the rest as in
    `convex_hull`. Returns an (s,) int64 array.
    """
    chosen = settings(
        backend=backend,
        cull=method,
        threads=threads,
        memory_budget=memory_budget,
        progress=progress,
    )
    device = as_device_points(points)
    if device is not None:
        return ids(_core.cull_device_points(device, chosen))
    return ids(_core.cull(as_points(points), chosen))


def certify(
    points: Any, hull: Hull, *, threads: int | None = None, progress: Progress = None
) -> Certificate:
    """An independent, exact check that ``hull`` is the hull of ``points``, with no engine code.

    Returns a `Certificate`: true if proven, else its ``reason`` names the first thing wrong.
    """
    if not isinstance(hull, Hull):
        raise TypeError(f"hull must be a cullhull.Hull, not {type(hull).__name__}")
    return _core.certify(
        as_points(points), hull._solid, settings(threads=threads, progress=progress)
    )


def generate(
    shape: str, count: int, dimension: int = 3, *, seed: int = 1
) -> npt.NDArray[np.float64]:
    """(count, dimension) float64 test points; `shapes` tells which shapes there are.

    The same arguments give the same bits on every machine.
    """
    return _core.generate(shape, count, dimension, seed).reshape(count, dimension)


def shapes() -> dict[str, str]:
    """The shapes `generate` knows, with a description each."""
    return _core.shapes()

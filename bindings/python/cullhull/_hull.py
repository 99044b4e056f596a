"""A hull, and the questions one can ask it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _core
from ._answers import Mesh
from ._arguments import as_points
from ._lists import Lists
from ._native import Certificate, Certified
from ._options import Unpack, Watched, documented, settings, takes
from ._questions import Questions
from .show._forms import (
    Picture,
    Rows,
    Surface,
    Table,
    VertexIndex,
    fan,
    places,
    polygon_geometry,
    require_drawable,
    require_plane,
    require_polygons,
    require_surface,
)
from .show._shown import Exported

if TYPE_CHECKING:
    from .show._pictures import Page


class Hull(Questions, Exported, Certified):
    """An exact convex hull, made by `convex_hull`, `convex_hulls`, `GrowingHull` and others.

    The result is the same, bit for bit, whatever the options, threads and layout of the points.
    Below, n is the number of points, d their dimension and k the dimension of the flat they span
    (`affine_dimension`): for k < d the hull is that of the points inside their flat.

    All arrays are read-only views of the result's own memory; ``.copy()`` them to change them. The
    hull keeps nothing of the points but its vertices' coordinates. It never changes: copies share
    their memory, and a pickle holds the arrays.

    Attributes
    ----------
    certificate : Certificate or None
        What ``certify=True`` found.

    Raises
    ------
    TypeError
        When called: hulls are made by the functions above.

    Examples
    --------
    >>> import cullhull
    >>> import itertools
    >>> cube = cullhull.convex_hull(list(itertools.product([0, 1], repeat=3)))
    >>> cube
    <Hull of 8 points in 3D: 8 vertices, 6 facets>
    >>> cube.dimension, cube.affine_dimension, cube.point_count
    (3, 3, 8)
    >>> cube.volume, cube.area, cube.centroid
    (1.0, 6.0, array([0.5, 0.5, 0.5]))
    >>> cube.vertices, cube.vertex_points[3]
    (array([0, 1, 2, 3, 4, 5, 6, 7]), array([0., 1., 1.]))
    >>> cube.facets[0], cube.facet_planes[0]
    (array([0, 1, 3, 2]), array([-1.,  0.,  0.,  0.]))
    >>> cube.facet_count, cube.facet_neighbours.lengths()
    (6, array([4, 4, 4, 4, 4, 4]))
    >>> cube.simplex_count, cube.simplices.shape, cube.simplex_neighbours.shape
    (12, (12, 3), (12, 3))
    >>> cube.simplex_facets
    array([0, 1, 0, 2, 2, 1, 3, 3, 4, 4, 5, 5], dtype=int32)
    >>> cube.statistics["backend"]
    'cpu'
    """

    __slots__ = ("_solid",)

    _made_of = ("_solid", "certificate")
    _solid: _core.Solid
    _made_by = "hulls are made by cullhull.convex_hull"

    def __reduce__(self) -> tuple[Any, ...]:
        return _hull_of_state, (_core.state_of_solid(self._solid), self.certificate)

    def _parts(self) -> tuple[Any, ...]:
        return self.dimension, self.point_count, self.vertices, self.vertex_points

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
        return self._solid.vertices

    @property
    def vertex_points(self) -> npt.NDArray[np.float64]:
        """(v, d) float64: coordinates of `vertices`, in their order."""
        return self._solid.vertex_points

    @property
    def points(self) -> npt.NDArray[np.float64]:
        """(v, d) float64: the points that the hull keeps, its vertices; the same as
        `vertex_points`. `vertex_index` has the row of each: ``points[vertex_index[simplices]]`` is
        what ``points[simplices]`` is of SciPy's hull, which holds all points."""
        return self.vertex_points

    @property
    def vertex_index(self) -> VertexIndex:
        """The rows of `points` that belong to indices of vertices: ``vertex_index[simplices]``.
        Any other index is an IndexError.

        >>> import cullhull
        >>> hull = cullhull.convex_hull([[0, 0], [1, 1], [4, 0], [0, 4]])
        >>> hull.vertices, hull.vertex_index[[3, 0]]
        (array([0, 2, 3]), array([2, 0]))
        """
        return VertexIndex(self.vertices)

    @property
    def equations(self) -> npt.NDArray[np.float64]:
        """(s, d + 1) float64: the plane of each of `simplices`, as in SciPy: outward unit normal
        and offset, ``<= 0`` inside. A new array; `facet_planes` has each plane once."""
        return self.facet_planes[self.simplex_facets]

    @property
    def facets(self) -> Lists:
        """Maximal facets, coplanar pieces merged: for each the indices of its vertices. For k = 3
        counter-clockwise seen from outside, for k = 2 the two ends counter-clockwise, otherwise
        ascending."""
        return Lists(self._solid.facet_offsets, self._solid.facet_vertices)

    @property
    def facet_neighbours(self) -> Lists:
        """For each facet the facets it shares a ridge with. For k = 3 entry j lies across the edge
        from its vertex j to vertex j + 1; otherwise ascending."""
        return Lists(self._solid.facet_neighbour_offsets, self._solid.facet_neighbours)

    @property
    def facet_planes(self) -> npt.NDArray[np.float64]:
        """(f, d + 1) float64: outward unit normal, then offset, in the points' units:
        ``normal @ x + offset <= 0`` for every point of the hull, up to rounding."""
        return self._solid.facet_planes

    @property
    def simplices(self) -> npt.NDArray[np.int64]:
        """(s, k) int64: the facets cut into simplices, oriented outward."""
        return self._solid.simplices

    @property
    def simplex_neighbours(self) -> npt.NDArray[np.int32]:
        """(s, k) int32: entry j is the simplex across the ridge opposite to vertex j."""
        return self._solid.simplex_neighbours

    @property
    def simplex_facets(self) -> npt.NDArray[np.int32]:
        """(s,) int32: the facet each simplex is part of."""
        return self._solid.simplex_facets

    @takes(Watched)
    def certify(self, points: Any, **options: Unpack[Watched]) -> Certificate:
        """Checks the hull against the points it is said to be the hull of: see `certify`.

        Parameters
        ----------
        points : (n, d) array

        Returns
        -------
        Certificate

        Raises
        ------
        InvalidArgument (a ValueError)
            For points of another shape or type.

        Examples
        --------
        >>> import cullhull
        >>> points = cullhull.generate("ball", 100)
        >>> cullhull.convex_hull(points).certify(points)
        <Certificate: valid>
        """
        chosen = settings(options, Watched)
        return _core.certify(as_points(points), self._solid, chosen)

    # With fewer vertices and planes

    @takes(Watched)
    def simplify(self, distance: float, **options: Unpack[Watched]) -> Simplified:
        """Drops vertices within `distance` of the hull of those kept.

        The result is the exact hull of the kept vertices, so it is certified against those, not
        against all points. It spans the same flat, however large the distance.

        Parameters
        ----------
        distance : float
            Not negative; in the points' units. 0 drops nothing.

        Returns
        -------
        Simplified
            The hull, how many vertices were dropped, and how far they are at most.

        Raises
        ------
        InvalidArgument (a ValueError)
            For a distance that is negative or not finite.
        KeyboardInterrupt

        Examples
        --------
        >>> import cullhull
        >>> hull = cullhull.convex_hull(cullhull.generate("sphere", 1000, 3))
        >>> small = hull.simplify(0.05)
        >>> small.dropped > 500, small.distance <= 0.05
        (True, True)
        """
        chosen = settings(options, Watched)
        solid, dropped, reached = _core.simplify(self._solid, float(distance), chosen)
        return Simplified(Hull._of(solid), dropped, reached)

    def shared_planes(self, distance: float) -> npt.NDArray[np.int64]:
        """For each facet one whose plane is within `distance` of all its vertices.

        ``facet_planes[shared_planes(distance)]`` are the planes of facets that are merged where
        they lie in one plane but for that distance; facets of one plane are connected.

        Parameters
        ----------
        distance : float
            Not negative; in the points' units. 0 gives each facet itself.

        Returns
        -------
        (f,) int64

        Raises
        ------
        InvalidArgument (a ValueError)
            For a distance that is negative or not finite.

        Examples
        --------
        >>> import cullhull
        >>> hull = cullhull.convex_hull([[0, 0], [1, -1e-9], [2, 0], [1, 1]])
        >>> hull.facet_count, len(set(hull.shared_planes(1e-8).tolist()))
        (4, 3)
        """
        return _core.shared_planes(self._solid, float(distance))

    def rounding_distance(self) -> float:
        """How far points of the hull of others may leave it by turns and shifts in doubles.

        A distance for `simplify` and `shared_planes` where coordinates are rounded.

        Returns
        -------
        float
            64 d^1.5 2^-53 times the largest coordinate of a vertex.

        Examples
        --------
        >>> import cullhull
        >>> f"{cullhull.convex_hull([[0, 0], [1, 0], [0, 1]]).rounding_distance():.2g}"
        '2e-14'
        """
        return _core.rounding_distance(self._solid)

    # Out of Python

    @documented("crs")
    def save(
        self,
        path: str | os.PathLike[str],
        points: Any = None,
        *,
        format: str = "",
        polygons: bool | None = None,
        crs: str | None = None,
    ) -> None:
        """Writes a file: .ply .obj .off .stl .glb .vtp (2D and 3D), .geojson .wkt .gpkg .fgb .shp
        (2D), .json (everything), .txt (as qconvex).

        The file appears whole or not at all.

        Parameters
        ----------
        path : str or path
        points : (n, d) array, optional
            Those the hull was computed from. Without them the file is about the vertices alone,
            numbered in the order of their indices.
        format : str
            Overrides the path's extension.
        polygons : bool, optional
            Whether .ply, .obj, .off and .vtp hold the merged facets as polygons, or the simplices
            as triangles. By default triangles, which every program reads; polygons in .vtp.

        Raises
        ------
        FileError (an OSError)
            Where the system refuses.
        InvalidArgument or BadFile (a ValueError)
            For an unknown format, or one that has no place for the hull's dimension; for
            ``polygons`` with a format that has no choice.

        Examples
        --------
        >>> import cullhull, os, tempfile
        >>> points = cullhull.generate("ball", 100)
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     cullhull.convex_hull(points).save(os.path.join(folder, "hull.ply"), points)
        ...     os.listdir(folder)
        ['hull.ply']
        """
        array = None if points is None else as_points(points)
        require_polygons(path, format, polygons)
        solid = self._solid
        from .geo._maps import save_map  # with what writes files

        save_map(path, format, crs, lambda p, f, c: _core.save(p, solid, array, f, polygons, c))

    def view(  # type: ignore[override]
        self,
        points: Any = None,
        path: str | os.PathLike[str] | None = None,
        *,
        show: bool = True,
    ) -> Page:
        """Writes an interactive HTML page of the hull, in any dimension, and shows it.

        A notebook shows the page below the cell, in a frame; elsewhere a browser opens it. The
        page is one file that needs no network.

        Parameters
        ----------
        points : (n, d) array, optional
            The points that the hull was computed from, to draw them as well (of many a sample).
        path : str or os.PathLike, optional
            Where to write the page; by default a temporary file.
        show : bool
            Open a browser, if this is no notebook.

        Returns
        -------
        str
            The path of the page. A notebook shows the page in its place.

        Raises
        ------
        BackendUnavailable (a RuntimeError)
            If the program was built without the viewer.
        Error
            If the viewer cannot draw the hull.

        Examples
        --------
        >>> import cullhull
        >>> cullhull.convex_hull([[0, 0], [1, 0], [0, 1]]).view()  # doctest: +SKIP
        '/tmp/cullhull-xxxxxxxx.html'
        """
        from .show import _pictures
        from .show._pages import page_of_hull

        return _pictures.shown(page_of_hull(self._solid, points), path, show)

    def mesh(self) -> Mesh:
        """The boundary as a mesh: coordinates of the vertices, and simplices that count them.

        Time and memory are proportional to the number of vertices and simplices.

        Returns
        -------
        Mesh
            ``vertices``, (v, d) float64, are `vertex_points`; ``faces``, (s, k) int64, are
            `simplices` by rows of these.

        Examples
        --------
        >>> import cullhull
        >>> points = [[0, 0], [1, 1], [4, 0], [0, 4]]        # the second one is inside
        >>> vertices, faces = cullhull.convex_hull(points).mesh()
        >>> vertices.tolist(), faces.tolist()
        ([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]], [[0, 2], [1, 0], [2, 1]])
        """
        return Mesh(self.vertex_points, places(self.vertices, self.simplices))

    # As others have it

    def _surface(self) -> Surface:
        k = self.affine_dimension
        require_surface(self.dimension, k, "a hull")
        count = len(self.vertices)
        if k == 2:
            ring = Lists(np.array([0, count], dtype=np.int64), np.arange(count, dtype=np.int64))
            whole = fan(count)
            one = np.zeros(len(whole), dtype=np.int64)
            return Surface(self.vertex_points, self.vertices, ring, whole, one)
        facets = Lists(self._solid.facet_offsets, places(self.vertices, self._solid.facet_vertices))
        rows, simplices = self.mesh()
        return Surface(rows, self.vertices, facets, simplices, self.simplex_facets)

    def _geometry(self) -> dict[str, Any]:
        require_plane(self.dimension, "a hull")
        corners = self.vertex_points
        if self.affine_dimension == 2:
            return polygon_geometry([corners])
        if self.affine_dimension == 1:
            return {"type": "LineString", "coordinates": corners.tolist()}
        if self.affine_dimension == 0:
            return {"type": "Point", "coordinates": corners[0].tolist()}
        return {"type": "GeometryCollection", "geometries": []}

    def _picture(self) -> Picture:
        require_drawable(self.dimension)
        return picture_of([self])

    def _outlines(self) -> list[list[Rows]]:
        """The facets as outlines; a hull in its own plane is one polygon."""
        if self.affine_dimension < 2:
            return []
        surface = self._surface()
        return [[surface.points[polygon]] for polygon in surface.polygons]

    def _shape_count(self) -> int:
        return self.facet_count

    def _table(self) -> Table:
        rows = [
            ("points", f"{self.point_count:,} in {self.dimension}D"),
            ("affine dimension", str(self.affine_dimension)),
            ("vertices", f"{len(self.vertices):,}"),
            ("facets", f"{self.facet_count:,} ({self.simplex_count:,} simplices)"),
            *self._measure_rows(),
            ("computed in", f"{self.statistics['compute_seconds'] * 1e3:.3g} ms"),
        ]
        if self.certificate is not None:
            rows.append(("certified", "yes" if self.certificate else "no"))
        return Table("Convex hull", rows)

    def _measure_rows(self) -> list[tuple[str, str]]:
        """The measures by their names in the dimension that the points span."""
        k = self.affine_dimension
        if k < 1:
            return []
        if k == 1:
            return [("length", f"{self.volume:.6g}")]
        inner, outer = ("area", "perimeter") if k == 2 else ("volume", "area")
        return [(inner, f"{self.volume:.6g}"), (outer, f"{self.area:.6g}")]

    def __repr__(self) -> str:
        flat = "" if self.affine_dimension == self.dimension else (
            f", flat (affine dimension {self.affine_dimension})"
        )
        return (
            f"<Hull of {self.point_count} points in {self.dimension}D{flat}: "
            f"{len(self.vertices)} vertices, {self.facet_count} facets>"
        )


def picture_of(hulls: Sequence[Hull]) -> Picture:
    """The picture of hulls of points in the plane or in space; lines are drawn as lines."""
    polygons = [outline for hull in hulls for outline in hull._outlines()]
    lines = [hull.vertex_points for hull in hulls if hull.affine_dimension == 1]
    flat = [hull.vertex_points for hull in hulls if hull.affine_dimension < 2]
    return Picture(polygons, lines, np.concatenate(flat) if flat else None, surface=True)


def _hull_of_state(state: dict[str, Any], certificate: Certificate | None) -> Hull:
    return Hull._of(_core.solid_of_state(state), certificate)


def load_hull(path: str | os.PathLike[str]) -> Hull:
    """The hull that a .json file holds, of `Hull.save` or of ``cullhull hull -o hull.json``.

    Vertices keep the indices that the file has: those of the points, if these were passed to
    `Hull.save`. Statistics are not in the file, and it is not verified: ``hull.certify(points)``
    does that.

    Parameters
    ----------
    path : str or path

    Returns
    -------
    Hull

    Raises
    ------
    FileError (an OSError)
        Where the system refuses to read.
    BadFile (a ValueError)
        For another file.

    Examples
    --------
    >>> import cullhull, os, tempfile
    >>> points = cullhull.generate("ball", 100)
    >>> hull = cullhull.convex_hull(points)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = os.path.join(folder, "hull.json")
    ...     hull.save(path, points)
    ...     cullhull.load_hull(path) == hull
    True
    """
    return Hull._of(_core.load_hull(os.fspath(path)))


class Simplified(NamedTuple):
    """Answer of `Hull.simplify`.

    Attributes
    ----------
    hull : Hull
        The exact hull of the vertices that were kept, with the same numbering of points.
    dropped : int
        Vertices that were dropped.
    distance : float
        No point is farther from `hull`: an upper bound, rounding included; units of the points.

    Examples
    --------
    >>> import cullhull
    >>> hull = cullhull.convex_hull([[0, 0], [2, 0], [2, 2], [0, 2], [1, 2.01]])
    >>> simplified = hull.simplify(0.1)
    >>> simplified.hull.vertices, simplified.dropped, round(simplified.distance, 4)
    (array([0, 1, 2, 3]), 1, 0.01)
    """

    #: The exact hull of the vertices that were kept, with the same numbering of points.
    hull: Hull
    #: Vertices that were dropped.
    dropped: int
    #: No point is farther from `hull`: an upper bound, rounding included; units of the points.
    distance: float

"""Alpha shapes and concave hulls of points, and the surface around them."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._answers import Mesh
from ._compared import Compared
from ._errors import InvalidArgument
from ._options import Budgeted, Unpack, settings, takes
from ._triangulation import Triangulation, triangulated
from .show._forms import (
    Picture,
    Rows,
    Surface,
    Table,
    multipolygon_geometry,
    places,
    polygon_geometry,
    require_drawable,
    require_plane,
    require_surface,
)
from .show._shown import Exported, Saved

Ids = npt.NDArray[np.int32]


@takes(Budgeted)
def alpha_shape(
    points: Any, alpha: float | str = "one-region", **options: Unpack[Budgeted]
) -> AlphaShape:
    """The alpha shape of points: the Delaunay cells whose circumscribed spheres are small.

    Time is that of `delaunay`, plus a time proportional to the number of cells (times its
    logarithm to choose alpha).

    Parameters
    ----------
    points : (n, d) array, or a `Triangulation` or `Delaunay` of the points
    alpha : float or str
        A number: keep the cells whose circumscribed sphere has at most this radius, compared
        exactly; ``inf`` keeps all cells, which is the convex hull. ``"all-points"``: choose the
        smallest radius at which every point is a vertex of a kept cell. ``"one-region"``: choose
        the smallest such radius at which the kept cells are connected through facets.

    Returns
    -------
    AlphaShape

    Raises
    ------
    NotFinite, InvalidArgument (ValueErrors), TypeError
        As `delaunay`; also if alpha is negative, NaN or an unknown word, and for a furthest-site
        triangulation.
    OutOfBudget (a MemoryError), KeyboardInterrupt

    Examples
    --------
    >>> import cullhull
    >>> corner = [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [0, 2]]
    >>> shape = cullhull.alpha_shape(corner)
    >>> shape.alpha, shape.cells.tolist()
    (0.7071067811865476, [[0, 1, 4], [0, 4, 3], [1, 2, 4], [3, 4, 5]])
    >>> [ring.tolist() for ring in shape.polygons()[0]]
    [[0, 1, 2, 4, 5, 3]]
    """
    chosen = settings(options, Budgeted)
    found = triangulated(points, **options)
    if isinstance(alpha, str):
        if alpha not in ("all-points", "one-region"):
            raise InvalidArgument(
                f'alpha {alpha!r}: expected "one-region", "all-points" or a number >= 0'
            )
        alpha = _core.critical_alpha(found._cells, alpha == "one-region", chosen)
    return AlphaShape(found, float(alpha), *_core.alpha_shape(found._cells, alpha, chosen))


class AlphaShape(Exported, Saved, Compared):
    """An alpha shape, made by `alpha_shape`.

    Attributes
    ----------
    triangulation : Triangulation
    alpha : float
    cell_numbers : (c,) int32 array, ascending
        The cells of the triangulation that the shape keeps.
    facets : (f, k) int32 array
        The boundary: of each facet the indices of its points, oriented outward; rows sorted.
    facet_cells : (f,) int32 array
        The kept cell that each facet belongs to.

    Examples
    --------
    >>> import cullhull
    >>> shape = cullhull.alpha_shape(cullhull.generate("disk", 500, 2, seed=1), 0.2)
    >>> len(shape.polygons())
    1
    """

    __slots__ = ("__weakref__", "alpha", "cell_numbers", "facet_cells", "facets", "triangulation")

    def __init__(
        self,
        triangulation: Triangulation,
        alpha: float,
        cell_numbers: npt.NDArray[np.int32],
        facets: npt.NDArray[np.int32],
        facet_cells: npt.NDArray[np.int32],
    ) -> None:
        self.triangulation, self.alpha = triangulation, alpha
        self.cell_numbers, self.facet_cells = cell_numbers, facet_cells
        self.facets = facets.reshape(len(facet_cells), max(triangulation.affine_dimension, 0))

    def __repr__(self) -> str:
        return (
            f"<AlphaShape of {self.triangulation.point_count} points in "
            f"{self.triangulation.dimension}D: {len(self.cell_numbers)} cells, "
            f"{len(self.facet_cells)} facets, alpha {self.alpha:g}>"
        )

    @property
    def cells(self) -> npt.NDArray[np.int32]:
        """(c, k + 1) int32: indices of the vertices of each cell, as `Triangulation.cells`."""
        return self.triangulation.cells[self.cell_numbers]

    @property
    def points(self) -> npt.NDArray[Any]:
        """(n, d): the points as they were given, as `Triangulation.points`."""
        return self.triangulation.points

    @property
    def dimension(self) -> int:
        """d, the number of coordinates of a point."""
        return self.triangulation.dimension

    def _parts(self) -> tuple[Any, ...]:
        return self.triangulation, self.alpha, self.cell_numbers

    @property
    def area(self) -> float:
        """In 2D the area of the shape, in 3D that of its surface. (`Hull.area` of points in the plane
        is the perimeter, as SciPy has it.)

        Of points that span other than two or three dimensions `InvalidArgument`, a ValueError.

        >>> import cullhull
        >>> shape = cullhull.alpha_shape([[0, 0], [2, 0], [2, 1], [0, 1]])
        >>> shape.area, shape.perimeter
        (2.0, 6.0)
        """
        within, boundary = self._measures(2, 3)
        return boundary if self.triangulation.affine_dimension == 3 else within

    @property
    def perimeter(self) -> float:
        """The length of the boundary of a shape in the plane, with that of its holes. In other
        dimensions `InvalidArgument`, a ValueError."""
        return self._measures(2)[1]

    @property
    def volume(self) -> float:
        """The volume of a shape in space. In other dimensions `InvalidArgument`, a ValueError.

        >>> import cullhull, itertools
        >>> cullhull.alpha_shape(list(itertools.product([0, 1], repeat=3))).volume
        1.0
        """
        return self._measures(3)[0]

    def _measures(self, *dimensions: int) -> tuple[float, float]:
        """The measures of shape and boundary; 0 for points on a line, equal ones and none."""
        found = self.triangulation
        if found.dimension not in dimensions and found.affine_dimension not in dimensions:
            known = " and ".join(f"{d}D" for d in dimensions)
            raise InvalidArgument(f"shapes in {known} have it, not in {found.dimension}D")
        if found.affine_dimension not in dimensions:
            return 0.0, 0.0
        return _core.shape_measures(found._cells, *self._lists())

    def _lists(self) -> tuple[Ids, Ids, Ids]:
        """The shape as `_core` takes it."""
        cells, owners = map(np.ascontiguousarray, (self.cell_numbers, self.facet_cells))
        return cells, np.ascontiguousarray(self.facets).ravel(), owners

    def _measure_rows(self) -> list[tuple[str, str]]:
        k = self.triangulation.affine_dimension
        names = {2: ("area", "perimeter"), 3: ("volume", "area")}.get(k, ())
        return [(name, f"{getattr(self, name):.6g}") for name in names]

    def polygons(self) -> list[list[npt.NDArray[np.int32]]]:
        """The shape of points in the plane as polygons, one for each piece.

        Returns
        -------
        list of lists of int32 arrays
            Of each polygon its rings as indices of points: the outer one, counter-clockwise, then
            holes, clockwise; none closed by its first point again. Rings touch in single points at
            most, as GeoJSON, WKT and Shapely want it.

        Raises
        ------
        InvalidArgument (a ValueError)
            For points that span more than two dimensions.

        Examples
        --------
        >>> import cullhull
        >>> cullhull.alpha_shape([[0, 0], [1, 0], [0, 1]]).polygons()[0][0].tolist()
        [0, 1, 2]
        """
        ids, rings, polygons = _core.cell_polygons(
            self.triangulation._cells, self.cell_numbers, None
        )
        return [
            [ids[rings[ring] : rings[ring + 1]] for ring in range(begin, end)]
            for begin, end in zip(polygons[:-1].tolist(), polygons[1:].tolist())
        ]

    def mesh(self) -> Mesh:
        """The boundary as a mesh: coordinates of its points, and `facets` that count them.

        Time and memory are proportional to the size of the boundary, times a logarithm.

        Returns
        -------
        Mesh
            ``vertices``, (v, d) float64, in the order of their indices, and ``faces``, (f, k)
            int64.

        Examples
        --------
        >>> import cullhull
        >>> vertices, faces = cullhull.alpha_shape([[0, 0], [0, 0], [4, 0], [0, 4]]).mesh()
        >>> vertices.tolist(), faces.tolist()
        ([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]], [[0, 1], [1, 2], [2, 0]])
        """
        return self.triangulation._mesh_of(self.facets)[0]

    # As others have it

    def _surface(self) -> Surface:
        found = self.triangulation
        require_surface(found.dimension, found.affine_dimension, "a shape")
        return found._triangles(self.facets if found.affine_dimension == 3 else self.cells)

    def _rows(self) -> Rows:
        return np.asarray(self.points, dtype=np.float64)

    def _polygon_rows(self) -> list[list[Rows]]:
        """`polygons`, as coordinates."""
        rows = np.asarray(self.points)
        return [[rows[ring].astype(np.float64) for ring in rings] for rings in self.polygons()]

    def _geometry(self) -> dict[str, Any]:
        require_plane(self.dimension, "a shape")
        flat = self._flat_geometry()
        return multipolygon_geometry(self._polygon_rows()) if flat is None else flat

    def _flat_geometry(self) -> dict[str, Any] | None:
        """Lines of points on a line, a point of equal ones; None for polygons, or without cells."""
        found = self.triangulation
        rows = self._rows()
        if found.affine_dimension > 1 or len(self.cell_numbers) == 0:
            return None
        if found.affine_dimension == 0:
            return {"type": "Point", "coordinates": rows[self.cells[0, 0]].tolist()}
        ends = rows[self.facets[:, 0]]
        ends = ends[np.argsort(ends[:, found.axes[0]])].reshape(-1, 2, 2)
        if len(ends) == 1:
            return {"type": "LineString", "coordinates": ends[0].tolist()}
        return {"type": "MultiLineString", "coordinates": ends.tolist()}

    def _picture(self) -> Picture:
        found = self.triangulation
        require_drawable(found.dimension)
        if found.affine_dimension == 3:
            return Picture([[triangle] for triangle in self._rows()[self.facets]], surface=True)
        if found.affine_dimension == 2 and found.dimension == 2:
            return Picture(self._polygon_rows())
        rows = self._rows()[self.cells]
        if found.affine_dimension == 2:
            return Picture([[triangle] for triangle in rows])
        lines = rows if found.affine_dimension == 1 else ()
        return Picture(segments=lines, dots=rows.reshape(-1, found.dimension))

    def _shape_count(self) -> int:
        return len(self.facet_cells)

    def _table(self) -> Table:
        found = self.triangulation
        return Table(
            "Alpha shape",
            [
                ("points", f"{found.point_count:,} in {found.dimension}D"),
                ("alpha", f"{self.alpha:.6g}"),
                ("cells", f"{len(self.cell_numbers):,} of {found.cell_count:,}"),
                ("facets of the boundary", f"{len(self.facet_cells):,}"),
                *self._measure_rows(),
            ],
        )

    def _write(self, path: str, format: str, crs: str = "") -> None:
        shape, alpha = self._lists(), self._alpha_written()
        _core.save_alpha_shape(path, self.triangulation._cells, *shape, alpha, format, crs)

    def _alpha_written(self) -> float:
        return self.alpha

    def _page(self) -> str:
        from .show._pages import page_of_surface

        return page_of_surface(self._surface(), self._page_edges(), self._table())

    def _page_edges(self) -> npt.NDArray[np.int64] | None:
        """In the plane the boundary alone is drawn by lines."""
        found = self.triangulation
        if found.affine_dimension != 2:
            return None
        return places(np.unique(self.cells), self.facets)


@takes(Budgeted)
def concave_hull(
    points: Any,
    ratio: float | None = None,
    *,
    edge_length: float | None = None,
    **options: Unpack[Budgeted],
) -> ConcaveHull:
    """The concave hull of points in a plane: one ring without holes, around all points.

    The algorithm starts from the convex hull. It removes the longest edge of the boundary together
    with its Delaunay triangle, as long as that edge is longer than a limit and the boundary remains
    one simple ring (Duckham and others, 2008, "chi-shape"). Time O(n log n).

    Parameters
    ----------
    points : (n, d) array, or a `Triangulation` or `Delaunay` of the points
    ratio : float, optional
        The limit, from 0, the shortest edge of the triangulation, to 1, the longest; 1 gives the
        convex hull.
    edge_length : float, optional
        The limit as a length, in the units of the points, compared exactly. Pass either ``ratio``
        or ``edge_length``.

    Returns
    -------
    ConcaveHull

    Raises
    ------
    NotFinite, InvalidArgument (ValueErrors), TypeError
        As `delaunay`; also for points that span more than two dimensions, numbers out of range,
        and triangulations of the furthest site or with hidden points.
    OutOfBudget (a MemoryError), KeyboardInterrupt

    Examples
    --------
    >>> import cullhull
    >>> corner = [[0, 0], [4, 0], [0, 4], [1, 1]]
    >>> cullhull.concave_hull(corner, edge_length=5).ring.tolist()
    [0, 1, 3, 2]
    >>> cullhull.concave_hull(corner, 1).ring.tolist()
    [0, 1, 2]
    """
    if edge_length is None and ratio is not None:
        number = ratio
    elif edge_length is not None and ratio is None:
        number = edge_length
    else:
        raise InvalidArgument("concave_hull needs either a ratio or an edge_length")
    chosen = settings(options, Budgeted)
    found = triangulated(points, **options)
    return ConcaveHull(
        found, *_core.concave_hull(found._cells, float(number), ratio is not None, chosen)
    )


class ConcaveHull(AlphaShape):
    """A concave hull by the length of edges, made by `concave_hull`.

    Attributes
    ----------
    edge_length : float
        The limit. A longer edge remains where its removal would have broken the ring.
    alpha : float
        Infinite: cells of any size may remain. All other attributes are those of `AlphaShape`.

    Examples
    --------
    >>> import cullhull
    >>> hull = cullhull.concave_hull(cullhull.generate("disk", 500, 2, seed=1), 0.3)
    >>> len(hull.polygons()), len(hull.polygons()[0])
    (1, 1)
    """

    __slots__ = ("edge_length",)

    def __init__(
        self,
        triangulation: Triangulation,
        edge_length: float,
        cell_numbers: npt.NDArray[np.int32],
        facets: npt.NDArray[np.int32],
        facet_cells: npt.NDArray[np.int32],
    ) -> None:
        super().__init__(triangulation, float("inf"), cell_numbers, facets, facet_cells)
        self.edge_length = edge_length

    def __repr__(self) -> str:
        return (
            f"<ConcaveHull of {self.triangulation.point_count} points: "
            f"{len(self.facet_cells)} edges, replaced where longer than {self.edge_length:g}>"
        )

    def _parts(self) -> tuple[Any, ...]:
        return self.triangulation, self.edge_length, self.cell_numbers

    def _geometry(self) -> dict[str, Any]:
        require_plane(self.dimension, "a hull")
        flat = self._flat_geometry()
        if flat is not None:
            return flat
        polygons = self._polygon_rows()
        if polygons:
            return polygon_geometry(polygons[0])
        return {"type": "Polygon", "coordinates": []}

    def _table(self) -> Table:
        found = self.triangulation
        return Table(
            "Concave hull",
            [
                ("points", f"{found.point_count:,} in {found.dimension}D"),
                ("boundary edges longer than this are replaced", f"{self.edge_length:.6g}"),
                ("edges of the boundary", f"{len(self.facet_cells):,}"),
                *self._measure_rows(),
            ],
        )

    def _alpha_written(self) -> float:
        return float("nan")

    @property
    def ring(self) -> npt.NDArray[np.int32]:
        """(m,) int32: indices of points around the hull, counter-clockwise from the lowest."""
        polygons = self.polygons()
        return polygons[0][0] if polygons else np.empty(0, np.int32)


@takes(Budgeted)
def alpha_radii(points: Any, **options: Unpack[Budgeted]) -> npt.NDArray[np.float64]:
    """The smallest alpha whose alpha shape contains each Delaunay cell.

    Parameters
    ----------
    points : (n, d) array, or a triangulation: of `delaunay` or a `Delaunay`

    Returns
    -------
    (c,) float64 array
        For each cell the radius of its circumscribed sphere, rounded up to a double, so that a
        comparison with any alpha is exact.

    Raises
    ------
    NotFinite, InvalidArgument (ValueErrors), TypeError, OutOfBudget, KeyboardInterrupt
        As `alpha_shape`.

    Examples
    --------
    >>> import cullhull
    >>> cullhull.alpha_radii([[0, 0], [6, 0], [0, 8]]).tolist()
    [5.0]
    """
    chosen = settings(options, Budgeted)
    found = triangulated(points, **options)
    return _core.alpha_radii(found._cells, chosen)

"""Ours in the place of SciPy's, trimesh's and PyVista's, in one call: `patch` and `unpatch`."""

from __future__ import annotations

import functools
import threading
from typing import Any, Callable, NamedTuple

import numpy as np

from . import _functions, _triangulation
from ._errors import InvalidArgument
from ._extras import needed
from .scipy import _convex_hull, _delaunay, _halfspaces, _interpolation, _spherical, _tolerant
from .scipy import _voronoi


class ConvexHull(_convex_hull.ConvexHull):
    """`cullhull.ConvexHull` with SciPy's error for flat points, which programs catch."""

    def __init__(
        self, points: Any, incremental: bool = False, qhull_options: str | None = None
    ) -> None:
        super().__init__(points, incremental, qhull_options, strict=True)


class HullForTrimesh(_tolerant.TolerantConvexHull):
    """`cullhull.TolerantConvexHull` without the warning that QbB has no effect: trimesh asks for it."""

    def __init__(
        self, points: Any, incremental: bool = False, qhull_options: str | None = None
    ) -> None:
        super().__init__(points, incremental, qhull_options and qhull_options.replace("QbB", ""))


class _Place(NamedTuple):
    """A name of a module or class, and what is to stand there."""

    owner: Any
    name: str
    ours: Any


def _of_scipy() -> list[_Place]:
    spatial = needed("scipy.spatial", "patch('scipy')", "scipy")
    interpolate = needed("scipy.interpolate", "patch('scipy')", "scipy")
    classes = (
        ConvexHull,
        _delaunay.Delaunay,
        _delaunay.tsearch,
        _halfspaces.HalfspaceIntersection,
        _spherical.SphericalVoronoi,
        _voronoi.Voronoi,
    )
    interpolators = (
        _interpolation.LinearNDInterpolator,
        _interpolation.NearestNDInterpolator,
        _interpolation.griddata,
    )
    return [_Place(spatial, ours.__name__, ours) for ours in classes] + [
        _Place(interpolate, ours.__name__, ours) for ours in interpolators
    ]


def _of_trimesh() -> list[_Place]:
    modules = [needed(f"trimesh.{m}", "patch('trimesh')", "mesh") for m in ("convex", "bounds")]
    return [_Place(module, "ConvexHull", HullForTrimesh) for module in modules]


def _of_pyvista() -> list[_Place]:
    pyvista = needed("pyvista", "patch('pyvista')", "mesh")
    filters = needed("pyvista.core.filters", "patch('pyvista')", "mesh")
    of_objects = getattr(filters, "DataObjectFilters", filters.DataSetFilters)  # since PyVista 0.45
    makers = (
        (filters.DataSetFilters, "delaunay_3d", _delaunay_3d),
        (of_objects, "convex_hull", _hull_of_mesh),  # since PyVista 0.49
    )
    return [
        _Place(owner, name, make(vars(owner)[name], pyvista))
        for owner, name, make in makers
        if name in vars(owner)
    ]


def _hull_of_mesh(theirs: Any, pyvista: Any) -> Any:
    @functools.wraps(theirs)
    def convex_hull(self: Any, *, dimensionality: Any = 3, progress_bar: bool = False) -> Any:
        many = isinstance(self, pyvista.MultiBlock)
        blocks = [*self.recursive_iterator(skip_empty=True, skip_none=True)] if many else [self]
        points = np.vstack([block.points for block in blocks]) if blocks else np.empty((0, 3))
        kind = dimensionality
        if kind == "auto" and len(points):
            kind = (pyvista.PointSet(points) if many else self).dimensionality
        hull = _functions.convex_hull(points) if kind == 3 else None
        if hull is None or hull.affine_dimension < 3:  # VTK projects to a plane
            return theirs(self, dimensionality=dimensionality, progress_bar=progress_bar)
        corners = np.sort(hull.vertices)
        faces = np.searchsorted(corners, hull.simplices)
        mesh = pyvista.PolyData.from_regular_faces(points[corners], faces)
        if match := getattr(pyvista.core.filters, "_match_points_dtype", None):  # a setting of 0.49
            given = pyvista.PointSet(points) if many else self
            match(mesh, given, algorithm="cullhull.convex_hull")
        if not many:
            mesh.field_data.update(self.field_data)
        return mesh

    return convex_hull


def _delaunay_3d(theirs: Any, pyvista: Any) -> Any:
    @functools.wraps(theirs)
    def delaunay_3d(
        self: Any,
        alpha: float = 0.0,
        tol: float = 0.001,
        offset: float = 2.5,
        progress_bar: bool = False,
    ) -> Any:
        found = _triangulation.delaunay(self.points) if alpha == 0 else None
        if found is None or found.affine_dimension < 3:  # VTK's alpha keeps edges and faces, too
            return theirs(self, alpha=alpha, tol=tol, offset=offset, progress_bar=progress_bar)
        cells = {pyvista.CellType.TETRA: found.cells}
        grid = pyvista.UnstructuredGrid(cells, np.array(self.points))
        grid.GetPointData().ShallowCopy(self.GetPointData())  # and which arrays are active
        grid.field_data.update(self.field_data)
        grid.copy_meta_from(self, deep=True)
        return grid

    return delaunay_3d


class _Package:
    """What is in place of a package, and for whom. Ours stand there while a call of `patch` is in
    force (`calls`, of which `unpatch` ends all at once) or a ``with`` block is open."""

    def __init__(self, places: Callable[[], list[_Place]]) -> None:
        self.places = places
        self.calls = 0
        self.ended = 0  #: how often `unpatch` has ended calls
        self.blocks = 0
        self.replaced: list[tuple[_Place, Any]] = []

    def restore(self, name: str) -> None:
        """Puts back all that stood there, or nothing."""
        if self.calls or self.blocks:
            return
        for place, _ in self.replaced:
            there = vars(place.owner).get(place.name)
            if there is not place.ours:
                raise InvalidArgument(
                    f"unpatch({name!r}): {place.owner.__name__}.{place.name} is no longer ours but "
                    f"{getattr(there, '__module__', type(there).__name__)}'s; undo that first"
                )
        for place, theirs in self.replaced:
            setattr(place.owner, place.name, theirs)
        self.replaced = []


_PACKAGES = {
    "scipy": _Package(_of_scipy),
    "trimesh": _Package(_of_trimesh),
    "pyvista": _Package(_of_pyvista),
}
_lock = threading.RLock()


def _named(packages: tuple[str, ...], function: str) -> dict[str, _Package]:
    for name in packages:
        if name not in _PACKAGES:
            known = ", ".join(map(repr, _PACKAGES))
            raise InvalidArgument(f"{function}({name!r}): there are {known}")
    if not packages:
        raise InvalidArgument(f"{function}() needs the name of a package, as {function}('scipy')")
    return {name: _PACKAGES[name] for name in packages}


class Patched:
    """What `patch` returns: a context manager, whose end undoes this call alone."""

    def __init__(self, packages: dict[str, _Package]) -> None:
        self._packages = packages
        self._calls = {name: package.ended for name, package in packages.items()}

    def __repr__(self) -> str:
        return f"<Patched {', '.join(self._packages)}>"

    def __enter__(self) -> Patched:
        with _lock:
            _put(self._packages)
            for name, package in self._packages.items():
                package.blocks += 1
                if self._calls.pop(name, None) == package.ended:
                    package.calls -= 1  # from now on the block keeps ours in place, not the call
        return self

    def __exit__(self, *_: object) -> None:
        with _lock:
            for package in self._packages.values():
                package.blocks -= 1
            _restore(self._packages)


def _restore(packages: dict[str, _Package]) -> None:
    """Of all packages; then raises the first fault, of one whose names are no longer ours."""
    faults = []
    for name, package in packages.items():
        try:
            package.restore(name)
        except InvalidArgument as fault:
            faults.append(fault)
    if faults:
        raise faults[0]


def _put(packages: dict[str, _Package]) -> None:
    places = {name: p.places() for name, p in packages.items() if not p.replaced}
    for name, found in places.items():
        for place in found:
            if place.name in vars(place.owner):  # versions differ
                packages[name].replaced.append((place, vars(place.owner)[place.name]))
                setattr(place.owner, place.name, place.ours)


def patch(*packages: str) -> Patched:
    """Puts ours in place of a package's hulls and triangulations, in the whole process.

    ``"scipy"``: `ConvexHull` (which raises `QhullError` for flat points, as SciPy's), `Delaunay`,
    `HalfspaceIntersection`, `Voronoi`, `SphericalVoronoi` and `tsearch` of scipy.spatial;
    `LinearNDInterpolator`, `NearestNDInterpolator` and `griddata` of scipy.interpolate.
    ``"trimesh"``: `TolerantConvexHull` for all that trimesh.convex and trimesh.bounds compute, so
    `Trimesh.convex_hull`, too. ``"pyvista"``: `convex_hull` of three dimensions and `delaunay_3d`
    without alpha. docs/coming-from/patch.md in the source tree says what is not reached.

    Names that another module has imported before keep what they had: call this first. Calling it
    twice is as calling it once. In a ``with`` statement ours stand there until the last block ends.

    Parameters
    ----------
    *packages : "scipy", "trimesh" or "pyvista"

    Returns
    -------
    Patched: a context manager

    Raises
    ------
    ImportError
        If a package is not installed; nothing is replaced then.
    InvalidArgument (a ValueError)
        For another name.

    Examples
    --------
    >>> import cullhull, scipy.spatial
    >>> with cullhull.patch("scipy"):
    ...     scipy.spatial.ConvexHull([[0, 0], [1, 0], [0, 1]])
    <ConvexHull of 3 points in 2D: 3 vertices, 3 simplices>
    >>> scipy.spatial.ConvexHull.__module__
    'scipy.spatial._qhull'
    """
    named = _named(packages, "patch")
    with _lock:
        _put(named)
        for package in named.values():
            package.calls += 1
        return Patched(named)


def unpatch(*packages: str) -> None:
    """Puts back what `patch` has replaced; does nothing where that is back already.

    ``with`` blocks that are still open keep ours until they end.

    Parameters
    ----------
    *packages : "scipy", "trimesh" or "pyvista"

    Returns
    -------
    None

    Raises
    ------
    InvalidArgument (a ValueError)
        For another name; and where something else has since been put in the place of ours. Then
        nothing of that package changes.

    Examples
    --------
    >>> import cullhull, scipy.spatial
    >>> _ = cullhull.patch("scipy")
    >>> cullhull.unpatch("scipy")
    >>> scipy.spatial.Delaunay.__module__
    'scipy.spatial._qhull'
    """
    with _lock:
        named = _named(packages, "unpatch")
        calls = {name: package.calls for name, package in named.items()}
        for package in named.values():
            package.calls = 0
        try:
            _restore(named)
        finally:
            for name, package in named.items():
                if package.replaced and not package.blocks:
                    package.calls = calls[name]  # refused: all of it is as it was
                else:
                    package.ended += 1

"""The class that stands in for scipy.spatial.Voronoi."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .. import _core
from .._lists import collector_paused
from .._options import Budgeted, settings, takes
from .._voronoi import VoronoiDiagram
from ..show._shown import Saved, Shown
from ._delaunay import Lifted
from ._incremental import Lazy

#: The attributes that are made of the native diagram.
_MADE_OF_DIAGRAM = ("vertices", "ridge_points", "ridge_vertices", "regions")


@takes(Budgeted)
class Voronoi(Shown, Saved, Lifted):
    """In place of `scipy.spatial.Voronoi`: the same attributes, exact, and faster.

    It can be pickled, copied and sent between processes, also while incremental. `plot`, `view` and
    `save` show the native diagram.

    Parameters
    ----------
    points : (n, d) array, d >= 2
        Read in place where `convex_hull` does so.
    furthest_site : bool
        Compute the furthest-site diagram.
    incremental : bool
        Allow `add_points`.
    qhull_options : str, optional
        As in SciPy, ``Qbb Qc Qz`` if not given, ``Qc`` if incremental. With ``Qz`` the first region
        is empty: that of a point at infinity. Without ``Qc`` duplicates have no region. Other
        options are accepted or refused as in `ConvexHull`.

    Attributes
    ----------
    points : (n, d) float64
    vertices : (v, d) float64, each the nearest double to the exact coordinate; vertices that
        coincide are one
    ridge_points : (r, 2) int32: pairs of points whose regions share a face
    ridge_vertices : list of lists of int: the vertices of each of these faces, in 2D and 3D in
        order around it; -1 is infinity
    ridge_dict : dict from pairs of points to the lists of ridge_vertices
    regions : list of lists of int: the vertices of each region, in 2D in order around it; -1 is
        infinity
    point_region : (n,) int64: the region of each point; -1 if it has none
    ndim, npoints : int
    min_bound, max_bound : (d,) float64
    furthest_site : bool
    triangulation, diagram : the native `Triangulation` and `VoronoiDiagram`

    Raises
    ------
    InvalidArgument, NotFinite (ValueErrors), TypeError, OutOfBudget, KeyboardInterrupt
        As `ConvexHull`.
    QhullError (a RuntimeError)
        If the points lie in a hyperplane. `voronoi` accepts these.

    Examples
    --------
    >>> import cullhull
    >>> found = cullhull.Voronoi([[0, 0], [2, 0], [0, 2], [2, 2], [1, 1]])
    >>> found
    <Voronoi of 5 points in 2D: 4 vertices>
    >>> found.regions[found.point_region[4]]
    [0, 2, 3, 1]
    >>> found.ridge_dict[0, 4]
    [1, 0]
    """

    def __repr__(self) -> str:
        kind = type(self).__name__
        return f"<{kind} of {self.npoints} points in {self.ndim}D: {len(self.vertices)} vertices>"

    @Lazy
    def diagram(self) -> VoronoiDiagram:
        """The native diagram."""
        return self._dual

    @Lazy
    def _dual(self) -> VoronoiDiagram:
        """The native diagram, until all that is made of it has been made."""
        chosen = {k: v for k, v in self._choices.items() if k != "memory_budget"}
        diagram = _core.voronoi(self.triangulation._cells, settings(chosen))
        return VoronoiDiagram._of(self.triangulation, diagram)

    #: Of a subclass what its attributes are made of, where that is no native diagram.
    _shown: Any = None

    @Lazy
    def _integers(self) -> list[int]:
        """The integers in the lists, while some are to be made."""
        return list(range(len(self._dual._diagram.vertices)))

    def _lists(self, name: str) -> list[list[int]]:
        """The ridges or the regions; the collector would look through the lists that are made."""
        shown = self._shown
        if shown is not None:
            found: list[list[int]] = getattr(shown, f"{name}s").tolist()
            return found
        make, numbers = getattr(self._dual._diagram, f"{name}_lists"), self._integers
        if self.npoints < 200:
            found = make(numbers)
        else:
            with collector_paused():
                found = make(numbers)
        self._let_go("ridge_vertices" if name == "ridge" else "regions")
        return found

    def _let_go(self, made: str) -> None:
        """Frees what no attribute is to be made of any more. `made`: the one that is being made."""
        held = self.__dict__
        for name in _MADE_OF_DIAGRAM:
            if name not in held and name != made:
                return
        held.pop("_integers", None)
        held.pop("_dual", None)

    @Lazy
    def vertices(self) -> npt.NDArray[np.float64]:
        """(v, d) float64: coordinates of the vertices."""
        shown = self._shown
        if shown is None:
            return self._dual._diagram.scipy_vertices()
        rows: npt.NDArray[np.float64] = shown.vertices.copy()
        return rows

    @Lazy
    def ridge_points(self) -> npt.NDArray[np.int32]:
        """(r, 2) int32: pairs of points whose regions share a face."""
        shown = self._shown
        if shown is None:
            return self._dual._diagram.scipy_ridge_points()
        pairs: npt.NDArray[np.int32] = shown.ridge_points.copy()
        return pairs

    @Lazy
    def ridge_vertices(self) -> list[list[int]]:
        """For each of `ridge_points` the vertices of the face; -1 is at infinity."""
        return self._lists("ridge")

    @Lazy
    def ridge_dict(self) -> dict[tuple[int, int], list[int]]:
        """From pairs of points, as in `ridge_points`, to lists of vertices."""
        first, second = self.ridge_points.T.tolist()
        with collector_paused():
            return dict(zip(zip(first, second), self.ridge_vertices))

    @Lazy
    def regions(self) -> list[list[int]]:
        """The vertices of each region; -1 is at infinity."""
        found = self._lists("region")
        if len(self.triangulation._cells.duplicates):
            found = [found[i] for i in self._sites.tolist()]
        if self._has_empty:
            found.insert(0, [])
        return found

    @Lazy
    def point_region(self) -> npt.NDArray[np.int64]:
        """(n,) int64: the region of each point."""
        first = int(self._has_empty)
        equal = self.triangulation._cells.duplicates
        if len(equal) == 0:
            return np.arange(first, first + self.npoints, dtype=np.int64)
        number = np.full(self.npoints, -1, dtype=np.int64)
        number[self._sites] = np.arange(first, first + len(self._sites))
        if self._options.coplanar:
            number[equal[:, 0]] = number[equal[:, 1]]
        return number

    @property
    def _sites(self) -> npt.NDArray[np.int64]:
        """Points that have a region of their own, be it empty."""
        site = np.ones(self.npoints, dtype=bool)
        site[self.triangulation.duplicates[:, 0]] = False
        return np.flatnonzero(site).astype(np.int64, copy=False)

    @property
    def _has_empty(self) -> bool:
        """Whether the first region is that of the point at infinity."""
        return self._options.at_infinity and not self.furthest_site

    # As the native diagram has it

    def _write(self, path: str, format: str, crs: str = "") -> None:
        self.diagram._write(path, format, crs)

    def _in_place(self) -> VoronoiDiagram:
        return self.diagram

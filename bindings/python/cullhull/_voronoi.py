"""The class that stands in for scipy.spatial.Voronoi."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ._delaunay import Lifted
from ._diagram import VoronoiDiagram, voronoi
from ._incremental import Lazy
from ._lists import collector_paused


class Voronoi(Lifted):
    """In place of `scipy.spatial.Voronoi`: the same attributes, exact, and faster.

    Pickles, copies and is sent between processes; also while incremental.

    Parameters
    ----------
    points : as of `Delaunay`
    furthest_site : bool
        The diagram of the furthest point.
    incremental : bool
        Allow `add_points`.
    qhull_options : str, optional
        As in SciPy ``Qbb Qc Qz`` if not given, ``Qc`` if incremental. With ``Qz`` there is an empty
        region, of a point at infinity; without ``Qc`` duplicates have no region. Others are
        accepted or refused as in `ConvexHull`.
    threads, memory_budget, progress : as in `convex_hull`

    Attributes
    ----------
    points : (n, d) float64
    vertices : (v, d) float64, each the nearest doubles; no two stand for one
    ridge_points : (r, 2) int32: pairs of points whose regions share a face
    ridge_vertices : list of lists of int: its vertices, in 2D and 3D in order; -1 is at infinity
    ridge_dict : dict from pairs of points to these lists
    regions : list of lists of int: the vertices of each region; in 2D in order
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
        For points that lie in a plane or a line. `voronoi` accepts these.

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
        threads, _, progress = self._choices
        return voronoi(self.triangulation, threads=threads, progress=progress)

    @property
    def _shown(self) -> Any:
        """What the attributes are made of: a diagram's vertices, ridges and regions."""
        return self.diagram

    @Lazy
    def vertices(self) -> npt.NDArray[np.float64]:
        """(v, d) float64: coordinates of the vertices."""
        rows: npt.NDArray[np.float64] = self._shown.vertices.copy()
        return rows

    @Lazy
    def ridge_points(self) -> npt.NDArray[np.int32]:
        """(r, 2) int32: pairs of points whose regions share a face."""
        pairs: npt.NDArray[np.int32] = self._shown.ridge_points.copy()
        return pairs

    @Lazy
    def ridge_vertices(self) -> list[list[int]]:
        """For each of `ridge_points` the vertices of the face; -1 is at infinity."""
        lists: list[list[int]] = self._shown.ridges.tolist()
        return lists

    @Lazy
    def ridge_dict(self) -> dict[tuple[int, int], list[int]]:
        """From pairs of points, as in `ridge_points`, to lists of vertices."""
        first, second = self.ridge_points.T.tolist()
        with collector_paused():
            return dict(zip(zip(first, second), self.ridge_vertices))

    @Lazy
    def regions(self) -> list[list[int]]:
        """The vertices of each region; -1 is at infinity."""
        each = self._shown.regions.tolist()
        mine: list[list[int]] = [each[i] for i in self._sites.tolist()]
        return [[], *mine] if self._has_empty else mine

    @Lazy
    def point_region(self) -> npt.NDArray[np.int64]:
        """(n,) int64: the region of each point."""
        number = np.full(self.npoints, -1, dtype=np.int64)
        number[self._sites] = np.arange(len(self._sites)) + self._has_empty
        if self._options.coplanar:
            equal = self.triangulation.duplicates
            number[equal[:, 0]] = number[equal[:, 1]]
        return number

    @property
    def _sites(self) -> npt.NDArray[np.intp]:
        """Points that have a region of their own, be it empty."""
        site = np.ones(self.npoints, dtype=bool)
        site[self.triangulation.duplicates[:, 0]] = False
        return np.flatnonzero(site)

    @property
    def _has_empty(self) -> bool:
        """Whether the first region is that of the point at infinity."""
        return self._options.at_infinity and not self.furthest_site

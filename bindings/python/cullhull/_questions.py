"""The questions one can ask a hull about points and directions."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._answers import NearestFacets, Rays
from ._arguments import as_questions
from ._device import DeviceArray, as_device_points
from ._errors import InvalidArgument
from ._options import Asked, Unpack, Watched, settings, takes


class Questions:
    """The part of `Hull` that answers them, from the native hull alone."""

    __slots__ = ()

    _solid: _core.Solid

    def _ask(self, question: str, points: Any, what: str, one: type, options: Asked) -> Any:
        """The answers of ``_solid`` for many points, or the only one as a ``one``."""
        chosen, on_device = settings(options, Asked), options.get("on_device", False)
        there = None if type(points) is np.ndarray else as_device_points(points)
        if there is not None and on_device:
            return DeviceArray._of(getattr(self._solid, f"{question}_on_device")(there, chosen))
        if there is not None:
            return getattr(self._solid, f"{question}_there")(there, chosen)
        if on_device:
            raise TypeError(f"`on_device` needs `{what}` in a CUDA device's memory")
        if options.get("backend") == "cuda":
            raise InvalidArgument(
                f"`{what}` in the host's memory are asked about on the CPU; use backend 'auto' or 'cpu'"
            )
        array, single = as_questions(points, self._solid.dimension, what)
        answers = getattr(self._solid, question)(array, chosen)
        return one(answers[0]) if single else answers

    @takes(Asked)
    def contains(self, points: Any, **options: Unpack[Asked]) -> Any:
        """Whether each point lies in the hull or on its boundary; exact.

        Parameters
        ----------
        points : (m, d) or (d,) array
            (m, d) also in a CUDA device's memory; others are asked about on the CPU.

        Returns
        -------
        (m,) bool array; a bool for one point (d,)
            For a flat hull, points off the flat are outside.

        Raises
        ------
        InvalidArgument, NotFinite (ValueErrors) : another dimension, an empty hull, a NaN, infinity

        Examples
        --------
        >>> import cullhull
        >>> hull = cullhull.convex_hull([[0, 0], [2, 0], [2, 1], [0, 1], [1, 0.5]])
        >>> hull.contains([[1, 0], [1, 2]]), hull.contains([2, 1])
        (array([ True, False]), True)
        """
        return self._ask("contains", points, "points", bool, options)

    @takes(Asked)
    def sides(self, points: Any, **options: Unpack[Asked]) -> Any:
        """Where each point lies, exactly: -1 inside, 0 on the boundary, 1 outside.

        Parameters
        ----------
        points : as of `contains`, as is what is raised

        Returns
        -------
        (m,) int8 array; an int for one point (d,)

        Examples
        --------
        >>> import cullhull
        >>> hull = cullhull.convex_hull([[0, 0], [2, 0], [2, 1], [0, 1], [1, 0.5]])
        >>> hull.sides([[1, 0.5], [1, 0], [1, 2]])
        array([-1,  0,  1], dtype=int8)
        """
        return self._ask("sides", points, "points", int, options)

    @takes(Asked)
    def distance(self, points: Any, **options: Unpack[Asked]) -> Any:
        """Euclidean distance to the hull in the points' units; inside, minus that to the boundary.

        Parameters
        ----------
        points : as of `contains`, as is what is raised

        Returns
        -------
        (m,) float64 array; a float for one point (d,)
            Relative error about 2**-40 of the hull's extent.

        Examples
        --------
        >>> import cullhull
        >>> hull = cullhull.convex_hull([[0, 0], [2, 0], [2, 1], [0, 1], [1, 0.5]])
        >>> hull.distance([[1, 0.5], [5, 5]])
        array([-0.5,  5. ])
        """
        return self._ask("distances", points, "points", float, options)

    @takes(Watched)
    def nearest_facets(self, points: Any, **options: Unpack[Watched]) -> NearestFacets:
        """The facet nearest to each point, and the signed distance.

        Parameters
        ----------
        points : (m, d) or (d,) array

        Returns
        -------
        NearestFacets
            ``facets``, (m,) int64, and ``distances``, (m,) float64.

        Examples
        --------
        >>> import cullhull
        >>> hull = cullhull.convex_hull([[0, 0], [2, 0], [2, 1], [0, 1], [1, 0.5]])
        >>> hull.nearest_facets([[1.0, 0.25]]).distances
        array([-0.25])
        """
        array, _ = as_questions(points, self._solid.dimension, "points")
        facets, distances = self._solid.nearest_facets(array, settings(options, Watched))
        return NearestFacets(facets, distances)

    @takes(Asked)
    def support(self, directions: Any, **options: Unpack[Asked]) -> Any:
        """Index of the vertex farthest along each direction; exact, the lowest index of several.

        Parameters
        ----------
        directions : (m, d) or (d,) array
            (m, d) also in a CUDA device's memory. Of any length. What is raised is as of `contains`.

        Returns
        -------
        (m,) int64 array; an int for one direction (d,)

        Examples
        --------
        >>> import cullhull
        >>> hull = cullhull.convex_hull([[0, 0], [2, 0], [2, 1], [0, 1], [1, 0.5]])
        >>> hull.support([[1, 1], [-1, -1]]), hull.support([0, 1])
        (array([2, 0]), 2)
        """
        return self._ask("supports", directions, "directions", int, options)

    def visible_from(self, point: Any) -> npt.NDArray[np.int64]:
        """The facets that a point lies strictly above; exact.

        Parameters
        ----------
        point : (d,) array

        Returns
        -------
        (v,) int64 array
            Indices of facets, ascending.

        Examples
        --------
        >>> import cullhull
        >>> hull = cullhull.convex_hull([[0, 0], [2, 0], [2, 1], [0, 1], [1, 0.5]])
        >>> facets = hull.visible_from([3, 0.5])
        >>> [hull.facets[f].tolist() for f in facets]
        [[1, 2]]
        """
        array, single = as_questions(point, self._solid.dimension, "point")
        if not single:
            raise InvalidArgument("`point` should be one point, shape (d,)")
        return self._solid.visible_facets(array, None)

    @takes(Watched)
    def rays(self, origins: Any, directions: Any, **options: Unpack[Watched]) -> Rays:
        """Where the lines ``origin + t * direction`` enter and leave the hull.

        Only for full-dimensional hulls.

        Parameters
        ----------
        origins, directions : (m, d) arrays
            Or one of them (d,), to stand for all.

        Returns
        -------
        Rays
            ``hit``, ``enter``, ``exit``, ``enter_facets``, ``exit_facets``, (m,) each.

        Raises
        ------
        InvalidArgument, NotFinite (ValueErrors)
            For another dimension, unequal numbers of both, a flat hull, a NaN or an infinity.

        Examples
        --------
        >>> import cullhull
        >>> hull = cullhull.convex_hull([[0, 0], [2, 0], [2, 1], [0, 1], [1, 0.5]])
        >>> found = hull.rays([1, 0.5], [[1, 0], [0, 1]])
        >>> found.enter, found.exit
        (array([-1. , -0.5]), array([1. , 0.5]))
        """
        from_, _ = as_questions(origins, self._solid.dimension, "origins")
        to, _ = as_questions(directions, self._solid.dimension, "directions")
        count = max(len(from_), len(to)) if min(len(from_), len(to)) > 0 else 0
        if len(from_) == 1:
            from_ = np.broadcast_to(from_, (count, self._solid.dimension))
        if len(to) == 1:
            to = np.broadcast_to(to, (count, self._solid.dimension))
        hit, enter, exit, first, last = self._solid.rays(from_, to, settings(options, Watched))
        return Rays(hit, enter, exit, first, last)

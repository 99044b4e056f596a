"""Hulls of moving points, frame by frame."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _core
from ._arguments import Backend, CullMethod, Progress, as_point_set, settings
from ._device import as_device_points
from ._hull import Hull


class HullTracker:
    """The exact hull of points that move, each frame using the hull of the one before.

    Every hull is the one `convex_hull` gives for the same points, bit for bit, whatever the motion:
    the last frame only says which points to look at first. One thread at a time may use a tracker.

    Parameters
    ----------
    cull : 'auto', 'gauge', 'pseudo-hull' or 'none'
        How the last frame is used; 'none' computes every frame afresh.
    backend, threads, memory_budget : as in `convex_hull`, for every frame

    Copies and pickles have the last hull, its report and the number of frames; their next frame is
    computed afresh, with the same result.

    Examples
    --------
    >>> import cullhull
    >>> points = cullhull.generate("ball", 10_000)
    >>> tracker = cullhull.HullTracker()
    >>> for frame in range(3):
    ...     hull = tracker.update(points * (1 + 0.01 * frame))
    >>> hull is tracker.hull, tracker.report["index"]
    (True, 2)
    """

    __slots__ = ("_choices", "_hull", "_report", "_tracker")

    _hull: Hull | None
    _report: dict[str, Any] | None

    def __init__(
        self,
        *,
        backend: Backend = "auto",
        cull: CullMethod = "auto",
        threads: int | None = None,
        memory_budget: int | None = None,
    ) -> None:
        self._begin((backend, cull, threads, memory_budget), None, None, 0)

    def _begin(
        self, choices: Any, hull: Hull | None, report: dict[str, Any] | None, frames: int
    ) -> None:
        backend, cull, threads, memory_budget = self._choices = choices
        chosen = settings(backend=backend, cull=cull, threads=threads, memory_budget=memory_budget)
        self._tracker = _core.Tracker(chosen, frames)
        self._hull = hull
        self._report = report  # of the tracker this is a copy of, until there is one of its own

    def __reduce__(self) -> tuple[Any, ...]:
        report = None if self._hull is None else self.report
        return _tracker_of, (self._choices, self._hull, report, self._tracker.frames)

    def update(self, points: Any, *, progress: Progress = None) -> Hull:
        """The hull of the points at their new places.

        Parameters
        ----------
        points : (n, d) array
            Read in place; of an array in a CUDA device's memory only the last hull's vertices and
            what survives the filter are copied. Point i is the point i of the frame before if n and d are the same; else
            tracking starts afresh.
        progress : callable or bool
            As in `convex_hull`.

        Returns
        -------
        Hull

        Raises
        ------
        Error
            As `convex_hull`, beginning with ``frame N:``; the tracker then keeps the last
            hull that succeeded. An update that is interrupted makes the next frame start afresh.

        Examples
        --------
        >>> import cullhull
        >>> cullhull.HullTracker().update([[0, 0], [1, 0], [0, 1]]).volume
        0.5
        """
        chosen = settings(progress=progress)
        device = None if type(points) is np.ndarray else as_device_points(points)
        if device is not None:
            self._hull = Hull._of(self._tracker.update_on_device(device, chosen))
        else:
            self._hull = Hull._of(self._tracker.update(as_point_set(points), chosen))
        self._report = None
        return self._hull

    @property
    def hull(self) -> Hull | None:
        """The last hull computed; None before the first update."""
        return self._hull

    @property
    def report(self) -> dict[str, Any]:
        """What the last update that succeeded did: ``index`` of the frame, ``method`` ('gauge' or
        'pseudo-hull': from the last frame; 'static'), points left by the pass over all
        (``scan_survivors``) and by the whole filter (``survivors``), ``vertices_came``,
        ``vertices_went``, ``facets_came``, ``facets_went`` against the frame before, seconds."""
        return self._tracker.report if self._report is None else self._report

    def reset(self) -> None:
        """Forgets the last frame; frames are numbered from 0 again.

        >>> import cullhull
        >>> tracker = cullhull.HullTracker()
        >>> tracker.reset()
        >>> tracker.hull is None
        True
        """
        self._tracker.reset()
        self._hull = self._report = None

    def __repr__(self) -> str:
        return f"<HullTracker: {self._hull!r}>"


def _tracker_of(
    choices: Any, hull: Hull | None, report: dict[str, Any] | None, frames: int
) -> HullTracker:
    tracker = object.__new__(HullTracker)
    tracker._begin(choices, hull, report, frames)
    return tracker

"""Hulls of moving points, frame by frame."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _core
from ._arguments import as_point_set
from ._device import as_device_points
from ._hull import Hull
from ._options import Reported, Standing, Unpack, settings, takes


@takes(Standing)
class HullTracker:
    """The exact hull of moving points, frame by frame: each frame reuses the hull of the last one.

    Every hull is bit for bit the one that `convex_hull` gives for the same points, whatever the
    motion: the last hull only yields a filter for the next frame. One thread at a time may use a
    tracker. Copies and pickles hold the last hull, its report and the number of frames; their next
    frame is computed from scratch, with the same result. The options hold for every frame. `cull` is
    the filter that is built from the last hull; 'none' computes every frame from scratch.

    Raises
    ------
    InvalidArgument (a ValueError), TypeError
        For an unknown option or one out of range.

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

    def __init__(self, **options: Unpack[Standing]) -> None:
        self._begin(options, None, None, 0)

    def _begin(
        self, options: Standing, hull: Hull | None, report: dict[str, Any] | None, frames: int
    ) -> None:
        self._choices, chosen = options, settings(options, Standing)
        self._tracker = _core.Tracker(chosen, frames)
        self._hull = hull
        self._report = report  # of the tracker this is a copy of, until there is one of its own

    def __reduce__(self) -> tuple[Any, ...]:
        report = None if self._hull is None else self.report
        return _tracker_of, (self._choices, self._hull, report, self._tracker.frames)

    @takes(Reported)
    def update(self, points: Any, **options: Unpack[Reported]) -> Hull:
        """The hull of the points at their new positions.

        Parameters
        ----------
        points : (n, d) array
            Row i is the new position of the point that was row i before; if n or d differs from the
            last frame, tracking starts again. Read in place; of an array in a CUDA device's memory
            only the vertices of the last hull and the points that survive the filter are copied.

        Returns
        -------
        Hull

        Raises
        ------
        InvalidArgument, NotFinite (ValueErrors), TypeError, OutOfBudget (a MemoryError)
            As `convex_hull`, with ``frame N:`` before the message; the tracker keeps the last hull.
        KeyboardInterrupt
            The next frame is then computed from scratch.

        Examples
        --------
        >>> import cullhull
        >>> cullhull.HullTracker().update([[0, 0], [1, 0], [0, 1]]).volume
        0.5
        """
        chosen = settings(options, Reported)
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
        """Statistics of the last successful update: ``index`` of the frame; ``method``, the filter
        ('gauge' or 'pseudo-hull' if built from the last hull, else 'static'); ``scan_survivors``,
        points left by the pass over all points; ``survivors``, points left by the whole filter;
        ``vertices_came``, ``vertices_went``, ``facets_came``, ``facets_went`` compared with the last
        frame; times in seconds."""
        return self._tracker.report if self._report is None else self._report

    def reset(self) -> None:
        """Discards the last frame; frames are numbered from 0 again.

        Examples
        --------
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

"""Hulls of moving points, frame by frame."""

from __future__ import annotations

from typing import Any

from . import _core
from ._arguments import Progress, as_points, settings
from ._hull import Hull


class HullTracker:
    """The exact hull of points that move, each frame led by the one before.

    Every hull is the one `convex_hull` gives for the same points, bit for bit, whatever the motion:
    the last frame only says which points to look at first. One thread at a time may use a tracker.

    Parameters
    ----------
    cull : 'auto', 'gauge', 'pseudo-hull' or 'none'
        How the last frame is used; 'none' computes every frame afresh.
    backend, threads, memory_budget : as in `convex_hull`, for every frame
    """

    __slots__ = ("_hull", "_tracker")

    def __init__(
        self,
        *,
        backend: str = "auto",
        cull: str = "auto",
        threads: int | None = None,
        memory_budget: int | None = None,
    ) -> None:
        self._tracker = _core.Tracker(
            settings(backend=backend, cull=cull, threads=threads, memory_budget=memory_budget)
        )
        self._hull: Hull | None = None

    def update(self, points: Any, *, progress: Progress = None) -> Hull:
        """The hull of the (n, d) points at their new places, read in place.

        Point i is the point i of the frame before if n and d are the same; else tracking starts
        afresh. Errors begin with ``frame N:``; the tracker then still knows the last hull that
        succeeded. An update that is interrupted makes the next frame start afresh.
        """
        array = as_points(points)
        self._hull = Hull._of(self._tracker.update(array, settings(progress=progress)))
        return self._hull

    @property
    def hull(self) -> Hull | None:
        """The last hull computed; None before the first update."""
        return self._hull

    @property
    def report(self) -> dict[str, Any]:
        """What the last update that succeeded did: ``index`` of the frame, ``method`` ('gauge' or
        'pseudo-hull': led by the last frame; 'static'), points left by the pass over all
        (``scan_survivors``) and by the whole filter (``survivors``), ``vertices_came``,
        ``vertices_went``, ``facets_came``, ``facets_went`` against the frame before, seconds."""
        return self._tracker.report

    def reset(self) -> None:
        """Forgets the last frame; frames are numbered from 0 again."""
        self._tracker.reset()
        self._hull = None

    def __repr__(self) -> str:
        return f"<HullTracker: {self._hull!r}>"

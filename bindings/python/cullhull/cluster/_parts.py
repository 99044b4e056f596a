"""Points that lie in many places: what cullhull.dask and cullhull.mpi have in common."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .._arguments import as_points
from .._errors import NotFinite
from .._hull import Hull
from .._streams import HullState, HullStream


def state_of_part(
    part: Any,
    first_id: int,
    where: str,
    *,
    several: bool = False,
    threads: int = 1,
    memory_budget: int | None = None,
) -> HullState:
    """The state of one part: an array or a data frame, or ``several`` of them in an iterable.
    ``where`` names it in errors."""
    stream = HullStream(threads=threads, memory_budget=memory_budget)
    next_id = first_id
    try:
        for block in part if several else [part]:
            points = as_points(block)
            stream.push(points, next_id)
            next_id += points.shape[0]
        return stream.state()
    except NotFinite as error:
        raise NotFinite(f"{where}: {error}") from None


def merged(states: list[HullState], *, numbered: bool) -> HullState:
    """The state of parts that follow one another. Unless they are ``numbered`` through already,
    each part's indices begin where those of the part before end."""
    total = states[0]
    for state in states[1:]:
        total = total | (state if numbered else state.shifted(total.point_count))
    return total


def hull_of(state: HullState, threads: int | None, memory_budget: int | None) -> Hull:
    return state.hull(threads=threads, memory_budget=memory_budget)


def kept_in(part: Any, hull: Hull | None, first_id: int, where: str) -> npt.NDArray[np.uint64]:
    """Indices of a part's points that may be extreme points of a set that ``hull``'s points belong
    to: all but those inside of it or on its border that are none of its vertices."""
    points = as_points(part)
    if not np.isfinite(points).all():
        row, column = np.argwhere(~np.isfinite(points))[0]
        raise NotFinite(f"{where}: coordinate {column} of point {first_id + int(row)} is not finite")
    if hull is None or points.shape[0] == 0:
        return np.arange(first_id, first_id + points.shape[0], dtype=np.uint64)
    inside = np.flatnonzero(hull.contains(points))
    keep = np.ones(points.shape[0], dtype=bool)
    keep[inside] = _rows_in(points[inside], hull.vertex_points)
    return np.flatnonzero(keep).astype(np.uint64) + np.uint64(first_id)


def _rows_in(rows: npt.NDArray[Any], vertices: npt.NDArray[Any]) -> npt.NDArray[np.bool_]:
    """Which rows equal one of the vertices; few do, and the first coordinate excludes most."""
    found = np.zeros(rows.shape[0], dtype=bool)
    candidates = np.flatnonzero(np.isin(rows[:, 0], vertices[:, 0]))
    known = {tuple(v) for v in (vertices + 0.0).tolist()}
    for i in candidates:
        found[i] = tuple((rows[i].astype(np.float64) + 0.0).tolist()) in known
    return found

"""The functions of `cullhull.dask`."""

from __future__ import annotations

import importlib
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

try:
    from dask.base import is_dask_collection, tokenize
    from dask.delayed import Delayed, delayed
except ImportError:
    raise ImportError(
        "cullhull.dask needs dask, which is not installed: pip install 'cullhull[dask]'"
    ) from None

from .._arguments import as_count, as_points, wrong_axes
from .._errors import InvalidArgument
from ._parts import hull_of, kept_in, merged, state_of_part


def state(
    points: Any,
    *,
    columns: Sequence[str] | None = None,
    split_every: int = 8,
    memory_budget: int | None = None,
) -> Delayed:
    """The `HullState` of a collection's points.

    Parameters
    ----------
    points : dask array (n, d), data frame, bag of arrays, or list of delayed arrays
        Chunks along the points may have any sizes, unknown ones too; chunks of coordinates are put
        together first. Indices count through the chunks in their order.
    columns : names, optional
        Of a data frame's columns; by default all.
    split_every : int
        So many states are merged by one task.
    memory_budget : int, optional
        Bytes for each task.

    Returns
    -------
    Delayed
        Of a `HullState`.

    Raises
    ------
    InvalidArgument (a ValueError), TypeError
        At once, for what is no collection of points.
    NotFinite, OutOfBudget
        When it is computed; with the chunk's number where the point's index is not known.
    """
    parts, starts, several = _parts_of(points, columns)
    every = as_count(split_every, "split_every", least=2)
    token = tokenize(parts, starts, every, memory_budget)
    level: list[Delayed] = [
        delayed(state_of_part)(
            part,
            0 if starts is None else starts[i],
            f"chunk {i}",
            several=several,
            memory_budget=memory_budget,
            dask_key_name=f"cullhull-state-{token}-{i}",
        )
        for i, part in enumerate(parts)
    ]
    depth = 0
    while len(level) > 1 or depth == 0:
        level = [
            delayed(merged)(
                level[i : i + every],
                numbered=starts is not None,
                dask_key_name=f"cullhull-merge-{token}-{depth}-{i // every}",
            )
            for i in range(0, len(level), every)
        ]
        depth += 1
    return level[0]


def convex_hull(
    points: Any,
    *,
    columns: Sequence[str] | None = None,
    split_every: int = 8,
    threads: int | None = None,
    memory_budget: int | None = None,
) -> Delayed:
    """The hull of a collection's points, as `cullhull.convex_hull` of all of them gives.

    Parameters
    ----------
    points, columns, split_every, memory_budget : as in `state`
    threads : int, optional
        For the last step, which one worker does; by default all of its machine's.

    Returns
    -------
    Delayed
        Of a `Hull`, whose indices count through the chunks.

    Examples
    --------
    >>> import cullhull.dask, dask.array as da
    >>> square = da.from_array([[0, 0], [2, 0], [1, 1], [2, 2], [0, 2]], chunks=(2, 1))
    >>> cullhull.dask.convex_hull(square).compute().vertices.tolist()
    [0, 1, 3, 4]
    """
    whole = state(points, columns=columns, split_every=split_every, memory_budget=memory_budget)
    hull: Delayed = delayed(hull_of)(
        whole,
        threads,
        memory_budget,
        dask_key_name=f"cullhull-hull-{tokenize(whole.key, threads, memory_budget)}",
    )
    return hull


def extreme_points(
    points: Any,
    *,
    columns: Sequence[str] | None = None,
    split_every: int = 8,
    memory_budget: int | None = None,
) -> Delayed:
    """Indices of the extreme points, without facets: any dimension.

    Parameters
    ----------
    points, columns, split_every, memory_budget : as in `state`

    Returns
    -------
    Delayed
        Of an ascending array of uint64.

    Examples
    --------
    >>> import cullhull.dask, dask.array as da
    >>> cullhull.dask.extreme_points(da.from_array([[0.0], [2.0], [1.0]], chunks=1)).compute()
    array([0, 1], dtype=uint64)
    """
    whole = state(points, columns=columns, split_every=split_every, memory_budget=memory_budget)
    ids: Delayed = delayed(_ids_of)(whole, dask_key_name=f"cullhull-extreme-{tokenize(whole.key)}")
    return ids


def cull(
    points: Any,
    *,
    columns: Sequence[str] | None = None,
    sample: int = 100_000,
    split_every: int = 8,
) -> Any:
    """Indices of the points that may be extreme, with far fewer than all for most sets.

    Two phases: each chunk gives some of its points, whose common hull goes to every chunk, which
    drops what lies in it. May keep too much, never drops an extreme point.

    Parameters
    ----------
    points, columns, split_every : as in `state`
        Sizes of chunks must be known (``compute_chunk_sizes`` of an array).
    sample : int
        About so many points are hulled for the filter.

    Returns
    -------
    dask array of uint64
        Ascending within and over chunks, which have unknown sizes.

    Examples
    --------
    >>> import cullhull, cullhull.dask, dask.array as da
    >>> points = da.from_array(cullhull.generate("ball", 10_000), chunks=(1000, 3))
    >>> ids = cullhull.dask.cull(points).compute()
    >>> bool(set(cullhull.convex_hull(points.compute()).vertices) <= set(ids.tolist()))
    True
    """
    da: Any = importlib.import_module("dask.array")
    parts, starts, _ = _parts_of(points, columns)
    if starts is None:
        raise InvalidArgument("cull needs chunks of known sizes: points.compute_chunk_sizes()")
    size = as_count(sample, "sample", least=1)
    every = as_count(split_every, "split_every", least=2)
    token = tokenize(parts, size, every)
    share = max(1, math.ceil(starts[-1] / size))
    samples = [
        delayed(_sampled)(part, share, dask_key_name=f"cullhull-sample-{token}-{i}")
        for i, part in enumerate(parts)
    ]
    common = delayed(_hull_or_none)(
        state(samples, split_every=every), dask_key_name=f"cullhull-filter-{token}"
    )
    kept = [
        da.from_delayed(
            delayed(kept_in)(
                part, common, starts[i], f"chunk {i}", dask_key_name=f"cullhull-cull-{token}-{i}"
            ),
            shape=(np.nan,),
            dtype=np.uint64,
        )
        for i, part in enumerate(parts)
    ]
    return da.concatenate(kept, allow_unknown_chunksizes=True)


def _ids_of(whole: Any) -> Any:
    return whole.ids


def _sampled(part: Any, share: int) -> Any:
    """Some of the finite points; `kept_in` reports the others, with their indices."""
    some = as_points(part)[::share]
    return some[np.isfinite(some).all(axis=1)]


def _hull_or_none(whole: Any) -> Any:
    """None where the sample's hull is flat: its points are then no filter for the others."""
    if len(whole) == 0:
        return None
    hull = whole.hull()
    return hull if hull.affine_dimension == whole.dimension else None


def _parts_of(
    points: Any, columns: Sequence[str] | None
) -> tuple[list[Delayed], list[int] | None, bool]:
    """A delayed array for each chunk; the index of the first point of each, with the number of all
    points in the end, or None where sizes are not known; whether a chunk has several arrays."""
    if isinstance(points, (list, tuple)) and all(isinstance(p, Delayed) for p in points):
        _refuse_columns(columns)
        if not points:
            raise InvalidArgument("points: a list of no delayed arrays has no dimension")
        return list(points), None, False
    if not is_dask_collection(points) or isinstance(points, Delayed):
        raise TypeError(
            "points must be a dask array, data frame or bag, or a list of delayed arrays, not "
            f"{type(points).__name__}; cullhull.convex_hull takes what is in memory"
        )
    if hasattr(points, "chunks"):
        _refuse_columns(columns)
        if points.ndim != 2:
            raise wrong_axes("points", 2, points.ndim)
        if len(points.chunks[1]) > 1:
            points = points.rechunk({1: -1})
        parts = list(points.to_delayed().ravel())
        sizes = points.chunks[0]
        if any(math.isnan(n) for n in sizes):
            return parts, None, False
        sums = [int(n) for n in np.concatenate([[0], np.cumsum(sizes)])]
        return parts, sums, False
    if hasattr(points, "columns"):
        if columns is not None:
            points = points[list(columns)]
        return list(points.to_delayed()), None, False
    _refuse_columns(columns)
    if hasattr(points, "to_delayed"):
        return list(points.to_delayed()), None, True
    raise TypeError(f"points of type {type(points).__name__} have no chunks")


def _refuse_columns(columns: Sequence[str] | None) -> None:
    if columns is not None:
        raise InvalidArgument("columns: names are those of a data frame's")

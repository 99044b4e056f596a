"""The functions of `cullhull.mpi`."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .._arguments import as_points
from .._errors import Error, InvalidArgument
from .._hull import Hull
from .._streams import HullState
from ._parts import hull_of, state_of_part

_PIECE = 1 << 30  # bytes a message; MPI counts in 32 bits


def state(
    comm: Any,
    points: Any,
    *,
    root: int = 0,
    threads: int | None = None,
    memory_budget: int | None = None,
) -> HullState | None:
    """The `HullState` of all ranks' points, on rank ``root``; None on the others.

    Parameters
    ----------
    comm : mpi4py communicator
    points : (n, d) array
        This rank's, perhaps of no rows. All ranks must give the same d.
    root : int
        The rank that gets it.
    threads, memory_budget : as in `convex_hull`, for this rank

    Raises
    ------
    InvalidArgument, NotFinite, OutOfBudget
        On every rank, naming the first rank that failed.
    """
    rank, size = comm.Get_rank(), comm.Get_size()
    if not 0 <= root < size:
        raise InvalidArgument(f"root must be a rank from 0 to {size - 1}, not {root!r}")
    mine = _agreed(comm, lambda: as_points(points))
    widths = comm.allgather(mine.shape)
    for other, (_, d) in enumerate(widths):
        if d != widths[0][1]:
            raise InvalidArgument(f"rank {other}: points of {d}D, rank 0 has {widths[0][1]}D")
    first = sum(n for n, _ in widths[:rank])
    total: HullState = _agreed(
        comm,
        lambda: state_of_part(
            mine, first, "its points", threads=threads or 1, memory_budget=memory_budget
        ),
    )
    place = (rank - root) % size
    step = 1
    while step < size:
        merge = None
        if place % (2 * step) == step:
            _send(comm, total.__reduce__()[1][0], (rank - step) % size)
        elif place % (2 * step) == 0 and place + step < size:
            merge = _receive(comm, (rank + step) % size)
        total = _agreed(comm, lambda: total if merge is None else total | _state(merge))
        step *= 2
    return total if rank == root else None


def convex_hull(
    comm: Any,
    points: Any,
    *,
    root: int | None = 0,
    threads: int | None = None,
    memory_budget: int | None = None,
) -> Hull | None:
    """The hull of all ranks' points, as `cullhull.convex_hull` of them all gives.

    Parameters
    ----------
    comm, points, threads, memory_budget : as in `state`
    root : int or None
        The rank that gets it, the others get None; ``root=None``: every rank does.

    Returns
    -------
    Hull or None
    """
    whole = _state_for(comm, points, root, threads, memory_budget)
    hull: Hull | None = _agreed(
        comm, lambda: None if whole is None else hull_of(whole, threads, memory_budget)
    )
    return hull


def extreme_points(
    comm: Any,
    points: Any,
    *,
    root: int | None = 0,
    threads: int | None = None,
    memory_budget: int | None = None,
) -> npt.NDArray[np.uint64] | None:
    """Indices of the extreme points of all ranks' points, ascending.

    Parameters
    ----------
    comm, points, root, threads, memory_budget : as in `convex_hull`
    """
    whole = _state_for(comm, points, root, threads, memory_budget)
    return None if whole is None else whole.ids


def _state_for(
    comm: Any, points: Any, root: int | None, threads: int | None, memory_budget: int | None
) -> HullState | None:
    """As `state`; on every rank where ``root`` is None."""
    first = 0 if root is None else root
    whole = state(comm, points, root=first, threads=threads, memory_budget=memory_budget)
    return _state(_shared(comm, whole)) if root is None else whole


def _agreed(comm: Any, work: Any) -> Any:
    """What ``work`` gives, where it succeeds on every rank: no rank waits for one that failed."""
    result, failure = None, None
    try:
        result = work()
    except (Error, TypeError, ValueError, MemoryError) as error:
        failure = error
    for rank, told in enumerate(comm.allgather(failure)):
        if told is not None:
            raise type(told)(f"rank {rank}: {told}") from failure
    return result


def _state(data: bytes) -> HullState:
    from .._streams import _state_of

    return _state_of(data)


def _send(comm: Any, data: bytes, to: int) -> None:
    comm.send(len(data), dest=to)
    for start in range(0, len(data), _PIECE):
        comm.Send(np.frombuffer(data[start : start + _PIECE], dtype=np.uint8), dest=to)


def _receive(comm: Any, source: int) -> bytes:
    data = np.empty(comm.recv(source=source), dtype=np.uint8)
    for start in range(0, data.size, _PIECE):
        comm.Recv(data[start : start + _PIECE], source=source)
    return data.tobytes()


def _shared(comm: Any, whole: HullState | None) -> bytes:
    """The bytes that rank 0 has, on every rank."""
    data = np.zeros(0, dtype=np.uint8)
    if whole is not None:
        data = np.frombuffer(whole.__reduce__()[1][0], dtype=np.uint8)
    size = comm.bcast(data.size)
    data = data if data.size == size else np.empty(size, dtype=np.uint8)
    for start in range(0, size, _PIECE):
        comm.Bcast(data[start : start + _PIECE])
    return data.tobytes()

"""Hulls of points that come in blocks: more than memory holds, from many threads or machines."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import as_count, as_points
from ._hull import Hull
from ._options import Budgeted, Kept, Reported, Unpack, documented, require_known, settings, takes
from .show._forms import Table
from .show._shown import Shown

@takes(Budgeted)
class HullState(Shown):
    """What some points contribute to a hull: the extreme points, with their indices.

    A state holds the index among all points and the coordinates of each extreme point, and of equal
    points the first. States merge: any order and any tree of merging gives the same state, and its
    `hull` is bit for bit that of `convex_hull` of all points at once. So parts of the points can be
    processed anywhere. States are immutable. They pickle, and ``==`` compares their content.

    Parameters
    ----------
    points : (n, d) array, optional
        None: the state of no points, which merges with any other.
    first_id : int
        The index of the first of these points among all points.

    Raises
    ------
    InvalidArgument, NotFinite (ValueErrors), TypeError, OutOfBudget (a MemoryError)
        As `convex_hull`; InvalidArgument also for a negative ``first_id``.
    KeyboardInterrupt

    Examples
    --------
    >>> import cullhull
    >>> points = cullhull.generate("ball", 10_000)
    >>> parts = [cullhull.HullState(points[i : i + 2500], i) for i in range(0, 10_000, 2500)]
    >>> state = parts[3] | parts[0] | parts[2] | parts[1]
    >>> state.point_count
    10000
    >>> bool((state.hull().vertices == cullhull.convex_hull(points).vertices).all())
    True
    """

    __slots__ = ("_state",)

    def __init__(self, points: Any = None, first_id: int = 0, **options: Unpack[Budgeted]) -> None:
        chosen = settings(options, Budgeted)
        if points is None:
            self._state = _core.State()
            return
        first = as_count(first_id, "first_id")
        self._state = _core.state_of(as_points(points), first, chosen)

    @classmethod
    def _of(cls, state: _core.State) -> HullState:
        new = object.__new__(cls)
        new._state = state
        return new

    @property
    def dimension(self) -> int:
        """d, the number of coordinates of a point; 0 for the state of no points."""
        return self._state.dimension

    @property
    def point_count(self) -> int:
        """Number of points that the state stands for."""
        return self._state.point_count

    def __len__(self) -> int:
        """Number of extreme points."""
        return self._state.count

    @property
    def ids(self) -> npt.NDArray[np.uint64]:
        """(m,) uint64: indices of the extreme points among all points, ascending."""
        return np.frombuffer(self._state.ids(), dtype=np.uint64)

    @property
    def points(self) -> npt.NDArray[Any]:
        """(m, d): coordinates of the extreme points, in the order of `ids` and of the type of the
        points that were passed."""
        kind = self._state.scalar  # "f32": for NumPy "f4"
        rows = np.frombuffer(self._state.rows(), dtype=f"{kind[0]}{int(kind[1:]) // 8}")
        return rows.reshape(len(self), self.dimension)

    def to_arrays(self) -> dict[str, npt.NDArray[Any]]:
        """The state as plain arrays, for programs that store or transport arrays.

        Returns
        -------
        dict
            ``ids``, (m,) uint64; ``points``, (m, d); ``point_count``, (1,) uint64.

        Examples
        --------
        >>> import cullhull
        >>> sorted(cullhull.HullState([[0, 0], [1, 0], [0, 1]]).to_arrays())
        ['ids', 'point_count', 'points']
        """
        return {
            "ids": self.ids,
            "points": self.points,
            "point_count": np.array([self.point_count], dtype=np.uint64),
        }

    @takes(Budgeted)
    def merge(self, other: HullState, **options: Unpack[Budgeted]) -> HullState:
        """The state of the points of both states; ``a | b`` is the same.

        Parameters
        ----------
        other : HullState
            Its points must have other indices.

        Returns
        -------
        HullState

        Raises
        ------
        InvalidArgument (a ValueError)
            If the dimensions differ.
        TypeError
            If `other` is no HullState.
        OutOfBudget (a MemoryError), KeyboardInterrupt

        Examples
        --------
        >>> import cullhull
        >>> a = cullhull.HullState([[0, 0], [1, 0]])
        >>> a.merge(cullhull.HullState([[0, 1]], 2)).hull().volume
        0.5
        """
        if not isinstance(other, HullState):
            raise TypeError(f"other must be a HullState, not {type(other).__name__}")
        chosen = settings(options, Budgeted)
        return HullState._of(self._state.merged(other._state, chosen))

    def __or__(self, other: object) -> HullState:
        if not isinstance(other, HullState):
            return NotImplemented
        return self.merge(other)

    def shifted(self, offset: int) -> HullState:
        """The state with ``offset`` added to every index: for a part whose indices began at 0.

        Parameters
        ----------
        offset : int
            At least 0 and below 2**63; no index may reach 2**64.

        Returns
        -------
        HullState

        Raises
        ------
        InvalidArgument (a ValueError)
            For an offset out of range.

        Examples
        --------
        >>> import cullhull
        >>> cullhull.HullState([[0, 0], [1, 0]]).shifted(10).ids.tolist()
        [10, 11]
        """
        return HullState._of(self._state.shifted(as_count(offset, "offset")))

    @takes(Budgeted)
    def hull(self, **options: Unpack[Budgeted]) -> Hull:
        """The hull of all points; its indices are those of the state.

        Parameters
        ----------

        Returns
        -------
        Hull

        Raises
        ------
        InvalidArgument (a ValueError)
            For the state of no points, which has no dimension.
        OutOfBudget (a MemoryError), KeyboardInterrupt

        Examples
        --------
        >>> import cullhull
        >>> cullhull.HullState([[0, 0], [2, 0], [0, 2], [1, 1]]).hull().volume
        2.0
        """
        chosen = settings(options, Budgeted)
        return Hull._of(self._state.solid(chosen))

    def _in_place(self) -> Hull:
        return self.hull()

    def _shape_count(self) -> int:
        return len(self)

    def _table(self) -> Table:
        return Table(
            "Hull state",
            [
                ("points", f"{self.point_count:,} in {self.dimension}D"),
                ("extreme points", f"{len(self):,}"),
            ],
        )

    def _page(self) -> str:
        from .show._pages import page_of_hull

        return page_of_hull(self.hull()._solid, None)

    @documented("path")
    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the state to a file: .hullstate (compact, with a checksum) or .npz (`to_arrays`).

        An error leaves no part of a file behind.

        Raises
        ------
        FileError (an OSError)
            If the operating system refuses to write the file.
        InvalidArgument (a ValueError)
            For another extension.

        Examples
        --------
        >>> import cullhull, os, tempfile
        >>> state = cullhull.HullState([[0, 0], [2, 0], [0, 2]])
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     state.save(os.path.join(folder, "part.hullstate"))
        ...     cullhull.HullState.load(os.path.join(folder, "part.hullstate")) == state
        True
        """
        self._state.save(os.fspath(path))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> HullState:
        """Reads a .hullstate file that `save` or ``cullhull hull --partial`` wrote.

        Parameters
        ----------
        path : str or os.PathLike
            Its content counts, not its extension. Read the arrays of an .npz with `numpy.load`.

        Returns
        -------
        HullState

        Raises
        ------
        FileError (an OSError)
            If the operating system refuses to read the file.
        BadFile (a ValueError)
            If the file holds no state, or is damaged.

        Examples
        --------
        >>> import cullhull
        >>> try:
        ...     cullhull.HullState.load("/no/such/file.hullstate")
        ... except OSError as error:
        ...     type(error).__name__
        'FileError'
        """
        return cls._of(_core.State.load(os.fspath(path)))

    def __reduce__(self) -> tuple[Any, ...]:
        return _state_of, (self._state.to_bytes(),)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, HullState):
            return NotImplemented
        return self._state.same(other._state)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return (
            f"<HullState: {len(self)} extreme of {self.point_count} points"
            + (f" in {self.dimension}D>" if self.dimension else ">")
        )


def _state_of(data: bytes) -> HullState:
    return HullState._of(_core.State.from_bytes(data))


@takes(Kept)
class HullStream:
    """The hull of points that are pushed block by block, in one pass over all points.

    Blocks may come in any order and from several threads at once. Memory holds the extreme points
    found so far and one block. The GIL is released while a block is processed. The options hold for
    every call. While several threads push, each takes no more of ``threads`` than are idle.

    Raises
    ------
    InvalidArgument (a ValueError), TypeError
        For an option out of range.

    Examples
    --------
    >>> import cullhull
    >>> points = cullhull.generate("ball", 10_000)
    >>> stream = cullhull.HullStream()
    >>> stream.extend(points[i : i + 1000] for i in range(0, 10_000, 1000))
    >>> stream.point_count
    10000
    >>> bool((stream.hull().simplices == cullhull.convex_hull(points).simplices).all())
    True
    """

    __slots__ = ("_choices", "_stream")

    def __init__(self, **options: Unpack[Kept]) -> None:
        self._stream = _core.Stream(settings(options, Kept))
        self._choices = options

    def push(self, points: Any, first_id: int | None = None) -> None:
        """Adds a block of points.

        A push that raises an `Error` leaves the stream unchanged; a push that is interrupted
        (KeyboardInterrupt) has been completed.

        Parameters
        ----------
        points : (n, d) array, or HullState
            Read in place. A state stands for all the points that it was made of.
        first_id : int, optional
            The index of the block's first point among all points; by default one more than the
            highest index so far.

        Raises
        ------
        InvalidArgument, NotFinite (ValueErrors), TypeError
            As `convex_hull`; InvalidArgument also for points of another dimension than before.
        OutOfBudget (a MemoryError)
            If the points that may be extreme need more than the memory budget.
        KeyboardInterrupt

        Examples
        --------
        >>> import cullhull
        >>> stream = cullhull.HullStream()
        >>> stream.push([[0, 1], [5, 5]], first_id=2)
        >>> stream.push([[0, 0], [1, 0]], first_id=0)
        >>> stream.hull().vertices.tolist()
        [0, 1, 3, 2]
        """
        if isinstance(points, HullState):
            if first_id is not None:
                points = points.shifted(first_id)
            self._stream.push_state(points._state)
            return
        first = None if first_id is None else as_count(first_id, "first_id")
        self._stream.push(as_points(points), first)

    def extend(self, blocks: Iterable[Any]) -> None:
        """Pushes every block of an iterable, one after the other.

        Parameters
        ----------
        blocks : iterable
            Yields arrays or states, as `push` takes them: ``cullhull.read(path, chunks=...)``.

        Raises
        ------
        As `push`. Blocks before the one that raises have been added.

        Examples
        --------
        >>> import cullhull
        >>> stream = cullhull.HullStream()
        >>> stream.extend([[[0, 0], [1, 0]], [[0, 1]]])
        >>> stream.hull().volume
        0.5
        """
        for block in blocks:
            self.push(block)

    def state(self) -> HullState:
        """The state of all points pushed so far.

        Returns
        -------
        HullState

        Raises
        ------
        OutOfBudget (a MemoryError), KeyboardInterrupt

        Examples
        --------
        >>> import cullhull
        >>> stream = cullhull.HullStream()
        >>> stream.push([[0, 0], [1, 0], [0, 1]])
        >>> len(stream.state())
        3
        """
        return HullState._of(self._stream.state())

    @takes(Reported)
    def hull(self, **options: Unpack[Reported]) -> Hull:
        """The hull of all points pushed so far: bit for bit that of `convex_hull` of them.

        More points may be pushed afterwards.

        Returns
        -------
        Hull

        Raises
        ------
        InvalidArgument (a ValueError)
            Before the first block.
        OutOfBudget (a MemoryError), KeyboardInterrupt

        Examples
        --------
        >>> import cullhull
        >>> stream = cullhull.HullStream()
        >>> stream.push([[0, 0], [1, 0], [0, 1]])
        >>> stream.hull().volume
        0.5
        """
        require_known(options, Reported)
        return self.state().hull(**self._choices, **options)

    @property
    def point_count(self) -> int:
        """Number of points pushed so far."""
        return self.report["point_count"]

    @property
    def report(self) -> dict[str, int]:
        """Statistics: ``point_count``; ``extreme``, points that the last exact hull found to be
        extreme, 0 after a filter has replaced it; ``waiting``, the other points held;
        ``reductions``, exact hulls computed; ``maps``, filters built."""
        return self._stream.report

    def __reduce__(self) -> tuple[Any, ...]:
        return _stream_of, (self._choices, self.state())

    def __repr__(self) -> str:
        report = self.report
        held = report["extreme"] + report["waiting"]
        return f"<HullStream: {report['point_count']} points, {held} of them held>"


def _stream_of(choices: Any, state: HullState) -> HullStream:
    stream = HullStream(**choices)
    stream.push(state)
    return stream

"""Many small hulls in one call, and hulls that take more points as they come."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, overload

import numpy as np
import numpy.typing as npt

from . import _core
from ._answers import Mesh
from ._arguments import as_count, as_point_set, as_points, as_position, refuse_mask
from ._device import DeviceArray, as_device_offsets, as_device_points, set_shape
from ._errors import InvalidArgument
from ._hull import Hull, picture_of
from ._lists import Lists
from ._native import Made, Native
from ._options import Budgeted, Unpack, settings, takes
from .show._forms import Picture, Surface, Table, features, require_drawable, require_plane
from .show._shown import Exported, Saved


class HullBatch(Exported, Saved, Native, Sequence[Hull]):
    """The hulls of many sets, from `convex_hulls`: a sequence of `Hull`, and arrays over all.

    Below, b is the number of sets and d the dimension. Vertex indices count from a set's first
    point. Arrays are read-only views. A batch never changes: copies share its memory, and a pickle
    holds the arrays.

    Raises
    ------
    TypeError
        When called: batches are made by `convex_hulls`.
    IndexError
        For a set that is not there.

    Examples
    --------
    >>> import cullhull
    >>> batch = cullhull.convex_hulls(cullhull.generate("cube", 600).reshape(20, 30, 3))
    >>> batch
    <HullBatch of 20 hulls in 3D>
    >>> len(batch), batch[3].point_count, batch.volumes.shape, batch.centroids.shape
    (20, 30, (20,), (20, 3))
    >>> bool((batch.facet_counts == [hull.facet_count for hull in batch]).all())
    True
    """

    __slots__ = ("_batch",)

    _batch: _core.Batch
    _made_by = "batches are made by cullhull.convex_hulls"
    _made_of = ("_batch",)

    def __reduce__(self) -> tuple[Any, ...]:
        return _batch_of_state, (_core.state_of_batch(self._batch),)

    def _parts(self) -> tuple[Any, ...]:
        return self.dimension, self.point_counts, self.vertices, self.vertex_points

    def __len__(self) -> int:
        return len(self._batch)

    @overload
    def __getitem__(self, i: int) -> Hull: ...
    @overload
    def __getitem__(self, i: slice) -> list[Hull]: ...
    def __getitem__(self, i: int | slice) -> Hull | list[Hull]:
        if isinstance(i, slice):
            return [self[j] for j in range(*i.indices(len(self)))]
        at = as_position(i, len(self), "set")
        return Hull._of(self._batch.solid(at))

    def __iter__(self) -> Iterator[Hull]:
        return (self[i] for i in range(len(self)))

    @property
    def dimension(self) -> int:
        """d, the number of coordinates of a point."""
        return self._batch.dimension

    @property
    def point_counts(self) -> npt.NDArray[np.int64]:
        """(b,) int64: number of points of each set."""
        return self._batch.point_counts

    @property
    def affine_dimensions(self) -> npt.NDArray[np.int32]:
        """(b,) int32: dimension of the flat each set spans, -1 for an empty one."""
        return self._batch.affine_dimensions

    @property
    def volumes(self) -> npt.NDArray[np.float64]:
        """(b,) float64: see `Hull.volume`."""
        return self._batch.volumes

    @property
    def areas(self) -> npt.NDArray[np.float64]:
        """(b,) float64: see `Hull.area`."""
        return self._batch.areas

    @property
    def centroids(self) -> npt.NDArray[np.float64]:
        """(b, d) float64; zeros for an empty set."""
        return self._batch.centroids

    @property
    def vertices(self) -> Lists:
        """For each set the indices of its vertices: see `Hull.vertices`."""
        return Lists(self._batch.vertex_offsets, self._batch.vertices)

    @property
    def vertex_points(self) -> npt.NDArray[np.float64]:
        """(vertices of all sets, d) float64: their coordinates, end to end as in `vertices`."""
        return self._batch.vertex_points

    @property
    def facet_counts(self) -> npt.NDArray[np.int64]:
        """(b,) int64: number of facets of each set."""
        return np.diff(self._batch.facet_starts)

    @property
    def facet_planes(self) -> npt.NDArray[np.float64]:
        """(facets of all sets, d + 1) float64, end to end: see `Hull.facet_planes`."""
        return self._batch.facet_planes

    @property
    def simplices(self) -> Lists:
        """For each set its simplices, k indices each, end to end."""
        return Lists(self._batch.simplex_offsets, self._batch.simplices)

    def mesh(self) -> Mesh:
        """The boundaries of all hulls as one mesh; all hulls must span equally many dimensions.

        Returns
        -------
        Mesh
            ``vertices``, (v, d) float64, are `vertex_points`; ``faces``, (s, k) int64, are the
            simplices of all hulls by rows of these.

        Raises
        ------
        InvalidArgument (a ValueError)
            For hulls of different affine dimensions.

        Examples
        --------
        >>> import cullhull
        >>> triangle = [[0, 0], [4, 0], [0, 4]]
        >>> cullhull.convex_hulls([triangle, triangle]).mesh().faces.tolist()
        [[0, 2], [1, 0], [2, 1], [3, 5], [4, 3], [5, 4]]
        """
        if len(np.unique(self.affine_dimensions)) > 1:
            raise InvalidArgument("hulls of different affine dimensions make no one mesh")
        starts = self.vertices.offsets.tolist()
        faces = [hull.mesh().faces + start for hull, start in zip(self, starts)]
        width = max(0, *self.affine_dimensions.tolist()) if faces else 0
        none = np.empty((0, width), dtype=np.int64)
        return Mesh(self.vertex_points, np.concatenate([none, *faces]))

    # As others have it

    def _surface(self) -> Surface:
        starts = self.vertices.offsets.tolist()
        surfaces = [hull._surface() for hull in self]
        polygons = [s.polygons.items + start for s, start in zip(surfaces, starts)]
        lengths = [s.polygons.lengths() for s in surfaces]
        numbers = [np.full(len(s.polygons), i) for i, s in enumerate(surfaces)]
        none = np.empty(0, dtype=np.int64)
        return Surface(
            self.vertex_points,
            self.vertices.items,
            Lists(np.cumsum(np.concatenate([[0], *lengths])), np.concatenate([none, *polygons])),
            np.concatenate(
                [none.reshape(0, 3), *(s.triangles + start for s, start in zip(surfaces, starts))]
            ),
            np.concatenate([none, *(np.full(len(s.triangles), i) for i, s in enumerate(surfaces))]),
            {"set": np.concatenate([none, *numbers])},
        )

    def _geometry(self) -> dict[str, Any]:
        require_plane(self.dimension, "a batch")
        return features(
            [hull._geometry() for hull in self],
            set=range(len(self)),
            points=self.point_counts.tolist(),
            perimeter=self.areas.tolist(),
            area=self.volumes.tolist(),
        )

    def _picture(self) -> Picture:
        require_drawable(self.dimension)
        return picture_of(list(self))

    def _shape_count(self) -> int:
        return len(self) if self.dimension == 2 else int(self.facet_counts.sum())

    def _table(self) -> Table:
        return Table(
            "Convex hulls",
            [
                ("sets", f"{len(self):,}"),
                ("points", f"{int(self.point_counts.sum()):,} in {self.dimension}D"),
                ("vertices", f"{len(self.vertices.items):,}"),
                ("facets", f"{int(self.facet_counts.sum()):,}"),
            ],
        )

    def _page(self) -> str:
        from .show._pages import page_of_surface

        return page_of_surface(self._surface(), None, self._table())

    def _write(self, path: str, format: str, crs: str = "") -> None:
        self._write_by([str(i) for i in range(len(self))], "set", path, format, crs)

    def _write_by(self, keys: list[str], name: str, path: str, format: str, crs: str) -> None:
        _core.save_batch(path, self._batch, keys, name, format, crs)

    def __repr__(self) -> str:
        return f"<HullBatch of {len(self)} hulls in {self.dimension}D>"


def _batch_of_state(state: dict[str, Any]) -> HullBatch:
    return HullBatch._of(_core.batch_of_state(state))


@takes(Budgeted)
def convex_hulls(points: Any, offsets: Any = None, **options: Unpack[Budgeted]) -> HullBatch:
    """The exact hulls of many sets in one call, spread over all cores.

    Parameters
    ----------
    points : (n, d) array, with `offsets`; or (b, m, d) array; or a list of (n_i, d) arrays
        The first two are read in place; a list is copied end to end. Arrays in a CUDA device's
        memory (``__cuda_array_interface__``, DLPack) are hulled there as far as doubles decide.
    offsets : (b + 1,) integers, ascending
        Set i is ``points[offsets[i]:offsets[i + 1]]``.

    Returns
    -------
    HullBatch

    Raises
    ------
    InvalidArgument, NotFinite (ValueErrors), TypeError, OutOfBudget (a MemoryError)
        As `convex_hull`, naming the set and the point within it; and for offsets that do not fit.

    Examples
    --------
    >>> import cullhull, numpy as np
    >>> points = cullhull.generate("cube", 100, 2)
    >>> batch = cullhull.convex_hulls(points, [0, 40, 100])
    >>> batch.point_counts, batch.affine_dimensions
    (array([40, 60]), array([2, 2], dtype=int32))
    >>> bool(cullhull.convex_hulls([points[:40], points[40:]])[1].volume == batch.volumes[1])
    True
    """
    chosen = settings(options, Budgeted)
    there = None if isinstance(points, (np.ndarray, list, tuple)) else _on_device(points, offsets)
    if there is not None:
        return HullBatch._of(_core.convex_hulls_of_device_points(*there, chosen))
    if offsets is None:
        array, starts = _end_to_end(points)
    else:
        array, starts = as_points(points), _as_offsets(offsets)
    return HullBatch._of(_core.convex_hulls(array, starts, chosen))


def _as_offsets(offsets: Any) -> npt.NDArray[np.int64]:
    refuse_mask(offsets, "offsets")
    starts = np.asarray(offsets)
    if starts.ndim != 1 or starts.dtype.kind not in "iu" or starts.size == 0:
        raise InvalidArgument("`offsets` should be a list of at least one integer")
    if starts.size and int(starts.min()) < 0:
        raise InvalidArgument("`offsets` must not be negative")
    return np.ascontiguousarray(starts, dtype=np.int64)


def _on_device(
    points: Any, offsets: Any
) -> tuple[_core.DevicePoints, npt.NDArray[np.int64] | None, int, int] | None:
    """Points in a device's memory; offsets here, or their address and number there."""
    view = as_device_points(points, sets=offsets is None)
    if view is None:
        return None
    if offsets is None:
        shape = set_shape(points, view)
        if shape is None:
            raise InvalidArgument("points on a device need offsets, or the shape (b, n, d)")
        return view, np.arange(shape[0] + 1, dtype=np.int64) * shape[1], 0, 0
    there = as_device_offsets(offsets)
    if there is not None:
        return view, None, *there
    return view, _as_offsets(offsets), 0, 0


class DeviceHullBatch(Made):
    """The hulls of many sets in a CUDA device's memory, from `convex_hulls_on_device`.

    Below, b is the number of sets and d the dimension. Vertex indices count from a set's first
    point. The arrays share one block of memory, which is freed behind all work that the device has
    when the last of them goes.

    Raises
    ------
    TypeError
        When called: batches are made by `convex_hulls_on_device`.
    AttributeError
        For an array that the call did not ask for.

    Examples
    --------
    >>> def longest(batch):
    ...     import torch
    ...     ends = torch.from_dlpack(batch.vertex_offsets)
    ...     return int((ends[1:] - ends[:-1]).max())    # never leaves the device
    """

    __slots__ = ("_batch",)

    _batch: _core.DeviceBatch
    _made_by = "batches are made by cullhull.convex_hulls_on_device"
    _made_of = ("_batch",)

    def __len__(self) -> int:
        return len(self._batch)

    @property
    def dimension(self) -> int:
        """d, the number of coordinates of a point."""
        return self._batch.dimension

    @property
    def vertices(self) -> DeviceArray:
        """(vertices of all sets,) int32, end to end, each set's in the order of `Hull.vertices`.

        Padded: (b, most vertices), filled up with -1.
        """
        return DeviceArray._of(self._batch.vertices)

    @property
    def vertex_offsets(self) -> DeviceArray:
        """(b + 1,) int64: set i has the vertices [``vertex_offsets[i]``, ``...[i + 1]``).

        Padded batches have `vertex_counts` instead.
        """
        return DeviceArray._of(self._batch.vertex_offsets)

    @property
    def vertex_counts(self) -> DeviceArray:
        """(b,) int32: the number of vertices of each set. Padded batches only."""
        return DeviceArray._of(self._batch.vertex_counts)

    @property
    def simplices(self) -> DeviceArray:
        """(simplices of all sets, d) int32, end to end: see `Hull.simplices`.

        Padded: (b, most simplices, d), filled up with -1.
        """
        return DeviceArray._of(self._batch.simplices)

    @property
    def simplex_offsets(self) -> DeviceArray:
        """(b + 1,) int64, as ``vertex_offsets``. A set in a flat has vertices, but no simplex.

        Padded batches have `simplex_counts` instead.
        """
        return DeviceArray._of(self._batch.simplex_offsets)

    @property
    def simplex_counts(self) -> DeviceArray:
        """(b,) int32: the number of simplices of each set. Padded batches only."""
        return DeviceArray._of(self._batch.simplex_counts)

    @property
    def affine_dimensions(self) -> DeviceArray:
        """(b,) int32: dimension of the flat each set spans, -1 for an empty one."""
        return DeviceArray._of(self._batch.affine_dimensions)

    @property
    def planes(self) -> DeviceArray:
        """(simplices of all sets, d + 1) float64: the plane of each simplex's facet.

        Unit outward normal and offset: a point x of the set has ``normal @ x + offset <= 0``, up to
        rounding. Simplices of one facet have the same plane, that of `Hull.facet_planes`, bit for
        bit. With ``planes=True``; padded: (b, most simplices, d + 1), filled up with 0.
        """
        return DeviceArray._of(self._batch.planes)

    @property
    def volumes(self) -> DeviceArray:
        """(b,) float64: see `Hull.volume`. With ``measures=True``, as the next two."""
        return DeviceArray._of(self._batch.volumes)

    @property
    def areas(self) -> DeviceArray:
        """(b,) float64: see `Hull.area`. In the plane the perimeter."""
        return DeviceArray._of(self._batch.areas)

    @property
    def centroids(self) -> DeviceArray:
        """(b, d) float64: see `Hull.centroid`; zeros for an empty set."""
        return DeviceArray._of(self._batch.centroids)

    def __repr__(self) -> str:
        return f"<DeviceHullBatch of {len(self)} hulls in {self.dimension}D>"


@takes(Budgeted)
def convex_hulls_on_device(
    points: Any,
    offsets: Any = None,
    *,
    planes: bool = False,
    measures: bool = False,
    padded: bool | tuple[int, int] = False,
    **options: Unpack[Budgeted],
) -> DeviceHullBatch:
    """The exact hulls of many sets in a CUDA device's memory, left there.

    Parameters
    ----------
    points : (n, d) array, with `offsets`; or (b, m, d) array
        In a device's memory (``__cuda_array_interface__``, DLPack), float32 or float64. Sets of up
        to 128 points in the plane and 16,384 in space are hulled there; those that doubles do not
        decide (coplanar points, say), hulls of more than some 640 vertices, larger sets and flats
        are computed by the CPU and copied back.
    offsets : (b + 1,) integers, ascending
        Set i is ``points[offsets[i]:offsets[i + 1]]``. On a device: int64.
    planes : bool
        Compute `DeviceHullBatch.planes`.
    measures : bool
        Compute `DeviceHullBatch.volumes`, ``areas`` and ``centroids``.
    padded : bool or (most vertices, most simplices)
        Whether each set has a row of a fixed length in place of lists end to end, for programs with
        fixed shapes. True: as long as the largest hull of the batch needs.

    Returns
    -------
    DeviceHullBatch
        What `convex_hulls` gives, bit for bit. Sets whose planes or measures are not certain in
        doubles are computed by the CPU, too, if these are asked for.

    Raises
    ------
    InvalidArgument, NotFinite (ValueErrors), TypeError, OutOfBudget (a MemoryError)
        As `convex_hulls`; TypeError also for points on the host; InvalidArgument also for a set
        that does not fit the rows, naming it.
    BackendUnavailable (a RuntimeError)
        Where there is no device.

    Examples
    --------
    >>> import cullhull, numpy as np
    >>> def vertices(tensor):    # (b, m, d), on a device
    ...     import torch
    ...     return torch.from_dlpack(cullhull.convex_hulls_on_device(tensor).vertices)
    >>> def volumes(tensor):
    ...     import torch
    ...     batch = cullhull.convex_hulls_on_device(tensor, measures=True)
    ...     return torch.from_dlpack(batch.volumes)
    >>> cullhull.convex_hulls_on_device(np.zeros((2, 4, 3)))
    Traceback (most recent call last):
    TypeError: convex_hulls_on_device needs points in a CUDA device's memory
    """
    chosen = settings(options, Budgeted)
    there = _on_device(points, offsets)
    if there is None:
        raise TypeError("convex_hulls_on_device needs points in a CUDA device's memory")
    rows = (0, 0) if isinstance(padded, bool) else _as_rows(padded)
    return DeviceHullBatch._of(
        _core.convex_hulls_on_device(
            *there, bool(planes), bool(measures), padded is not False, *rows, chosen
        )
    )


def _as_rows(padded: Any) -> tuple[int, int]:
    vertices, simplices = padded
    return (
        as_count(vertices, "the most vertices", least=1),
        as_count(simplices, "the most simplices", least=1),
    )


def _end_to_end(points: Any) -> tuple[npt.NDArray[Any], npt.NDArray[np.int64]]:
    if hasattr(points, "__array_interface__") or hasattr(points, "__dlpack_device__"):
        array = as_points(points, axes=3)
        sets, size, dimension = array.shape
        # A view wherever the sets follow one another at equal steps.
        return (
            array.reshape(sets * size, dimension),
            np.arange(sets + 1, dtype=np.int64) * size,
        )
    parts = [as_points(part, f"points[{i}]") for i, part in enumerate(points)]
    if not parts:
        raise InvalidArgument("an empty list has no dimension; pass points and offsets")
    for i, part in enumerate(parts):
        if part.shape[1] != parts[0].shape[1]:
            raise InvalidArgument(
                f"points[{i}] has {part.shape[1]} coordinates, points[0] has {parts[0].shape[1]}"
            )
    starts = np.zeros(len(parts) + 1, dtype=np.int64)
    np.cumsum([len(part) for part in parts], out=starts[1:])
    if any(part.dtype != parts[0].dtype for part in parts):
        parts = [part.astype(np.float64) for part in parts]  # exact for all that as_points gives
    return np.concatenate(parts), starts


class GrowingHull:
    """The hull of points added batch by batch, which need not be kept: only vertices are.

    Indices number the points in the order in which they were added. The result is the same, bit for
    bit, as that of `convex_hull` of all points at once. One thread at a time may use it. Copies and
    pickles go on by themselves from where it is.

    Parameters
    ----------
    dimension : int
        d, at least 1.

    Raises
    ------
    InvalidArgument (a ValueError)
        For an impossible dimension.

    Examples
    --------
    >>> import cullhull
    >>> growing = cullhull.GrowingHull(2)
    >>> growing.add([[0, 0], [1, 0], [0, 1]]), growing.add([[1, 1], [0.5, 0.5]])
    (3, 1)
    >>> growing.hull.volume, growing.dimension
    (1.0, 2)
    """

    __slots__ = ("_grower", "_hull")

    def __init__(self, dimension: int) -> None:
        d = as_count(dimension, "dimension", least=1, most=2**32 - 1)
        self._grower = _core.Grower(d)
        self._hull: Hull | None = None

    @classmethod
    def _of(cls, hull: Hull) -> GrowingHull:
        growing = object.__new__(cls)
        growing._grower = _core.Grower(hull._solid)
        growing._hull = hull
        return growing

    def __reduce__(self) -> tuple[Any, ...]:
        return GrowingHull._of, (self.hull,)

    @takes(Budgeted)
    def add(self, points: Any, **options: Unpack[Budgeted]) -> int:
        """Adds points. A call that fails or is interrupted changes nothing.

        Parameters
        ----------
        points : (n, d) array

        Returns
        -------
        int
            How many of them lay outside the hull before.

        Raises
        ------
        InvalidArgument, NotFinite (ValueErrors), TypeError, OutOfBudget (a MemoryError)

        Examples
        --------
        >>> import cullhull
        >>> growing = cullhull.GrowingHull(3)
        >>> growing.add(cullhull.generate("ball", 1000))
        1000
        """
        chosen = settings(options, Budgeted)
        outside: int = self._grower.add(as_point_set(points), chosen)
        self._hull = None
        return outside

    @property
    def dimension(self) -> int:
        """d, the number of coordinates of a point."""
        return self._grower.dimension

    @property
    def hull(self) -> Hull:
        """The hull of all points so far; what is added later does not change it."""
        if self._hull is None:
            self._hull = Hull._of(self._grower.solid())
        return self._hull

    def __repr__(self) -> str:
        return f"<GrowingHull: {self.hull!r}>"

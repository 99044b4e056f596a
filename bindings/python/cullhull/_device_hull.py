"""A hull that stays in the memory of the device that has its points."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._device import DeviceArray, as_device_points
from ._native import Made
from ._options import Filtered, Unpack, settings, takes


class DeviceHull(Made):
    """A hull in a CUDA device's memory, from `convex_hull_on_device`.

    Its arrays share one block of memory, which is freed behind all work that the device has when
    the last of them goes. Measures are numbers on the host. k is `affine_dimension`.

    Raises
    ------
    TypeError
        When called: such hulls are made by `convex_hull_on_device`.

    Examples
    --------
    >>> def heights(points):    # of PyTorch, on a device: of each point over each facet's plane
    ...     import torch
    ...     planes = torch.from_dlpack(cullhull.convex_hull_on_device(points).planes)
    ...     return points.double() @ planes[:, :-1].T + planes[:, -1]
    """

    __slots__ = ("_hull",)

    _hull: _core.DeviceHull
    _made_by = "hulls on a device are made by cullhull.convex_hull_on_device"
    _made_of = ("_hull",)

    @property
    def dimension(self) -> int:
        """d, the number of coordinates of a point."""
        return self._hull.dimension

    @property
    def affine_dimension(self) -> int:
        """k, the dimension of the flat the points span: -1 no points, 0 all equal, ..., d full."""
        return self._hull.affine_dimension

    @property
    def point_count(self) -> int:
        """n, the number of points the hull was computed from."""
        return self._hull.point_count

    @property
    def volume(self) -> float:
        """See `Hull.volume`."""
        return self._hull.volume

    @property
    def area(self) -> float:
        """See `Hull.area`."""
        return self._hull.area

    @property
    def centroid(self) -> npt.NDArray[np.float64]:
        """(d,) float64, on the host: see `Hull.centroid`."""
        return np.array(self._hull.centroid, dtype=np.float64)

    @property
    def statistics(self) -> dict[str, Any]:
        """See `Hull.statistics`."""
        return self._hull.statistics

    @property
    def vertices(self) -> DeviceArray:
        """(v,) int64: see `Hull.vertices`."""
        return DeviceArray._of(self._hull.vertices)

    @property
    def simplices(self) -> DeviceArray:
        """(s, k) int64: see `Hull.simplices`."""
        return DeviceArray._of(self._hull.simplices)

    @property
    def simplex_neighbours(self) -> DeviceArray:
        """(s, k) int32: see `Hull.simplex_neighbours`."""
        return DeviceArray._of(self._hull.simplex_neighbours)

    @property
    def planes(self) -> DeviceArray:
        """(s, d + 1) float64: the plane of each simplex's facet, as in `Hull.facet_planes`."""
        return DeviceArray._of(self._hull.planes)

    def __repr__(self) -> str:
        simplices = len(self.simplices)
        return f"<DeviceHull of {self.point_count} points in {self.dimension}D, {simplices} simplices>"


@takes(Filtered)
def convex_hull_on_device(points: Any, **options: Unpack[Filtered]) -> DeviceHull:
    """The exact hull of points in a CUDA device's memory, left there.

    Parameters
    ----------
    points : (n, d) array
        In a device's memory (``__cuda_array_interface__``, DLPack), float32 or float64. In space
        the device finds the hull where doubles decide every edge. Others (four points in a plane,
        say), those of other dimensions and of few points are hulled by the CPU and copied back.

    Returns
    -------
    DeviceHull
        What `convex_hull` gives, bit for bit.

    Raises
    ------
    InvalidArgument, NotFinite (ValueErrors), TypeError, OutOfBudget (a MemoryError)
        As `convex_hull`; TypeError also for points on the host.
    BackendUnavailable (a RuntimeError)
        Where there is no device.

    Examples
    --------
    >>> import cullhull, numpy as np
    >>> def triangles(tensor):    # (n, 3), on a device
    ...     import torch
    ...     return torch.from_dlpack(cullhull.convex_hull_on_device(tensor).simplices)
    >>> cullhull.convex_hull_on_device(np.zeros((4, 3)))
    Traceback (most recent call last):
    TypeError: convex_hull_on_device needs points in a CUDA device's memory
    """
    chosen = settings(options)
    there = as_device_points(points)
    if there is None:
        raise TypeError("convex_hull_on_device needs points in a CUDA device's memory")
    return DeviceHull._of(_core.convex_hull_on_device(there, chosen))

"""The native face: functions that make hulls, cull, check, and generate points."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import as_count, as_point_set, as_points
from ._device import as_device_points
from ._errors import InvalidArgument, NotCertified, OutOfBudget
from ._hull import Hull
from ._native import Certificate
from ._options import (
    Backend,
    Budgeted,
    CullMethod,
    Filtered,
    Unpack,
    Watched,
    require_known,
    settings,
    takes,
)


@takes(Filtered)
def convex_hull(points: Any, *, certify: bool = False, **options: Unpack[Filtered]) -> Hull:
    """The exact convex hull of any number of points in any dimension.

    No option changes the result. In 2D and 3D expected time is O(n + m log m) if the filter leaves
    m of n points; in d dimensions the number of facets, up to m^floor(d/2), bounds it from below.
    Memory is proportional to m and the number of facets: the points are not copied.

    Parameters
    ----------
    points : (n, d) array
        Read in place, without a copy, for float32, float64, booleans and integers up to 32 bits
        of any strides (slices, Fortran order, memory maps, fields of records), and for DLPack
        arrays on the host. Arrays in a CUDA device's memory (``__cuda_array_interface__``, DLPack)
        are culled there, and only survivors are copied. Other real types are converted to doubles
        if that is exact. It must not change during the call.
    certify : bool
        Check the result with an independent exact test, kept as ``hull.certificate``.

    Returns
    -------
    Hull

    Raises
    ------
    NotFinite (a ValueError)
        For a NaN, an infinity or a missing value; names the first bad point.
    InvalidArgument (a ValueError), TypeError
        For another shape, another type, or an unknown option.
    OutOfBudget (a MemoryError), BackendUnavailable (a RuntimeError), KeyboardInterrupt

    Examples
    --------
    >>> import cullhull, itertools
    >>> cube = list(itertools.product([0, 1], repeat=3))
    >>> hull = cullhull.convex_hull(cube, certify=True)
    >>> hull.volume, hull.facet_count, hull.certificate
    (1.0, 6, <Certificate: valid>)
    """
    chosen = settings(options)
    device = None if type(points) is np.ndarray else as_device_points(points)
    if device is not None:
        if certify:
            raise InvalidArgument("certify=True needs points on the host")
        return Hull._of(_core.convex_hull_of_device_points(device, chosen))
    array = as_point_set(points)
    hull = Hull._of(_core.convex_hull(array, chosen))
    if certify:
        hull.certificate = _core.certify(array, hull._solid, chosen)
        if not hull.certificate:
            raise NotCertified(hull.certificate.reason)
    return hull


@takes(Budgeted)
def cull(
    points: Any,
    *,
    backend: Backend = "auto",
    method: CullMethod = "auto",
    **options: Unpack[Budgeted],
) -> npt.NDArray[np.int64]:
    """Indices, ascending, of the points that may be extreme: a filter in front of other code.

    The filter keeps every extreme point and every duplicate of one, and discards only points that
    lie strictly inside the hull. So ``points[cullhull.cull(points)]`` has the same hull as
    ``points``. Time is proportional to the number of points, about that of reading them.

    Parameters
    ----------
    points : (n, d) array
    backend : 'auto', 'cpu' or 'cuda'
    method : 'auto', 'gauge', 'pseudo-hull' or 'none'
        'none' keeps all.

    Returns
    -------
    (s,) int64 array

    Raises
    ------
    NotFinite, InvalidArgument, OutOfBudget, BackendUnavailable, TypeError : as `convex_hull`

    Examples
    --------
    >>> import cullhull
    >>> points = cullhull.generate("ball", 1_000_000)
    >>> kept = cullhull.cull(points)
    >>> len(kept) < 100_000
    True
    >>> cullhull.convex_hull(points[kept]).volume == cullhull.convex_hull(points).volume
    True
    """
    if backend == method == "auto":
        chosen = settings(options, Budgeted)
    else:
        require_known(options, Budgeted)
        chosen = settings({**options, "backend": backend, "cull": method})
    device = as_device_points(points)
    if device is not None:
        return _core.cull_device_points(device, chosen)
    return _core.cull(as_point_set(points), chosen)


@takes(Watched)
def certify(points: Any, hull: Hull, **options: Unpack[Watched]) -> Certificate:
    """Checks exactly, and without the code that computed it, that ``hull`` is that of ``points``.

    Time is proportional to the number of points and facets, times a logarithm.

    Parameters
    ----------
    points : (n, d) array
    hull : Hull or ConvexHull

    Returns
    -------
    Certificate
        True if the hull is proven right; otherwise its ``reason`` names the first fault.

    Raises
    ------
    TypeError
        If `hull` is neither.
    InvalidArgument, NotFinite (ValueErrors)
        For points of another shape or type.

    Examples
    --------
    >>> import cullhull
    >>> points = cullhull.generate("ball", 100)
    >>> hull = cullhull.convex_hull(points)
    >>> cullhull.certify(points, hull)
    <Certificate: valid>
    >>> points[7] = 3
    >>> bool(cullhull.certify(points, hull))
    False
    """
    hull = getattr(hull, "hull", hull)  # of a ConvexHull
    if not isinstance(hull, Hull):
        found = f"{type(hull).__module__}.{type(hull).__qualname__}"
        raise TypeError(f"hull must be a cullhull.Hull or cullhull.ConvexHull, not {found}")
    return _core.certify(as_points(points), hull._solid, settings(options, Watched))


def generate(
    shape: str, count: int, dimension: int = 3, *, seed: int = 1
) -> npt.NDArray[np.float64]:
    """Test points: the same arguments give the same bits on every machine.

    Parameters
    ----------
    shape : str
        One of `shapes`.
    count, dimension : int
    seed : int
        From 0 to 2**64 - 1.

    Returns
    -------
    (count, dimension) float64 array

    Raises
    ------
    InvalidArgument (a ValueError)
        For an unknown shape, a dimension it does not have, or a number out of range.
    MemoryError

    Examples
    --------
    >>> import cullhull
    >>> cullhull.generate("cube", 1000, 4).shape
    (1000, 4)
    """
    n = as_count(count, "count")
    d = as_count(dimension, "dimension", least=1, most=2**32 - 1)
    chosen = as_count(seed, "seed", most=2**64 - 1)
    if not isinstance(shape, str):
        raise TypeError(f"shape must be a string, not {type(shape).__name__}")
    if n * d >= 2**60:
        raise OutOfBudget(f"{n} points in {d}D do not fit into memory")
    return _core.generate(shape, n, d, chosen).reshape(n, d)


def shapes() -> dict[str, str]:
    """The shapes that `generate` can make.

    Returns
    -------
    dict of str to str
        Names, with a description each.

    Examples
    --------
    >>> import cullhull
    >>> "sphere" in cullhull.shapes()
    True
    """
    return _core.shapes()

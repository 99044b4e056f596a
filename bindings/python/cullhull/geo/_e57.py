"""Points of E57 scans, read in blocks with pye57."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from .._errors import BadFile
from .._extras import needed

Rows = npt.NDArray[np.float64]

#: Points read at a time: Ctrl-C is heard in between.
_MANY = 1 << 18
_CARTESIAN = ("cartesianX", "cartesianY", "cartesianZ")
_SPHERICAL = ("sphericalRange", "sphericalAzimuth", "sphericalElevation")


def blocks(name: str) -> Iterator[Rows]:
    """The (n, 3) coordinates of the valid points of all scans, in the coordinates of the file: each
    scan is turned and moved by its pose. Raises `BadFile`, or `ImportError` without pye57."""
    pye57 = needed("pye57", "reading .e57 files", "e57")
    try:
        with pye57.E57(name) as file:
            for scan in range(file.scan_count):
                yield from _scan(file, scan, name)
    except pye57.libe57.E57Exception as error:
        first = (str(error).strip().splitlines() or ["not readable"])[0]  # the rest is a trace
        raise BadFile(f"{name}: {first}") from None


def _scan(file: Any, scan: int, name: str) -> Iterator[Rows]:
    header = file.get_header(scan)
    known = set(header.point_fields)
    axes = next((a for a in (_CARTESIAN, _SPHERICAL) if known.issuperset(a)), None)
    if axes is None:
        raise BadFile(f"{name}: scan {scan} has neither cartesian nor spherical coordinates")
    invalid = ("cartesian" if axes is _CARTESIAN else "spherical") + "InvalidState"
    columns = [*axes, *([invalid] if invalid in known else [])]
    data, buffers = file.make_buffers(columns, _MANY)
    reader = header.points.reader(buffers)
    try:
        while count := reader.read():
            rows = np.column_stack([data[axis][:count] for axis in axes])
            if invalid in data:
                rows = rows[data[invalid][:count] == 0]
            if axes is _SPHERICAL:
                rows = _cartesian(rows)
            if header.has_pose():
                rows = file.to_global(rows, header.rotation, header.translation)
            yield np.ascontiguousarray(rows)
    finally:
        reader.close()


def _cartesian(rows: Rows) -> Rows:
    """From range, azimuth and elevation, as the standard has them."""
    distance, azimuth, elevation = rows.T
    level = distance * np.cos(elevation)
    axes = level * np.cos(azimuth), level * np.sin(azimuth), distance * np.sin(elevation)
    return np.column_stack(axes)

"""Vertices of vector files (GeoPackage, Shapefile, FlatGeobuf, GML, KML), read with pyogrio."""

from __future__ import annotations

import os
import re
import struct
from typing import Any

import numpy as np
import numpy.typing as npt

from ._errors import BadFile

Rows = npt.NDArray[np.float64]

ENDINGS = (".gpkg", ".shp", ".fgb", ".gml", ".kml")

_POINT, _LINE, _POLYGON, _TRIANGLE = 1, 2, 3, 17
_COLLECTIONS = (4, 5, 6, 7, 15, 16)  # multi-, collections, polyhedral surfaces, TINs
_LAYER = re.compile(r"(.*\.gpkg):([^/]+)$", re.IGNORECASE)


def split_layer(word: str) -> tuple[str, str | None]:
    """FILE.gpkg:LAYER as its two parts."""
    found = _LAYER.match(word)
    return (found[1], found[2]) if found else (word, None)


def vertices(word: str) -> Rows:
    """The positions of all geometries, (n, 2) or (n, 3); a ring's last, which is its first again,
    is not taken. Raises `BadFile`, or `ImportError` without pyogrio."""
    path, layer = split_layer(word)
    try:
        import pyogrio
    except ImportError:
        raise ImportError(
            f"{path}: reading {os.path.splitext(path)[1]} files needs pyogrio, which is not "
            "installed: pip install 'cullhull[vector]'"
        ) from None
    try:
        layers = [str(name) for name, _ in pyogrio.list_layers(path)]
        if layer is None and len(layers) > 1:
            named = ", ".join(f"{path}:{name}" for name in layers)
            raise BadFile(f"{path}: has several layers: {named}")
        shapes = pyogrio.raw.read(path, layer=layer, columns=[])[2]
    except BadFile:
        raise
    except Exception as error:  # pyogrio's, which have no common base
        raise BadFile(f"{path}: {' '.join(str(error).split())}") from None
    parts: list[Rows] = []
    for shape in () if shapes is None else shapes:
        if shape is not None:
            _add(parts, bytes(shape), 0)
    return _together(parts, path)


def _together(parts: list[Rows], path: str) -> Rows:
    widths = {part.shape[1] for part in parts}
    if len(widths) > 1:
        raise BadFile(f"{path}: some geometries have heights and others have none")
    return np.concatenate(parts) if parts else np.empty((0, 2))


def _add(parts: list[Rows], data: bytes, at: int) -> int:
    """Adds the vertices of the WKB geometry at byte `at`; returns where it ends."""
    order = "<" if data[at] == 1 else ">"
    (kind,) = struct.unpack_from(order + "I", data, at + 1)
    at += 5
    if kind & 0x20000000:  # an SRID follows
        at += 4
    base = kind & 0xFFFF
    has_z = bool(kind & 0x80000000) or base // 1000 in (1, 3)
    width = 2 + has_z + (bool(kind & 0x40000000) or base // 1000 in (2, 3))
    base %= 1000

    def rows(count: int) -> Rows:
        nonlocal at
        found = np.frombuffer(data, order + "f8", count * width, at).reshape(count, width)
        at += found.nbytes
        return found[:, : 2 + has_z].astype(np.float64)

    def number() -> int:
        nonlocal at
        (found,) = struct.unpack_from(order + "I", data, at)
        at += 4
        return int(found)

    if base == _POINT:
        point = rows(1)
        if not np.isnan(point).all():  # POINT EMPTY
            parts.append(point)
    elif base == _LINE:
        parts.append(rows(number()))
    elif base in (_POLYGON, _TRIANGLE):
        for _ in range(number()):
            ring = rows(number())
            closed = len(ring) > 1 and (ring[0] == ring[-1]).all()
            parts.append(ring[:-1] if closed else ring)
    elif base in _COLLECTIONS:
        for _ in range(number()):
            at = _add(parts, data, at)
    else:
        raise BadFile(f"curves (WKB type {base}) have no vertices to take")
    return at


def as_ply(points: Any) -> bytes:
    """As a PLY of doubles, which names its columns x, y and z."""
    axes = "".join(f"property double {axis}\n" for axis in "xyz"[: points.shape[1]])
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n{axes}end_header\n"
    rows: bytes = points.astype("<f8").tobytes()
    return head.encode() + rows

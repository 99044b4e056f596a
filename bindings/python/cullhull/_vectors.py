"""Vertices of vector files (GeoPackage, Shapefile, FlatGeobuf, GML, KML), with pyogrio."""

from __future__ import annotations

import importlib
import os
import re
import struct
import warnings
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import numpy as np
import numpy.typing as npt

from ._errors import BadFile, Error

Rows = npt.NDArray[np.float64]

ENDINGS = (".gpkg", ".shp", ".fgb", ".gml", ".kml")

_POINT, _LINE, _POLYGON, _TRIANGLE = 1, 2, 3, 17
_COLLECTIONS = (4, 5, 6, 7, 15, 16)  # multi-, collections, polyhedral surfaces, TINs
#: Geometries read at a time: some tenths of a second where they are polygons.
_MANY = 1 << 14
#: GDAL's own stream of FlatGeobuf loses features beside those without a geometry (GDAL 3.12).
_PLAIN_STREAM = "OGR_FLATGEOBUF_STREAM_BASE_IMPL"
#: How points of 2 and 3 coordinates begin, in the byte order of most files.
_PLAIN_POINTS = {struct.pack("<BI", 1, kind): 2 + (kind != 1) for kind in (1, 1001, 0x80000001)}
_LAYER = re.compile(r"(.*\.gpkg):([^/]+)$", re.IGNORECASE)


def split_layer(word: str) -> tuple[str, str | None]:
    """FILE.gpkg:LAYER as its two parts."""
    found = _LAYER.match(word)
    return (found[1], found[2]) if found else (word, None)


def blocks(word: str, size: int | None = None) -> Iterator[Rows]:
    """The positions of all geometries, (n, 2) or (n, 3) a block, of at most `size` rows if given; a
    ring's last, which is its first again, is not taken.

    A block is of a few thousand geometries, so that memory stays small and Ctrl-C is heard. At
    least one block comes, perhaps of no rows. Raises `BadFile`, or `ImportError` without a package.
    """
    path, layer = split_layer(word)
    before: Rows | None = None
    empty = True
    for parts in _parts(path, layer):
        if not parts:
            continue
        before = rows = _together(parts, path, before)
        empty = empty and not len(rows)
        for start in range(0, len(rows), size or len(rows) or 1):
            yield rows[start : start + size] if size else rows
    if empty:
        yield np.empty((0, 2)) if before is None else before


def _together(parts: list[Rows], path: str, before: Rows | None = None) -> Rows:
    """One array, of as many coordinates as the block before has."""
    widths = {part.shape[1] for part in (*parts, *([] if before is None else [before]))}
    if len(widths) > 1:
        raise BadFile(f"{path}: some geometries have heights and others have none")
    return np.concatenate(parts) if parts else np.empty((0, 2))


def _parts(path: str, layer: str | None) -> Iterator[list[Rows]]:
    """The vertices of some thousand geometries at a time."""
    pyogrio = _pyogrio(path)
    try:
        with ExitStack() as stack:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of measures, which are not taken
                name = _chosen(pyogrio, path, layer)
                opened = pyogrio.open_arrow(
                    path, layer=name, columns=[], batch_size=_MANY, use_pyarrow=True
                )
                _, stream = stack.enter_context(opened)
            before = pyogrio.get_gdal_config_option(_PLAIN_STREAM)
            stack.callback(pyogrio.set_gdal_config_options, {_PLAIN_STREAM: before})
            pyogrio.set_gdal_config_options({_PLAIN_STREAM: True})
            for offsets, data in _binary_batches(stream):
                parts: list[Rows] = []
                try:
                    _add_all(parts, offsets, data)
                except BadFile as error:
                    raise BadFile(f"{path}: {error}") from None
                yield parts
    except (Error, ImportError, MemoryError):
        raise
    except Exception as error:  # pyogrio's, which have no common base
        raise BadFile(f"{path}: {' '.join(str(error).split())}") from None


def _binary_batches(
    stream: Any,
) -> Iterator[tuple[npt.NDArray[np.int64], npt.NDArray[np.uint8]]]:
    """Of each batch of a pyarrow reader the first column of bytes: where each value begins and
    ends, and the bytes of all values; of a missing one none. Nothing if there is no such column."""
    wide = {"binary": False, "large_binary": True}
    kinds = [(i, wide[str(field.type)]) for i, field in enumerate(stream.schema)
             if str(field.type) in wide]
    if not kinds:
        return
    place, large = kinds[0]
    for batch in stream:
        column = batch.column(place)
        if not len(column):
            continue
        _, ends, data = column.buffers()
        offsets = np.frombuffer(ends, dtype="<i8" if large else "<i4")
        offsets = offsets[column.offset : column.offset + len(column) + 1].astype(np.int64)
        if (np.diff(offsets) < 0).any():
            raise OSError("the values of the Arrow stream overlap")
        taken = np.frombuffer(data or b"", dtype=np.uint8)[offsets[0] : offsets[-1]]
        yield offsets - offsets[0], taken


def _pyogrio(path: str) -> Any:
    for package in ("pyogrio", "pyarrow"):
        try:
            importlib.import_module(package)
        except ImportError:
            raise ImportError(
                f"{path}: reading {os.path.splitext(path)[1]} files needs {package}, which is not "
                "installed: pip install 'cullhull[vector]'"
            ) from None
    return importlib.import_module("pyogrio")


def _chosen(pyogrio: Any, path: str, layer: str | None) -> str:
    """The layer to read: the one that is named, or the only one with geometries."""
    found = {str(name): kind for name, kind in pyogrio.list_layers(path)}
    spatial = [name for name, kind in found.items() if kind is not None]
    if layer is not None and layer not in found:
        raise BadFile(f"{path}: has no layer {layer!r}; there are {', '.join(found) or 'none'}")
    if not spatial or (layer is not None and layer not in spatial):
        which = "no layer has" if layer is None else f"layer {layer!r} has no"
        raise BadFile(f"{path}: {which} geometries")
    if layer is None and len(spatial) > 1:
        named = ", ".join(f"{path}:{name}" for name in spatial)
        raise BadFile(f"{path}: has several layers: {named}")
    return layer or spatial[0]


def _add_all(
    parts: list[Rows], offsets: npt.NDArray[np.int64], data: npt.NDArray[np.uint8]
) -> None:
    """Adds the vertices of many geometries in WKB; of points at once."""
    lengths = np.diff(offsets)
    size = int(lengths[0]) if len(lengths) else 0
    if size >= 21 and (lengths == size).all():
        rows = data.reshape(-1, size)
        head = rows[0, :5].tobytes()
        if head in _PLAIN_POINTS and (rows[:, :5] == rows[0, :5]).all():
            width = _PLAIN_POINTS[head]
            points = np.ascontiguousarray(rows[:, 5 : 5 + 8 * width]).view("<f8")
            parts.append(points[~np.isnan(points).all(axis=1)])  # no POINT EMPTY
            return
    whole = data.tobytes()
    for at, length in zip(offsets[:-1].tolist(), lengths.tolist()):
        if length:  # a feature may have no geometry
            _add(parts, whole, at)


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

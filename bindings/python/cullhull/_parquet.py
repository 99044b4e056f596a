"""Which columns of a Parquet file are the points, and how their values become rows of numbers."""

from __future__ import annotations

import importlib
import json
import struct
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Union

import numpy as np
import numpy.typing as npt

from ._columns import side_by_side
from ._errors import BadFile, InvalidArgument, ShapeWarning, warn

Columns = Union[Sequence[str], Sequence[int], None]
Rows = npt.NDArray[Any]

_HEIGHTS = ("z", "height", "elevation", "altitude")
#: Coordinates by their names, in the order of src/io/columns.cpp.
_KNOWN = (
    ("x", "y", ("z",)),
    ("lon", "lat", _HEIGHTS),
    ("longitude", "latitude", _HEIGHTS),
    ("easting", "northing", _HEIGHTS),
)
_NUMBERING = ("id", "index", "fid", "", "__index_level_0__")


class Choice(NamedTuple):
    """The columns to read, and what makes (n, d) rows of a batch of them."""

    columns: list[str]
    #: Of one column, its name and the number of its first row; None: each column is a coordinate.
    rows: Callable[[Any, str, int], Rows] | None


def choose(name: str, schema: Any, columns: Columns) -> Choice:
    """By `columns` or, without them, by names and types; warns where these leave a doubt.

    Raises `InvalidArgument` where no column holds points.
    """
    types = {field.name: field.type for field in schema}
    if columns is not None:
        return _asked_for(name, types, columns)
    numbers = [c for c, kind in types.items() if _is_number(kind)]
    known = _known(numbers)
    if known:
        return Choice(known, None)
    geometry = _geometry(schema, types)
    if geometry:
        return Choice([geometry], _rows_of(types[geometry]))
    lists = [c for c, kind in types.items() if _rows_of(kind) is _rows_of_lists]
    if len(lists) > 1:
        raise InvalidArgument(f"{name}: columns= says which holds the points: {_listed(lists)}")
    if lists:
        return Choice(lists, _rows_of_lists)
    taken = [c for c in numbers if c.lower() not in _NUMBERING]
    if not taken:
        raise InvalidArgument(f"{name}: no column of numbers; there are {_described(types)}")
    left = [c for c in types if c not in taken]
    warn(
        f"{name}: {_listed(taken)} are taken as coordinates"
        + (f", not {_listed(left)}" if left else ""),
        ShapeWarning,
    )
    return Choice(taken, None)


def _asked_for(name: str, types: dict[str, Any], columns: Sequence[Any]) -> Choice:
    names = list(types)
    wanted = []
    for c in columns:
        if isinstance(c, str):
            same = [n for n in names if n == c] or [n for n in names if n.lower() == c.lower()]
            if len(same) != 1:
                raise InvalidArgument(f"{name}: no column {c!r}; there are {_described(types)}")
            wanted += same
        elif isinstance(c, (int, np.integer)) and 0 <= c < len(names):
            wanted.append(names[int(c)])
        else:
            raise InvalidArgument(f"{name}: columns must be numbers from 0 to {len(names) - 1}")
    if not wanted:
        raise InvalidArgument(f"{name}: columns names none")
    for c in wanted:
        rows = _rows_of(types[c])
        if rows is not None and len(wanted) == 1:
            return Choice(wanted, rows)
        if rows is not None:
            raise InvalidArgument(f"{name}: column {c!r} holds whole points; it is read alone")
        if not _is_number(types[c]):
            raise InvalidArgument(f"{name}: column {c!r} holds {types[c]}, not numbers")
    return Choice(wanted, None)


def _known(names: list[str]) -> list[str]:
    def one(wanted: Sequence[str]) -> list[str]:
        return [n for n in names if n.lower() in wanted]

    for first, second, third in _KNOWN:
        x, y, z = one((first,)), one((second,)), one(third)
        if len(x) == len(y) == 1 and len(z) <= 1:
            return x + y + z
    return []


def _geometry(schema: Any, types: dict[str, Any]) -> str:
    """The column that GeoParquet's metadata call the primary one, if it may hold points."""
    try:
        geo = json.loads((schema.metadata or {}).get(b"geo", b"{}"))
        primary = geo.get("primary_column", "")
    except (ValueError, AttributeError):
        return ""
    return primary if primary in types and _rows_of(types[primary]) is not None else ""


def _listed(names: Sequence[str], most: int = 12) -> str:
    return ", ".join(repr(n) for n in names[:most]) + (", ..." if len(names) > most else "")


def _described(types: dict[str, Any], most: int = 12) -> str:
    text = ", ".join(f"{n!r} ({kind})" for n, kind in list(types.items())[:most])
    return text + (", ..." if len(types) > most else "")


def _is_number(kind: Any) -> bool:
    t: Any = importlib.import_module("pyarrow.types")

    return bool(t.is_integer(kind) or t.is_floating(kind))


def _rows_of(kind: Any) -> Callable[[Any, str, int], Rows] | None:
    t: Any = importlib.import_module("pyarrow.types")

    if t.is_fixed_size_list(kind) or t.is_list(kind) or t.is_large_list(kind):
        return _rows_of_lists if _is_number(kind.value_type) else None
    if t.is_struct(kind):
        names = {kind.field(i).name for i in range(kind.num_fields)}
        return _rows_of_structs if {"x", "y"} <= names else None
    if t.is_binary(kind) or t.is_large_binary(kind):
        return _rows_of_wkb
    return None


def _refuse_holes(array: Any, column: str) -> None:
    if array.null_count:
        raise BadFile(f"column {column!r} has missing values")


def _rows_of_lists(array: Any, column: str, first: int = 0) -> Rows:
    _refuse_holes(array, column)
    if len(array) == 0:
        return np.empty((0, 0))
    flat = array.flatten()
    _refuse_holes(flat, column)
    lengths = set(np.unique(array.value_lengths().to_numpy(zero_copy_only=False)).tolist())
    if len(lengths) > 1:
        few, many = sorted(lengths)[:2]
        raise BadFile(f"column {column!r}: lists of {few} and of {many} numbers")
    return np.asarray(flat.to_numpy(zero_copy_only=False)).reshape(len(array), lengths.pop())


def _rows_of_structs(array: Any, column: str, first: int = 0) -> Rows:
    _refuse_holes(array, column)
    names = [array.type.field(i).name for i in range(array.type.num_fields)]
    names = [axis for axis in "xyz" if axis in names]
    axes = [array.field(axis) for axis in names]
    for axis in axes:
        _refuse_holes(axis, column)
    parts = [axis.to_numpy(zero_copy_only=False) for axis in axes]
    return side_by_side(parts, names, f"column {column!r}", first)


def _rows_of_wkb(array: Any, column: str, first: int = 0) -> Rows:
    _refuse_holes(array, column)
    geometries = array.to_pylist()
    if not geometries:
        return np.empty((0, 0))
    whole = b"".join(geometries)
    size = len(geometries[0])
    if len(whole) == size * len(geometries) and all(len(g) == size for g in geometries):
        bytes_ = np.frombuffer(whole, np.uint8).reshape(-1, size)
        if size >= 9 and (bytes_[:, :5] == bytes_[0, :5]).all():
            order, width, start = _wkb_head(geometries[0], column, first)
            if size >= start + 8 * width:
                packed = np.ascontiguousarray(bytes_[:, start : start + 8 * width])
                rows = packed.view(order + "f8").astype(np.float64)
                empty = np.flatnonzero(np.isnan(rows).all(axis=1))
                if empty.size:
                    raise BadFile(f"column {column!r}, row {first + empty[0]}: an empty point")
                return rows
    return np.array(_wkb_one_by_one(geometries, column, first))


def _wkb_one_by_one(
    geometries: list[bytes], column: str, first: int
) -> list[tuple[float, ...]]:
    rows: list[tuple[float, ...]] = []
    for i, geometry in enumerate(geometries, first):
        order, width, start = _wkb_head(geometry, column, i)
        if rows and width != len(rows[0]):
            raise BadFile(
                f"column {column!r}, row {i}: {width} coordinates where the first has {len(rows[0])}"
            )
        rows.append(struct.unpack_from(f"{order}{width}d", geometry, start))
        if all(v != v for v in rows[-1]):
            raise BadFile(f"column {column!r}, row {i}: an empty point")
    return rows


def _wkb_head(geometry: bytes, column: str, row: int) -> tuple[str, int, int]:
    """Byte order, number of coordinates without a measure, and where they begin; of a point in
    ISO's well-known binary or PostGIS's."""
    if len(geometry) < 5 or geometry[0] > 1:
        raise BadFile(f"column {column!r}, row {row}: no geometry in WKB")
    order = "<" if geometry[0] else ">"
    (code,) = struct.unpack_from(order + "I", geometry, 1)
    kind, dimensions = code & 0xFFFF, (code & 0xFFFF) // 1000
    if kind % 1000 != 1:
        raise BadFile(
            f"column {column!r}, row {row}: a geometry of type {kind % 1000}, not a point (1)"
        )
    width = 3 if dimensions in (1, 3) or code & 0x80000000 else 2
    start = 9 if code & 0x20000000 else 5
    if len(geometry) < start + 8 * width:
        raise BadFile(f"column {column!r}, row {row}: no geometry in WKB")
    return order, width, start

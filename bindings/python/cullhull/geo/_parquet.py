"""Which columns of a Parquet file are the points, and how their values become rows of numbers: of
GeoParquet the vertices of all geometries, in WKB or in GeoArrow's nested lists."""

from __future__ import annotations

import csv
import importlib
import json
import struct
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple, Union

import numpy as np
import numpy.typing as npt

from .. import _core
from .._errors import BadFile, InvalidArgument, ShapeWarning, warn
from .._extras import needed
from . import _vectors
from ._columns import faults_of_a_package, side_by_side

Columns = Union[Sequence[str], Sequence[int], None]
Rows = npt.NDArray[Any]

#: pandas writes an index without a name so.
_INDEX = "__index_level_0__"
#: GeoArrow's encodings, by the lists around a position.
_NESTED = {"point": 0, "linestring": 1, "multipoint": 1, "polygon": 2, "multilinestring": 2,
           "multipolygon": 3}  # fmt: skip
_EXTENSION = b"ARROW:extension:name"
#: Names of columns in WKB without metadata.
_PLAIN = ("geometry", "geom", "the_geom", "wkb_geometry", "wkb", "shape")


class Taken(NamedTuple):
    """The points of a batch of values, and the number in the batch of each point's value."""

    rows: Rows
    owners: npt.NDArray[np.int64]


class Choice(NamedTuple):
    """The columns to read, and what makes (n, d) rows of a batch of them."""

    columns: list[str]
    #: Called with a column, its name and the number of its first row; None: each column is a
    #: coordinate.
    rows: Callable[[Any, str, int], Taken] | None
    #: Whether the column holds geometries, of which some may be missing.
    geometries: bool = False


def choose(
    name: str, schema: Any, columns: Columns, peek: Callable[[str], bytes | None] | None = None
) -> Choice:
    """By `columns` or, without them, by the metadata of GeoParquet, by names and types; warns where
    these leave a doubt. `peek` gives the first value of a column of bytes.

    Raises `InvalidArgument` where no column holds points.
    """
    types = {field.name: _storage(field.type) for field in schema}
    shapes = _encodings(name, schema, types)
    if columns is not None:
        return _asked_for(name, types, shapes, columns)
    primary = _primary(schema)
    if primary is not None:
        if primary not in shapes:
            raise InvalidArgument(
                f"{name}: its geometries, column {primary!r}, are neither WKB nor lists of "
                "coordinates"
            )
        return Choice([primary], shapes[primary], True)
    numbers = [c for c, kind in types.items() if _is_number(kind)]
    numbers = [c for c in numbers if c != _INDEX]
    known = coordinates_of(numbers, series=False)
    if known:
        return Choice(known, None)
    found = list(shapes) or [
        c for c, kind in types.items() if _is_bytes(kind) and _looks_like_wkb(c, peek)
    ]
    if len(found) > 1:
        raise InvalidArgument(f"{name}: columns= says which holds the points: {_listed(found)}")
    if found:
        return Choice(found, shapes.get(found[0], _rows_of_wkb), True)
    lists = [c for c, kind in types.items() if _rows_of(kind) is _rows_of_lists]
    if len(lists) > 1:
        raise InvalidArgument(f"{name}: columns= says which holds the points: {_listed(lists)}")
    if lists:
        return Choice(lists, _rows_of_lists)
    if not numbers:
        raise InvalidArgument(f"{name}: no column of numbers; there are {_described(types)}")
    taken = coordinates_of(numbers)
    if not taken:
        raise InvalidArgument(
            f"{name}: the names of the columns are not known as coordinates: {_listed(numbers)}; "
            "columns= takes some by name or number"
        )
    left = [c for c in types if c not in taken]
    warn(
        f"{name}: {_listed(taken)} are taken as coordinates"
        + (f", not {_listed(left)}" if left else ""),
        ShapeWarning,
    )
    return Choice(taken, None)


def _storage(kind: Any) -> Any:
    """What an extension type holds: of GeoArrow's, where its package is loaded."""
    return getattr(kind, "storage_type", kind)


def _metadata(schema: Any) -> dict[str, Any]:
    """The metadata `geo` of GeoParquet."""
    try:
        geo = json.loads((schema.metadata or {}).get(b"geo", b"{}"))
    except ValueError:
        return {}
    return geo if isinstance(geo, dict) else {}


def _primary(schema: Any) -> str | None:
    """The column that GeoParquet's metadata call the primary one."""
    geo = _metadata(schema)
    primary = geo.get("primary_column")
    if not isinstance(primary, str):
        columns = geo.get("columns")
        primary = next(iter(columns), None) if isinstance(columns, dict) else None
    return primary if primary in schema.names else None


def _encodings(
    name: str, schema: Any, types: dict[str, Any]
) -> dict[str, Callable[[Any, str, int], Taken]]:
    """The columns that are said to hold geometries, and how these are read."""
    said = _metadata(schema).get("columns")
    found: dict[str, Callable[[Any, str, int], Taken]] = {}
    for field in schema:
        of_geo = said.get(field.name) if isinstance(said, dict) else None
        encoding = of_geo.get("encoding") if isinstance(of_geo, dict) else None
        extension = getattr(field.type, "extension_name", "") or (
            (field.metadata or {}).get(_EXTENSION, b"").decode(errors="replace")
        )
        if not isinstance(encoding, str):
            encoding = extension
        encoding = encoding.lower().replace("geoarrow.", "").replace("ogc.", "")
        kind = types[field.name]
        if encoding == "wkb" or (isinstance(of_geo, dict) and not encoding):
            if _is_bytes(kind):
                found[field.name] = _rows_of_wkb
        elif encoding in _NESTED and _nesting(kind) == _NESTED[encoding]:
            closed = encoding.endswith("polygon")
            found[field.name] = _rows_of_rings if closed else _rows_of_nested
    return found


def _is(kind: Any, *names: str) -> bool:
    """Whether a type of Arrow is one of those that Arrow calls so."""
    types: Any = importlib.import_module("pyarrow.types")
    return any(getattr(types, f"is_{name}")(kind) for name in names)


def _nesting(kind: Any) -> int | None:
    """The lists around a position, a struct of x and y or a list of fixed size."""
    depth = 0
    while _is(kind, "list", "large_list"):
        kind, depth = kind.value_type, depth + 1
    if _is(kind, "fixed_size_list"):
        return depth if _is_number(kind.value_type) and 2 <= kind.list_size <= 4 else None
    if _is(kind, "struct"):
        return depth if {"x", "y"} <= {kind.field(i).name for i in range(kind.num_fields)} else None
    return None


def _looks_like_wkb(column: str, peek: Callable[[str], bytes | None] | None) -> bool:
    first = peek(column) if peek is not None else None
    if first is None:
        return column.lower() in _PLAIN
    if len(first) < 9 or first[0] > 1:
        return False
    return 1 <= _vectors.wkb_head(first, 0)[0] <= 17 and 0 < first[1 if first[0] else 4] <= 17


def _asked_for(
    name: str,
    types: dict[str, Any],
    shapes: dict[str, Callable[[Any, str, int], Taken]],
    columns: Sequence[Any],
) -> Choice:
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
        rows = shapes.get(c, _rows_of(types[c]))
        if rows is not None and len(wanted) == 1:
            return Choice(wanted, rows, c in shapes or rows is _rows_of_wkb)
        if rows is not None:
            raise InvalidArgument(f"{name}: column {c!r} holds whole points; it is read alone")
        if not _is_number(types[c]):
            raise InvalidArgument(f"{name}: column {c!r} holds {types[c]}, not numbers")
    return Choice(wanted, None)


def coordinates_of(names: list[str], series: bool = True) -> list[str]:
    """Those that are coordinates by their names, as in a text; `series`: or as `a`, `b`, `c`."""
    return [names[j] for j in _core.coordinate_columns(names, series)]


def _listed(names: Sequence[str], most: int = 12) -> str:
    return ", ".join(repr(n) for n in names[:most]) + (", ..." if len(names) > most else "")


def _described(types: dict[str, Any], most: int = 12) -> str:
    text = ", ".join(f"{n!r} ({kind})" for n, kind in list(types.items())[:most])
    return text + (", ..." if len(types) > most else "")


def _is_number(kind: Any) -> bool:
    return _is(kind, "integer", "floating")


def _is_bytes(kind: Any) -> bool:
    return _is(kind, "binary", "large_binary")


def _rows_of(kind: Any) -> Callable[[Any, str, int], Taken] | None:
    """How a column of points that is not said to hold geometries is read."""
    if _is(kind, "fixed_size_list", "list", "large_list"):
        return _rows_of_lists if _is_number(kind.value_type) else None
    if _is(kind, "struct"):
        names = {kind.field(i).name for i in range(kind.num_fields)}
        return _rows_of_structs if {"x", "y"} <= names else None
    return _rows_of_wkb if _is_bytes(kind) else None


def _refuse_holes(array: Any, column: str) -> None:
    if array.null_count:
        raise BadFile(f"column {column!r} has missing values")


def _one_each(rows: Rows) -> Taken:
    return Taken(rows, np.arange(len(rows)))


def _rows_of_lists(array: Any, column: str, first: int = 0) -> Taken:
    _refuse_holes(array, column)
    if len(array) == 0:
        return _one_each(np.empty((0, 0)))
    flat = array.flatten()
    _refuse_holes(flat, column)
    lengths = set(np.unique(array.value_lengths().to_numpy(zero_copy_only=False)).tolist())
    if len(lengths) > 1:
        few, many = sorted(lengths)[:2]
        raise BadFile(f"column {column!r}: lists of {few} and of {many} numbers")
    numbers = np.asarray(flat.to_numpy(zero_copy_only=False))
    return _one_each(numbers.reshape(len(array), lengths.pop()))


def _rows_of_structs(array: Any, column: str, first: int = 0) -> Taken:
    _refuse_holes(array, column)
    return _one_each(_positions(array, column, first))


def _positions(array: Any, column: str, first: int) -> Rows:
    """x, y and z of an array of structs, or of lists of a fixed size; no measures."""
    if _is(array.type, "fixed_size_list"):
        width = array.type.list_size
        numbers = np.asarray(array.flatten().to_numpy(zero_copy_only=False)).reshape(-1, width)
        measured = array.type.value_field.name in ("xym", "xyzm")
        return numbers[:, : width - measured].astype(np.float64)
    names = [array.type.field(i).name for i in range(array.type.num_fields)]
    names = [axis for axis in "xyz" if axis in names]
    axes = [array.field(axis) for axis in names]
    for axis in axes:
        _refuse_holes(axis, column)
    parts = [axis.to_numpy(zero_copy_only=False) for axis in axes]
    return side_by_side(parts, names, f"column {column!r}", first)


def _present(array: Any) -> tuple[Any, npt.NDArray[np.int64]]:
    """The values that are there, and their numbers."""
    array = getattr(array, "storage", array)
    owners = np.flatnonzero(array.is_valid().to_numpy(zero_copy_only=False))
    return array.drop_null() if array.null_count else array, owners


def _rows_of_nested(array: Any, column: str, first: int = 0, *, rings: bool = False) -> Taken:
    array, owners = _present(array)
    closing: npt.NDArray[np.int64] | None = None
    while _is(array.type, "list", "large_list"):
        lengths = array.value_lengths().to_numpy(zero_copy_only=False).astype(np.int64)
        owners = np.repeat(owners, lengths)
        array = array.flatten()
        if rings and not _is(array.type, "list", "large_list"):
            ends = np.cumsum(lengths)
            longer = lengths > 1
            closing = np.column_stack([(ends - lengths)[longer], ends[longer] - 1])
    rows = np.asarray(_positions(array, column, first), dtype=np.float64)
    keep = np.array(~np.isnan(rows).all(axis=1), dtype=bool)  # an empty point
    if closing is not None:
        same = (rows[closing[:, 0]] == rows[closing[:, 1]]).all(axis=1)
        keep[closing[same, 1]] = False
    return Taken(rows[keep], owners[keep])


def _rows_of_rings(array: Any, column: str, first: int = 0) -> Taken:
    """The rows of polygons, without a ring's last position, which is its first again."""
    return _rows_of_nested(array, column, first, rings=True)


def _rows_of_wkb(array: Any, column: str, first: int = 0) -> Taken:
    array, owners = _present(array)
    if len(array) == 0:
        return Taken(np.empty((0, 0)), owners)
    offsets, data = _vectors.binary_values(array, "large" in str(array.type))
    lengths = np.diff(offsets)
    try:
        points = _vectors.plain_points(lengths, data)
    except struct.error:
        points = None
    if points is not None:
        keep = ~np.isnan(points).all(axis=1)
        return Taken(points[keep], owners[keep])
    whole = data.tobytes()
    parts: list[Rows] = []
    of: list[npt.NDArray[np.int64]] = []
    width = 0
    for owner, at, length in zip(owners.tolist(), offsets.tolist(), lengths.tolist()):
        where = f"column {column!r}, row {first + owner}"
        for part in _parts_of_wkb(whole[at : at + length], where):
            if width not in (0, part.shape[1]):
                raise BadFile(
                    f"{where}: {part.shape[1]} coordinates where those before have {width}"
                )
            width = part.shape[1]
            parts.append(part)
            of.append(np.full(len(part), owner))
    if not parts:
        return Taken(np.empty((0, 0)), owners[:0])
    return Taken(np.concatenate(parts), np.concatenate(of))


def _parts_of_wkb(geometry: bytes, where: str) -> list[Rows]:
    parts: list[Rows] = []
    try:
        if not geometry or geometry[0] > 1:
            raise ValueError
        _vectors.add(parts, geometry, 0)
    except BadFile as error:
        raise BadFile(f"{where}: {error}") from None
    except (struct.error, ValueError, IndexError, RecursionError):
        raise BadFile(f"{where}: no geometry in WKB") from None
    return [part for part in parts if len(part)]


# ------------------------------------------------------------- for ``python -m cullhull``


def _opened(path: str) -> Any:
    parquet = needed("pyarrow.parquet", "reading .parquet files", "parquet")
    arrow = needed("pyarrow", "reading .parquet files", "parquet")
    with faults_of_a_package(path, arrow.lib.ArrowException):
        return parquet.ParquetFile(path)


def peek_of(file: Any) -> Callable[[str], bytes | None]:
    """What `choose` asks of an open file."""

    def first(column: str) -> bytes | None:
        for batch in file.iter_batches(batch_size=64, columns=[column]):
            for value in batch.column(0):
                if value.is_valid:
                    return bytes(value.as_py())
        return None

    return first


def column_names(path: str) -> list[str]:
    return [str(name) for name in _opened(path).schema_arrow.names]


def crs_of(path: str) -> str | None:
    """The system of the primary geometries: AUTHORITY:CODE; None where the file states none."""
    schema = _opened(path).schema_arrow
    primary = _primary(schema)
    if primary is None:
        return None
    said = _metadata(schema).get("columns", {}).get(primary, {})
    if "crs" not in said:
        return "OGC:CRS84"  # as GeoParquet has it
    crs = said["crs"]
    if isinstance(crs, dict) and "components" in crs:
        crs = next(iter(crs["components"]), None)
    found = crs.get("id") if isinstance(crs, dict) else None
    return f"{found['authority']}:{found['code']}" if isinstance(found, dict) else None


def write_table(target: Path, path: str, columns: Columns, fields: list[str]) -> None:
    """The points as a .csv of x, y (z) and these fields of their rows."""
    file = _opened(path)
    wanted, rows, _ = choose(path, file.schema_arrow, columns, peek_of(file))
    begun = False
    with open(target, "w", newline="", encoding="utf-8") as out:
        lines = csv.writer(out, lineterminator="\n")
        done = 0
        for batch in file.iter_batches(batch_size=1 << 16, columns=list({*wanted, *fields})):
            try:
                taken = (
                    _one_each(
                        side_by_side(
                            [batch.column(c).to_numpy(zero_copy_only=False) for c in wanted],
                            wanted,
                            path,
                            done,
                        )
                    )
                    if rows is None
                    else rows(batch.column(wanted[0]), wanted[0], done)
                )
            except BadFile as error:
                raise BadFile(f"{path}: {error}") from None
            done += len(batch)
            if not len(taken.rows):
                continue
            if taken.rows.shape[1] not in (2, 3):
                raise BadFile(f"{path}: columns beside points are read in 2D and 3D alone")
            if not begun:
                lines.writerow([*"xyz"[: taken.rows.shape[1]], *fields])
            begun = True
            values = [batch.column(f).to_pylist() for f in fields]
            for row, owner in zip(taken.rows.tolist(), taken.owners.tolist()):
                lines.writerow([*map(repr, row), *(_vectors.spelled(v[owner]) for v in values)])
        if not begun:
            lines.writerow(["x", "y", *fields])


def write_shapes(target: Path, path: str) -> None:
    """The geometries as GeoJSON."""
    file = _opened(path)
    choice = choose(path, file.schema_arrow, None, peek_of(file))
    if not choice.geometries:
        raise InvalidArgument(f"{path}: has no geometries")
    _vectors.write_features(target, _shapes(file, choice))


#: GeoJSON's names of nested lists of this depth.
_SHAPES = {"_rows_of_rings": {2: "Polygon", 3: "MultiPolygon"},
           "_rows_of_nested": {0: "Point", 1: "LineString", 2: "MultiLineString"}}  # fmt: skip


def _shapes(file: Any, choice: Choice) -> Iterator[dict[str, Any]]:
    column = choice.columns[0]
    kind = _storage(file.schema_arrow.field(column).type)
    for batch in file.iter_batches(batch_size=1 << 12, columns=[column]):
        array, _ = _present(batch.column(0))
        for value in array.to_pylist():
            if choice.rows is _rows_of_wkb:
                yield _vectors.shape(value)
            else:
                depth = _nesting(kind) or 0
                name = _SHAPES[getattr(choice.rows, "__name__", "")][depth]
                yield {"type": name, "coordinates": _bare(value)}


def _bare(value: Any) -> Any:
    """Nested lists of structs or numbers as nested lists of numbers."""
    if isinstance(value, dict):
        return [value[axis] for axis in "xyz" if value.get(axis) is not None]
    if isinstance(value, list):
        return [_bare(item) for item in value]
    return value
